"use strict";
// Handles of the picture for the keyboard: ends and arrows of bodies take the focus, and
// arrow keys move them. Begin with `placeHandles`.

const PAGE_STEPS = 10; // steps of a page key
const KEY_STEPS = {
  ArrowRight: 1,
  ArrowUp: 1,
  ArrowLeft: -1,
  ArrowDown: -1,
  PageUp: PAGE_STEPS,
  PageDown: -PAGE_STEPS,
};

/** Handles that the strip offers before contact, each with its path, name and point. */
function offeredHandles({ arrows, ends, frame, middle }) {
  const handles = [];
  for (const { body, tip, y } of arrows) {
    const { kind, name } = page.scene.bodies[body];
    handles.push({
      path: draggedPath(body, "arrow", 1),
      name: `Velocity of ${name}`,
      x: tip,
      y,
    });
    if (kind === "rod") {
      handles.push({
        path: draggedPath(body, "end", 1),
        name: `Length of ${name}`,
        x: frame.across(ends.get(body)[1]),
        y: middle,
      });
    }
  }
  // The strip shows an earlier row while the row of the form cannot be solved.
  return handles.filter(({ path }) => byId(path));
}

/** A new handle for the number at a path. */
function makeHandle(path) {
  const handle = makeElement("span", {
    role: "slider",
    tabindex: 0,
    class: "handle",
    "data-handle": path,
  });
  handle.addEventListener("keydown", (event) => moveHandle(event, path));
  return handle;
}

/** Change the number of a handle by a key, as its slider would. */
function moveHandle(event, path) {
  const steps = KEY_STEPS[event.key];
  if (!steps || isShortcut(event)) {
    return;
  }
  event.preventDefault();
  const step = Number(byId(`slider:${path}`).step);
  let number = byId(path).valueAsNumber + steps * step;
  if (path.endsWith("length")) {
    number = Math.max(step, number);
  }
  enterNumber(path, Number(number.toFixed(6)));
}

/** Let a handle tell its number and be at its point; only what has changed is written. */
function updateHandle(handle, { path, name, x, y }) {
  const slider = byId(`slider:${path}`);
  const attributes = {
    "aria-label": name,
    "aria-valuemin": slider.min,
    "aria-valuemax": slider.max,
    "aria-valuenow": byId(path).value,
    "aria-valuetext": minus(slider.getAttribute("aria-valuetext")),
  };
  for (const [key, text] of Object.entries(attributes)) {
    if (handle.getAttribute(key) !== text) {
      handle.setAttribute(key, text);
    }
  }
  const transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
  if (handle.style.transform !== transform) {
    handle.style.transform = transform;
  }
}

/** Keep one handle for each end and arrow that the strip offers; one with the focus stays. */
function placeHandles(strip) {
  const holder = byId("handles");
  const offered = offeredHandles(strip);
  const paths = offered.map(({ path }) => path);
  for (const handle of [...holder.children]) {
    const isOffered = paths.includes(handle.dataset.handle);
    if (!isOffered && handle !== document.activeElement) {
      handle.remove();
    }
  }
  let before = null; // handles are in the order of the bodies
  for (const offer of offered) {
    let handle = [...holder.children].find(
      ({ dataset }) => dataset.handle === offer.path,
    );
    if (!handle) {
      handle = makeHandle(offer.path);
      const next = before ? before.nextSibling : holder.firstChild;
      holder.insertBefore(handle, next);
    }
    updateHandle(handle, offer);
    before = handle;
  }
}

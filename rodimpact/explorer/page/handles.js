"use strict";
// Handles of the picture for the keyboard: ends and arrows of bodies take the focus, and arrow keys move them.

const PAGE = 10; // steps of a page key

/** Path of the number that dragging a part of a body changes: its velocity, or the length of its outermost segment. */
function draggedPath(body, isArrow, side) {
  if (isArrow) return `bodies.${body}.velocity`;
  const segments = listOf(getAt(design.case.bodies, [body, "segments"]));
  const last = side < 0 ? 0 : segments.length - 1;
  const segment = segments.length ? `.segments.${last}` : "";
  return `bodies.${body}${segment}.length`;
}

/** Handles that the strip offers before the bodies meet, each with its path, its name and its place. */
function offeredHandles({ arrows, ends, frame, middle }) {
  const found = [];
  for (const { body, tip, y } of arrows) {
    const { kind, name } = shown.scene.bodies[body];
    found.push({
      path: draggedPath(body, true, 1),
      name: `Velocity of ${name}`,
      x: tip,
      y,
    });
    if (kind === "rod")
      found.push({
        path: draggedPath(body, false, 1),
        name: `Length of ${name}`,
        x: frame.across(ends.get(body)[1]),
        y: middle,
      });
  }
  // the strip shows an earlier row while the row of the form cannot be solved
  return found.filter(({ path }) => byId(path));
}

function makeHandle(path) {
  const handle = make("span", {
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
  const slider = byId(`slider:${path}`);
  const steps = {
    ArrowRight: 1,
    ArrowUp: 1,
    ArrowLeft: -1,
    ArrowDown: -1,
    PageUp: PAGE,
    PageDown: -PAGE,
  }[event.key];
  if (!steps || event.ctrlKey || event.altKey || event.metaKey) return;
  event.preventDefault();
  const step = Number(slider.step);
  const number = byId(path).valueAsNumber + steps * step;
  const least = path.endsWith("length") ? step : -Infinity;
  enter(path, Number(Math.max(least, number).toFixed(6)));
}

/** Let a handle say its number and stand at its place; only what has changed is written. */
function showHandle(handle, { path, name, x, y }) {
  const slider = byId(`slider:${path}`);
  const said = {
    "aria-label": name,
    "aria-valuemin": slider.min,
    "aria-valuemax": slider.max,
    "aria-valuenow": byId(path).value,
    "aria-valuetext": minus(slider.getAttribute("aria-valuetext")),
  };
  for (const [key, text] of Object.entries(said))
    if (handle.getAttribute(key) !== text) handle.setAttribute(key, text);
  const place = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
  if (handle.style.transform !== place) handle.style.transform = place;
}

/** Keep one handle for each end and arrow that the strip offers; one that has the focus stays. */
function placeHandles(strip) {
  const holder = byId("handles");
  const offered = offeredHandles(strip);
  const paths = offered.map(({ path }) => path);
  for (const handle of [...holder.children])
    if (
      !paths.includes(handle.dataset.handle) &&
      handle !== document.activeElement
    )
      handle.remove();
  let before = null; // handles stand in the order of the bodies
  for (const one of offered) {
    const there = [...holder.children].find(
      ({ dataset }) => dataset.handle === one.path,
    );
    const handle = there || makeHandle(one.path);
    if (!there)
      holder.insertBefore(
        handle,
        before ? before.nextSibling : holder.firstChild,
      );
    showHandle(handle, one);
    before = handle;
  }
}

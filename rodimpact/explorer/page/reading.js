"use strict";
// Reading values off the diagram, and zooming into it.

const MOST_ZOOM = 10000;

/** What is under the reading mark, in words. */
function showReading() {
  const { scene, mark, frame } = shown;
  const found = mark && pick(scene, mark.place, mark.t, frame);
  const { velocity, stress } = scene.tiling;
  const said = !found
    ? "no rod here"
    : `${scene.bodies[found.body].title}, x = ${quantity(found.x, "m")} from its left end: ` +
      `velocity ${quantity(velocity[found.polygon], "m/s")}, stress ${quantity(stress[found.polygon], "Pa")}`;
  document.documentElement.toggleAttribute("data-marked", Boolean(mark));
  write(
    byId("readout"),
    mark
      ? unbroken(`t = ${quantity(mark.t, "s")}: ${said}`)
      : "Drag the red line, the ends of the rods, or their arrows. Point at the diagram to read values.",
  );
}

/** The polygon under a place in the picture and a time, with the place in the body; or null. */
function pick(scene, place, t, frame) {
  const found = slice(scene, t, frame.places).find(
    ({ low, high }) => low <= place && place <= high,
  );
  if (!found) return null;
  const [left, right] = chord(scene, found.polygon, t, scene.tiling.x);
  const x =
    left + ((right - left) * (place - found.low)) / (found.high - found.low);
  return { polygon: found.polygon, body: scene.tiling.body[found.polygon], x };
}

/** Magnify about a place and a time. */
function zoom(factor, place, t) {
  const { view } = shown;
  const whole = wholeView(shown.scene);
  const scale = Math.min(
    factor,
    ((view.right - view.left) / (whole.right - whole.left)) * MOST_ZOOM,
  );
  shown.view = {
    left: place + (view.left - place) / scale,
    right: place + (view.right - place) / scale,
    from: t + (view.from - t) / scale,
    to: t + (view.to - t) / scale,
  };
  keepInside(whole);
  redraw();
}

/** No view is wider than the whole, or beside it. */
function keepInside(whole) {
  const { view } = shown;
  for (const [low, high] of [
    ["left", "right"],
    ["from", "to"],
  ]) {
    const width = Math.min(view[high] - view[low], whole[high] - whole[low]);
    view[low] = Math.max(whole[low], Math.min(view[low], whole[high] - width));
    view[high] = view[low] + width;
  }
  shown.zoomed = view.right - view.left < 0.999 * (whole.right - whole.left);
}

function zoomAtMiddle(factor) {
  const { view, mark } = shown;
  zoom(
    factor,
    mark ? mark.place : (view.left + view.right) / 2,
    mark ? mark.t : (view.from + view.to) / 2,
  );
}

function zoomAll() {
  shown.zoomed = false;
  shown.view = wholeView(shown.scene);
  redraw();
}

function pan(across, up) {
  const { view } = shown;
  const [dx, dt] = [
    across * (view.right - view.left),
    up * (view.to - view.from),
  ];
  shown.view = {
    left: view.left + dx,
    right: view.right + dx,
    from: view.from + dt,
    to: view.to + dt,
  };
  keepInside(wholeView(shown.scene));
  redraw();
}

function moveMark(across, up) {
  const { view } = shown;
  const mark = shown.mark || { place: (view.left + view.right) / 2, t: now() };
  const within = (value, low, high) => Math.max(low, Math.min(high, value));
  shown.mark = {
    place: within(
      mark.place + across * (view.right - view.left),
      view.left,
      view.right,
    ),
    t: within(mark.t + up * (view.to - view.from), view.from, view.to),
  };
  redraw();
}

function diagramKey(event) {
  const arrows = {
    ArrowLeft: [-1, 0],
    ArrowRight: [1, 0],
    ArrowUp: [0, 1],
    ArrowDown: [0, -1],
  };
  if (event.ctrlKey || event.altKey || event.metaKey || !shown.scene) return;
  const [across, up] = arrows[event.key] || [0, 0];
  if (across || up)
    (event.shiftKey ? pan : moveMark)(
      across / (event.shiftKey ? 10 : 50),
      up / (event.shiftKey ? 10 : 50),
    );
  else if (event.key === "+" || event.key === "=") zoomAtMiddle(1.5);
  else if (event.key === "-") zoomAtMiddle(1 / 1.5);
  else if (event.key === "0") zoomAll();
  else if (event.key === "Escape") markAt(null);
  else return;
  event.preventDefault();
}

function markAt(event) {
  if (!shown.frame) return;
  const { frame } = shown;
  const [x, y] = event ? [event.offsetX, event.offsetY] : [-1, -1];
  const inside =
    x >= frame.x && x <= frame.right && y >= frame.y && y <= frame.bottom;
  shown.mark = inside ? { place: frame.placeAt(x), t: frame.timeAt(y) } : null;
  redraw();
}

/** Go to the event whose dot on the time axis is nearest. */
function goToNearest(y) {
  const far = ({ t }) => Math.abs(shown.frame.up(t) - y);
  goTo(
    shown.scene.events.reduce((best, event) =>
      far(event) < far(best) ? event : best,
    ).t,
  );
}

function connectDiagram() {
  const diagram = byId("diagram");
  let [held, timed] = [null, false];
  const atTime = ({ offsetX, offsetY }) =>
    shown.frame &&
    (Math.abs(shown.frame.up(now()) - offsetY) < 8 ||
      (shown.frame.force && offsetX > shown.frame.force.x));
  const follow = ({ offsetY }) =>
    setShare(shareOfTime(shown.frame.timeAt(offsetY)));
  diagram.addEventListener(
    "wheel",
    (event) => {
      if (!shown.frame || !(event.ctrlKey || event.metaKey || shown.zoomed))
        return; // the page scrolls
      event.preventDefault();
      zoom(
        1.0015 ** -event.deltaY,
        shown.frame.placeAt(event.offsetX),
        shown.frame.timeAt(event.offsetY),
      );
    },
    { passive: false },
  );
  diagram.addEventListener("pointerdown", (event) => {
    if (atTime(event)) {
      timed = true;
      play(false);
      follow(event);
      diagram.setPointerCapture(event.pointerId);
      return;
    }
    if (event.offsetX < shown.frame.x + 12) {
      goToNearest(event.offsetY);
      return;
    }
    held = [event.offsetX, event.offsetY];
    diagram.setPointerCapture(event.pointerId);
    markAt(event);
  });
  diagram.addEventListener("pointermove", (event) => {
    diagram.style.cursor = timed || atTime(event) ? "ns-resize" : "";
    if (timed) {
      follow(event);
      return;
    }
    if (held && shown.zoomed) {
      pan(
        (held[0] - event.offsetX) / shown.frame.width,
        (event.offsetY - held[1]) / shown.frame.height,
      );
      held = [event.offsetX, event.offsetY];
    }
    markAt(event);
  });
  diagram.addEventListener("pointerup", () => {
    [held, timed] = [null, false];
  });
  diagram.addEventListener("pointerleave", (event) => {
    [held, timed] = [null, false];
    if (event.pointerType === "mouse") markAt(null); // what a finger has marked stays
  });
  diagram.addEventListener("keydown", diagramKey);
  byId("zoom-in").addEventListener("click", () => zoomAtMiddle(1.5));
  byId("zoom-out").addEventListener("click", () => zoomAtMiddle(1 / 1.5));
  byId("zoom-all").addEventListener("click", zoomAll);
}

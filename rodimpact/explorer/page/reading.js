"use strict";
// Reading values off the diagram, and zooming into it. Begin with `connectDiagram`.

const MAX_ZOOM = 10000;
const ZOOM_STEP = 1.5; // factor of buttons and keys
const WHEEL_STEP = 1.0015; // factor for each pixel that the wheel turns
const TIME_LINE_REACH = 8; // px from the line of the time, to take hold of it
const TIME_AXIS_REACH = 12; // px to the right of the axis of time, for its events
const READING_HELP =
  "Drag the red line, ends of rods, or arrows. Point at the diagram to read values. Dots are events.";

// Values ----------------------------------------------------------------------------------

/** Say what is under the reading mark. */
function showReading() {
  const { mark } = page;
  document.documentElement.toggleAttribute("data-marked", Boolean(mark));
  let text = READING_HELP;
  if (mark) {
    text = unbroken(`t = ${quantity(mark.t, "s")}: ${readingAt(mark)}`);
  }
  setText(byId("readout"), text);
}

/** Velocity and stress at a mark, in words. */
function readingAt({ place, t }) {
  const { scene, frame } = page;
  const point = pointAt(scene, place, t, frame.places);
  if (point === null) {
    return "no rod here";
  }
  const { tiling, bodies } = scene;
  const { title } = bodies[point.body];
  const velocity = quantity(tiling.velocity[point.polygon], "m/s");
  const stress = quantity(tiling.stress[point.polygon], "Pa");
  return (
    `${title}, x = ${quantity(point.x, "m")} from its left end: ` +
    `velocity ${velocity}, stress ${stress}`
  );
}

/** Polygon, body, and x in the body, at a place in the picture at time t; or null. */
function pointAt(scene, place, t, places) {
  const cut = cutPolygons(scene, t, places).find(
    ({ low, high }) => low <= place && place <= high,
  );
  if (!cut) {
    return null;
  }
  const { polygon, low, high } = cut;
  const [left, right] = rangeAt(scene, polygon, t, scene.tiling.x);
  const x = left + ((right - left) * (place - low)) / (high - low);
  return { polygon, body: scene.tiling.body[polygon], x };
}

/** Mark the point of the diagram under a pointer. */
function markAt({ offsetX, offsetY }) {
  const { frame } = page;
  if (!frame) {
    return;
  }
  const isAcross = offsetX >= frame.x && offsetX <= frame.right;
  const isUp = offsetY >= frame.y && offsetY <= frame.bottom;
  page.mark = null;
  if (isAcross && isUp) {
    page.mark = { place: frame.placeAt(offsetX), t: frame.timeAt(offsetY) };
  }
  redraw();
}

/** Take the reading mark away. */
function removeMark() {
  if (!page.frame) {
    return;
  }
  page.mark = null;
  redraw();
}

/** Move the mark by fractions of the view. */
function moveMark(across, up) {
  const { left, right, from, to } = page.view;
  const mark = page.mark || { place: (left + right) / 2, t: currentTime() };
  page.mark = {
    place: clamp(mark.place + across * (right - left), left, right),
    t: clamp(mark.t + up * (to - from), from, to),
  };
  redraw();
}

// Zoom ------------------------------------------------------------------------------------

/** Magnify about a place and a time. */
function zoom(factor, place, t) {
  const { left, right, from, to } = page.view;
  const whole = wholeView(page.scene);
  const widest = ((right - left) / (whole.right - whole.left)) * MAX_ZOOM;
  const scale = Math.min(factor, widest);
  page.view = {
    left: place + (left - place) / scale,
    right: place + (right - place) / scale,
    from: t + (from - t) / scale,
    to: t + (to - t) / scale,
  };
  keepInside(whole);
  redraw();
}

/** Keep the view inside the whole. */
function keepInside(whole) {
  const { view } = page;
  const sides = [
    ["left", "right"],
    ["from", "to"],
  ];
  for (const [low, high] of sides) {
    const width = Math.min(view[high] - view[low], whole[high] - whole[low]);
    view[low] = clamp(view[low], whole[low], whole[high] - width);
    view[high] = view[low] + width;
  }
  page.isZoomed = view.right - view.left < 0.999 * (whole.right - whole.left);
}

/** Magnify about the mark, or the middle of the view. */
function zoomAtMark(factor) {
  const { left, right, from, to } = page.view;
  const middle = { place: (left + right) / 2, t: (from + to) / 2 };
  const { place, t } = page.mark || middle;
  zoom(factor, place, t);
}

/** Show the whole scene. */
function zoomAll() {
  page.isZoomed = false;
  page.view = wholeView(page.scene);
  redraw();
}

/** Move the view by fractions of its width and height. */
function pan(across, up) {
  const { left, right, from, to } = page.view;
  const shift = across * (right - left);
  const delay = up * (to - from);
  page.view = {
    left: left + shift,
    right: right + shift,
    from: from + delay,
    to: to + delay,
  };
  keepInside(wholeView(page.scene));
  redraw();
}

// Pointer and keys ------------------------------------------------------------------------

const ARROWS = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

/** Whether an event has a key that belongs to the browser. */
const isShortcut = ({ ctrlKey, altKey, metaKey }) =>
  ctrlKey || altKey || metaKey;

/** Move the mark or the view, or magnify, by a key. */
function useDiagramKey(event) {
  const { key, shiftKey } = event;
  if (isShortcut(event) || !page.scene) {
    return;
  }
  if (key in ARROWS) {
    const [across, up] = ARROWS[key];
    if (shiftKey) {
      pan(across / 10, up / 10);
    } else {
      moveMark(across / 50, up / 50);
    }
  } else if (key === "+" || key === "=") {
    zoomAtMark(ZOOM_STEP);
  } else if (key === "-") {
    zoomAtMark(1 / ZOOM_STEP);
  } else if (key === "0") {
    zoomAll();
  } else if (key === "Escape") {
    removeMark();
  } else {
    return;
  }
  event.preventDefault();
}

/** Magnify by the wheel, with a key or where the view is magnified; else the page scrolls. */
function useWheel(event) {
  const isMeant = event.ctrlKey || event.metaKey || page.isZoomed;
  if (!page.frame || !isMeant) {
    return;
  }
  event.preventDefault();
  const place = page.frame.placeAt(event.offsetX);
  const t = page.frame.timeAt(event.offsetY);
  zoom(WHEEL_STEP ** -event.deltaY, place, t);
}

/** Whether a pointer is on the line of the time, or in the panel of the forces. */
function isOnTime({ offsetX, offsetY }) {
  const { frame } = page;
  if (!frame) {
    return false;
  }
  const distance = Math.abs(frame.up(currentTime()) - offsetY);
  const isOnForces = frame.force && offsetX > frame.force.x;
  return distance < TIME_LINE_REACH || isOnForces;
}

/** Go to the event whose dot on the axis of time is nearest. */
function goToNearest(y) {
  const distanceOf = ({ t }) => Math.abs(page.frame.up(t) - y);
  let nearest = page.scene.events[0];
  for (const event of page.scene.events) {
    if (distanceOf(event) < distanceOf(nearest)) {
      nearest = event;
    }
  }
  goTo(nearest.t);
}

/** Let the diagram be read, magnified, moved, and used to set the time. */
function connectDiagram() {
  const diagram = byId("diagram");
  let held = null; // the last point, while the view is dragged
  let isTimeHeld = false;
  const followTime = ({ offsetY }) =>
    setFraction(fractionAt(page.frame.timeAt(offsetY)));
  const release = () => {
    held = null;
    isTimeHeld = false;
  };
  diagram.addEventListener("wheel", useWheel, { passive: false });
  diagram.addEventListener("pointerdown", (event) => {
    const { offsetX, offsetY, pointerId } = event;
    if (isOnTime(event)) {
      isTimeHeld = true;
      play(false);
      followTime(event);
      diagram.setPointerCapture(pointerId);
    } else if (offsetX < page.frame.x + TIME_AXIS_REACH) {
      goToNearest(offsetY);
    } else {
      held = { x: offsetX, y: offsetY };
      diagram.setPointerCapture(pointerId);
      markAt(event);
    }
  });
  diagram.addEventListener("pointermove", (event) => {
    const { offsetX, offsetY } = event;
    const isOnLine = isTimeHeld || isOnTime(event);
    diagram.style.cursor = isOnLine ? "ns-resize" : "";
    if (isTimeHeld) {
      followTime(event);
      return;
    }
    if (held && page.isZoomed) {
      const { width, height } = page.frame;
      pan((held.x - offsetX) / width, (offsetY - held.y) / height);
      held = { x: offsetX, y: offsetY };
    }
    markAt(event);
  });
  diagram.addEventListener("pointerup", release);
  diagram.addEventListener("pointerleave", ({ pointerType }) => {
    release();
    if (pointerType === "mouse") {
      removeMark();
    } // the mark of a finger stays
  });
  diagram.addEventListener("keydown", useDiagramKey);
  byId("zoom-in").addEventListener("click", () => zoomAtMark(ZOOM_STEP));
  byId("zoom-out").addEventListener("click", () => zoomAtMark(1 / ZOOM_STEP));
  byId("zoom-all").addEventListener("click", zoomAll);
}

"use strict";
// Dragging in the picture of the rods: ends, arrows, gauges and whole rods. Begin with
// `connectDragging`.

const END_REACH = 10; // px, to take hold of an end
const POINT_REACH = 15; // px, to take hold of a gauge or of the tip of an arrow

/** Write a number into its box, as if the user had typed it. */
function enterNumber(path, number) {
  const box = byId(path);
  if (!box) {
    return;
  }
  box.value = number;
  box.dispatchEvent(new Event("input"));
}

/** Path of the number that a part of a body changes: its velocity, or a length at an end. */
function draggedPath(body, part, side) {
  if (part === "arrow") {
    return `bodies.${body}.velocity`;
  }
  const segments = listOf(getAt(design.case.bodies, [body, "segments"]));
  const outermost = side < 0 ? 0 : segments.length - 1;
  const segment = segments.length > 0 ? `.segments.${outermost}` : "";
  return `bodies.${body}${segment}.length`;
}

// What is under a point -------------------------------------------------------------------

/**
 * What can be dragged at a point of the strip, or null.
 *
 * It has its `body` and `part`, "arrow", "gauge", "end" or "body"; a gauge its `gauge`, an
 * end its `side`, -1 or 1.
 */
function partAt(x, y) {
  const { ends, frame, gauges, arrows } = page.strip;
  const arrow = arrows.find(
    (candidate) => Math.hypot(candidate.tip - x, candidate.y - y) < POINT_REACH,
  );
  if (arrow) {
    return { body: arrow.body, part: "arrow", side: 1 };
  }
  const gauge = gauges.findIndex(
    ([gaugeX, gaugeY]) => Math.hypot(gaugeX - x, gaugeY - y) < POINT_REACH,
  );
  if (gauge >= 0) {
    return { body: page.scene.gauges[gauge].body, part: "gauge", gauge };
  }
  const body = bodyAt(x);
  if (body === undefined) {
    return null;
  }
  const { kind } = page.scene.bodies[body];
  if (kind === "wall") {
    return null;
  }
  if (kind !== "rod") {
    return { body, part: "body" };
  }
  const [left, right] = ends.get(body).map(frame.across);
  const isNear = (end) => Math.abs(end - x) < END_REACH;
  if (isNear(right)) {
    return { body, part: "end", side: 1 };
  }
  if (isNear(left)) {
    return { body, part: "end", side: -1 };
  }
  return { body, part: "body" };
}

/** Index of the body at x, or near x; else undefined. */
function bodyAt(x) {
  const { ends, frame } = page.strip;
  const bodies = [...ends.keys()].sort((a, b) => a - b);
  const find = (reach) =>
    bodies.find((i) => {
      const [left, right] = ends.get(i).map(frame.across);
      return x >= left - reach && x <= right + reach;
    });
  return find(0) ?? find(END_REACH);
}

const CURSORS = {
  arrow: "ew-resize",
  gauge: "ew-resize",
  end: "ew-resize",
  body: "grab",
};

// Dragging --------------------------------------------------------------------------------

/** Change the number that is held as the pointer moves. */
function drag(held, offsetX) {
  const { ends, frame } = page.strip;
  const place = frame.placeAt(offsetX);
  if (held.part === "gauge") {
    const [low, high] = ends.get(held.body);
    const fraction = clamp((place - low) / (high - low), 0, 1);
    enterNumber(`gauges.${held.gauge}.fraction`, Math.round(100 * fraction));
  } else if (held.part === "arrow") {
    const change = (offsetX - held.x) / page.arrowScale;
    enterNumber(held.path, Number((held.number + change).toFixed(1)));
  } else if (held.part === "end") {
    const change = 1000 * held.side * (place - frame.placeAt(held.x)); // mm
    enterNumber(held.path, Math.max(1, Math.round(held.number + change)));
  } else if (held.scene !== page.scene) {
    swapWithNeighbour(held, place);
  }
}

/** Let a body change places with its neighbour when it is dragged beyond its middle. */
function swapWithNeighbour(held, place) {
  const { ends } = page.strip;
  const middle = (body) => (ends.get(body)[0] + ends.get(body)[1]) / 2;
  const direction = Math.sign(place - middle(held.body));
  const next = held.body + direction;
  if (!ends.has(next) || page.scene.bodies[next].kind === "wall") {
    return;
  }
  const isBeyond = (place - middle(next)) * direction > 0;
  if (!isBeyond) {
    return;
  }
  swapBodies(design, held.body, next);
  held.body = next;
  held.scene = page.scene; // no other change before this one is seen
  designChanged(true);
}

/** Let pointers drag the parts of the picture of the rods. */
function connectDragging() {
  const strip = byId("rods");
  let held = null;
  strip.addEventListener("pointerdown", ({ offsetX, offsetY, pointerId }) => {
    held = page.strip && partAt(offsetX, offsetY);
    if (!held) {
      return;
    }
    strip.setPointerCapture(pointerId);
    undoHistory.endChange();
    held.x = offsetX;
    held.path = draggedPath(held.body, held.part, held.side);
    held.number = byId(held.path)?.valueAsNumber;
    page.isDragging = true;
  });
  strip.addEventListener("pointermove", ({ offsetX, offsetY }) => {
    if (!page.strip) {
      return;
    }
    if (held) {
      drag(held, offsetX);
      return;
    }
    const part = partAt(offsetX, offsetY);
    strip.style.cursor = part ? CURSORS[part.part] : "";
  });
  const release = () => {
    if (held) {
      page.isDragging = false;
      zoomAll();
    }
    held = null;
  };
  strip.addEventListener("pointerup", release);
  strip.addEventListener("pointercancel", release);
}

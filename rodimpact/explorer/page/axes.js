"use strict";
// Axes of all pictures: where places and times lie in a drawing, and ticks with their
// labels. Begin with `frameOf` and `drawAxes`.

const FORCE_PANEL = { minWidth: 40, width: 7.5 }; // heights of letters: beside a diagram so wide
const TICK = 4; // px

/**
 * A rectangle for a view in a drawing, and the pixels of places and times in it.
 *
 * A `scene` has room for its names and marks, and for its forces beside a wide diagram.
 */
function frameOf(pen, view, size, scene = null) {
  let top = 0.6;
  let rightEdge = 0.8;
  let beside = 0;
  if (scene && pen.hasNames) {
    top = 1.6;
  }
  if (scene && scene.marks.length > 0) {
    rightEdge = 2.9;
  }
  if (scene && pen.width > FORCE_PANEL.minWidth * size) {
    beside = FORCE_PANEL.width * size;
  }
  const x = 4.2 * size;
  const y = top * size;
  const right = pen.width - rightEdge * size - beside;
  const bottom = pen.height - 3.2 * size;
  const width = Math.max(1, right - x);
  const height = Math.max(1, bottom - y);
  const viewWidth = view.right - view.left;
  const viewHeight = view.to - view.from;
  const frame = {
    x,
    y,
    right,
    bottom,
    width,
    height,
    across: (place) => x + ((place - view.left) / viewWidth) * width,
    up: (t) => bottom - ((t - view.from) / viewHeight) * height,
    placeAt: (px) => view.left + ((px - x) / width) * viewWidth,
    timeAt: (py) => view.from + ((bottom - py) / height) * viewHeight,
  };
  if (beside > 0) {
    frame.force = {
      x: pen.width - beside + 0.6 * size,
      right: pen.width - 0.9 * size,
    };
  }
  return frame;
}

/**
 * Axes with ticks, in one SI prefix each.
 *
 * Each axis has `low`, `high`, `unit` and `name`. The axis of x may have `notes`, which
 * are left out, the last one first, where there is no room.
 */
function drawAxes(pen, frame, theme, { x, y }) {
  const { size } = theme;
  const style = { size: 0.85 * size, colour: theme.faint };
  const corner = [frame.x, frame.bottom];
  const outline = [[frame.x, frame.y], corner, [frame.right, frame.bottom]];
  pen.line(outline, theme.faint, 1);
  drawAxisOfPlaces(pen, frame, theme, x, style);
  const count = Math.max(2, frame.height / (2.6 * size));
  const { ticks, unit } = labelledTicks(y.low, y.high, count, y.unit);
  for (const [value, label] of ticks) {
    const py =
      frame.bottom - ((value - y.low) / (y.high - y.low)) * frame.height;
    pen.segment([frame.x - TICK, py], [frame.x, py], theme.faint);
    pen.text(frame.x - 6, py, label, { ...style, align: "right" });
  }
  const name = [y.name, unit].filter(Boolean).join(", ");
  const middle = (frame.y + frame.bottom) / 2;
  pen.text(0.7 * size, middle, name, {
    ...style,
    align: "center",
    isUpright: true,
  });
}

/** The horizontal axis: ticks, labels, and as much of its name and notes as there is room. */
function drawAxisOfPlaces(pen, frame, theme, axis, style) {
  const { low, high, notes = [] } = axis;
  const { size } = theme;
  const centred = { ...style, align: "center", baseline: "top" };
  const count = Math.max(2, frame.width / (5.5 * size));
  const { ticks, unit } = labelledTicks(low, high, count, axis.unit);
  for (const [value, label] of ticks) {
    const px = frame.x + ((value - low) / (high - low)) * frame.width;
    const labelX = Math.min(px, pen.width - 0.33 * style.size * label.length);
    pen.segment([px, frame.bottom], [px, frame.bottom + TICK], theme.faint);
    pen.text(labelX, frame.bottom + 6, label, centred);
  }
  const middle = (frame.x + frame.right) / 2;
  const room = 2 * Math.min(middle, pen.width - middle);
  const plainName = unit ? `${axis.name}, ${unit}` : axis.name;
  const names = [];
  if (notes.length > 0) {
    names.push(`${plainName} (${notes.join(", ")})`);
    names.push(`${plainName} (${notes[0]})`);
  }
  names.push(plainName);
  const fitting = names.find((name) => 0.53 * style.size * name.length < room);
  const name = fitting || axis.name;
  const fontSize = Math.min(style.size, room / (0.55 * name.length));
  pen.text(middle, frame.bottom + 1.5 * size, name, {
    ...centred,
    size: fontSize,
  });
}

/** The grip by which the time is dragged. */
function drawGrip(pen, x, y, theme) {
  const height = 0.5 * theme.size;
  pen.triangle(
    x + 1.2 * height,
    x - height,
    y,
    height,
    theme.accent,
    theme.paper,
  );
}

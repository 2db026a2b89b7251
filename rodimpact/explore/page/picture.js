"use strict";
// The row in space and time, and the rods at one time: both drawn from the same polygons.

const STOPS = [[22, 37, 110], [83, 101, 159], [160, 160, 160], [214, 192, 95], [255, 233, 74]];
const UNITS = { velocity: "m/s", stress: "Pa" };
const CROWDED = 400; // polygons from which lines would hide the colours

/** Colour of a number from -1 to 1: blue, grey at 0, yellow. */
function colourOf(share) {
  const at = Math.max(0, Math.min(1, (share + 1) / 2)) * (STOPS.length - 1);
  const i = Math.min(STOPS.length - 2, Math.floor(at));
  const mixed = STOPS[i].map((c, k) => Math.round(c + (STOPS[i + 1][k] - c) * (at - i)));
  return { css: `rgb(${mixed.join(",")})`, dark: 0.3 * mixed[0] + 0.59 * mixed[1] + 0.11 * mixed[2] < 115 };
}

/** Place in the picture of a point of a body, displaced, at a time. */
function placeOf(row, body, x, t, displacement) {
  return row.left[body] + x + row.magnification * (row.apart[body] + displacement - row.frame * t);
}

/** Adds what drawing asks for again and again: places in the picture, largest values. */
function prepare(scene) {
  const { start, body, x, t, displacement } = scene.tiling;
  const place = new Array(x.length);
  for (let i = 0; i < body.length; i += 1) {
    for (let k = start[i]; k < start[i + 1]; k += 1) {
      place[k] = placeOf(scene.row, body[i], x[k], t[k], displacement[k]);
    }
  }
  const largest = (values) => values.reduce((most, v) => Math.max(most, Math.abs(v)), 0);
  scene.place = place;
  scene.reach = { velocity: largest(scene.tiling.velocity), stress: largest(scene.tiling.stress) };
  return scene;
}

function shareOf(scene, name, polygon) {
  const reach = scene.reach[name];
  return reach > 0 ? scene.tiling[name][polygon] / reach : 0;
}

/** What all of the scene needs: places from left to right, times from first to last. */
function wholeView(scene) {
  const [low, high] = scene.row.span;
  const edge = 0.04 * (high - low);
  return { left: low - edge, right: high + edge, from: 0, to: scene.end };
}

/** A frame in a drawing, and the pixels of places and times in it. */
function frameOf(pen, view, size) {
  const frame = { x: 4.2 * size, y: 0.6 * size, right: pen.width - 0.8 * size, bottom: pen.height - 3.2 * size };
  frame.width = Math.max(1, frame.right - frame.x);
  frame.height = Math.max(1, frame.bottom - frame.y);
  frame.across = (place) => frame.x + (place - view.left) / (view.right - view.left) * frame.width;
  frame.up = (t) => frame.bottom - (t - view.from) / (view.to - view.from) * frame.height;
  frame.placeAt = (px) => view.left + (px - frame.x) / frame.width * (view.right - view.left);
  frame.timeAt = (py) => view.from + (frame.bottom - py) / frame.height * (view.to - view.from);
  return frame;
}

function cornersOf(scene, i, frame) {
  const corners = [];
  for (let k = scene.tiling.start[i]; k < scene.tiling.start[i + 1]; k += 1) {
    corners.push([frame.across(scene.place[k]), frame.up(scene.tiling.t[k])]);
  }
  return corners;
}

/** Twice the area of a triangle, with its sign. */
function turn([ax, ay], [bx, by], [cx, cy]) {
  return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
}

function contains(corners, point) {
  let left = false;
  let right = false;
  corners.forEach((corner, k) => {
    const side = turn(corner, corners[(k + 1) % corners.length], point);
    left = left || side > 1e-6;
    right = right || side < -1e-6;
  });
  return !(left && right);
}

/** Write the value of a polygon into it, where there is room. */
function writeInto(pen, corners, text, size, colour) {
  const middle = [0, 1].map((axis) => corners.reduce((sum, c) => sum + c[axis], 0) / corners.length);
  const [half, tall] = [0.3 * size * text.length + 3, 0.6 * size];
  const box = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([i, j]) => [middle[0] + i * half, middle[1] + j * tall]);
  if (box.every((point) => contains(corners, point))) {
    pen.text(middle[0], middle[1], text, { size, colour, align: "center" });
  }
}

/** Paths of walls and masses through space and time. */
function drawSolids(pen, scene, frame, theme) {
  scene.bodies.forEach((body, i) => {
    if (!body.path) return;
    const along = (shift) => body.path.t.map((t, k) => [
      frame.across(placeOf(scene.row, i, shift, t, body.path.displacement[k])), frame.up(t)]);
    const near = along(0);
    const far = body.kind === "mass" ? along(body.width)
      : near.map(([, y]) => [i ? pen.width : 0, y]);
    pen.polygon([...near, ...far.reverse()], body.kind === "mass" ? theme.faint : theme.line, theme.ink, 0.7);
  });
}

/** The diagram: every polygon in the colour of its value, axes, and the chosen time. */
function drawDiagram(pen, scene, view, name, now, mark, theme) {
  const size = theme.size;
  const frame = frameOf(pen, view, size);
  const count = scene.tiling.body.length;
  const crowded = count > CROWDED;
  const power = powerFor(scene.reach[name], UNITS[name]);
  pen.inside(frame.x, frame.y, frame.width, frame.height, () => {
    drawSolids(pen, scene, frame, theme);
    for (let i = 0; i < count; i += 1) {
      const corners = cornersOf(scene, i, frame);
      const colour = colourOf(shareOf(scene, name, i));
      pen.polygon(corners, colour.css, crowded ? colour.css : theme.ink, crowded ? 1 : 0.7);
      if (count <= 80) {
        const text = plainNumber(Math.round(scene.tiling[name][i] / 10 ** power * 1e4) / 1e4, 3);
        writeInto(pen, corners, text, 0.85 * size, colour.dark ? "#ffffff" : "#101010");
      }
    }
    pen.line([[frame.x, frame.up(now)], [frame.right, frame.up(now)]], theme.wrong, 1.6);
    if (mark) drawMark(pen, frame, mark, theme);
  });
  drawFrame(pen, frame, size, theme, {
    x: [view.left, view.right, "m", "place"], y: [view.from, view.to, "s", "time"],
    note: scene.row.note,
  });
  return frame;
}

function drawMark(pen, frame, mark, theme) {
  const [x, y] = [frame.across(mark.place), frame.up(mark.t)];
  pen.line([[x, frame.y], [x, frame.bottom]], theme.ink, 0.8, [3, 3]);
  pen.line([[frame.x, y], [frame.right, y]], theme.ink, 0.8, [3, 3]);
}

/** Axes with ticks in one SI prefix each. */
function drawFrame(pen, frame, size, theme, axes) {
  const ink = { size: 0.85 * size, colour: theme.faint };
  pen.line([[frame.x, frame.y], [frame.x, frame.bottom], [frame.right, frame.bottom]], theme.faint, 1);
  const [x0, x1, xUnit, xName] = axes.x;
  const xs = labelledTicks(x0, x1, Math.max(2, frame.width / (5.5 * size)), xUnit);
  for (const [value, label] of xs.ticks) {
    const px = frame.x + (value - x0) / (x1 - x0) * frame.width;
    pen.line([[px, frame.bottom], [px, frame.bottom + 4]], theme.faint, 1);
    pen.text(px, frame.bottom + 6, label, { ...ink, align: "center", baseline: "top" });
  }
  const unit = xs.unit ? `, ${xs.unit}` : "";
  const note = axes.note ? ` (${axes.note})` : "";
  pen.text((frame.x + frame.right) / 2, frame.bottom + 1.5 * size, xName + unit + note,
    { ...ink, align: "center", baseline: "top" });
  const [y0, y1, yUnit, yName] = axes.y;
  const ys = labelledTicks(y0, y1, Math.max(2, frame.height / (2.6 * size)), yUnit);
  for (const [value, label] of ys.ticks) {
    const py = frame.bottom - (value - y0) / (y1 - y0) * frame.height;
    pen.line([[frame.x - 4, py], [frame.x, py]], theme.faint, 1);
    pen.text(frame.x - 6, py, label, { ...ink, align: "right" });
  }
  pen.text(0.7 * size, (frame.y + frame.bottom) / 2, [yName, ys.unit].filter(Boolean).join(", "),
    { ...ink, align: "center", turned: true });
}

/** Cut the polygons at time t: pieces of rods, from left to right, each with its polygon. */
function slice(scene, t) {
  const { start, t: times } = scene.tiling;
  const pieces = [];
  for (let i = 0; i < scene.tiling.body.length; i += 1) {
    let [low, high] = [Infinity, -Infinity];
    for (let k = start[i]; k < start[i + 1]; k += 1) {
      const next = k + 1 < start[i + 1] ? k + 1 : start[i];
      const [a, b] = [times[k], times[next]];
      if ((a - t) * (b - t) > 0) continue;
      const share = a === b ? 0 : (t - a) / (b - a);
      const place = scene.place[k] + (scene.place[next] - scene.place[k]) * share;
      [low, high] = [Math.min(low, place), Math.max(high, place)];
    }
    if (high > low) pieces.push({ polygon: i, low, high });
  }
  return pieces;
}

/** The rods, masses and walls at one time, below the diagram and on the same axis. */
function drawRods(pen, scene, view, name, now, theme) {
  const frame = frameOf(pen, view, theme.size);
  const [top, bottom] = [0.36 * pen.height, 0.92 * pen.height];
  pen.inside(frame.x, 0, frame.width, pen.height, () => {
    const ends = new Map();
    for (const { polygon, low, high } of slice(scene, now)) {
      const box = [[low, top], [high, top], [high, bottom], [low, bottom]].map(([p, y]) => [frame.across(p), y]);
      const { css } = colourOf(shareOf(scene, name, polygon));
      pen.polygon(box, css, css, 0.5);
      const body = scene.tiling.body[polygon];
      const known = ends.get(body) || [Infinity, -Infinity];
      ends.set(body, [Math.min(known[0], low), Math.max(known[1], high)]);
    }
    scene.bodies.forEach((body, i) => {
      if (body.path) ends.set(i, endsOfSolid(scene, i, now, view));
      const [low, high] = ends.get(i) || [0, 0];
      const [x0, x1] = [frame.across(low), frame.across(high)];
      const fill = body.path ? (body.kind === "mass" ? theme.faint : theme.line) : "transparent";
      pen.polygon([[x0, top], [x1, top], [x1, bottom], [x0, bottom]], fill, theme.ink, 1.2);
      const middle = (Math.max(x0, frame.x) + Math.min(x1, frame.right)) / 2;
      pen.text(middle, top - 0.7 * theme.size, body.title, { size: 0.8 * theme.size, colour: theme.faint, align: "center" });
    });
  });
}

function endsOfSolid(scene, i, now, view) {
  const body = scene.bodies[i];
  const moved = valueAt({ t: body.path.t, y: body.path.displacement, steps: false }, now);
  const face = placeOf(scene.row, i, 0, now, moved);
  if (body.kind === "mass") return [face, face + body.width];
  const deep = 0.06 * (view.right - view.left);
  return i ? [face, face + deep] : [face - deep, face];
}

/** The polygon under a place in the picture and a time, with the place in the body; or null. */
function pick(scene, place, t, frame) {
  const point = [frame.across(place), frame.up(t)];
  for (let i = 0; i < scene.tiling.body.length; i += 1) {
    const corners = cornersOf(scene, i, frame);
    if (contains(corners, point)) return { polygon: i, body: scene.tiling.body[i], x: placeInBody(scene, i, corners, point) };
  }
  return null;
}

/** Place in the body at a point of a polygon: linear between its corners. */
function placeInBody(scene, i, corners, point) {
  const x = scene.tiling.x.slice(scene.tiling.start[i], scene.tiling.start[i + 1]);
  let best = [0, 1, 2];
  for (let k = 1; k + 1 < corners.length; k += 1) {
    const fan = [0, k, k + 1];
    if (contains(fan.map((j) => corners[j]), point)) best = fan;
  }
  const [a, b, c] = best.map((j) => corners[j]);
  const all = turn(a, b, c);
  if (all === 0) return x[best[0]];
  const [p, q] = [turn(point, b, c) / all, turn(a, point, c) / all];
  return p * x[best[0]] + q * x[best[1]] + (1 - p - q) * x[best[2]];
}

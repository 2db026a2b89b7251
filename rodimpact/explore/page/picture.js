"use strict";
// The row in space and time, and the rods at one time: both drawn from the same polygons.

const STOPS = { // blue, nearly the paper's colour at 0, yellow
  light: [[22, 37, 110], [112, 132, 196], [244, 244, 241], [238, 198, 84], [196, 134, 0]],
  dark: [[157, 183, 255], [78, 98, 160], [38, 43, 51], [150, 122, 48], [255, 233, 74]],
};
const UNITS = { velocity: "m/s", stress: "Pa" };
const CROWDED = 400; // polygons from which lines would hide the colours
const THICKER = 0.22; // of a rod, where it is compressed most

/** Colour of a number from -1 to 1. */
function colourOf(share, { stops }) {
  const at = Math.max(0, Math.min(1, (share + 1) / 2)) * (stops.length - 1);
  const i = Math.min(stops.length - 2, Math.floor(at));
  return stops[i].map((c, k) => Math.round(c + (stops[i + 1][k] - c) * (at - i)));
}

function css(colour) {
  return `rgb(${colour.join(",")})`;
}

function isDark([red, green, blue]) {
  return 0.3 * red + 0.59 * green + 0.11 * blue < 115;
}

function shareOf(scene, name, polygon) {
  const reach = scene.reach[name];
  return reach > 0 ? scene.tiling[name][polygon] / reach : 0;
}

/** What all of the scene needs: places from left to right, times from first to last. */
function wholeView(scene) {
  const [low, high] = scene.row.span;
  const edge = 0.04 * (high - low);
  return { left: low - edge, right: high + edge, from: filmSpan().begin, to: filmSpan().end };
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
    corners.push([frame.across(frame.places[k]), frame.up(scene.tiling.t[k])]);
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

/** Place of a point of a body in the diagram: where it is, or where it was at rest. */
function placeInDiagram(scene, frame, body, x, t, displacement) {
  return frame.displaced ? placeOf(scene.row, body, x, t, displacement) : scene.row.left[body] + x;
}

/** Paths of walls and masses through space and time. */
function drawSolids(pen, scene, frame, theme) {
  scene.bodies.forEach((body, i) => {
    if (!body.path) return;
    const along = (shift) => body.path.t.map((t, k) => [
      frame.across(placeInDiagram(scene, frame, i, shift, t, body.path.displacement[k])), frame.up(t)]);
    const near = along(0);
    const far = body.kind === "mass" ? along(body.width)
      : near.map(([, y]) => [i ? pen.width : 0, y]);
    pen.polygon([...near, ...far.reverse()], body.kind === "mass" ? theme.faint : theme.line, theme.ink, 0.7);
  });
}

/** Cells as one smooth picture each; `row` picks one time, interpolated. */
function imageOf(scene, grid, name, theme, row = null) {
  const { across, first } = grid;
  const high = row === null ? grid.rows : 1;
  const image = document.createElement("canvas");
  Object.assign(image, { width: across, height: high });
  const pixels = new ImageData(across, high);
  for (let j = 0; j < high; j += 1) {
    const from = row === null ? high - 1 - j : Math.floor(row);
    const next = row === null ? from : Math.min(grid.rows - 1, from + 1);
    for (let i = 0; i < across; i += 1) {
      const shares = [from, next].map((k) => shareOf(scene, name, first + k * across + i));
      const share = row === null ? shares[0] : shares[0] + (shares[1] - shares[0]) * (row - from);
      pixels.data.set([...colourOf(share, theme), 255], 4 * (j * across + i));
    }
  }
  image.getContext("2d").putImageData(pixels, 0, 0);
  return image;
}

function drawGrids(pen, scene, frame, name, theme) {
  const key = name + theme.name;
  for (const grid of scene.grids) {
    grid.images ||= {};
    grid.images[key] ||= imageOf(scene, grid, name, theme);
    const [x0, x1] = [grid.left, grid.right].map((x) => frame.across(scene.row.left[grid.body] + x));
    const [y0, y1] = [frame.up(scene.end), frame.up(0)];
    pen.image(grid.images[key], x0, y0, x1 - x0, y1 - y0);
    pen.line([[x0, y1], [x0, y0], [x1, y0], [x1, y1]], theme.ink, 0.7);
  }
}

/** Polygons of one colour each; lines between them where they are few. */
function drawPolygons(pen, scene, frame, name, theme, from) {
  const count = scene.tiling.body.length;
  const crowded = count > CROWDED;
  const power = powerFor(scene.reach[name], UNITS[name]);
  for (let i = from; i < count; i += 1) {
    const corners = cornersOf(scene, i, frame);
    const colour = colourOf(shareOf(scene, name, i), theme);
    pen.polygon(corners, css(colour), crowded ? css(colour) : theme.ink, crowded ? 1 : 0.7);
    if (count <= 80) {
      const text = plainNumber(Math.round(scene.tiling[name][i] / 10 ** power * 1e4) / 1e4, 3);
      writeInto(pen, corners, text, 0.85 * theme.size, isDark(colour) ? "#ffffff" : "#101010");
    }
  }
}

/** A spring in the diagram: the darker, the harder it presses. */
function drawSpring(pen, scene, frame, contact, { from, to }, theme) {
  const right = scene.row.left[contact.index + 1];
  const [x0, x1] = [frame.across(right - contact.room), frame.across(right)];
  const most = largestOf(contact.force.y);
  for (let k = 0; k < 40; k += 1) {
    const [t0, t1] = [from + (to - from) * k / 40, from + (to - from) * (k + 1) / 40];
    const share = Math.abs(valueAt(contact.force, (t0 + t1) / 2)) / most;
    const shade = css(theme.inks.map((c, i) => Math.round(theme.papers[i] + (c - theme.papers[i]) * 0.75 * share)));
    pen.polygon([[x0, frame.up(t0)], [x1, frame.up(t0)], [x1, frame.up(t1)], [x0, frame.up(t1)]], shade, shade);
  }
}

/** Contacts over time: a thick line where they press, none where they are open; springs as bands. */
function drawContacts(pen, scene, frame, theme) {
  for (const contact of scene.contacts) {
    if (contact.bonded || frame.displaced) continue;
    const x = frame.across(scene.row.left[contact.index + 1]);
    for (const { from, to, state } of contact.spells) {
      if (contact.room) {
        if (state === "pressing") drawSpring(pen, scene, frame, contact, { from, to }, theme);
        continue;
      }
      const line = [[x, frame.up(from)], [x, frame.up(to)]];
      if (state === "open") {
        pen.line(line, theme.ink, 6);
        pen.line(line, theme.paper, 4.5);
      } else pen.line(line, theme.ink, state === "pressing" ? 3.5 : 1);
    }
  }
}

/** The diagram: every polygon in the colour of its value, axes, and the chosen time. */
function drawDiagram(pen, scene, look, now, mark, theme) {
  const { view, quantity: name, displaced } = look;
  const frame = frameOf(pen, view, theme.size);
  Object.assign(frame, { displaced, places: displaced ? scene.place : scene.rest });
  const smooth = scene.grids && !displaced;
  pen.inside(frame.x, frame.y, frame.width, frame.height, () => {
    drawSolids(pen, scene, frame, theme);
    if (smooth) drawGrids(pen, scene, frame, name, theme);
    drawPolygons(pen, scene, frame, name, theme, smooth ? scene.cells : 0);
    drawContacts(pen, scene, frame, theme);
    pen.line([[frame.x, frame.up(now)], [frame.right, frame.up(now)]], theme.wrong, 1.6);
    if (mark) drawMark(pen, frame, mark, theme);
  });
  const springs = scene.contacts.some((contact) => contact.room) ? "springs drawn wide" : "";
  const note = displaced ? scene.row.note : "before it moves";
  drawFrame(pen, frame, theme.size, theme, {
    x: [view.left, view.right, "m", "place"], y: [view.from, view.to, "s", "time"],
    note: [note, springs].filter(Boolean).join(", "),
  });
  for (const { t } of scene.events) {
    if (t >= view.from && t <= view.to) pen.disc(frame.x, frame.up(t), 0.3 * theme.size, theme.series[0]);
  }
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
  const name = xName + unit + note;
  pen.text((frame.x + frame.right) / 2, frame.bottom + 1.5 * size, name,
    { ...ink, size: Math.min(ink.size, pen.width / (0.55 * name.length)), align: "center", baseline: "top" });
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
  return pieces.sort((a, b) => a.low - b.low);
}

/** The rods, masses and walls at one time, below the diagram and on the same axis; where all is. */
function drawRods(pen, scene, look, now, theme) {
  const { view, quantity: name } = look;
  const frame = frameOf(pen, view, theme.size);
  const [middle, half] = [0.53 * pen.height, 0.23 * pen.height];
  const gauges = [];
  const ends = new Map();
  const outlines = new Map();
  pen.inside(frame.x, 0, frame.width, pen.height, () => {
    for (const { polygon, low, high } of slice(scene, now)) {
      const body = scene.tiling.body[polygon];
      const x = (scene.tiling.x[scene.tiling.start[polygon]] + scene.tiling.x[scene.tiling.start[polygon] + 1]) / 2;
      const thick = half * widthAt(scene, body, x) * (1 - THICKER * shareOf(scene, "stress", polygon));
      const box = [low, high].map((place) => [frame.across(place), thick]);
      outlines.set(body, [...(outlines.get(body) || []), ...box]);
      const known = ends.get(body) || [Infinity, -Infinity];
      ends.set(body, [Math.min(known[0], low), Math.max(known[1], high)]);
      if (scene.grids && now > 0) continue;
      const [[x0], [x1]] = box;
      const fill = css(colourOf(shareOf(scene, name, polygon), theme));
      pen.polygon([[x0, middle - thick], [x1, middle - thick], [x1, middle + thick], [x0, middle + thick]], fill, fill, 0.5);
    }
    if (scene.grids && now > 0) drawSlices(pen, scene, frame, name, now, middle, half, ends, outlines, theme);
    scene.bodies.forEach((body, i) => {
      if (body.path) ends.set(i, endsOfSolid(scene, i, now, view));
      const [x0, x1] = (ends.get(i) || [0, 0]).map(frame.across);
      const fill = body.path ? (body.kind === "mass" ? theme.faint : theme.line) : "transparent";
      const upper = outlines.get(i) || [[x0, half], [x1, half]];
      pen.polygon([...upper.map(([x, h]) => [x, middle - h]), ...upper.map(([x, h]) => [x, middle + h]).reverse()],
        fill, theme.ink, 1.2);
    });
    nameBodies(pen, scene, frame, ends, theme);
    for (const contact of scene.contacts) drawContact(pen, scene, frame, contact, now, ends, middle, half, theme);
    for (const { body, fraction } of scene.gauges) {
      const [low, high] = ends.get(body);
      gauges.push([frame.across(low + fraction * (high - low)), middle - half * widthAt(scene, body, fraction * scene.lengths[body])]);
    }
    for (const [x, y] of gauges) drawGauge(pen, x, y, theme);
  });
  return { frame, ends, gauges, middle };
}

/** Names above the rods; numbers where names would overlap. */
function nameBodies(pen, scene, frame, ends, theme) {
  const size = 0.8 * theme.size;
  const seen = scene.bodies.map((_, i) => {
    const [x0, x1] = ends.get(i).map(frame.across);
    return [Math.max(x0, frame.x), Math.min(x1, frame.right)];
  });
  const fit = scene.bodies.every(({ path, title }, i) => path || 0.6 * size * title.length < seen[i][1] - seen[i][0]);
  scene.bodies.forEach(({ title }, i) => {
    const [from, to] = seen[i];
    if (fit || to - from > size) {
      pen.text((from + to) / 2, size, fit ? title : String(i), { size, colour: theme.faint, align: "center" });
    }
  });
}

/** Rods of cells, smooth from end to end. */
function drawSlices(pen, scene, frame, name, now, middle, half, ends, outlines, theme) {
  for (const grid of scene.grids) {
    const [low, high] = ends.get(grid.body);
    const long = scene.lengths[grid.body];
    const [x0, x1] = [grid.left, grid.right].map((x) => frame.across(low + (high - low) * x / long));
    const row = Math.max(0, Math.min(grid.rows - 1, now / scene.end * grid.rows - 0.5));
    const thickest = half * (1 + THICKER);
    pen.image(imageOf(scene, grid, name, theme, row), x0, middle - thickest, x1 - x0, 2 * thickest);
  }
  for (const [body, points] of outlines) { // hide what is outside of the outline
    const smooth = points.filter((_, k) => k % 2 === 0).map(([x, h], k) => [(x + points[2 * k + 1][0]) / 2, h]);
    const outline = [[points[0][0], smooth[0][1]], ...smooth, [points.at(-1)[0], smooth.at(-1)[1]]];
    outlines.set(body, outline);
    for (const side of [-1, 1]) {
      const edge = middle + side * half * (1 + 2 * THICKER);
      pen.polygon([...outline.map(([x, h]) => [x, middle + side * h]), [outline.at(-1)[0] + 1, edge], [outline[0][0] - 1, edge]],
        theme.paper, theme.paper, 1);
    }
  }
}

/** A contact of the strip: arrow heads where it presses, a spring where it has one. */
function drawContact(pen, scene, frame, contact, now, ends, middle, half, theme) {
  if (contact.bonded) return;
  const [left, right] = [ends.get(contact.index), ends.get(contact.index + 1)];
  if (!left || !right) return;
  const [x0, x1] = [frame.across(left[1]), frame.across(right[0])];
  if (contact.room) {
    const reach = Math.min(x1, frame.across(left[1] + contact.room));
    const turns = [0.1, 0.3, 0.5, 0.7, 0.9].map((share, k) => [x0 + share * (reach - x0), middle + (k % 2 ? 0.5 : -0.5) * half]);
    pen.line([[x0, middle], ...turns, [reach, middle]], theme.ink, 1.4);
  }
  if (stateAt(contact, now) !== "pressing") return;
  const [x, y, w] = [(x0 + x1) / 2, middle + half * (1 + THICKER) + 0.45 * theme.size, 0.4 * theme.size];
  for (const side of [-1, 1]) pen.polygon([[x + side, y], [x + side * 2.4 * w, y - w], [x + side * 2.4 * w, y + w]], theme.wrong, null);
}

function drawGauge(pen, x, top, theme) {
  const w = 0.4 * theme.size;
  pen.polygon([[x, top + w], [x - w, top - 0.6 * w], [x + w, top - 0.6 * w]], theme.series[0], theme.paper, 1);
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

"use strict";
// The bodies at one time: polygons of the diagram, cut at this time. Begin with
// `cutPolygons` and `endsAt`.

const MIN_CUT_RTOL = 1e-9; // a cut shorter than this part of the row is a point
const WALL_DEPTH = 0.06; // part of the width of the view
const THINNEST = 0.3; // least width of a rod, in widths of the thickest rod

/** Value of a curve at time t. */
const valueAt = (curve, t) => solver.value_at(curve, t);

/** State of a contact at time t: "open", "touching" or "pressing". */
function stateAt({ spells }, t) {
  const spell = spells.find(({ to }) => t < to) || spells.at(-1);
  return spell ? spell.state : "touching";
}

/** Places of all corners in the picture. */
const placesOf = (scene, isDisplaced) =>
  isDisplaced ? scene.places : scene.restPlaces;

/** Smallest and largest of the values that a polygon has on its boundary at time t. */
function rangeAt({ tiling }, polygon, t, values) {
  const first = tiling.start[polygon];
  const end = tiling.start[polygon + 1];
  let low = Infinity;
  let high = -Infinity;
  for (let k = first; k < end; k += 1) {
    const next = k + 1 < end ? k + 1 : first;
    const before = tiling.t[k];
    const after = tiling.t[next];
    const isOnOneSide = (before - t) * (after - t) > 0; // the edge does not cross t
    if (isOnOneSide) {
      continue;
    }
    let fraction = 0;
    if (before !== after) {
      fraction = (t - before) / (after - before);
    }
    const value = values[k] + (values[next] - values[k]) * fraction;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return [low, high];
}

/** Cut the polygons at time t: pieces of rods from left to right, each with its polygon. */
function cutPolygons(scene, t, places = scene.places) {
  const pieces = [];
  for (let polygon = 0; polygon < scene.tiling.body.length; polygon += 1) {
    const [low, high] = rangeAt(scene, polygon, t, places);
    if (high - low > MIN_CUT_RTOL * scene.length) {
      pieces.push({ polygon, low, high });
    }
  }
  return pieces.sort((a, b) => a.low - b.low);
}

/** Left and right end of every body at time t, by its number. */
function endsAt(scene, t, { view, isDisplaced }) {
  const ends = new Map();
  const places = placesOf(scene, isDisplaced);
  for (const { polygon, low, high } of cutPolygons(scene, t, places)) {
    const body = scene.tiling.body[polygon];
    const [left, right] = ends.get(body) || [low, high];
    ends.set(body, [Math.min(left, low), Math.max(right, high)]);
  }
  scene.bodies.forEach(({ path }, i) => {
    if (path) {
      ends.set(i, endsOfSolid(scene, i, t, view, isDisplaced));
    }
  });
  return ends;
}

/** Ends of a mass or a wall at time t. */
function endsOfSolid(scene, i, t, view, isDisplaced) {
  const { kind, path } = scene.bodies[i];
  let face = scene.row.left[i];
  if (isDisplaced) {
    face = valueAt(pathOf(scene, i, 0, path), t);
  }
  if (kind === "mass") {
    return [face, face + scene.lengths[i]];
  }
  const depth = WALL_DEPTH * (view.right - view.left);
  return i > 0 ? [face, face + depth] : [face - depth, face];
}

/** The segment of a rod at x. */
function segmentAt(scene, body, x) {
  const { segments } = scene.bodies[body];
  let end = 0;
  for (const segment of segments) {
    end += segment.length;
    if (end > x) {
      return segment;
    }
  }
  return segments.at(-1);
}

/** Radius of a rod at x over the largest radius; not too small to be seen. */
function radiusAt(scene, body, x) {
  const { area } = segmentAt(scene, body, x);
  return Math.max(THINNEST, Math.sqrt(area / scene.largestArea));
}

"use strict";
// Layout of a scene in the picture: places of all points, room for springs, and the time
// before the bodies meet. Begin with `prepareScene`.

const SPRING_ROOM = 0.04; // length of a spring at rest, part of the row's
const CLOSED_GAP_RTOL = 1e-12; // smaller gaps, as parts of the row, are closed
const SAME_PLACE_RTOL = 1e-6; // part of the length of a body
const APPROACH = { way: 0.12, time: 0.2 }; // limits, as parts of the row and of the film

/** Largest magnitude of some values; 0 without any. */
const largestOf = (values) =>
  values.reduce((largest, value) => Math.max(largest, Math.abs(value)), 0);

/** The smallest and the largest of some values. */
function rangeOf(values) {
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return [low, high];
}

/** Place in the picture of the point x of a body with a displacement, at time t. */
function placeOf(row, body, x, t, displacement) {
  const offset = row.offsets[body] + displacement - row.frame * t;
  return row.left[body] + x + row.magnification * offset;
}

/** Path of a point of a body through the picture: places `y` over times `t`. */
function pathOf(scene, body, x, { t, displacement }) {
  const y = t.map((time, k) =>
    placeOf(scene.row, body, x, time, displacement[k]),
  );
  return { t, y };
}

/** Add to a scene what drawing needs again and again. */
function prepareScene(scene) {
  const { tiling, row } = scene;
  scene.ranges = {
    velocity: rangeOf(tiling.velocity),
    stress: rangeOf(tiling.stress),
  };
  scene.largest = {
    velocity: largestOf(tiling.velocity),
    stress: largestOf(tiling.stress),
  };
  scene.lengths = lengthsOf(scene);
  const areas = scene.bodies.flatMap(({ segments }) =>
    segments.map(({ area }) => area),
  );
  scene.largestArea = Math.max(...areas);
  row.left = []; // left ends of the bodies side by side
  let left = 0;
  for (const length of scene.lengths) {
    row.left.push(left);
    left += length;
  }
  scene.length = left;
  scene.begin = 0;
  if (!scene.exact) {
    scene.grids = cutGrids(tiling);
  }
  scene.cellCount = tiling.body.length;
  scene.plots = [...plotsOfContacts(scene), ...scene.plots].filter(
    ({ series }) => series.length > 0,
  );
  const unilateral = scene.contacts.filter(({ gap }) => gap);
  addSpringRoom(scene, unilateral);
  addApproach(scene, unilateral);
  setPlaces(scene);
  for (const contact of scene.contacts) {
    const { index } = contact;
    contact.spells = solver.spells_of(contact);
    contact.faces = [
      faceOf(scene, index, scene.lengths[index]),
      faceOf(scene, index + 1, 0),
    ];
  }
  scene.centres = centresOf(scene);
  scene.marks = marksOf(scene);
  return scene;
}

/** Set the places of all corners, displaced and at rest, and the spans that they fill. */
function setPlaces(scene) {
  const { row } = scene;
  const { start, body, x, t, displacement } = scene.tiling;
  scene.places = new Array(x.length);
  scene.restPlaces = new Array(x.length);
  for (let i = 0; i < body.length; i += 1) {
    for (let k = start[i]; k < start[i + 1]; k += 1) {
      scene.places[k] = placeOf(row, body[i], x[k], t[k], displacement[k]);
      scene.restPlaces[k] = row.left[body[i]] + x[k];
    }
  }
  scene.restSpan = [row.left[0], row.left.at(-1) + scene.lengths.at(-1)];
  const places = [...scene.places];
  scene.bodies.forEach(({ path }, i) => {
    if (!path) {
      return;
    }
    places.push(...pathOf(scene, i, 0, path).y);
    places.push(...pathOf(scene, i, scene.lengths[i], path).y);
  });
  row.span = rangeOf(places);
}

/** Path of the face at x of a body. */
function faceOf(scene, body, x) {
  const { path } = scene.bodies[body];
  if (path) {
    return pathOf(scene, body, x, path);
  }
  const { tiling } = scene;
  const { start } = tiling;
  const tolerance = SAME_PLACE_RTOL * scene.lengths[body];
  const places = new Map(); // place at each time
  tiling.body.forEach((owner, i) => {
    if (owner !== body) {
      return;
    }
    for (let k = start[i]; k < start[i + 1]; k += 1) {
      if (Math.abs(tiling.x[k] - x) < tolerance) {
        places.set(tiling.t[k], scene.places[k]);
      }
    }
  });
  const times = [...places.keys()].sort((a, b) => a - b);
  return { t: times, y: times.map((time) => places.get(time)) };
}

/** Times at which the wave that a contact sends into a uniform rod is back: 2 l/c later. */
function marksOf({ bodies, contacts, end }) {
  if (contacts.length !== 1) {
    return [];
  }
  const first = contacts[0].spells.find(({ state }) => state === "pressing");
  if (!first) {
    return [];
  }
  const marks = [];
  for (const { number, segments } of bodies) {
    if (segments.length !== 1) {
      continue;
    }
    const t = first.from + 2 * segments[0].transit_time;
    if (t <= end) {
      marks.push({ t, text: `2l${subscript(number)}/c` });
    }
  }
  marks.sort((a, b) => a.t - b.t);
  const isOneTime =
    marks.length === 2 &&
    Math.abs(marks[0].t - marks[1].t) < SAME_TIME_RTOL * end;
  return isOneTime ? [{ t: marks[0].t, text: "2l/c" }] : marks;
}

/** Length in the picture of each body. */
function lengthsOf({ bodies, tiling, row }) {
  const lengths = bodies.map(({ kind }) =>
    kind === "mass" ? row.mass_width : 0,
  );
  tiling.body.forEach((body, i) => {
    for (let k = tiling.start[i]; k < tiling.start[i + 1]; k += 1) {
      lengths[body] = Math.max(lengths[body], tiling.x[k]);
    }
  });
  return lengths;
}

/** Figures of the forces and gaps of the contacts. */
function plotsOfContacts({ contacts }) {
  const forces = [];
  const gaps = [];
  let gapTitle = "Gap";
  for (const contact of contacts) {
    const { force, gap } = contact;
    force.name = `contact ${contact.name}`;
    forces.push(force);
    if (gap) {
      gap.name = force.name;
      gaps.push(gap);
    }
    if (contact.compliant) {
      gapTitle = "Gap, below 0 overlap";
    }
  }
  return [
    { key: "force", title: "Contact force", unit: "N", series: forces },
    { key: "gap", title: gapTitle, unit: "m", series: gaps },
  ];
}

/** Move bodies to the right of compliant contacts until their faces never overlap. */
function addSpringRoom(scene, contacts) {
  const { row } = scene;
  for (const contact of contacts) {
    if (!contact.compliant) {
      continue;
    }
    const overlap = Math.max(0, -Math.min(...contact.gap.y));
    contact.room = row.magnification * overlap + SPRING_ROOM * scene.length;
    for (let i = contact.index + 1; i < row.left.length; i += 1) {
      row.left[i] += contact.room;
    }
  }
}

// The time before contact -----------------------------------------------------------------

/** Let the film begin before bodies meet, if each comes unstrained with one velocity. */
function addApproach(scene, contacts) {
  const { bodies, row } = scene;
  if (bodies.some(({ approach }) => approach === null)) {
    return;
  }
  const closing = contacts.map(({ index, gap }) => {
    if (Math.abs(gap.y[0]) >= CLOSED_GAP_RTOL * scene.length) {
      return 0;
    }
    return bodies[index].approach - bodies[index + 1].approach;
  });
  const fastest = Math.max(0, ...closing);
  if (fastest === 0 || Math.min(...closing) < 0) {
    return;
  }
  const way = (APPROACH.way * scene.length) / (row.magnification * fastest);
  scene.begin = -Math.min(way, APPROACH.time * scene.end);
  bodies.forEach((body, i) => addApproachOfBody(scene, body, i));
  for (const { key, series } of scene.plots) {
    for (const curve of series) {
      const contact = contacts.find(({ gap }) => gap === curve);
      if (contact) {
        addApproachOfGap(scene, contact);
      } else {
        const value = key === "energy" ? curve.y[0] : 0;
        curve.y.unshift(value, value);
        curve.t.unshift(scene.begin, 0);
      }
    }
  }
}

/** Add the motion of a body before t = 0: to its path, or as a polygon. */
function addApproachOfBody({ begin, lengths, tiling }, { approach, path }, i) {
  const displacement = approach * begin;
  if (path) {
    path.t.unshift(begin);
    path.displacement.unshift(path.displacement[0] + displacement);
    return;
  }
  const length = lengths[i];
  tiling.body.push(i);
  tiling.velocity.push(approach);
  tiling.stress.push(0);
  tiling.x.push(0, length, length, 0);
  tiling.t.push(begin, begin, 0, 0);
  tiling.displacement.push(displacement, displacement, 0, 0);
  tiling.start.push(tiling.x.length);
}

/** Add the gap of a contact before t = 0, which closes evenly. */
function addApproachOfGap({ begin, bodies }, { index, gap }) {
  const opening = bodies[index + 1].approach - bodies[index].approach;
  const gapAtContact = gap.y[0];
  gap.y.unshift(gapAtContact + opening * begin, gapAtContact);
  gap.t.unshift(begin, 0);
}

// Grids -----------------------------------------------------------------------------------

/** Make a polygon of each cell of the grids; returns the grids. */
function cutGrids(tiling) {
  const { x, t, displacement } = tiling;
  const cells = { body: [], start: [0], x: [], t: [], displacement: [] };
  const grids = tiling.body.map((body, g) => {
    const first = tiling.start[g]; // point
    const across = tiling.across[g];
    const rows = (tiling.start[g + 1] - first) / (across + 1) - 1;
    const firstCell = cells.body.length;
    for (let i = 0; i < rows * across; i += 1) {
      // Point at the lower left corner of cell i: a row has one point more than cells.
      const k = first + i + Math.floor(i / across);
      cells.body.push(body);
      for (const corner of [k, k + 1, k + across + 2, k + across + 1]) {
        cells.x.push(x[corner]);
        cells.t.push(t[corner]);
        cells.displacement.push(displacement[corner]);
      }
      cells.start.push(cells.x.length);
    }
    const left = x[first];
    const right = x[first + across];
    return { body, first: firstCell, across, rows, left, right };
  });
  Object.assign(tiling, cells);
  return grids;
}

"use strict";
// Where a scene is drawn: places in the picture, room for springs, and the time before contact.

const ROOM = 0.04; // of a spring at rest, in lengths of the row
const THINNEST = 0.3; // of the thickest rod
const MOMENTS = 60; // of the path of a centre of mass
const TOUCHING = 1e-12; // of the row: a gap that is none
const APPROACH = { way: 0.12, time: 0.2 }; // at most: in lengths of the row, in lengths of the film

const largestOf = (values) =>
  values.reduce((most, v) => Math.max(most, Math.abs(v)), 0);

/** The least and the largest of some values. */
const rangeIn = (values) =>
  values.reduce(
    ([low, high], value) => [Math.min(low, value), Math.max(high, value)],
    [Infinity, -Infinity],
  );

/** What a contact does at a time: it is open, it touches, or it presses. */
function stateAt(contact, t) {
  const spell =
    contact.spells.find(({ to }) => t < to) || contact.spells.at(-1);
  return spell ? spell.state : "touching";
}

/** Place in the picture of a point of a body, displaced, at a time. */
function placeOf(row, body, x, t, displacement) {
  return (
    row.left[body] +
    x +
    row.magnification * (row.apart[body] + displacement - row.frame * t)
  );
}

/** Adds what drawing asks for again and again: places, largest values, states of contacts. */
function prepare(scene) {
  const { tiling, row } = scene;
  scene.own = {
    velocity: largestOf(tiling.velocity),
    stress: largestOf(tiling.stress),
  };
  scene.ownRange = {
    velocity: rangeIn(tiling.velocity),
    stress: rangeIn(tiling.stress),
  };
  scene.lengths = lengthsOf(scene);
  row.left = scene.lengths.map((_, i) =>
    scene.lengths.slice(0, i).reduce((sum, length) => sum + length, 0),
  );
  scene.length = row.left.at(-1) + scene.lengths.at(-1);
  scene.begin = 0;
  if (!scene.exact) scene.grids = gridsOf(tiling);
  scene.cells = tiling.body.length;
  const gaps = plotContacts(scene);
  makeRoom(scene, gaps);
  approach(scene, gaps);
  const { start, body, x, t, displacement } = tiling;
  scene.place = new Array(x.length);
  scene.rest = new Array(x.length);
  for (let i = 0; i < body.length; i += 1) {
    for (let k = start[i]; k < start[i + 1]; k += 1) {
      scene.place[k] = placeOf(row, body[i], x[k], t[k], displacement[k]);
      scene.rest[k] = row.left[body[i]] + x[k];
    }
  }
  scene.whole = [row.left[0], row.left.at(-1) + scene.lengths.at(-1)]; // with room for springs
  const solids = scene.bodies.flatMap(({ path }, i) =>
    path
      ? [0, scene.lengths[i]].flatMap((x) => pathOf(scene, i, x, path).y)
      : [],
  );
  row.span = rangeIn([...scene.place, ...solids]);
  for (const contact of scene.contacts) {
    contact.spells = fronts.spells_of(contact);
    contact.faces = [
      faceOf(scene, contact.index, scene.lengths[contact.index]),
      faceOf(scene, contact.index + 1, 0),
    ];
  }
  scene.centres = centresOf(scene);
  scene.marks = marksOf(scene);
  return scene;
}

/** Path of a point of a body, displaced: places over time. */
function pathOf(scene, body, x, { t, displacement }) {
  return {
    t,
    y: t.map((at, k) => placeOf(scene.row, body, x, at, displacement[k])),
  };
}

/** Path of the face at x of a body. */
function faceOf(scene, body, x) {
  const { path } = scene.bodies[body];
  if (path) return pathOf(scene, body, x, path);
  const { start, t } = scene.tiling;
  const found = new Map();
  scene.tiling.body.forEach((owner, i) => {
    for (let k = start[i]; owner === body && k < start[i + 1]; k += 1) {
      if (Math.abs(scene.tiling.x[k] - x) < 1e-6 * scene.lengths[body])
        found.set(t[k], scene.place[k]);
    }
  });
  const times = [...found.keys()].sort((a, b) => a - b);
  return { t: times, y: times.map((at) => found.get(at)) };
}

/** Paths of the centres of mass of rods and masses: the middles of pieces, weighed by their masses. */
function centresOf(scene) {
  const { tiling, begin, end, bodies, grids, lengths } = scene;
  const centres = (ofRod) =>
    bodies.flatMap(({ kind, path }, i) =>
      kind === "wall"
        ? []
        : [path ? pathOf(scene, i, lengths[i] / 2, path) : ofRod(i)],
    );
  if (grids)
    return centres((i) =>
      centreOfGrids(
        scene,
        grids.filter(({ body }) => body === i),
      ),
    );
  const t = Array.from(
    { length: MOMENTS },
    (_, k) => begin + ((end - begin) * (k + 0.5)) / MOMENTS,
  );
  const sums = bodies.map(() => t.map(() => [0, 0]));
  t.forEach((at, k) =>
    slice(scene, at).forEach(({ polygon, low, high }) => {
      const [body, [left, right]] = [
        tiling.body[polygon],
        chord(scene, polygon, at, tiling.x),
      ];
      const [piece, sum] = [
        pieceAt(scene, body, (left + right) / 2),
        sums[body][k],
      ];
      const mass = (piece.mass / piece.length) * (right - left);
      sum[0] += mass;
      sum[1] += (mass * (low + high)) / 2;
    }),
  );
  return centres((i) => ({
    t,
    y: sums[i].map(([mass, moment]) => moment / mass),
  }));
}

/** Path of the centre of mass of a rod, from the rows of its grids, which are of one height. */
function centreOfGrids(
  { place, tiling, bodies, begin, row: { magnification, frame } },
  grids,
) {
  const [{ first, rows }] = grids;
  const edges = Array.from({ length: rows + 1 }, (_, j) => [
    Math.min(j, rows - 1),
    j < rows ? [0, 1] : [3, 2],
  ]);
  const y = edges.map(([row, corners]) => {
    let [mass, moment] = [0, 0];
    grids.forEach((grid, k) => {
      const share = bodies[grid.body].pieces[k].mass / grid.across / 2;
      for (
        let cell = grid.first + row * grid.across;
        cell < grid.first + (row + 1) * grid.across;
        cell += 1
      ) {
        for (const corner of corners)
          moment += share * place[4 * cell + corner];
        mass += 2 * share;
      }
    });
    return moment / mass;
  });
  const t = edges.map(
    ([row, [corner]]) => tiling.t[4 * (first + row * grids[0].across) + corner],
  );
  if (begin < 0) {
    // it comes with one velocity
    t.unshift(begin);
    y.unshift(
      y[0] + magnification * (bodies[grids[0].body].approach - frame) * begin,
    );
  }
  return { t, y };
}

/** When the wave that a contact sends into a rod of one piece is back: 2 l/c after it begins to press. */
function marksOf({ bodies, contacts, end }) {
  const first =
    contacts.length === 1 &&
    contacts[0].spells.find(({ state }) => state === "pressing");
  const found = !first
    ? []
    : bodies
        .filter(({ pieces }) => pieces.length === 1)
        .map(({ name, pieces }) => ({
          t: first.from + 2 * pieces[0].transit_time,
          text: `2l${"₀₁₂"[name.slice(-1)]}/c`,
        }))
        .filter(({ t }) => t <= end)
        .sort((a, b) => a.t - b.t);
  const same =
    found.length === 2 && Math.abs(found[0].t - found[1].t) < 1e-6 * end;
  return same ? [{ ...found[0], text: "2l/c" }] : found;
}

/** Length in the picture of each body. */
function lengthsOf({ bodies, tiling, row }) {
  const lengths = bodies.map(({ kind }) => (kind === "mass" ? row.block : 0));
  tiling.body.forEach((body, i) => {
    for (let k = tiling.start[i]; k < tiling.start[i + 1]; k += 1)
      lengths[body] = Math.max(lengths[body], tiling.x[k]);
  });
  return lengths;
}

/** The piece of a rod at x. */
function pieceAt(scene, body, x) {
  const { pieces } = scene.bodies[body];
  let end = 0;
  return pieces.find(({ length }) => (end += length) > x) || pieces.at(-1);
}

/** Half of the diameter of a rod at x, as a share of the largest of all; no less than can be seen. */
function widthAt(scene, body, x) {
  scene.widest ||= Math.max(
    ...scene.bodies.flatMap((rod) => rod.pieces.map(({ area }) => area)),
  );
  return Math.max(
    THINNEST,
    Math.sqrt(pieceAt(scene, body, x).area / scene.widest),
  );
}

/** Make figures of the curves of contacts; returns the contacts that have a gap. */
function plotContacts(scene) {
  const open = scene.contacts.filter(({ gap }) => gap);
  for (const { name, force, gap } of scene.contacts)
    for (const curve of [force, gap || {}]) curve.name = `contact ${name}`;
  const title = scene.contacts.some(({ compliant }) => compliant)
    ? "Gap, below 0 overlap"
    : "Gap";
  scene.plots = [
    {
      key: "force",
      title: "Contact force",
      unit: "N",
      series: scene.contacts.map(({ force }) => force),
    },
    { key: "gap", title, unit: "m", series: open.map(({ gap }) => gap) },
    ...scene.plots,
  ].filter(({ series }) => series.length);
  return open;
}

/** Draw a body to the right of each compliant contact so far away that the faces stay apart. */
function makeRoom(scene, contacts) {
  const { row } = scene;
  for (const contact of contacts) {
    if (!contact.compliant) continue;
    const deepest = Math.max(0, -Math.min(...contact.gap.y));
    contact.room = row.magnification * deepest + ROOM * scene.length;
    for (let i = contact.index + 1; i < row.left.length; i += 1)
      row.left[i] += contact.room;
  }
}

/** Let the film begin before bodies meet that come with one velocity each, unstrained. */
function approach(scene, contacts) {
  const { bodies, row, tiling } = scene;
  if (bodies.some((body) => body.approach === null)) return;
  const closing = contacts.map(({ index, gap }) =>
    Math.abs(gap.y[0]) < TOUCHING * scene.length
      ? bodies[index].approach - bodies[index + 1].approach
      : 0,
  );
  const fastest = Math.max(0, ...closing);
  if (fastest === 0 || Math.min(...closing) < 0) return;
  const way = (APPROACH.way * scene.length) / (row.magnification * fastest);
  const before = -Math.min(way, APPROACH.time * scene.end);
  scene.begin = before;
  bodies.forEach((body, i) => {
    const moved = body.approach * before;
    if (body.path) {
      body.path.t.unshift(before);
      body.path.displacement.unshift(body.path.displacement[0] + moved);
      return;
    }
    const long = scene.lengths[i];
    tiling.body.push(i);
    tiling.velocity.push(body.approach);
    tiling.stress.push(0);
    tiling.x.push(0, long, long, 0);
    tiling.t.push(before, before, 0, 0);
    tiling.displacement.push(moved, moved, 0, 0);
    tiling.start.push(tiling.x.length);
  });
  for (const { key, series } of scene.plots) {
    for (const curve of series) {
      const first = key === "energy" ? curve.y[0] : 0;
      const gap = contacts.find((contact) => contact.gap === curve);
      const apart = gap
        ? bodies[gap.index + 1].approach - bodies[gap.index].approach
        : 0;
      curve.y.unshift(
        gap ? curve.y[0] + apart * before : first,
        gap ? curve.y[0] : first,
      );
      curve.t.unshift(before, 0);
    }
  }
}

/** Make polygons of the cells of grids; returns the grids: body, first cell, and how many there are. */
function gridsOf(tiling) {
  const { body: bodies, across: widths, start, x, t, displacement } = tiling;
  const points = { x: [], t: [], displacement: [] };
  const body = [];
  const grids = bodies.map((owner, g) => {
    const [from, across] = [start[g], widths[g]];
    const rows = (start[g + 1] - from) / (across + 1) - 1;
    const grid = {
      body: owner,
      first: body.length,
      across,
      rows,
      left: x[from],
      right: x[from + across],
    };
    for (let i = 0; i < rows * across; i += 1) {
      const k = from + i + Math.floor(i / across);
      body.push(owner);
      for (const corner of [k, k + 1, k + across + 2, k + across + 1]) {
        points.x.push(x[corner]);
        points.t.push(t[corner]);
        points.displacement.push(displacement[corner]);
      }
    }
    return grid;
  });
  Object.assign(tiling, points, {
    body,
    start: Array.from({ length: body.length + 1 }, (_, i) => 4 * i),
  });
  return grids;
}

"use strict";
// Paths of the centres of mass of rods and masses in the picture. Begin with `centresOf`.

const CENTRE_TIMES = 60; // points of a path read off polygons

/** Paths of the centres of mass of all rods and masses, from left to right. */
function centresOf(scene) {
  const { bodies, lengths, grids } = scene;
  const pathsOfRods = grids ? null : centresOfPolygons(scene);
  const paths = [];
  bodies.forEach(({ kind, path }, i) => {
    if (kind === "wall") {
      return;
    }
    if (path) {
      paths.push(pathOf(scene, i, lengths[i] / 2, path));
    } else if (grids) {
      paths.push(centreOfGrids(scene, i));
    } else {
      paths.push(pathsOfRods[i]);
    }
  });
  return paths;
}

/** Paths of all rods: the middles of their cut polygons, weighted by mass. */
function centresOfPolygons(scene) {
  const { tiling, begin, end, bodies } = scene;
  const times = Array.from(
    { length: CENTRE_TIMES },
    (_, k) => begin + ((end - begin) * (k + 0.5)) / CENTRE_TIMES,
  );
  const paths = bodies.map(() => ({ t: times, y: [] }));
  for (const time of times) {
    const masses = bodies.map(() => 0);
    const moments = bodies.map(() => 0);
    for (const { polygon, low, high } of cutPolygons(scene, time)) {
      const body = tiling.body[polygon];
      const [left, right] = rangeAt(scene, polygon, time, tiling.x);
      const segment = segmentAt(scene, body, (left + right) / 2);
      const mass = (segment.mass / segment.length) * (right - left);
      masses[body] += mass;
      moments[body] += (mass * (low + high)) / 2;
    }
    paths.forEach(({ y }, i) => y.push(moments[i] / masses[i]));
  }
  return paths;
}

/** Path of a rod from the rows of its grids, all of which have equally many. */
function centreOfGrids(scene, body) {
  const { tiling, bodies, begin, row } = scene;
  const grids = scene.grids.filter((grid) => grid.body === body);
  const [{ first, across, rows }] = grids;
  const path = { t: [], y: [] };
  for (let j = 0; j <= rows; j += 1) {
    const cellRow = Math.min(j, rows - 1);
    const corners = j < rows ? [0, 1] : [3, 2]; // lower edge; upper one of the last row
    const firstCorner = 4 * (first + cellRow * across) + corners[0];
    path.t.push(tiling.t[firstCorner]);
    path.y.push(centreOfRow(scene, grids, cellRow, corners));
  }
  if (begin < 0) {
    const velocity = bodies[body].approach - row.frame;
    path.t.unshift(begin);
    path.y.unshift(path.y[0] + row.magnification * velocity * begin);
  }
  return path;
}

/** Centre of mass of the corners of a row of cells. */
function centreOfRow({ places, bodies }, grids, cellRow, corners) {
  let mass = 0;
  let moment = 0;
  grids.forEach((grid, k) => {
    const cornerMass = bodies[grid.body].segments[k].mass / grid.across / 2;
    const firstCell = grid.first + cellRow * grid.across;
    for (let cell = firstCell; cell < firstCell + grid.across; cell += 1) {
      for (const corner of corners) {
        moment += cornerMass * places[4 * cell + corner];
      }
      mass += 2 * cornerMass;
    }
  });
  return moment / mass;
}

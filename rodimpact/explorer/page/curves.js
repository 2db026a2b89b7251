"use strict";
// Curves of e over one number of a pair, and the map of e over two numbers of a design.
// They take many runs, so the page stays awake between them. Begin with `addCurves`.

const CURVE_POINTS = 20; // points of a curve solved by characteristics
const FRONTS_CURVE_POINTS = 80;
const AWAKE_INTERVAL = 30; // ms of work after which the page reacts to the user
const ROUND_ENDS = { low: -2, high: 4 }; // range of log10(kappa)
let sceneCount = 0; // the curves of an earlier scene are not solved to their end
const solvedCurves = {}; // the last curve that was solved, by its key in the scene

// Solving ---------------------------------------------------------------------------------

/** e of a case with numbers at some paths, pairs of both; null where there is none. */
function restitutionWith(tables, ...numbers) {
  for (const [path, number] of numbers) {
    setAt(tables, path, number);
  }
  return solver.restitution_of_case(
    tables,
    embedded.materials,
    TIME_LIMITS.restitution,
  );
}

/** A function to be called often: after a while of work it lets the page react. */
function restingPoint() {
  let lastRest = performance.now();
  return async () => {
    if (performance.now() - lastRest < AWAKE_INTERVAL) {
      return;
    }
    await new Promise((resolve) => {
      setTimeout(resolve);
    });
    lastRest = performance.now();
  };
}

/** Solve curves of the scene that is shown, one after the other. */
async function solveCurves(curves) {
  const startedFor = sceneCount;
  for (const [key, curve] of curves) {
    const values = await curve.solveAwake(() => startedFor !== sceneCount);
    if (values === null) {
      return;
    }
    const { ratios } = curve;
    solvedCurves[key] = { row: curve.row, points: ratios, values };
    Object.assign(page.scene[key], {
      points: ratios,
      values,
      isOutdated: false,
    });
    redraw();
  }
}

/** e over two numbers of a design, row by row. */
async function* restitutionRows(tables, [xPath, xs], [yPath, ys]) {
  const rest = restingPoint();
  for (const y of ys) {
    const row = [];
    for (const x of xs) {
      row.push(restitutionWith(tables, [yPath, y], [xPath, x]));
      await rest();
    }
    yield row;
  }
}

// Curves ----------------------------------------------------------------------------------

/**
 * A curve of e that is to be solved.
 *
 * `ratios` are its places, `numberAt(ratio)` the number that a case has there at `path`.
 * Two curves with the same `row` are equal.
 */
function curveToSolve(ratios, noun, tables, path, numberAt) {
  const copy = structuredClone(tables);
  const restitutionAt = (ratio) =>
    restitutionWith(copy, [path, numberAt(ratio)]);
  setAt(copy, path, null);
  return {
    ratios,
    points: [],
    values: [],
    source: `solved at ${ratios.length} ${noun}`,
    row: JSON.stringify([ratios, copy]),
    solve: () => ratios.map(restitutionAt),
    solveAwake: async (isOver) => {
      const rest = restingPoint();
      const values = [];
      for (const ratio of ratios) {
        values.push(restitutionAt(ratio));
        await rest();
        if (isOver()) {
          return null;
        }
      }
      return values;
    },
  };
}

/** The curve of e over l1/l2, from 0 to a power of two above the ratio of the scene. */
function curveOverLengths(tables, { ratio, method }) {
  const count = method === "fronts" ? FRONTS_CURVE_POINTS : CURVE_POINTS;
  const highest = 2 ** Math.max(1, Math.ceil(Math.log2(1.1 * ratio)));
  const ratios = Array.from(
    { length: count },
    (_, k) => (highest * (k + 1)) / count,
  );
  const [, right] = tables.bodies;
  const path = ["bodies", 0, "length"];
  return curveToSolve(
    ratios,
    "ratios",
    tables,
    path,
    (lengths) => lengths * right.length,
  );
}

/**
 * The curve of e over log10(kappa) for round ends, which meet by Hertz's law.
 *
 * kappa = k (V T)^(1/2) T/Z, with the stiffness k, the closing velocity V, and T and Z of
 * the rod with the longer transit time. `unit` is the stiffness for which kappa is 1.
 */
function curveOverRoundness(tables, contact, closing, { bodies }) {
  const [left, right] = bodies.map(({ segments }) => segments[0]);
  const slow = left.transit_time < right.transit_time ? right : left;
  const T = slow.transit_time;
  const unit = slow.impedance / (T * Math.sqrt(closing * T));
  const { stiffness, ...otherNumbers } = contact;
  const hertz = { ...otherNumbers, law: "hertz", stiffness: unit };
  const rounded = { ...tables, solve: {}, contacts: [hertz] };
  const { low, high } = ROUND_ENDS;
  const ratios = Array.from(
    { length: CURVE_POINTS },
    (_, k) => ((high - low) * k) / (CURVE_POINTS - 1) + low,
  );
  const path = ["contacts", 0, "stiffness"];
  const curve = curveToSolve(
    ratios,
    "stiffnesses",
    rounded,
    path,
    (logKappa) => unit * 10 ** logKappa,
  );
  const here = stiffness === undefined ? null : Math.log10(stiffness / unit);
  return { ...curve, unit, here };
}

/** Curves of e of two uniform rods, by their keys in the scene. */
function curvesOf(tables, scene) {
  if (scene.ratio === null) {
    return {};
  }
  const [left, right] = tables.bodies;
  const curves = {};
  const hasProfile = [left.velocity, left.strain].some(
    (value) => typeof value === "object",
  );
  if (!hasProfile) {
    curves.curve = curveOverLengths(tables, scene);
  } // profiles have a length
  const [contact = {}] = listOf(tables.contacts);
  const { law = "rigid" } = contact;
  const closing = (left.velocity || 0) - (right.velocity || 0); // NaN for a profile
  if (["rigid", "hertz"].includes(law) && closing > 0) {
    curves.roundness = curveOverRoundness(tables, contact, closing, scene);
  }
  return curves;
}

/**
 * Give a scene its curves; returns those that are still to be solved.
 *
 * The curve over lengths by fronts is solved at once. Another one is as it was last, and
 * outdated if that was of other rods.
 */
function addCurves(scene, { case: tables }) {
  const unsolved = [];
  for (const [key, curve] of Object.entries(curvesOf(tables, scene))) {
    const isQuick = key === "curve" && scene.method === "fronts";
    const last = solvedCurves[key];
    scene[key] = { ...curve, isOutdated: false };
    if (isQuick) {
      scene[key].points = curve.ratios;
      scene[key].values = curve.solve();
    } else {
      scene[key].isOutdated = !last || last.row !== curve.row;
      if (last) {
        scene[key].points = last.points;
        scene[key].values = last.values;
      }
    }
    if (scene[key].isOutdated) {
      unsolved.push([key, curve]);
    }
  }
  return unsolved;
}

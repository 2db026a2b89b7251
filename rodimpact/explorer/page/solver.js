"use strict";
// The scene of a design: all that the page shows of it, solved in the page. Begin with
// `sceneOf`. `solver` holds the functions that are translated from Python.

const DRAFT_TOLERANCES = { pair: 1e-5, chain: 1e-4 }; // while a slider moves
const TIME_LIMITS = { scene: 3, draft: 0.7, restitution: 2 }; // s of work at most
const REST_DELAY = 150; // ms without a change before long work begins
let restTimer = 0;

/** Mistakes in a design, or the physics in it that this page cannot solve. */
function problemsOf({ case: tables, gauges }) {
  const [path, physics] = solver.lacking(tables);
  if (physics) {
    const message =
      `this page cannot solve ${physics}; Python can, ` +
      "with rodimpact animate CASE.toml -o FILE.gif";
    return [{ path, message }];
  }
  return solver.mistakes(tables, listOf(gauges), embedded.materials);
}

/**
 * The scene of a design as `scene`, or its `problems`.
 *
 * A draft of compliant contacts is quicker and less accurate; its stated errors are shown.
 */
function sceneOf(design, isDraft = false) {
  try {
    const problems = problemsOf(design);
    if (problems.length > 0) {
      return { problems };
    }
    return solveScene(design, isDraft);
  } catch (error) {
    const message = `The design cannot be read: ${error.message}`;
    return { problems: [{ path: "", message }] };
  }
}

/** The scene of a design without mistakes, or the problem of its run. */
function solveScene(design, isDraft) {
  const { case: tables, gauges } = design;
  const size = tables.bodies.length > 3 ? "chain" : "pair";
  const { problem, ...scene } = solver.scene_of(
    tables,
    listOf(gauges),
    embedded.materials,
    isDraft ? DRAFT_TOLERANCES[size] : undefined,
    isDraft ? TIME_LIMITS.draft : TIME_LIMITS.scene,
  );
  if (!problem) {
    const curves = addCurves(scene, design);
    solveAtRest(isDraft && scene.method === "characteristics", curves);
    return { scene };
  }
  const [path, message] = problem;
  if (isDraft && path === "") {
    solveAtRest(true, []); // without a draft the run may take longer
    return {};
  }
  return { problems: [{ path, message }] };
}

/** Solve a draft in full, or else curves, when nothing has changed for a while. */
function solveAtRest(isDraft, curves) {
  if (isDraft) {
    restTimer = setTimeout(() => showSolution(sceneOf(design)), REST_DELAY);
  } else if (curves.length > 0) {
    restTimer = setTimeout(solveCurves, REST_DELAY, curves);
  }
}

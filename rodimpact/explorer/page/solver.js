"use strict";
// What the page solves by itself, and the case file of what it shows.

/** What is wrong with a design, or what of it this page cannot solve. */
function problemsOf({ case: tables, gauges }) {
  const [path, what] = fronts.lacking(tables);
  if (what)
    return [
      {
        path,
        message: `this page cannot solve ${what}; Python can, with rodimpact animate CASE.toml -o FILE.gif`,
      },
    ];
  return fronts
    .mistakes(tables, listOf(gauges), start.materials, start.rules)
    .map(([where, message]) => ({ path: where, message }));
}

const FEW = 20; // points of a curve of e; four times as many of fronts
const QUIET = 150; // ms after which sliders rest
const DRAFT = [1e-5, 1e-4]; // tolerances while a slider moves, of pairs and of chains; their errors are shown
const AWAKE = 30; // ms of work between two looks at what the user does
const PATIENCE = { scene: 3, draft: 0.7, e: 2 }; // s of work at most for a scene, for a draft of it, for one e
let resting = 0;
let curveTurn = 0; // counts scenes: curves of an earlier one are not solved on
const kept = {}; // curves that take long, as they were last

/** e of a case in which numbers are set at some paths; null where there is none. */
function eWith(copy, ...numbers) {
  for (const [path, number] of numbers) setAt(copy, path, number);
  return fronts.e_of(copy, start.materials, PATIENCE.e);
}

/** A function that lets the page wake up, if the work since it was last awake was long enough. */
function restingPoint() {
  let rested = performance.now();
  return async () => {
    if (performance.now() - rested < AWAKE) return;
    await new Promise((resolve) => {
      setTimeout(resolve);
    });
    rested = performance.now();
  };
}

/** Curves of e, to be solved: over l1/l2 of two uniform rods, and over the roundness of their ends, which meet by Hertz's law. */
function curvesOf({ case: tables }, { ratio, method, bodies }) {
  if (ratio === null) return {};
  const [left, right] = tables.bodies;
  const [{ law = "rigid", stiffness, ...contact } = {}] = listOf(
    tables.contacts,
  );
  const curve = (count, placeOf, source, asked, path, numberAt) => {
    const ratios = Array.from({ length: count }, (_, k) => placeOf(k));
    const copy = structuredClone(asked);
    const eAt = (ratio) => eWith(copy, [path, numberAt(ratio)]);
    setAt(copy, path, null);
    return {
      ratios: [],
      values: [],
      source: `solved at ${count} ${source}`,
      row: JSON.stringify([ratios, copy]), // two rows with one text have one curve
      solve: () => ({ ratios, values: ratios.map(eAt) }),
      solveAwake: async (isOver) => {
        const values = [];
        const rest = restingPoint();
        for (const ratio of ratios) {
          values.push(eAt(ratio));
          await rest();
          if (isOver()) return null;
        }
        return { ratios, values };
      },
    };
  };
  const found = {};
  if (
    ![left.velocity, left.strain].some((value) => typeof value === "object")
  ) {
    // a profile is bound to its length
    const [reach, count] = [
      2 ** Math.max(1, Math.ceil(Math.log2(1.1 * ratio))),
      method === "fronts" ? 4 * FEW : FEW,
    ];
    found.curve = curve(
      count,
      (k) => (reach * (k + 1)) / count,
      "ratios",
      tables,
      ["bodies", 0, "length"],
      (r) => r * right.length,
    );
  }
  const closing = (left.velocity || 0) - (right.velocity || 0); // no number where there is a profile
  if (!/^(rigid|hertz)$/.test(law) || !(closing > 0)) return found;
  const [{ impedance, transit_time: T }] = bodies
    .map(({ pieces }) => pieces[0])
    .sort((a, b) => b.transit_time - a.transit_time);
  const unit = impedance / (T * Math.sqrt(closing * T)); // of the stiffness k: then kappa = k (V T)^(1/2) T/Z is 1
  const rounded = {
    ...tables,
    solve: {},
    contacts: [{ ...contact, law: "hertz", stiffness: unit }],
  };
  found.roundness = {
    unit,
    here: stiffness === undefined ? null : Math.log10(stiffness / unit),
    ...curve(
      FEW,
      (k) => (6 * k) / (FEW - 1) - 2,
      "stiffnesses",
      rounded,
      ["contacts", 0, "stiffness"],
      (log) => unit * 10 ** log,
    ),
  };
  return found;
}

/** Give a scene its curves; one of other rods is `outdated`. Returns the curves that are to be solved. */
function addCurves(scene, asked) {
  return Object.entries(curvesOf(asked, scene)).filter(([key, curve]) => {
    const quick = key === "curve" && scene.method === "fronts";
    const before = kept[key];
    const outdated = !quick && (!before || before.row !== curve.row);
    scene[key] = { ...curve, ...(quick ? curve.solve() : before), outdated };
    return outdated;
  });
}

/** Solve curves of the scene shown, one after the other, while the page stays awake. */
async function solveCurves(curves) {
  const turn = curveTurn;
  for (const [key, { row, solveAwake }] of curves) {
    const solved = await solveAwake(() => turn !== curveTurn);
    if (!solved) return;
    kept[key] = { row, ...solved };
    Object.assign(shown.scene[key], solved, { outdated: false });
    redraw();
  }
}

/** Do at rest what takes long: a draft is solved in full; then curves are solved. */
function solveAtRest(draft, curves) {
  if (draft) resting = setTimeout(() => receive(sceneOf(design)), QUIET);
  else if (curves.length) resting = setTimeout(solveCurves, QUIET, curves);
}

/** The scene of a design as `data`, or its `problems`; a draft of compliant contacts is quicker. */
function sceneOf(asked, draft = false) {
  try {
    const problems = problemsOf(asked);
    if (problems.length) return { problems };
    const { problem, ...data } = fronts.scene_of(
      asked.case,
      listOf(asked.gauges),
      start.materials,
      draft ? DRAFT[asked.case.bodies.length > 3 ? 1 : 0] : undefined,
      draft ? PATIENCE.draft : PATIENCE.scene,
    );
    if (draft && problem && problem[0] === "") {
      solveAtRest(true, []); // a draft that took too long: in full it may take longer
      return {};
    }
    if (problem)
      return { problems: [{ path: problem[0], message: problem[1] }] };
    const curves = addCurves(data, asked);
    solveAtRest(draft && data.method === "characteristics", curves);
    return { data };
  } catch (error) {
    return {
      problems: [
        { path: "", message: `The design cannot be read: ${error.message}` },
      ],
    };
  }
}

/** e over two numbers of a design, row by row; the page stays awake. */
async function* mapOf(design, [xPath, xs], [yPath, ys]) {
  const copy = structuredClone(design.case);
  const rest = restingPoint();
  for (const y of ys) {
    const row = [];
    for (const x of xs) {
      row.push(eWith(copy, [yPath, y], [xPath, x]));
      await rest();
    }
    yield row;
  }
}

// Case files -------------------------------------------------------------------------------------

function tomlValue(value) {
  if (Array.isArray(value)) return `[${value.map(tomlValue).join(", ")}]`;
  if (typeof value === "string")
    return JSON.stringify(value).replace(/\x7f/g, "\\u007f");
  if (typeof value === "object") return `{${tomlLines(value).join(", ")}}`;
  return String(value);
}

const tomlKey = (key) => (/^[\w-]+$/.test(key) ? key : JSON.stringify(key));
const tomlLines = (table) =>
  Object.entries(table)
    .filter(([, value]) => value !== null)
    .map(([key, value]) => `${tomlKey(key)} = ${tomlValue(value)}`);

/** A design as the text of a case file; every material is spelt out. */
function tomlOf(design, library) {
  const { bodies, contacts, materials, ends, solve, ...plain } = design.case;
  const lines = tomlLines(plain);
  const add = (head, table) => lines.push("", head, ...tomlLines(table));
  const used = new Set(
    bodies
      .flatMap((body) => [body, ...listOf(body.segments)])
      .map(({ material }) => material),
  );
  for (const name of used)
    if (name)
      add(`[materials.${tomlKey(name)}]`, { ...library, ...materials }[name]);
  for (const { segments, ...body } of bodies) {
    add("[[bodies]]", body);
    for (const segment of listOf(segments)) add("[[bodies.segments]]", segment);
  }
  for (const contact of listOf(contacts)) add("[[contacts]]", contact);
  for (const [side, end] of Object.entries(ends || {}))
    add(`[ends.${side}]`, end);
  for (const gauge of listOf(design.gauges)) add("[[gauges]]", gauge);
  if (solve) add("[solve]", solve);
  return `${lines.join("\n")}\n`;
}

"use strict";
// What the page solves by itself, and the case file of what it shows.

/** What is wrong with a design, or what of it this page cannot solve. */
function problemsOf({ case: tables, gauges }) {
  const [path, what] = fronts.lacking(tables);
  if (what) return [{ path, message: `this page cannot solve ${what}; Python can, with rodimpact explore CASE.toml` }];
  return fronts.mistakes(tables, listOf(gauges), start.materials, start.rules).map(([where, message]) => ({ path: where, message }));
}

/** Whether Python has solved this design, which the page cannot solve. */
const isStored = (asked) => start.scene !== null && JSON.stringify(asked) === JSON.stringify(start.design);

const AT_ONCE = 20; // cells of a map between two looks at the clock
const QUIET = 150; // ms after which sliders rest
const DRAFT = [1e-5, 1e-4]; // tolerances while a slider moves, of pairs and of chains; their errors are shown
const AWAKE = 30; // ms of work between two looks at what the user does
let resting = 0;
const kept = {}; // curves that take long, as they were last

/** Solve what takes long once the sliders rest; until then curves before are shown, and a draft. */
function solveAtRest(scene, draft) {
  const late = ["curve", "roundness"].filter((key) => scene[key] && !scene[key].values.length);
  for (const key of late) scene[key] = { ...scene[key], ...kept[key] };
  const solve = { curve: () => fronts.curve_of(design.case, start.materials, scene.ratio), roundness: () => fronts.roundness_of(design.case, start.materials) };
  if (late.length || draft) resting = setTimeout(() => {
    if (draft) receive(sceneOf(design));
    clearTimeout(resting);
    for (const key of late) {
      kept[key] = solve[key]();
      Object.assign(shown.scene[key], kept[key]);
    }
    redraw();
  }, QUIET);
}

/** The scene of a design as `data`, or its `problems`; a draft of compliant contacts is quicker. */
function sceneOf(asked, draft = false) {
  if (isStored(asked)) return { data: structuredClone(start.scene) };
  try {
    const problems = problemsOf(asked);
    if (problems.length) return { problems };
    const { problem, ...data } = fronts.scene_of(asked.case, listOf(asked.gauges), start.materials, ...(draft ? [DRAFT[asked.case.bodies.length > 3 ? 1 : 0]] : []));
    if (!problem) solveAtRest(data, draft && data.method === "characteristics");
    return problem ? { problems: [{ path: problem[0], message: problem[1] }] } : { data };
  } catch (error) {
    return { problems: [{ path: "", message: `The design cannot be read: ${error.message}` }] };
  }
}

/** e over two numbers of a design, row by row; the page stays awake. */
async function* mapOf(design, [xPath, xs], [yPath, ys]) {
  let rested = performance.now();
  for (const y of ys) {
    const tables = fronts.changed(design.case, yPath, y);
    const row = [];
    while (row.length < xs.length) {
      row.push(...fronts.e_over(tables, start.materials, xPath, xs.slice(row.length, row.length + AT_ONCE)));
      if (performance.now() - rested < AWAKE) continue;
      await new Promise((resolve) => { setTimeout(resolve); });
      rested = performance.now();
    }
    yield row;
  }
}

// Case files -------------------------------------------------------------------------------------

function tomlValue(value) {
  if (Array.isArray(value)) return `[${value.map(tomlValue).join(", ")}]`;
  if (typeof value === "string") return JSON.stringify(value).replace(/\x7f/g, "\\u007f");
  if (typeof value === "object") return `{${tomlLines(value).join(", ")}}`;
  return String(value);
}

const tomlKey = (key) => (/^[\w-]+$/.test(key) ? key : JSON.stringify(key));
const tomlLines = (table) => Object.entries(table).filter(([, value]) => value !== null)
  .map(([key, value]) => `${tomlKey(key)} = ${tomlValue(value)}`);

/** A design as the text of a case file; every material is spelt out. */
function tomlOf(design, library) {
  const { bodies, contacts, materials, ends, solve, ...plain } = design.case;
  const lines = tomlLines(plain);
  const add = (head, table) => lines.push("", head, ...tomlLines(table));
  const used = new Set(bodies.flatMap((body) => [body, ...listOf(body.segments)]).map(({ material }) => material));
  for (const name of used) if (name) add(`[materials.${tomlKey(name)}]`, { ...library, ...materials }[name]);
  for (const { segments, ...body } of bodies) {
    add("[[bodies]]", body);
    for (const segment of listOf(segments)) add("[[bodies.segments]]", segment);
  }
  for (const contact of listOf(contacts)) add("[[contacts]]", contact);
  for (const [side, end] of Object.entries(ends || {})) add(`[ends.${side}]`, end);
  for (const gauge of listOf(design.gauges)) add("[[gauges]]", gauge);
  if (solve) add("[solve]", solve);
  return `${lines.join("\n")}\n`;
}

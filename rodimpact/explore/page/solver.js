"use strict";
// Answers of the page itself, where the fronts of a collision can be followed: it needs no server.

/** Unpack the kernels, which a page of one file holds compressed. */
async function unpackKernels() {
  if (!embedded) return;
  const bytes = Uint8Array.from(atob(byId("packed").textContent), (letter) => letter.charCodeAt(0));
  const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const script = document.createElement("script");
  script.textContent = await new Response(plain).text();
  document.head.append(script);
}

/** What is wrong with a design that this page would solve, or what of it fronts cannot carry. */
function problemsOf({ case: tables, gauges }) {
  const [path, what] = fronts.lacking(tables);
  if (what) return [{ path, message: `this page follows fronts only, without ${what}; the one that rodimpact explore serves solves it` }];
  return fronts.mistakes(tables, listOf(gauges), start.materials, start.rules).map(([where, message]) => ({ path: where, message }));
}

const answers = {
  "/scene"(design) {
    const row = fronts.row_of(design.case, start.materials);
    const known = fronts.known_of(row, listOf(design.gauges));
    if (known.problem) return { problems: [{ path: known.problem[0], message: known.problem[1] }] };
    const ratio = fronts.ratio_of(known);
    if (ratio !== null) known.curve = fronts.curve_of(design.case, start.materials, ratio);
    return { data: fronts.picture(known) };
  },
  "/curve": () => ({ data: null }), // a scene of fronts has it, if there is one
  "/case": (design) => ({ data: { toml: tomlOf(design, start.materials) } }),
};

/** The answer of this page to a question; null where only a server has one. */
function answerHere(address, design) {
  if (!(address in answers)) return null;
  let answer;
  try {
    const problems = problemsOf(design);
    answer = problems.length ? { problems } : answers[address](design);
  } catch (error) {
    answer = { problems: [{ path: "", message: `The design cannot be read: ${error.message}` }] };
  }
  return embedded || "data" in answer ? answer : null;
}

/** e over two numbers of a design, row by row; the page stays awake. */
async function* mapOf(design, [xPath, xs], [yPath, ys]) {
  for (let j = 0; j < ys.length; j += 1) {
    const tables = fronts.changed(design.case, yPath, ys[j]);
    yield fronts.restitutions(tables, start.materials, xPath, xs);
    if (j % 10 === 9) await new Promise((resolve) => { setTimeout(resolve); });
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

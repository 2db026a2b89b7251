"use strict";
// The case file of a design. Begin with `tomlOf`.

/** A value in TOML; a table is written inline. */
function tomlValue(value) {
  if (Array.isArray(value)) {
    return `[${value.map(tomlValue).join(", ")}]`;
  }
  if (typeof value === "string") {
    return JSON.stringify(value).replace(/\x7f/g, "\\u007f");
  }
  if (typeof value === "object") {
    return `{${tomlLines(value).join(", ")}}`;
  }
  return String(value);
}

/** A key in TOML, in quotes if it needs them. */
const tomlKey = (key) => (/^[\w-]+$/.test(key) ? key : JSON.stringify(key));

/** Lines "key = value" of a table; entries that are null are left out. */
const tomlLines = (table) =>
  Object.entries(table)
    .filter(([, value]) => value !== null)
    .map(([key, value]) => `${tomlKey(key)} = ${tomlValue(value)}`);

/** Names of the materials that bodies use. */
function materialsIn(bodies) {
  const names = new Set();
  for (const body of bodies) {
    for (const { material } of [body, ...listOf(body.segments)]) {
      if (material) {
        names.add(material);
      }
    }
  }
  return names;
}

/** A design as the text of a case file; all its materials are written out. */
function tomlOf(design, library) {
  const { bodies, contacts, materials, ends, solve, ...numbers } = design.case;
  const lines = tomlLines(numbers);
  const add = (head, table) => lines.push("", head, ...tomlLines(table));
  const allMaterials = { ...library, ...materials };
  for (const name of materialsIn(bodies)) {
    add(`[materials.${tomlKey(name)}]`, allMaterials[name]);
  }
  for (const { segments, ...body } of bodies) {
    add("[[bodies]]", body);
    for (const segment of listOf(segments)) {
      add("[[bodies.segments]]", segment);
    }
  }
  for (const contact of listOf(contacts)) {
    add("[[contacts]]", contact);
  }
  for (const [side, end] of Object.entries(ends || {})) {
    add(`[ends.${side}]`, end);
  }
  for (const gauge of listOf(design.gauges)) {
    add("[[gauges]]", gauge);
  }
  if (solve) {
    add("[solve]", solve);
  }
  return `${lines.join("\n")}\n`;
}

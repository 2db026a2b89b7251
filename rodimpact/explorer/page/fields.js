"use strict";
// Numbers of a design: where they are in its tables, and the unit and the range in which
// the form shows them. Begin with `FIELDS`.

// A field has its name, its unit as a power of ten of the SI unit, and the range and the
// step of its slider in this unit. A slider with `isLog` runs over ratios; one with
// `isBounded` keeps its range.
const FIELDS = {
  length: {
    name: "length",
    unit: "mm",
    power: -3,
    low: 20,
    high: 2000,
    step: 1,
  },
  area: {
    name: "area",
    unit: "mm²",
    power: -6,
    low: 1,
    high: 10000,
    isLog: true,
  },
  velocity: {
    name: "velocity",
    unit: "m/s",
    power: 0,
    low: -20,
    high: 20,
    step: 0.1,
  },
  mass: {
    name: "mass",
    unit: "kg",
    power: 0,
    low: 0.01,
    high: 100,
    isLog: true,
  },
  youngs_modulus: {
    name: "Young's modulus E",
    unit: "GPa",
    power: 9,
    low: 1,
    high: 500,
    isLog: true,
  },
  density: {
    name: "density ρ",
    unit: "kg/m³",
    power: 0,
    low: 500,
    high: 20000,
    isLog: true,
  },
  gap: { name: "gap", unit: "µm", power: -6, low: 0, high: 500, step: 1 },
  spring: {
    name: "stiffness",
    unit: "N/µm",
    power: 6,
    low: 1,
    high: 100000,
    isLog: true,
  },
  hertz: {
    name: "stiffness",
    unit: "GN/m^1.5",
    power: 9,
    low: 1e-3,
    high: 1e4,
    isLog: true,
  },
  damping: {
    name: "damping",
    unit: "SI",
    power: 0,
    low: 0,
    high: 1000,
    step: 1,
  },
  restitution: {
    name: "restitution",
    unit: "",
    power: 0,
    low: 0,
    high: 1,
    step: 0.01,
    isBounded: true,
  },
  fraction: {
    name: "at",
    unit: "%",
    power: -2,
    low: 0,
    high: 100,
    step: 1,
    isBounded: true,
  },
};
const LAWS = {
  rigid: {},
  hertz: { stiffness: 1e10 },
  spring: { stiffness: 1e8 },
}; // laws that the form offers, with their first numbers
const LAW_NAMES = { rigid: "rigid (flat)", hertz: "Hertz (round)" };
const HERTZ_LAWS = ["hertz", "hunt-crossley"]; // laws with a stiffness in N/m^1.5

/** Key in `FIELDS` of the stiffness of a contact law. */
const stiffnessField = (law) => (HERTZ_LAWS.includes(law) ? "hertz" : "spring");

/** A number of a design in the unit of its field. */
function toShown(value, power) {
  const number = power < 0 ? value * 10 ** -power : value / 10 ** power;
  return Number(number.toPrecision(12));
}

/** A number of a field in SI units: the nearest float, by one division or product. */
const fromShown = (number, power) =>
  power < 0 ? number / 10 ** -power : number * 10 ** power;

/** A list as it is; no items for anything else, such as an entry that is missing. */
const listOf = (value) => (Array.isArray(value) ? value : []);

/** Entry of nested tables at a path; undefined if there is none. */
const getAt = (tables, path) =>
  path.reduce((table, key) => table?.[key], tables);

/** Set the entry of nested tables at a path. */
function setAt(tables, path, value) {
  const table = getAt(tables, path.slice(0, -1));
  table[path.at(-1)] = value;
}

/** Numbers of bodies, and names of their contacts. */
function namesOf(bodies) {
  const kinds = bodies.map(({ kind }) => kind);
  return {
    numbers: solver.body_numbers(kinds),
    contacts: solver.contact_names(kinds),
  };
}

/** Segments of a rod, with the path of their numbers in its table. */
function segmentsWithPaths(body) {
  if (Array.isArray(body.segments)) {
    return body.segments.map((segment, j) => ({
      segment,
      path: ["segments", j],
    }));
  }
  if (body.kind !== "rod") {
    return [];
  }
  return [{ segment: body, path: [] }];
}

"use strict";
// Numbers as texts: quantities with SI prefixes, and the ticks of axes. Begin with
// `quantity`.

const PREFIXES = {
  "-9": "n",
  "-6": "µ",
  "-3": "m",
  0: "",
  3: "k",
  6: "M",
  9: "G",
};
const UNITS_WITH_PREFIX = ["N", "J", "m", "s", "Pa", "N s", "m/s"];
const UNITS_WITHOUT_SPACE = ["", "%"];
const ROUNDING_RTOL = 1e-9; // a number nearer to a limit than this counts as there

/** A number from low to high: the one nearest to a value. */
const clamp = (value, low, high) => Math.max(low, Math.min(high, value));

/** Power of ten of the SI prefix for numbers of a size: a multiple of three. */
function powerFor(size, unit) {
  if (!UNITS_WITH_PREFIX.includes(unit) || !(size > 0)) {
    return 0;
  }
  const power = Math.log10(size * (1 + ROUNDING_RTOL));
  return clamp(3 * Math.floor(power / 3), -9, 9);
}

/** A text whose numbers have the printed minus sign, also in their exponents. */
const minus = (text) => text.replace(/(^|e|\s)-(?=\d)/g, "$1−");

/**
 * A text whose lines do not end between a number and its unit, between a body and its
 * number, or beside an equals sign.
 */
const unbroken = (text) =>
  text
    .replace(/\b(rod|mass|contact) (?=\d)/gi, "$1\u00a0")
    .replace(/(\d) (?=%|[nµmkMG]?(?:N|J|m|s|Pa|kg)\b)/g, "$1\u00a0")
    .replace(/N s\b/g, "N\u00a0s")
    .replace(/ ([=×]) /g, "\u00a0$1\u00a0");

/** A text whose digits are subscripts. */
const subscript = (text) => text.replace(/\d/g, (digit) => "₀₁₂₃₄₅₆₇₈₉"[digit]);

/** A number with so many significant digits. */
function plainNumber(value, digits) {
  const rounded = Number(value.toPrecision(digits));
  const size = Math.abs(rounded);
  if (size !== 0 && (size < 1e-4 || size >= 1e7)) {
    return minus(rounded.toExponential());
  }
  return minus(String(rounded));
}

/** A quantity with its unit. */
function quantity(value, unit, digits = 4) {
  const rounded = Number(value.toPrecision(digits)); // 999.6 of two digits is 1000
  const power = powerFor(Math.abs(rounded), unit);
  const number = plainNumber(value / 10 ** power, digits);
  if (UNITS_WITHOUT_SPACE.includes(unit)) {
    return number + unit;
  }
  return `${number}\u00a0${PREFIXES[power]}${unit}`;
}

/** A quantity with more digits, as texts of a solution have it. */
const inSi = (value, unit, digits = 6) => quantity(value, unit, digits);

/** Multiples of a step from low to high. */
function multiplesBetween(low, high, step) {
  const first = Math.ceil(low / step - ROUNDING_RTOL);
  const last = Math.floor(high / step + ROUNDING_RTOL);
  const multiples = [];
  for (let k = first; k <= last; k += 1) {
    multiples.push(k * step);
  }
  return multiples;
}

/** About `count` round numbers from low to high, no less than three. */
function ticksBetween(low, high, count) {
  const width = (high - low) / count;
  if (!(width > 0) || !Number.isFinite(width)) {
    return [low];
  }
  const decade = 10 ** Math.floor(Math.log10(width));
  const steps = [10, 5, 2, 1, 0.5, 0.2].map((factor) => factor * decade);
  const widest = steps.findLastIndex(
    (step) => step >= width * (1 - ROUNDING_RTOL),
  );
  let ticks = [];
  for (const step of steps.slice(widest)) {
    ticks = multiplesBetween(low, high, step);
    if (ticks.length > 2) {
      return ticks;
    }
  }
  return ticks;
}

/** Ticks with their labels, all with one prefix, and the unit with this prefix. */
function labelledTicks(low, high, count, unit) {
  const power = powerFor(Math.max(Math.abs(low), Math.abs(high)), unit);
  const ticks = ticksBetween(low, high, count).map((value) => {
    const rounded = Math.round((value / 10 ** power) * 1e9) / 1e9;
    return [value, plainNumber(rounded, 6)];
  });
  return { ticks, unit: PREFIXES[power] + unit };
}

"use strict";
// Numbers for people: SI prefixes, and ticks of axes.

const PREFIXES = {
  "-9": "n",
  "-6": "µ",
  "-3": "m",
  0: "",
  3: "k",
  6: "M",
  9: "G",
};
const TAKES_PREFIX = /^(N|J|m|s|Pa|N s|m\/s)$/;
const NO_SPACE = new Set(["", "%"]);

/** Power of ten of the prefix that suits numbers of this size: a multiple of three. */
function powerFor(size, unit) {
  if (!TAKES_PREFIX.test(unit) || !(size > 0)) return 0;
  return Math.max(
    -9,
    Math.min(9, 3 * Math.floor(Math.log10(size * (1 + 1e-9)) / 3)),
  );
}

/** A number with the sign that is printed, also in its exponent. */
const minus = (text) => text.replace(/(^|e|\s)-(?=\d)/g, "$1−");

/** A text in which no line ends between a number and its unit, or beside an equals sign. */
const unbroken = (text) =>
  text
    .replace(/(\d) (?=%|[nµmkMG]?(?:N|J|m|s|Pa|kg)\b)/g, "$1\u00a0")
    .replace(/N s\b/g, "N\u00a0s")
    .replace(/ ([=×]) /g, "\u00a0$1\u00a0");

/** Digits as an index. */
const lowered = (text) => text.replace(/\d/g, (digit) => "₀₁₂₃₄₅₆₇₈₉"[digit]);

function plainNumber(value, digits) {
  const rounded = Number(value.toPrecision(digits));
  const size = Math.abs(rounded);
  return minus(
    size !== 0 && (size < 1e-4 || size >= 1e7)
      ? rounded.toExponential()
      : String(rounded),
  );
}

/** A quantity with its unit. */
function quantity(value, unit, digits = 4) {
  const power = powerFor(Math.abs(value), unit);
  const number = plainNumber(value / 10 ** power, digits);
  return NO_SPACE.has(unit)
    ? number + unit
    : `${number}\u00a0${PREFIXES[power]}${unit}`;
}

/** A quantity with more digits, as texts of a solution have it. */
const inSi = (value, unit, digits = 6) => quantity(value, unit, digits);

/** About `count` round numbers from low to high, no less than three. */
function ticksBetween(low, high, count) {
  const raw = (high - low) / count;
  if (!(raw > 0) || !Number.isFinite(raw)) return [low];
  const steps = [10, 5, 2, 1, 0.5, 0.2].map(
    (lead) => lead * 10 ** Math.floor(Math.log10(raw)),
  );
  const found = steps
    .slice(steps.findLastIndex((s) => s >= raw * (1 - 1e-9)))
    .map((step) => {
      const first = Math.ceil(low / step - 1e-9);
      return Array.from(
        { length: Math.floor(high / step + 1e-9) - first + 1 },
        (_, k) => (first + k) * step,
      );
    });
  return found.find((ticks) => ticks.length > 2) || found.at(-1);
}

/** Ticks with their labels, all with one prefix; `unit` has it. */
function labelledTicks(low, high, count, unit) {
  const power = powerFor(Math.max(Math.abs(low), Math.abs(high)), unit);
  const ticks = ticksBetween(low, high, count);
  const label = (value) =>
    plainNumber(Math.round((value / 10 ** power) * 1e9) / 1e9, 6);
  return {
    ticks: ticks.map((value) => [value, label(value)]),
    unit: PREFIXES[power] + unit,
  };
}

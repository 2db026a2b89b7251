"use strict";
// Numbers for people: SI prefixes, and ticks of axes.

const PREFIXES = { "-9": "n", "-6": "µ", "-3": "m", "0": "", "3": "k", "6": "M", "9": "G" };
const TAKES_PREFIX = /^(N|J|m|s|Pa|N s|m\/s)$/;
const NO_SPACE = new Set(["", "%"]);

function clampPower(power) {
  return Math.max(-9, Math.min(9, power));
}

/** Power of ten of the prefix that suits numbers of this size: a multiple of three. */
function powerFor(size, unit) {
  if (!TAKES_PREFIX.test(unit) || !(size > 0)) return 0;
  return clampPower(3 * Math.floor(Math.log10(size * (1 + 1e-9)) / 3));
}

function minus(text) {
  return text.replace("-", "−");
}

function plainNumber(value, digits) {
  const rounded = Number(value.toPrecision(digits));
  const size = Math.abs(rounded);
  return minus(size !== 0 && (size < 1e-4 || size >= 1e7) ? rounded.toExponential() : String(rounded));
}

/** A quantity with its unit. */
function quantity(value, unit, digits = 4) {
  const power = powerFor(Math.abs(value), unit);
  const number = plainNumber(value / 10 ** power, digits);
  return NO_SPACE.has(unit) ? number + unit : `${number}\u00a0${PREFIXES[power]}${unit}`;
}

/** A quantity with more digits, as texts of a solution have it. */
function inSi(value, unit, digits = 6) {
  return quantity(value, unit, digits);
}

/** About `count` round numbers from low to high. */
function ticksBetween(low, high, count) {
  const raw = (high - low) / Math.max(1, count);
  if (!(raw > 0) || !Number.isFinite(raw)) return [low];
  const base = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((lead) => lead * base).find((s) => s >= raw * (1 - 1e-9));
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1) found.push(k * step);
  return found;
}

/** Ticks with their labels, all with one prefix; `unit` has it. */
function labelledTicks(low, high, count, unit) {
  const power = powerFor(Math.max(Math.abs(low), Math.abs(high)), unit);
  const ticks = ticksBetween(low, high, count);
  const label = (value) => plainNumber(Math.round(value / 10 ** power * 1e9) / 1e9, 6);
  return { ticks: ticks.map((value) => [value, label(value)]), unit: PREFIXES[power] + unit };
}

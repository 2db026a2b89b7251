"use strict";
// What Python means where JavaScript means something else; javascript.py writes calls of these.

const py = {
  floordiv(a, b) {
    if (b === 0) throw new RangeError("division by zero");
    return (a - py.mod(a, b)) / b + 0; // exact where a / b would round up
  },
  mod(a, b) {
    if (b === 0) throw new RangeError("modulo by zero");
    const rest = a % b;
    return (rest !== 0 && rest < 0 !== b < 0 ? rest + b : rest) + 0;
  },
  xor(a, b) {
    if ((a | 0) !== a || (b | 0) !== b)
      throw new RangeError(`${a} ^ ${b} is beyond 32 bits`);
    return a ^ b;
  },
  shl(a, b) {
    const shifted = a * 2 ** b;
    if (b < 0 || !Number.isSafeInteger(shifted))
      throw new RangeError(`${a} << ${b}`);
    return shifted;
  },
  shr(a, b) {
    if (b < 0) throw new RangeError(`${a} >> ${b}`);
    return Math.floor(a / 2 ** b) + 0;
  },
  monotonic: () => performance.now() / 1000,
  blank(count, fields) {
    const all = [],
      lists = Object.keys(fields).filter((key) => Array.isArray(fields[key]));
    while (all.length < count) {
      const made = { ...fields };
      for (const key of lists)
        made[key] = fields[key].map((one) =>
          Array.isArray(one) ? one.slice() : one,
        );
      all.push(made);
    }
    return all;
  },
  pow: (base, exponent) =>
    exponent === 2
      ? base * base
      : base === 10 && Number.isInteger(exponent)
        ? Number(`1e${exponent}`)
        : base ** exponent,
  min: (a, b) => (b < a ? b : a),
  where: (test, a, b) => (test ? a : b),
  spacing: (x) => 2 ** (py.frexp(x)[1] - 53),
  extremes: (x) =>
    typeof x === "number"
      ? [x, x]
      : [Math.min(...x.values), Math.max(...x.values)],
  steps: (values, at) => ({ values, at }),
  max: (a, b) => (b > a ? b : a),
  int(x) {
    const whole = Math.trunc(x);
    if (!Number.isSafeInteger(whole))
      throw new RangeError(`${x} is no whole number below 2^53`);
    return whole + 0;
  },
  /** To the nearest whole number, halves to the even one. */
  round(x) {
    const below = Math.floor(x);
    const rest = x - below;
    return py.int(
      rest < 0.5 || (rest === 0.5 && below % 2 === 0) ? below : below + 1,
    );
  },
  gcd(a, b) {
    while (b) [a, b] = [b, a % b];
    return Math.abs(a);
  },
  frexp(x) {
    if (x === 0 || !Number.isFinite(x)) return [x, 0];
    let power = Math.max(-1023, Math.floor(Math.log2(Math.abs(x))) + 1);
    let part = x * 2 ** -power;
    for (; Math.abs(part) < 0.5; power -= 1) part *= 2;
    for (; Math.abs(part) >= 1; power += 1) part /= 2;
    return [part, power];
  },
  truth(x) {
    if (typeof x === "boolean") return x;
    if (typeof x !== "number") throw new TypeError(`${x} is no condition`);
    return x !== 0;
  },
  any: (list) => list.some(py.truth),
  all: (list) => list.every(py.truth),
  sum: (list) => list.reduce((sum, x) => sum + x, 0),
  most: (list) => list.reduce(py.max),
  least: (list) => list.reduce(py.min),
  isinstance: (x, kind) =>
    x !== null && (Array.isArray(x) ? "array" : typeof x) === kind,
  repeat: ([item], count) =>
    typeof item === "number"
      ? new Float64Array(Math.max(0, count)).fill(item)
      : new Array(Math.max(0, count)).fill(item),
  range(...given) {
    const [start, stop, step = 1] = given.length > 1 ? given : [0, ...given];
    const all = [],
      count = Math.ceil((stop - start) / step);
    while (all.length < count) all.push(start + all.length * step);
    return all;
  },
  enumerate: (items) => py.range(items.length).map((i) => [i, items[i]]),
  zip(...lists) {
    if (lists.some((list) => list.length !== lists[0].length))
      throw new RangeError("lists of unequal lengths");
    return Array.from(lists[0], (_, i) => lists.map((list) => list[i]));
  },
  /** First place in a sorted list whose item is not below x, or is above it. */
  bisect(list, x, low, high, above) {
    while (low < high) {
      const middle = Math.floor((low + high) / 2);
      if (list[middle] < x || (above && list[middle] === x)) low = middle + 1;
      else high = middle;
    }
    return low;
  },
  bisect_left: (list, x, low = 0, high = list.length) =>
    py.bisect(list, x, low, high, false),
  bisect_right: (list, x, low = 0, high = list.length) =>
    py.bisect(list, x, low, high, true),
  sorted: (numbers) => Array.from(numbers).sort((a, b) => a - b),
  extend: (list, more) => more.forEach((item) => list.push(item)),
  has: (all, key) =>
    Array.isArray(all) ? all.includes(key) : Object.hasOwn(all, key),
  get: (table, key, other = null) =>
    Object.hasOwn(table, key) ? table[key] : other,
  /** Text of a whole number; or format "g": so many digits, halves to the even one, without zeros at the end. */
  format(x, spec = "") {
    const [, whole] = /^\.(\d+)g$/.exec(spec) || [];
    if (typeof x === "string" || (spec === "" && Number.isSafeInteger(x)))
      return String(x);
    if (whole === undefined) throw new TypeError(`${x} needs a format`);
    const digits = Number(whole);
    if (!Number.isFinite(x))
      return Number.isNaN(x) ? "nan" : x > 0 ? "inf" : "-inf";
    const [figures, exponent] = Math.abs(x)
      .toExponential(100)
      .replace(".", "")
      .split("e");
    const half =
      /^50*$/.test(figures.slice(digits)) &&
      Number(figures[digits - 1]) % 2 === 0;
    const rounded = half
      ? Math.sign(x) *
        Number(`${figures.slice(0, digits)}e${exponent - digits + 1}`)
      : x;
    const [lead, power] = rounded
      .toExponential(digits - 1)
      .split("e")
      .map(Number);
    if (x !== 0 && (power < -4 || power >= digits)) {
      const size = String(Math.abs(power)).padStart(2, "0");
      return `${lead}e${power < 0 ? "-" : "+"}${size}`;
    }
    return String(Number(rounded.toPrecision(digits)) + 0);
  },
};

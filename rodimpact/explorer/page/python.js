"use strict";
// Operations of Python that JavaScript lacks or does in another way. The functions that
// javascript.py translates call them by these names; `format` is the hardest.

const py = {
  // Whole numbers -----------------------------------------------------------------------

  /** The quotient a/b of whole numbers, rounded down. */
  floordiv(a, b) {
    if (b === 0) {
      throw new RangeError("division by zero");
    }
    return (a - py.mod(a, b)) / b + 0; // exact where a / b would round up
  },
  /** a % b: the remainder of a division rounded down, with the sign of b. */
  mod(a, b) {
    if (b === 0) {
      throw new RangeError("modulo by zero");
    }
    let remainder = a % b;
    if (remainder !== 0 && remainder < 0 !== b < 0) {
      remainder += b;
    }
    return remainder + 0; // no -0
  },
  /** a ^ b of numbers of 32 bits. */
  xor(a, b) {
    if ((a | 0) !== a || (b | 0) !== b) {
      throw new RangeError(`${a} ^ ${b} is beyond 32 bits`);
    }
    return a ^ b;
  },
  /** a << b, that is a 2^b. */
  shl(a, b) {
    const shifted = a * 2 ** b;
    if (b < 0 || !Number.isSafeInteger(shifted)) {
      throw new RangeError(`${a} << ${b}`);
    }
    return shifted;
  },
  /** a >> b, that is a/2^b rounded down. */
  shr(a, b) {
    if (b < 0) {
      throw new RangeError(`${a} >> ${b}`);
    }
    return Math.floor(a / 2 ** b) + 0;
  },
  /** The number without its decimals. */
  int(x) {
    const whole = Math.trunc(x);
    if (!Number.isSafeInteger(whole)) {
      throw new RangeError(`${x} is no whole number below 2^53`);
    }
    return whole + 0;
  },
  /** The nearest whole number; of two that are as near, the even one. */
  round(x) {
    const below = Math.floor(x);
    const remainder = x - below;
    const isEven = below % 2 === 0;
    const isNearer = remainder < 0.5;
    const isHalf = remainder === 0.5;
    if (isNearer || (isHalf && isEven)) {
      return py.int(below);
    }
    return py.int(below + 1);
  },
  /** Greatest common divisor, by Euclid. */
  gcd(a, b) {
    while (b) {
      [a, b] = [b, a % b];
    }
    return Math.abs(a);
  },

  // Floats ------------------------------------------------------------------------------

  /** Power; squares and powers of ten are those of Python, to the last bit. */
  pow(base, exponent) {
    if (exponent === 2) {
      return base * base;
    }
    if (base === 10 && Number.isInteger(exponent)) {
      return Number(`1e${exponent}`);
    }
    return base ** exponent;
  },
  /** Fraction from 1/2 to 1 and power of two whose product is x. */
  frexp(x) {
    if (x === 0 || !Number.isFinite(x)) {
      return [x, 0];
    }
    let power = Math.max(-1023, Math.floor(Math.log2(Math.abs(x))) + 1);
    let fraction = x * 2 ** -power;
    for (; Math.abs(fraction) < 0.5; power -= 1) {
      fraction *= 2;
    }
    for (; Math.abs(fraction) >= 1; power += 1) {
      fraction /= 2;
    }
    return [fraction, power];
  },
  /** Distance from x to the next float. */
  spacing: (x) => 2 ** (py.frexp(x)[1] - 53),
  min: (a, b) => (b < a ? b : a),
  max: (a, b) => (b > a ? b : a),
  where: (test, a, b) => (test ? a : b),
  monotonic: () => performance.now() / 1000,

  // Truth and types ---------------------------------------------------------------------

  /** Whether a condition is true: a number that is not 0 is. */
  truth(x) {
    if (typeof x === "boolean") {
      return x;
    }
    if (typeof x !== "number") {
      throw new TypeError(`${x} is no condition`);
    }
    return x !== 0;
  },
  any: (list) => list.some(py.truth),
  all: (list) => list.every(py.truth),
  /** Whether x has a type, one of `TYPES` in javascript.py. */
  isinstance(x, type) {
    if (x === null) {
      return false;
    }
    if (Array.isArray(x)) {
      return type === "array";
    }
    return typeof x === type;
  },

  // Lists and tables --------------------------------------------------------------------

  sum: (list) => list.reduce((sum, x) => sum + x, 0),
  most: (list) => list.reduce(py.max),
  least: (list) => list.reduce(py.min),
  sorted: (numbers) => Array.from(numbers).sort((a, b) => a - b),
  /** [item] * count. */
  repeat([item], count) {
    const length = Math.max(0, count);
    if (typeof item === "number") {
      return new Float64Array(length).fill(item);
    }
    return new Array(length).fill(item);
  },
  /** Numbers of range(stop), range(start, stop) or range(start, stop, step). */
  range(...bounds) {
    if (bounds.length === 1) {
      bounds.unshift(0);
    }
    const [start, stop, step = 1] = bounds;
    const count = Math.ceil((stop - start) / step);
    const numbers = [];
    for (let k = 0; k < count; k += 1) {
      numbers.push(start + k * step);
    }
    return numbers;
  },
  enumerate: (items) => py.range(items.length).map((i) => [i, items[i]]),
  /** zip(..., strict=True): lists of the items at each index. */
  zip(...lists) {
    if (lists.some((list) => list.length !== lists[0].length)) {
      throw new RangeError("lists of unequal lengths");
    }
    return Array.from(lists[0], (_, i) => lists.map((list) => list[i]));
  },
  extend: (list, items) => items.forEach((item) => list.push(item)),
  /** key in collection: an item of a list or a key of a table. */
  has(collection, key) {
    if (Array.isArray(collection)) {
      return collection.includes(key);
    }
    return Object.hasOwn(collection, key);
  },
  /** table.get(key, fallback). */
  get(table, key, fallback = null) {
    return Object.hasOwn(table, key) ? table[key] : fallback;
  },
  /** First index in a sorted list whose item is not below x, or is above x. */
  bisect(list, x, low, high, isAbove) {
    while (low < high) {
      const middle = Math.floor((low + high) / 2);
      const item = list[middle];
      if (item < x || (isAbove && item === x)) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return low;
  },
  bisect_left: (list, x, low = 0, high = list.length) =>
    py.bisect(list, x, low, high, false),
  bisect_right: (list, x, low = 0, high = list.length) =>
    py.bisect(list, x, low, high, true),

  // Records and profiles ----------------------------------------------------------------

  /** So many records of zeros, each with lists of its own. */
  blank(count, fields) {
    const copyRow = (row) => (Array.isArray(row) ? row.slice() : row);
    const lists = Object.keys(fields).filter((key) =>
      Array.isArray(fields[key]),
    );
    const records = [];
    while (records.length < count) {
      const record = { ...fields };
      for (const key of lists) {
        record[key] = fields[key].map(copyRow);
      }
      records.push(record);
    }
    return records;
  },
  /** Smallest and largest value of a number or of steps. */
  extremes(x) {
    if (typeof x === "number") {
      return [x, x];
    }
    return [Math.min(...x.values), Math.max(...x.values)];
  },
  steps: (values, at) => ({ values, at }),

  // Texts -------------------------------------------------------------------------------

  /** Text of a whole number, or of a number in a format such as ".6g". */
  format(x, spec = "") {
    if (typeof x === "string") {
      return x;
    }
    if (spec === "" && Number.isSafeInteger(x)) {
      return String(x);
    }
    const [, digits] = /^\.(\d+)g$/.exec(spec) || [];
    if (digits === undefined) {
      throw new TypeError(`${x} needs a format`);
    }
    if (Number.isNaN(x)) {
      return "nan";
    }
    if (!Number.isFinite(x)) {
      return x > 0 ? "inf" : "-inf";
    }
    return py.formatG(x, Number(digits));
  },
  /** So many digits without zeros at the end; halves are rounded to the even digit. */
  formatG(x, digits) {
    const rounded = py.halfToEven(x, digits);
    const [lead, power] = rounded.toExponential(digits - 1).split("e");
    const exponent = Number(power);
    if (x === 0 || (exponent >= -4 && exponent < digits)) {
      return String(Number(rounded.toPrecision(digits)) + 0);
    }
    const sign = exponent < 0 ? "-" : "+";
    const size = String(Math.abs(exponent)).padStart(2, "0");
    return `${Number(lead)}e${sign}${size}`;
  },
  /** x, or the number below it if x lies halfway and its last digit is even. */
  halfToEven(x, digits) {
    // 101 digits hold all of a float's that matter, so that a half is seen exactly.
    const [lead, exponent] = Math.abs(x).toExponential(100).split("e");
    const figures = lead.replace(".", "");
    const isHalf = /^50*$/.test(figures.slice(digits));
    const isEven = Number(figures[digits - 1]) % 2 === 0;
    if (!isHalf || !isEven) {
      return x;
    }
    const below = `${figures.slice(0, digits)}e${exponent - digits + 1}`;
    return Math.sign(x) * Number(below);
  },
};

"use strict";
// A map of e over two numbers of the design; a click takes the numbers there. Begin with
// `showMap`.

const MAP_CELLS = 100; // each way
const MAP_REDRAW_INTERVAL = 200; // ms between two drawings of a map that grows
const MAP_DELAY = 300; // ms without a change before the map is solved
const MAP_STOPS = [
  [0, 35, 90],
  [130, 120, 115],
  [255, 230, 90],
]; // colours of e = 0, 1/2 and 1
const NO_RESTITUTION = [128, 128, 128, 40]; // pixel where there is no e
const map = {
  x: null, // number of the design that varies across, and up
  y: null,
  xs: [], // its values, in the unit of its field
  ys: [],
  values: [], // e by rows
  timer: 0,
  turn: 0, // maps of an earlier turn are not solved to their end
  frame: null,
};

// Numbers ---------------------------------------------------------------------------------

/** Numbers that a map can vary, each with its path, name, value and the key of its field. */
function numbersOf(tables) {
  const numbers = [];
  const add = (key, path, where) => {
    const value = getAt(tables, path);
    if (typeof value === "number") {
      const name = `${FIELDS[key].name} of ${where}`;
      numbers.push({ name, key, path, value });
    }
  };
  const names = namesOf(tables.bodies);
  tables.bodies.forEach((body, i) => {
    const path = ["bodies", i];
    const name = solver.name_of(body.kind, names.numbers[i]);
    const hasProfile = [body.velocity, body.strain].some(
      (value) => typeof value === "object",
    );
    const places = segmentsWithPaths(body);
    places.forEach((segment, j) => {
      const segmentPath = [...path, ...segment.path];
      const where = body.segments ? `${name}, segment ${j + 1}` : name;
      if (!hasProfile) {
        add("length", [...segmentPath, "length"], where);
      } // profiles have a length
      add("area", [...segmentPath, "area"], where);
    });
    add("mass", [...path, "mass"], name);
    add("velocity", [...path, "velocity"], name);
  });
  listOf(tables.contacts).forEach(({ law }, i) => {
    const where = `contact ${names.contacts[i]}`;
    add("gap", ["contacts", i, "gap"], where);
    add(stiffnessField(law), ["contacts", i, "stiffness"], where);
  });
  for (const name of Object.keys(tables.materials || {})) {
    add("youngs_modulus", ["materials", name, "youngs_modulus"], name);
    add("density", ["materials", name, "density"], name);
  }
  return numbers;
}

/** Even values about that of a number, or over the range of its slider. */
function valuesAbout({ key, value }) {
  const { low, high, power } = FIELDS[key];
  let from = low;
  let to = high;
  if (value > 0) {
    from = toShown(value, power) / 10;
    to = 2 * toShown(value, power);
  }
  return Array.from(
    { length: MAP_CELLS },
    (_, i) => from + ((to - from) * i) / (MAP_CELLS - 1),
  );
}

/** Offer the numbers of the design; those that are chosen stay. */
function offerNumbers(numbers) {
  const lengthOfRod2 = numbers.findIndex(
    ({ path }) => path[1] === 1 && path[2] === "length",
  );
  const defaults = { "map-x": 0, "map-y": Math.max(0, lengthOfRod2) };
  for (const [id, index] of Object.entries(defaults)) {
    const select = byId(id);
    const { value: chosen } = select;
    select.replaceChildren(
      ...numbers.map(({ name }, i) => new Option(name, i)),
    );
    const isThere = chosen !== "" && Number(chosen) < numbers.length;
    select.value = isThere ? chosen : index;
  }
}

// Solving ---------------------------------------------------------------------------------

/** Stop the map that is being solved. */
function stopMap() {
  clearTimeout(map.timer);
  map.turn += 1;
}

/** Solve the map of the design as it is now, if the map is open. */
function showMap() {
  stopMap();
  if (!byId("map").open) {
    return;
  }
  const numbers = numbersOf(design.case);
  offerNumbers(numbers);
  const canSolve = page.scene && problemsOf(design).length === 0;
  if (canSolve) {
    byId("map-reading").textContent = "";
    map.timer = setTimeout(solveMap, MAP_DELAY, numbers, map.turn);
  } else {
    byId("map-reading").textContent =
      "The map is for collisions that this page can solve.";
  }
}

/** Solve the map of the two numbers that are chosen, row by row, and draw it as it grows. */
async function solveMap(numbers, turn) {
  map.x = numbers[byId("map-x").value];
  map.y = numbers[byId("map-y").value];
  map.xs = valuesAbout(map.x);
  map.ys = valuesAbout(map.y);
  map.values = [];
  const start = performance.now();
  let lastDrawing = start;
  const inSiUnits = ({ path, key }, values) => [
    path,
    values.map((value) => fromShown(value, FIELDS[key].power)),
  ];
  const rows = restitutionRows(
    structuredClone(design.case),
    inSiUnits(map.x, map.xs),
    inSiUnits(map.y, map.ys),
  );
  for await (const row of rows) {
    if (turn !== map.turn) {
      return;
    }
    map.values.push(row);
    if (performance.now() - lastDrawing >= MAP_REDRAW_INTERVAL) {
      lastDrawing = performance.now();
      const percentage = Math.round((100 * map.values.length) / MAP_CELLS);
      byId("map-reading").textContent = `${percentage} % solved`;
      drawMap();
    }
  }
  byId("map-reading").textContent = "";
  byId("map").dataset.took = Math.round(performance.now() - start);
  drawMap();
}

// Drawing ---------------------------------------------------------------------------------

/** Pixel of e: from dark at 0 to light at 1. */
function pixelOf(e) {
  if (e === null) {
    return NO_RESTITUTION;
  }
  return [...colourOf(2 * e - 1, { stops: MAP_STOPS }), 255];
}

/** Draw the rows of the map that are solved, and the design as a dot. */
function drawMap() {
  const { x, y, xs, ys, values } = map;
  if (values.length === 0) {
    return;
  }
  const { theme } = page;
  const xField = FIELDS[x.key];
  const yField = FIELDS[y.key];
  const axes = {
    x: { low: xs[0], high: xs.at(-1), unit: xField.unit, name: x.name },
    y: { low: ys[0], high: ys.at(-1), unit: yField.unit, name: y.name },
  };
  const pen = new CanvasPen(byId("map-picture"));
  const frame = frameOfPlot(pen, axes, theme);
  const pixels = new ImageData(MAP_CELLS, MAP_CELLS);
  values.forEach((row, j) => {
    const firstPixel = (MAP_CELLS - 1 - j) * MAP_CELLS;
    row.forEach((e, i) => pixels.data.set(pixelOf(e), 4 * (firstPixel + i)));
  });
  const cells = new OffscreenCanvas(MAP_CELLS, MAP_CELLS);
  cells.getContext("2d").putImageData(pixels, 0, 0);
  pen.context.imageSmoothingEnabled = false;
  pen.image(cells, frame.x, frame.y, frame.width, frame.height);
  const hereX = frame.across(toShown(x.value, xField.power));
  const hereY = frame.up(toShown(y.value, yField.power));
  pen.disc(hereX, hereY, 0.35 * theme.size, theme.accent);
  drawAxes(pen, frame, theme, axes);
  map.frame = frame;
}

/** Numbers, to three digits, and e under a pointer; null beside the map. */
function cellAt({ offsetX, offsetY }) {
  const { frame, xs, ys, values } = map;
  if (!frame) {
    return null;
  }
  const indexOf = (fraction) => Math.round(fraction * (MAP_CELLS - 1));
  const i = indexOf((offsetX - frame.x) / frame.width);
  const j = indexOf((frame.bottom - offsetY) / frame.height);
  const e = getAt(values, [j, i]);
  if (e === undefined) {
    return null;
  }
  const x = Number(xs[i].toPrecision(3));
  const y = Number(ys[j].toPrecision(3));
  return { x, y, e };
}

/** A cell of the map in words. */
function cellText({ x, y, e }) {
  const textOf = ({ name, key }, value) =>
    `${name} ${plainNumber(value, 4)} ${FIELDS[key].unit}`;
  const result = e === null ? "no e" : `e = ${plainNumber(e, 4)}`;
  return `${textOf(map.x, x)}, ${textOf(map.y, y)}: ${result}`;
}

/** Let the map show e under the pointer, and a click take the numbers there. */
function connectMap() {
  const colours = [0, 0.5, 1].map((e) => css(pixelOf(e).slice(0, 3)));
  byId("map-colours").style.background = gradient(colours);
  byId("map").addEventListener("toggle", showMap);
  byId("map-x").addEventListener("change", showMap);
  byId("map-y").addEventListener("change", showMap);
  const picture = byId("map-picture");
  picture.addEventListener("pointermove", (event) => {
    const cell = cellAt(event);
    byId("map-reading").textContent = cell ? cellText(cell) : "";
  });
  picture.addEventListener("click", (event) => {
    const cell = cellAt(event);
    if (!cell) {
      return;
    }
    const take = ({ key, path }, value) =>
      setAt(design.case, path, fromShown(value, FIELDS[key].power));
    take(map.x, cell.x);
    take(map.y, cell.y);
    designChanged(true);
  });
}

"use strict";
// A map of e over two numbers of the design, computed by the page; a click takes the numbers there.

const CELLS = 100; // each way
const SOON = 200; // ms between two drawings of a map that is not ready
const REST = 300; // ms without a change before the map is computed anew
const chart = {
  cells: 0,
  xs: null,
  ys: null,
  values: [],
  timer: 0,
  turn: 0,
  frame: null,
};

/** The numbers that a map can vary, each with its path in the case and its name. */
function numbersOf({ case: tables }) {
  const found = [];
  const add = (key, path, where, entry = key) => {
    const value = getAt(tables, [...path, entry]);
    if (typeof value === "number")
      found.push({
        name: `${FIELDS[key].name} of ${where}`,
        key,
        path: [...path, entry],
        value,
      });
  };
  const [numbers, contacts] = namesIn(tables.bodies);
  tables.bodies.forEach((body, i) => {
    const name = fronts.name_of(body.kind, numbers[i]);
    const profile = [body.velocity, body.strain].some(
      (value) => typeof value === "object",
    );
    listOf(body.segments || [body]).forEach((_, j) => {
      const path = body.segments ? ["bodies", i, "segments", j] : ["bodies", i];
      const where = body.segments ? `${name}, segment ${j + 1}` : name;
      if (!profile) add("length", path, where); // which is bound to the length it was made for
      add("area", path, where);
    });
    add("mass", ["bodies", i], name);
    add("velocity", ["bodies", i], name);
  });
  listOf(tables.contacts).forEach(({ law }, i) => {
    add("gap", ["contacts", i], `contact ${contacts[i]}`);
    add(
      stiffnessField(law),
      ["contacts", i],
      `contact ${contacts[i]}`,
      "stiffness",
    );
  });
  for (const name of Object.keys(tables.materials || {})) {
    add("youngs_modulus", ["materials", name], name);
    add("density", ["materials", name], name);
  }
  return found;
}

/** Even values about the one in use, or over the range of its slider, in the unit of that. */
function valuesAbout({ key, value }) {
  const { low, high, power } = FIELDS[key];
  const [from, to] =
    value > 0
      ? [toShown(value, power) / 10, 2 * toShown(value, power)]
      : [low, high];
  return Array.from(
    { length: chart.cells },
    (_, i) => from + ((to - from) * i) / (chart.cells - 1),
  );
}

/** Offer the numbers of the design, and keep those that are chosen. */
function offerNumbers(numbers) {
  ["map-x", "map-y"].forEach((id, k) => {
    const chosen = byId(id).value;
    const other = numbers.findIndex(
      ({ path }) => path[1] === 1 && path[2] === "length",
    );
    byId(id).replaceChildren(
      ...numbers.map(({ name }, i) => new Option(name, i)),
    );
    byId(id).value =
      chosen && chosen < numbers.length ? chosen : k && other > 0 ? other : 0;
  });
}

function stopMap() {
  clearTimeout(chart.timer);
  chart.turn += 1;
}

/** Compute the map of the design as it is now, if it is open. */
function showMap() {
  stopMap();
  if (!byId("map").open) return;
  const numbers = numbersOf(design);
  offerNumbers(numbers);
  const able = shown.scene && !problemsOf(design).length;
  byId("map-reading").textContent = able
    ? ""
    : "The map is for collisions that this page can solve.";
  if (able) chart.timer = setTimeout(computeMap, REST, numbers, chart.turn);
}

async function computeMap(numbers, turn) {
  const [x, y] = ["map-x", "map-y"].map((id) => numbers[byId(id).value]);
  chart.cells = CELLS;
  const [xs, ys] = [valuesAbout(x), valuesAbout(y)];
  Object.assign(chart, { x, y, xs, ys, values: [] });
  const began = performance.now();
  let drawn = began;
  const inSI = (values, { key }) =>
    values.map((value) => fromShown(value, FIELDS[key].power));
  for await (const row of mapOf(
    structuredClone(design),
    [x.path, inSI(xs, x)],
    [y.path, inSI(ys, y)],
  )) {
    if (turn !== chart.turn) return;
    chart.values.push(row);
    if (performance.now() - drawn < SOON) continue;
    drawn = performance.now();
    byId("map-reading").textContent =
      `${Math.round((100 * chart.values.length) / ys.length)} % solved`;
    drawMap();
  }
  byId("map-reading").textContent = "";
  byId("map").dataset.took = Math.round(performance.now() - began);
  drawMap();
}

/** Colour of e: from dark at 0 to light at 1; without e nothing. */
const colourOfE = (e) =>
  e === null
    ? [128, 128, 128, 40]
    : [
        ...colourOf(2 * e - 1, {
          stops: [
            [0, 35, 90],
            [130, 120, 115],
            [255, 230, 90],
          ],
        }),
        255,
      ];

function drawMap() {
  const { x, y, xs, ys, values } = chart;
  if (!values.length) return;
  const pen = new CanvasPen(byId("map-picture"));
  const { theme } = shown;
  const frame = plotFrame(pen, theme.size, {
    x0: xs[0],
    x1: xs.at(-1),
    y0: ys[0],
    y1: ys.at(-1),
  });
  const count = chart.cells;
  const image = new ImageData(count, count);
  values.forEach((row, j) =>
    row.forEach((e, i) =>
      image.data.set(colourOfE(e), 4 * ((count - 1 - j) * count + i)),
    ),
  );
  const cells = new OffscreenCanvas(count, count);
  cells.getContext("2d").putImageData(image, 0, 0);
  pen.context.imageSmoothingEnabled = false;
  pen.context.drawImage(cells, frame.x, frame.y, frame.width, frame.height);
  const [xField, yField] = [x, y].map(({ key }) => FIELDS[key]);
  pen.disc(
    frame.across(toShown(x.value, xField.power)),
    frame.up(toShown(y.value, yField.power)),
    0.35 * theme.size,
    theme.wrong,
  );
  drawFrame(pen, frame, theme.size, theme, {
    x: [xs[0], xs.at(-1), xField.unit, x.name],
    y: [ys[0], ys.at(-1), yField.unit, y.name],
  });
  chart.frame = frame;
}

/** Numbers, to three digits, and e under a pointer; null beside the map. */
function placeOnMap({ offsetX, offsetY }) {
  const { frame, xs, ys, values } = chart;
  if (!frame) return null;
  const [i, j] = [
    (offsetX - frame.x) / frame.width,
    (frame.bottom - offsetY) / frame.height,
  ].map((share) => Math.round(share * (chart.cells - 1)));
  if (!values[j] || values[j][i] === undefined) return null;
  return {
    x: Number(xs[i].toPrecision(3)),
    y: Number(ys[j].toPrecision(3)),
    e: values[j][i],
  };
}

function connectMap() {
  const stops = [0, 0.5, 1].map(
    (e) => `rgb(${colourOfE(e).slice(0, 3).join(",")})`,
  );
  byId("map-colours").style.background =
    `linear-gradient(to right, ${stops.join(",")})`;
  byId("map").addEventListener("toggle", showMap);
  for (const id of ["map-x", "map-y"])
    byId(id).addEventListener("change", showMap);
  const picture = byId("map-picture");
  const told = ({ name, key }, value) =>
    `${name} ${plainNumber(value, 4)} ${FIELDS[key].unit}`;
  picture.addEventListener("pointermove", (event) => {
    const at = placeOnMap(event);
    byId("map-reading").textContent = at
      ? `${told(chart.x, at.x)}, ${told(chart.y, at.y)}: ${at.e === null ? "no e" : `e = ${plainNumber(at.e, 4)}`}`
      : "";
  });
  picture.addEventListener("click", (event) => {
    const at = placeOnMap(event);
    if (!at) return;
    for (const [{ key, path }, value] of [
      [chart.x, at.x],
      [chart.y, at.y],
    ]) {
      setAt(design.case, path, fromShown(value, FIELDS[key].power));
    }
    changed(true);
  });
}

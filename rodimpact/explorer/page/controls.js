"use strict";
// Sliders and boxes for a design; each knows the path of its number in the case.

// power: of ten, of the unit shown; log: whether the slider runs over ratios
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
    log: true,
  },
  velocity: {
    name: "velocity",
    unit: "m/s",
    power: 0,
    low: -20,
    high: 20,
    step: 0.1,
  },
  mass: { name: "mass", unit: "kg", power: 0, low: 0.01, high: 100, log: true },
  youngs_modulus: {
    name: "Young's modulus E",
    unit: "GPa",
    power: 9,
    low: 1,
    high: 500,
    log: true,
  },
  density: {
    name: "density ρ",
    unit: "kg/m³",
    power: 0,
    low: 500,
    high: 20000,
    log: true,
  },
  gap: { name: "gap", unit: "µm", power: -6, low: 0, high: 500, step: 1 },
  spring: {
    name: "stiffness",
    unit: "N/µm",
    power: 6,
    low: 1,
    high: 100000,
    log: true,
  },
  hertz: {
    name: "stiffness",
    unit: "GN/m^1.5",
    power: 9,
    low: 1e-3,
    high: 1e4,
    log: true,
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
    bounded: true,
  },
  fraction: {
    name: "at",
    unit: "%",
    power: -2,
    low: 0,
    high: 100,
    step: 1,
    bounded: true,
  },
};
const LAWS = {
  rigid: {},
  hertz: { stiffness: 1e10 },
  spring: { stiffness: 1e8 },
};
const LAW_NAMES = { rigid: "rigid (flat)", hertz: "Hertz (round)" };

const stiffnessField = (law) => (/hertz|hunt/.test(law) ? "hertz" : "spring");

const toShown = (value, power) =>
  Number(
    (power < 0 ? value * 10 ** -power : value / 10 ** power).toPrecision(12),
  );

/** The float nearest to what is written: one rounding, by one division or product. */
const fromShown = (shown, power) =>
  power < 0 ? shown / 10 ** -power : shown * 10 ** power;

const listOf = (value) => (Array.isArray(value) ? value : []);

const getAt = (tree, path) => path.reduce((found, key) => found?.[key], tree);

const setAt = (tree, path, value) => {
  getAt(tree, path.slice(0, -1))[path.at(-1)] = value;
};

/** Write a text where it is another; whether it was. */
function write(element, text) {
  const other = element.textContent !== text;
  if (other) element.textContent = text;
  return other;
}

function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes))
    element.setAttribute(name, value);
  element.append(...children);
  return element;
}

/** What is folded away of a body, in short. */
function aboutBody({ kind, segments, area, material }) {
  if (kind !== "rod") return kind === "wall" ? "velocity, place" : "place";
  if (segments) return `${segments.length} segments`;
  return [
    typeof area === "number"
      ? `${toShown(area, FIELDS.area.power)} mm²`
      : "area",
    material,
  ].join(", ");
}

/** Numbers of bodies, and names of their contacts. */
const namesIn = (bodies) =>
  [fronts.body_numbers, fronts.contact_names].map((namesOf) =>
    namesOf(bodies.map(({ kind }) => kind)),
  );

/** What a problem calls the field of a number. */
const keyOf = (path) => (path[0] === "case" ? path.slice(1) : path).join(".");

const problemAt = (key) =>
  make("span", {
    class: "problem",
    id: `problem:${key}`,
    "aria-live": "polite",
  });

/** Builds the form of a design, and changes the design as the form is used. */
class Controls {
  /** `changed(rebuild)` is called after each change of `state`. */
  constructor(form, library, changed) {
    Object.assign(this, {
      form,
      library,
      changed,
      state: null,
      open: new Set(),
      folded: [],
    });
    form.addEventListener("submit", (event) => event.preventDefault());
  }

  build(state) {
    const focused = this.form.contains(document.activeElement)
      ? document.activeElement.id
      : "";
    this.state = state;
    const bodies = listOf(state.case.bodies);
    const blocks = [];
    this.folded = [];
    [this.numbers, this.contacts] = namesIn(bodies);
    bodies.forEach((body, i) => {
      blocks.push(this.body(body, i));
      if (i + 1 < bodies.length) blocks.push(this.contact(i));
    });
    if (listOf(state.gauges).length) blocks.push(this.gauges());
    blocks.push(rowTools(state, this.changed));
    this.form.replaceChildren(...blocks);
    this.tellFolded();
    const again = focused && document.getElementById(focused);
    if (again) again.focus();
  }

  body(body, i) {
    const path = ["case", "bodies", i];
    const name = fronts.name_of(String(body.kind), this.numbers[i]);
    const [block, rest] = [
      make("fieldset"),
      make("div", { id: `rest:bodies.${i}` }),
    ];
    if (body.kind === "mass")
      block.append(this.number([...path, "mass"], FIELDS.mass));
    const pieces = Array.isArray(body.segments)
      ? body.segments.map((_, j) => [...path, "segments", j])
      : body.kind === "rod"
        ? [path]
        : [];
    pieces.forEach((piece, j) => {
      const where = pieces.length > 1 ? ` of segment ${j + 1}` : "";
      block.append(this.number([...piece, "length"], FIELDS.length, where));
      (where ? block : rest).append(
        this.number([...piece, "area"], FIELDS.area, where),
      );
      rest.append(
        ...this.material(piece, where),
        make("p", { class: "derived", "data-body": i, "data-segment": j }),
      );
    });
    (body.kind === "wall" ? rest : block).append(
      this.number([...path, "velocity"], FIELDS.velocity),
    );
    rest.append(bodyTools(this.state, i, name, this.changed));
    return this.fold(block, capital(name), rest, () =>
      aboutBody(getAt(this.state, path)),
    );
  }

  contact(i) {
    const entry = getAt(this.state, ["case", "contacts", i]) || {};
    const path = ["case", "contacts", i];
    const [block, rest] = [
      make("fieldset", { class: "contact" }),
      make(
        "div",
        { id: `rest:contacts.${i}` },
        this.number([...path, "gap"], FIELDS.gap),
      ),
    ];
    const laws = [...new Set([...Object.keys(LAWS), entry.law || "rigid"])];
    block.append(
      this.choice([...path, "law"], "law", laws, entry.law || "rigid", (law) =>
        setAt(this.state, path, { gap: entry.gap || 0, law, ...LAWS[law] }),
      ),
    );
    for (const key of Object.keys(entry).filter(
      (k) => k !== "gap" && k !== "law",
    )) {
      const field =
        FIELDS[key === "stiffness" ? stiffnessField(entry.law) : key];
      if (field) block.append(this.number([...path, key], field));
    }
    return this.fold(block, `Contact ${this.contacts[i]}`, rest, () =>
      entry.gap ? `gap ${toShown(entry.gap, FIELDS.gap.power)} µm` : "gap",
    );
  }

  /** Let a block have a name and a part that is folded away; \`about\` tells what is in that. */
  fold(block, name, rest, about) {
    const { id } = rest;
    const said = make("span");
    const button = make(
      "button",
      { type: "button", class: "fold", "aria-controls": id },
      make("span", { class: "unseen" }, `More of ${name}: `),
      said,
    );
    const show = () => {
      rest.hidden = !this.open.has(id);
      button.setAttribute("aria-expanded", String(!rest.hidden));
    };
    button.addEventListener("click", () => {
      if (!this.open.delete(id)) this.open.add(id);
      show();
    });
    show();
    this.folded.push([said, about]);
    block.prepend(make("legend", {}, name), button);
    block.append(rest);
    return block;
  }

  tellFolded() {
    for (const [said, about] of this.folded) write(said, about());
  }

  gauges() {
    const [block, rest] = [
      make("fieldset", { class: "gauges" }),
      make("div", { id: "rest:gauges" }),
    ];
    const rods = listOf(this.state.case.bodies).flatMap((body, i) =>
      body.kind === "rod" ? [i] : [],
    );
    listOf(this.state.gauges).forEach((gauge, k) => {
      const path = ["gauges", k];
      rest.append(
        this.choice(
          [...path, "body"],
          `gauge ${k + 1} on rod`,
          rods.map((i) => this.numbers[i]),
          this.numbers[gauge.body],
          (number) => {
            gauge.body = this.numbers.indexOf(number);
          },
        ),
        this.number([...path, "fraction"], {
          ...FIELDS.fraction,
          name: `gauge ${k + 1} at`,
        }),
        toolButton(this.changed, "✕", `Remove gauge ${k + 1}`, () =>
          this.state.gauges.splice(k, 1),
        ),
      );
    });
    return this.fold(block, "Strain gauges", rest, () =>
      listOf(this.state.gauges)
        .map(
          ({ body, fraction }) =>
            `rod ${this.numbers[body]} at ${toShown(fraction, -2)} %`,
        )
        .join(", "),
    );
  }

  material(piece, where) {
    const name = getAt(this.state, [...piece, "material"]);
    const own = Object.keys(this.state.case.materials || {});
    const mine = `own ${[this.numbers[piece[2]], ...piece.slice(4).map((j) => j + 1)].join("-")}`;
    const names = [...new Set([...Object.keys(this.library), ...own, mine])];
    const found = [
      this.choice(
        [...piece, "material"],
        `material${where}`,
        names,
        name,
        (chosen) => {
          if (chosen === mine && !own.includes(mine))
            this.copyMaterial(name, mine);
          setAt(this.state, [...piece, "material"], chosen);
        },
      ),
    ];
    if (!own.includes(name)) return found;
    return [
      ...found,
      ...["youngs_modulus", "density"].map((key) =>
        this.number(["case", "materials", name, key], FIELDS[key], where),
      ),
    ];
  }

  copyMaterial(from, name) {
    const materials = (this.state.case.materials ||= {});
    const { youngs_modulus, density } =
      materials[from] || this.library[from] || this.library.steel;
    materials[name] = { youngs_modulus, density };
  }

  choice(path, name, values, chosen, choose) {
    const key = keyOf(path);
    const select = make("select", { id: key, "data-path": key });
    for (const value of values)
      select.append(
        new Option(LAW_NAMES[value] || value, value, false, value === chosen),
      );
    select.addEventListener("change", () => {
      choose(select.value);
      this.changed(true);
    });
    return make(
      "div",
      { class: "field" },
      make("label", { for: key }, name),
      select,
      problemAt(key),
    );
  }

  number(path, field, where = "") {
    const value = getAt(this.state, path);
    const key = keyOf(path);
    if (typeof value === "object" && value !== null) {
      return make(
        "p",
        { class: "derived" },
        `${field.name}: a profile, from the case file`,
      );
    }
    const shown = typeof value === "number" ? toShown(value, field.power) : "";
    const label = make(
      "label",
      { for: key, id: `label:${key}` },
      field.name + where,
    );
    const box = make("input", {
      type: "number",
      id: key,
      step: "any",
      value: shown,
      "data-path": key,
      "data-power": field.power,
      "data-unit": field.unit,
      "aria-describedby": `problem:${key}`,
    });
    const slider = this.slider(field, shown, key);
    const apply = (number) => {
      setAt(
        this.state,
        path,
        Number.isFinite(number) ? fromShown(number, field.power) : null,
      );
      slider.setAttribute("aria-valuetext", `${number} ${field.unit}`);
      this.changed(false);
    };
    box.addEventListener("input", () => {
      const number = field.log
        ? Math.log10(box.valueAsNumber)
        : box.valueAsNumber;
      this.follow(slider, field, number);
      slider.value = number;
      apply(box.valueAsNumber);
    });
    slider.addEventListener("input", () => {
      const number = field.log
        ? Number((10 ** slider.valueAsNumber).toPrecision(3))
        : slider.valueAsNumber;
      box.value = number;
      apply(number);
    });
    slider.addEventListener("change", () =>
      this.follow(slider, field, slider.valueAsNumber),
    );
    return make(
      "div",
      { class: "field" },
      label,
      make(
        "span",
        { class: "box" },
        box,
        make("span", { class: "unit" }, field.unit),
      ),
      slider,
      problemAt(key),
    );
  }

  /** Let the range of a slider grow where its value reaches an end. */
  follow(slider, field, number) {
    if (field.bounded || !Number.isFinite(number)) return;
    const [low, high] = [Number(slider.min), Number(slider.max)];
    const room = field.log ? 1 : (high - low) / 2;
    if (number >= high) slider.max = number + room;
    if (number <= low)
      slider.min =
        field.log || field.low < 0
          ? number - room
          : Math.max(0, Math.min(low, number));
  }

  /** A slider whose range holds the value it begins with. */
  slider(field, shown, key) {
    const value = Number(shown) || 0;
    let [low, high] = [
      Math.min(field.low, value > 0 || !field.log ? value : field.low),
      Math.max(field.high, value),
    ];
    if (field.log) [low, high] = [Math.log10(low), Math.log10(high)];
    const slider = make("input", {
      type: "range",
      min: low,
      max: high,
      step: field.log ? 0.005 : field.step,
      id: `slider:${key}`,
      "aria-labelledby": `label:${key}`,
      "aria-valuetext": `${shown} ${field.unit}`,
      "data-slides": key,
    });
    slider.value = field.log ? Math.log10(value || field.low) : value;
    return slider;
  }

  /** Put what follows from the numbers beside them. */
  showDerived(bodies) {
    this.tellFolded();
    for (const line of this.form.querySelectorAll(".derived[data-body]")) {
      const items =
        getAt(bodies, [line.dataset.body, "derived", line.dataset.segment]) ||
        [];
      while (line.children.length < items.length) line.append(make("span"));
      items.forEach(([name, value], k) =>
        write(line.children[k], `${name} ${minus(value)}`),
      );
    }
  }

  /** Put each problem beside its field; returns those that have none here. */
  showProblems(problems) {
    for (const field of this.form.querySelectorAll("[aria-invalid]"))
      field.removeAttribute("aria-invalid");
    for (const span of this.form.querySelectorAll(".problem"))
      span.textContent = "";
    return problems.filter(({ path, message }) => {
      const parts = path.split(".");
      for (let n = parts.length; n > 0; n -= 1) {
        const key = parts.slice(0, n).join(".");
        const field = document.getElementById(key);
        if (!field || !this.form.contains(field)) continue;
        field.setAttribute("aria-invalid", "true");
        document.getElementById(`problem:${key}`).textContent = inUnit(
          message,
          field.dataset,
        );
        return false;
      }
      return true;
    });
  }
}

/** A message of the model about a number, in the unit of its field. */
function inUnit(message, { unit, power }) {
  const [, said, got] = /^(.*), got (\S+)$/.exec(message) || [];
  if (!Number.isFinite(Number(got)) || unit === undefined) return message;
  return `${said.replace(/ number of .*/, " number")}, got ${minus(`${toShown(Number(got), Number(power))} ${unit}`)}`;
}

/** Rows of names and values; only what has changed is written. */
function fillTable(rows, entries) {
  while (rows.children.length > entries.length) rows.lastElementChild.remove();
  entries.forEach(([name, ...values], i) => {
    const row =
      rows.children[i] ||
      rows.appendChild(make("tr", {}, make("th", { scope: "row" })));
    write(row.children[0], name);
    values.forEach((value, k) => {
      const cell = row.children[k + 1] || row.appendChild(make("td"));
      write(cell, minus(value));
    });
  });
}

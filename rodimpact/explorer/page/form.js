"use strict";
// The form of a design: boxes and sliders, each with the path of its number in the case.
// Begin with `Form.build`.

const DEFAULT_LAW = "rigid";

/** The part of a body that is folded away, in short. */
function summaryOfBody({ kind, segments, area, material }) {
  if (kind === "wall") {
    return "velocity, place";
  }
  if (kind !== "rod") {
    return "place";
  }
  if (segments) {
    return `${segments.length} segments`;
  }
  let areaText = "area";
  if (typeof area === "number") {
    areaText = `${toShown(area, FIELDS.area.power)} mm²`;
  }
  return [areaText, material].join(", ");
}

/** Name of the field at a path, as problems have it. */
function fieldName(path) {
  const inCase = path[0] === "case" ? path.slice(1) : path;
  return inCase.join(".");
}

/** Empty line for the problem of a field. */
const makeProblem = (name) =>
  makeElement("span", {
    class: "problem",
    id: `problem:${name}`,
    "aria-live": "polite",
  });

/** Builds the form of a design, and changes the design as the form is used. */
class Form {
  constructor(element, library) {
    this.element = element;
    this.library = library; // materials
    this.design = null;
    this.unfolded = new Set(); // ids of parts
    this.summaries = []; // element and text, a function, of each folded part
    element.addEventListener("submit", (event) => event.preventDefault());
  }

  /** Make the form anew for a design; the element with the focus keeps it. */
  build(design) {
    const { activeElement } = document;
    const hasFocus = this.element.contains(activeElement);
    const focusedId = hasFocus ? activeElement.id : "";
    this.design = design;
    const bodies = listOf(design.case.bodies);
    this.names = namesOf(bodies);
    this.summaries = [];
    const blocks = [];
    bodies.forEach((body, i) => {
      blocks.push(this.makeBody(body, i));
      if (i + 1 < bodies.length) {
        blocks.push(this.makeContact(i));
      }
    });
    if (listOf(design.gauges).length > 0) {
      blocks.push(this.makeGauges());
    }
    blocks.push(toolsOfRow(design));
    this.element.replaceChildren(...blocks);
    this.updateSummaries();
    if (focusedId) {
      byId(focusedId)?.focus();
    }
  }

  // Blocks --------------------------------------------------------------------------------

  /** Block of body i; rarely changed numbers are folded away. */
  makeBody(body, i) {
    const path = ["case", "bodies", i];
    const name = solver.name_of(String(body.kind), this.names.numbers[i]);
    const block = makeElement("fieldset");
    const folded = makeElement("div", { id: `rest:bodies.${i}` });
    if (body.kind === "mass") {
      block.append(this.makeNumber([...path, "mass"], FIELDS.mass));
    }
    const segments = segmentsWithPaths(body);
    segments.forEach((segment, j) => {
      const segmentPath = [...path, ...segment.path];
      const where = segments.length > 1 ? ` of segment ${j + 1}` : "";
      const lengthPath = [...segmentPath, "length"];
      block.append(this.makeNumber(lengthPath, FIELDS.length, where));
      const areaBlock = segments.length > 1 ? block : folded;
      const areaPath = [...segmentPath, "area"];
      areaBlock.append(this.makeNumber(areaPath, FIELDS.area, where));
      folded.append(
        ...this.makeMaterial(segmentPath, where),
        makeElement("p", {
          class: "derived",
          "data-body": i,
          "data-segment": j,
        }),
      );
    });
    const velocity = this.makeNumber([...path, "velocity"], FIELDS.velocity);
    const velocityBlock = body.kind === "wall" ? folded : block;
    velocityBlock.append(velocity);
    folded.append(toolsOfBody(this.design, i, name));
    const summary = () => summaryOfBody(getAt(this.design, path));
    return this.fold(block, capital(name), folded, summary);
  }

  /** Block of the contact of the bodies i and i + 1. */
  makeContact(i) {
    const path = ["case", "contacts", i];
    const contact = getAt(this.design, path) || {};
    const law = contact.law || DEFAULT_LAW;
    const block = makeElement("fieldset", { class: "contact" });
    const gap = this.makeNumber([...path, "gap"], FIELDS.gap);
    const folded = makeElement("div", { id: `rest:contacts.${i}` }, gap);
    const laws = new Set([...Object.keys(LAWS), law]);
    const choose = (chosen) => {
      const numbers = LAWS[chosen];
      const newContact = { gap: contact.gap || 0, law: chosen, ...numbers };
      setAt(this.design, path, newContact);
    };
    block.append(this.makeChoice([...path, "law"], "law", laws, law, choose));
    for (const key of Object.keys(contact)) {
      const fieldKey = key === "stiffness" ? stiffnessField(law) : key;
      const field = FIELDS[fieldKey];
      if (field && key !== "gap") {
        block.append(this.makeNumber([...path, key], field));
      }
    }
    const summary = () => {
      if (!contact.gap) {
        return "gap";
      }
      return `gap ${toShown(contact.gap, FIELDS.gap.power)} µm`;
    };
    const name = `Contact ${this.names.contacts[i]}`;
    return this.fold(block, name, folded, summary);
  }

  /** Block of all gauges. */
  makeGauges() {
    const { numbers } = this.names;
    const block = makeElement("fieldset", { class: "gauges" });
    const folded = makeElement("div", { id: "rest:gauges" });
    const rods = [];
    listOf(this.design.case.bodies).forEach((body, i) => {
      if (body.kind === "rod") {
        rods.push(numbers[i]);
      }
    });
    const { gauges } = this.design;
    gauges.forEach((gauge, k) => {
      const path = ["gauges", k];
      const name = `gauge ${k + 1}`;
      const choose = (number) => {
        gauge.body = numbers.indexOf(number);
      };
      const rod = numbers[gauge.body];
      const field = { ...FIELDS.fraction, name: `${name} at` };
      const remove = () => gauges.splice(k, 1);
      folded.append(
        this.makeChoice([...path, "body"], `${name} on rod`, rods, rod, choose),
        this.makeNumber([...path, "fraction"], field),
        toolButton("✕", `Remove ${name}`, remove),
      );
    });
    const summaryOfGauge = ({ body, fraction }) => {
      const percentage = toShown(fraction, FIELDS.fraction.power);
      return `rod ${numbers[body]} at ${percentage} %`;
    };
    const summary = () => gauges.map(summaryOfGauge).join(", ");
    return this.fold(block, "Strain gauges", folded, summary);
  }

  /** Give a block its name, and a button that unfolds a part of it. */
  fold(block, name, folded, summary) {
    const { id } = folded;
    const label = makeElement("span");
    const button = makeElement(
      "button",
      { type: "button", class: "fold", "aria-controls": id },
      makeElement("span", { class: "unseen" }, `More of ${name}: `),
      label,
    );
    const show = () => {
      folded.hidden = !this.unfolded.has(id);
      button.setAttribute("aria-expanded", String(!folded.hidden));
    };
    button.addEventListener("click", () => {
      if (!this.unfolded.delete(id)) {
        this.unfolded.add(id);
      }
      show();
    });
    show();
    this.summaries.push([label, summary]);
    block.prepend(makeElement("legend", {}, name), button);
    block.append(folded);
    return block;
  }

  /** Write the short texts of the folded parts anew. */
  updateSummaries() {
    for (const [label, summary] of this.summaries) {
      setText(label, summary());
    }
  }

  // Fields --------------------------------------------------------------------------------

  /** Choice of the material of a segment, and the numbers of one of the case's own. */
  makeMaterial(segmentPath, where) {
    const path = [...segmentPath, "material"];
    const name = getAt(this.design, path);
    const ownNames = Object.keys(this.design.case.materials || {});
    const [, , body, , segment] = segmentPath;
    const numbers = [this.names.numbers[body]];
    if (segment !== undefined) {
      numbers.push(segment + 1);
    }
    const newName = `own ${numbers.join("-")}`;
    const names = new Set([...Object.keys(this.library), ...ownNames, newName]);
    const choose = (chosen) => {
      const isNew = chosen === newName && !ownNames.includes(newName);
      if (isNew) {
        this.copyMaterial(name, newName);
      }
      setAt(this.design, path, chosen);
    };
    const label = `material${where}`;
    const fields = [this.makeChoice(path, label, names, name, choose)];
    if (ownNames.includes(name)) {
      for (const key of ["youngs_modulus", "density"]) {
        const numberPath = ["case", "materials", name, key];
        fields.push(this.makeNumber(numberPath, FIELDS[key], where));
      }
    }
    return fields;
  }

  /** Add a material with the numbers of another one. */
  copyMaterial(from, name) {
    this.design.case.materials ||= {};
    const { materials } = this.design.case;
    const { youngs_modulus, density } =
      materials[from] || this.library[from] || this.library.steel;
    materials[name] = { youngs_modulus, density };
  }

  /** A list of values to choose from; `choose` changes the design to the value chosen. */
  makeChoice(path, label, values, chosen, choose) {
    const name = fieldName(path);
    const select = makeElement("select", { id: name, "data-path": name });
    for (const value of values) {
      const text = LAW_NAMES[value] || value;
      select.append(new Option(text, value, false, value === chosen));
    }
    select.addEventListener("change", () => {
      choose(select.value);
      designChanged(true);
    });
    return makeElement(
      "div",
      { class: "field" },
      makeElement("label", { for: name }, label),
      select,
      makeProblem(name),
    );
  }

  /** Box and slider of a number; a sentence for a profile. */
  makeNumber(path, field, where = "") {
    const value = getAt(this.design, path);
    const name = fieldName(path);
    if (typeof value === "object" && value !== null) {
      const text = `${field.name}: a profile, from the case file`;
      return makeElement("p", { class: "derived" }, text);
    }
    const isNumber = typeof value === "number";
    const number = isNumber ? toShown(value, field.power) : "";
    const box = makeBox(field, number, name);
    const slider = makeSlider(field, number, name);
    const apply = (entered) => {
      const isFinite = Number.isFinite(entered);
      const inSiUnits = isFinite ? fromShown(entered, field.power) : null;
      setAt(this.design, path, inSiUnits);
      slider.setAttribute("aria-valuetext", `${entered} ${field.unit}`);
      designChanged(false);
    };
    box.addEventListener("input", () => {
      const entered = box.valueAsNumber;
      const position = field.isLog ? Math.log10(entered) : entered;
      growRange(slider, field, position);
      slider.value = position;
      apply(entered);
    });
    slider.addEventListener("input", () => {
      let entered = slider.valueAsNumber;
      if (field.isLog) {
        entered = Number((10 ** entered).toPrecision(3));
      }
      box.value = entered;
      apply(entered);
    });
    slider.addEventListener("change", () =>
      growRange(slider, field, slider.valueAsNumber),
    );
    return makeElement(
      "div",
      { class: "field" },
      makeElement(
        "label",
        { for: name, id: `label:${name}` },
        field.name + where,
      ),
      makeElement(
        "span",
        { class: "box" },
        box,
        makeElement("span", { class: "unit" }, field.unit),
      ),
      slider,
      makeProblem(name),
    );
  }

  // Texts beside the fields ---------------------------------------------------------------

  /** Show what follows from the numbers of each segment. */
  showDerived(bodies) {
    this.updateSummaries();
    for (const line of this.element.querySelectorAll(".derived[data-body]")) {
      const { body, segment } = line.dataset;
      const quantities = getAt(bodies, [body, "derived", segment]) || [];
      while (line.children.length < quantities.length) {
        line.append(makeElement("span"));
      }
      quantities.forEach(([name, value], k) =>
        setText(line.children[k], `${name} ${minus(value)}`),
      );
    }
  }

  /** Show each problem beside its field; returns those without a field. */
  showProblems(problems) {
    for (const field of this.element.querySelectorAll("[aria-invalid]")) {
      field.removeAttribute("aria-invalid");
    }
    for (const label of this.element.querySelectorAll(".problem")) {
      label.textContent = "";
    }
    const others = [];
    for (const problem of problems) {
      const field = this.fieldOf(problem.path);
      if (field) {
        field.setAttribute("aria-invalid", "true");
        byId(`problem:${field.id}`).textContent = problemInUnit(
          problem,
          field.dataset,
        );
      } else {
        others.push(problem);
      }
    }
    return others;
  }

  /** The field at a path, or at the longest part of it that has one; null without any. */
  fieldOf(path) {
    const keys = path.split(".");
    for (let count = keys.length; count > 0; count -= 1) {
      const field = byId(keys.slice(0, count).join("."));
      if (field && this.element.contains(field)) {
        return field;
      }
    }
    return null;
  }
}

// Numbers ---------------------------------------------------------------------------------

/** The box of a number, which keeps the unit of its field for the texts of problems. */
const makeBox = ({ power, unit }, number, name) =>
  makeElement("input", {
    type: "number",
    id: name,
    step: "any",
    value: number,
    "data-path": name,
    "data-power": power,
    "data-unit": unit,
    "aria-describedby": `problem:${name}`,
  });

/** A slider whose range includes its first number. */
function makeSlider(field, number, name) {
  const { isLog, unit } = field;
  const value = Number(number) || 0;
  let { low } = field;
  let high = Math.max(field.high, value);
  if (value > 0 || !isLog) {
    low = Math.min(low, value);
  }
  let position = value;
  if (isLog) {
    low = Math.log10(low);
    high = Math.log10(high);
    position = Math.log10(value || field.low);
  }
  const slider = makeElement("input", {
    type: "range",
    min: low,
    max: high,
    step: isLog ? 0.005 : field.step,
    id: `slider:${name}`,
    "aria-labelledby": `label:${name}`,
    "aria-valuetext": `${number} ${unit}`,
    "data-slides": name,
  });
  slider.value = position;
  return slider;
}

/** Let the range of a slider grow where its position reaches an end. */
function growRange(slider, field, position) {
  if (field.isBounded || !Number.isFinite(position)) {
    return;
  }
  const low = Number(slider.min);
  const high = Number(slider.max);
  const growth = field.isLog ? 1 : (high - low) / 2;
  if (position >= high) {
    slider.max = position + growth;
  }
  if (position > low) {
    return;
  }
  const canBeNegative = field.isLog || field.low < 0;
  if (canBeNegative) {
    slider.min = position - growth;
  } else {
    slider.min = clamp(position, 0, low);
  }
}

// Problems --------------------------------------------------------------------------------

/** A problem in words, with a wrong number in SI units. */
function problemInSiUnits({ message, unit, value }) {
  if (typeof value !== "number") {
    return message;
  }
  return `${message}${unit}, got ${plainNumber(value, 6)}`;
}

/** A problem in words, with a wrong number in the unit of its field. */
function problemInUnit(problem, { unit, power }) {
  const { message, value } = problem;
  if (typeof value !== "number" || unit === undefined) {
    return problemInSiUnits(problem);
  }
  const number = toShown(Number(value.toPrecision(6)), Number(power));
  return `${message}, got ${minus(`${number} ${unit}`.trim())}`;
}

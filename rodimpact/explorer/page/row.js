"use strict";
// The row of a design: bodies, steps and gauges come, go and change places. Begin with
// `rearrange` and `toolsOfRow`.

const NEW_SEGMENT = { length: 0.25, area: 1e-4, material: "steel" };
const NEW_BODIES = {
  rod: { kind: "rod", length: 0.5, area: 1e-4, material: "steel", velocity: 0 },
  "stepped rod": {
    kind: "rod",
    segments: [NEW_SEGMENT, { ...NEW_SEGMENT, area: 3e-4 }],
    velocity: 0,
  },
  mass: { kind: "mass", mass: 1, velocity: 0 },
  wall: { kind: "wall", velocity: 0 },
};
// no wave decides a rigid contact of two masses, so that they get a spring
const NEW_SPRING = { gap: 0, law: "spring", ...LAWS.spring };

/** Put bodies in another order: indices of those there are, and tables of new ones. */
function rearrange(design, order) {
  const { bodies } = design.case;
  const contacts = listOf(design.case.contacts);
  const isPermutation = order.length === bodies.length;
  const row = order.map((body) => bodies[body] || body);
  const newContacts = [];
  for (let i = 0; i + 1 < row.length; i += 1) {
    const areNeighbours = order[i + 1] - order[i] === 1; // and were before
    let contact = null;
    if (isPermutation) {
      contact = contacts[i];
    } else if (areNeighbours) {
      contact = contacts[order[i]];
    }
    newContacts.push(contactBetween(row[i], row[i + 1], contact));
  }
  design.case.contacts = newContacts;
  design.case.bodies = row;
  const gauges = [];
  for (const gauge of listOf(design.gauges)) {
    if (order.includes(gauge.body)) {
      gauges.push({ ...gauge, body: order.indexOf(gauge.body) });
    }
  }
  design.gauges = gauges;
}

/** The contact that two bodies had, or a new one where this cannot be. */
function contactBetween(left, right, contact) {
  const hasRod = left.kind === "rod" || right.kind === "rod";
  if (contact && (hasRod || contact.law !== "rigid")) {
    return contact;
  }
  return hasRod ? { gap: 0, law: "rigid" } : { ...NEW_SPRING };
}

/** Indices of the bodies as they are now, for `rearrange`. */
const orderOf = (design) => listOf(design.case.bodies).map((_, i) => i);

/** Add a body at the right end; walls stay outermost. */
function addBody(design, kind) {
  const order = orderOf(design);
  const last = design.case.bodies.at(-1);
  const endsWithWall = last && last.kind === "wall";
  let position = order.length;
  if (endsWithWall) {
    position = kind === "wall" ? 0 : order.length - 1;
  }
  order.splice(position, 0, structuredClone(NEW_BODIES[kind]));
  rearrange(design, order);
}

/** Remove body i. */
function removeBody(design, i) {
  const order = orderOf(design).filter((k) => k !== i);
  rearrange(design, order);
}

/** Let bodies i and j change places. */
function swapBodies(design, i, j) {
  const order = orderOf(design);
  order[i] = j;
  order[j] = i;
  rearrange(design, order);
}

/** Give a rod one more segment, twice as thick as its last one. */
function addStep(body) {
  if (!body.segments) {
    const { length, area, material } = body;
    body.segments = [{ length, area, material }];
    for (const key of ["length", "area", "material"]) {
      delete body[key];
    }
  }
  const last = body.segments.at(-1);
  const hasNumber = typeof last.area === "number";
  const area = hasNumber ? 2 * last.area : NEW_SEGMENT.area;
  body.segments.push({ ...last, area });
}

/** Remove the last segment of a rod. */
function removeStep(body) {
  body.segments.pop();
  if (body.segments.length > 1) {
    return;
  }
  Object.assign(body, body.segments[0]);
  delete body.segments;
}

/** Add a gauge in the middle of the last rod. */
function addGauge(design, rods) {
  const gauges = listOf(design.gauges);
  design.gauges = [...gauges, { body: rods.at(-1), fraction: 0.5 }];
}

// Buttons ---------------------------------------------------------------------------------

/** A button that changes the design. */
function toolButton(text, name, change, isPossible = true) {
  const attributes = { type: "button", "aria-label": name, title: name };
  const button = makeElement("button", attributes, text);
  button.disabled = !isPossible;
  button.addEventListener("click", () => {
    change();
    designChanged(true);
  });
  return button;
}

/** Buttons that move, remove or step a body. */
function toolsOfBody(design, i, name) {
  const { bodies } = design.case;
  const body = bodies[i];
  const buttons = [];
  if (body.kind === "rod") {
    const hasSteps = listOf(body.segments).length > 1;
    buttons.push(
      toolButton("+ step", `+ step of ${name}`, () => addStep(body)),
      toolButton(
        "− step",
        `− step of ${name}`,
        () => removeStep(body),
        hasSteps,
      ),
    );
  }
  const moveLeft = () => swapBodies(design, i, i - 1);
  const moveRight = () => swapBodies(design, i, i + 1);
  const remove = () => removeBody(design, i);
  const count = bodies.length;
  buttons.push(
    toolButton("◀", `Move ${name} to the left`, moveLeft, i > 0),
    toolButton("▶", `Move ${name} to the right`, moveRight, i + 1 < count),
    toolButton("✕", `Remove ${name}`, remove, count > 1),
  );
  return makeElement("div", { class: "tools-body" }, ...buttons);
}

/** Buttons that add a body or a gauge. */
function toolsOfRow(design) {
  const kinds = makeElement("select", {
    id: "add-kind",
    "aria-label": "Kind of the new body",
  });
  for (const kind of Object.keys(NEW_BODIES)) {
    kinds.append(new Option(kind, kind));
  }
  const rods = orderOf(design).filter(
    (i) => design.case.bodies[i].kind === "rod",
  );
  const add = () => addBody(design, kinds.value);
  const addOneGauge = () => addGauge(design, rods);
  return makeElement(
    "div",
    { class: "tools-body" },
    kinds,
    toolButton("Add", "Add body", add),
    toolButton("Add gauge", "Add gauge", addOneGauge, rods.length > 0),
  );
}

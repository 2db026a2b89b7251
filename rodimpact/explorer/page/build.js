"use strict";
// Building a collision: bodies, steps and gauges come, go and change places; rods are dragged.

const NEW = {
  rod: { kind: "rod", length: 0.5, area: 1e-4, material: "steel", velocity: 0 },
  "stepped rod": {
    kind: "rod",
    segments: [1e-4, 3e-4].map((area) => ({
      length: 0.25,
      area,
      material: "steel",
    })),
    velocity: 0,
  },
  mass: { kind: "mass", mass: 1, velocity: 0 },
  wall: { kind: "wall", velocity: 0 },
};
const SPRING = { law: "spring", ...LAWS.spring }; // between bodies in which no wave decides the contact
const CLOSE = 10; // px, to take hold of an end or a gauge
const UNDONE = 100; // states that are kept
const PAUSE = 800; // ms, after which a change of a number is another one

// The row ----------------------------------------------------------------------------------------

/** Put bodies in another order: numbers of those there are, and tables of new ones. */
function rearrange(state, order) {
  const { bodies, contacts } = state.case;
  const known = listOf(contacts);
  const same = order.length === bodies.length;
  const row = order.map((body) => bodies[body] || body);
  state.case.contacts = order.slice(1).map((body, i) => {
    const old = known[same ? i : body - order[i] === 1 ? order[i] : -1];
    const waves = row[i].kind === "rod" || row[i + 1].kind === "rod";
    return old && (waves || old.law !== "rigid")
      ? old
      : { gap: 0, ...(waves ? { law: "rigid" } : SPRING) };
  });
  state.case.bodies = row;
  state.gauges = listOf(state.gauges).flatMap((gauge) =>
    order.includes(gauge.body)
      ? [{ ...gauge, body: order.indexOf(gauge.body) }]
      : [],
  );
}

const orderOf = (state) => listOf(state.case.bodies).map((_, i) => i);

/** Add a body at the right end, but walls stay outermost. */
function addBody(state, kind) {
  const order = orderOf(state);
  const walled = (state.case.bodies.at(-1) || {}).kind === "wall";
  const at = !walled ? order.length : kind === "wall" ? 0 : order.length - 1;
  order.splice(at, 0, structuredClone(NEW[kind]));
  rearrange(state, order);
}

function swap(state, i, j) {
  const order = orderOf(state);
  [order[i], order[j]] = [j, i];
  rearrange(state, order);
}

/** Give a rod one segment more, twice as wide; or one less. */
function addStep(body) {
  const { length, area, material } = body;
  if (!body.segments) {
    body.segments = [{ length, area, material }];
    for (const key of ["length", "area", "material"]) delete body[key];
  }
  const last = body.segments.at(-1);
  body.segments.push({
    ...last,
    area: typeof last.area === "number" ? 2 * last.area : 1e-4,
  });
}

function removeStep(body) {
  body.segments.pop();
  if (body.segments.length > 1) return;
  Object.assign(body, body.segments[0]);
  delete body.segments;
}

/** A button that changes what the form describes; `changed` is told. */
function toolButton(changed, text, name, change, possible = true) {
  const button = make(
    "button",
    { type: "button", "aria-label": name, title: name },
    text,
  );
  button.disabled = !possible;
  button.addEventListener("click", () => {
    change();
    changed(true);
  });
  return button;
}

function bodyTools(state, i, name, changed) {
  const { bodies } = state.case;
  const button = toolButton.bind(null, changed);
  const steps =
    bodies[i].kind !== "rod"
      ? []
      : [
          button("+ step", `+ step of ${name}`, () => addStep(bodies[i])),
          button(
            "− step",
            `− step of ${name}`,
            () => removeStep(bodies[i]),
            listOf(bodies[i].segments).length > 1,
          ),
        ];
  return make(
    "div",
    { class: "tools-body" },
    ...steps,
    button("◀", `Move ${name} to the left`, () => swap(state, i, i - 1), i > 0),
    button(
      "▶",
      `Move ${name} to the right`,
      () => swap(state, i, i + 1),
      i + 1 < bodies.length,
    ),
    button(
      "✕",
      `Remove ${name}`,
      () =>
        rearrange(
          state,
          orderOf(state).filter((k) => k !== i),
        ),
      bodies.length > 1,
    ),
  );
}

function rowTools(state, changed) {
  const kinds = make("select", {
    id: "add-kind",
    "aria-label": "Kind of the new body",
  });
  kinds.append(...Object.keys(NEW).map((kind) => new Option(kind, kind)));
  const rods = orderOf(state).filter(
    (i) => state.case.bodies[i].kind === "rod",
  );
  const addGauge = () => {
    state.gauges = [
      ...listOf(state.gauges),
      { body: rods.at(-1), fraction: 0.5 },
    ];
  };
  return make(
    "div",
    { class: "tools-body" },
    kinds,
    toolButton(changed, "Add", "Add body", () => addBody(state, kinds.value)),
    toolButton(changed, "Add gauge", "Add gauge", addGauge, rods.length > 0),
  );
}

// Undo -------------------------------------------------------------------------------------------

class History {
  constructor(button, restore) {
    Object.assign(this, { states: [], now: null, last: -Infinity, button });
    button.addEventListener("click", () => restore(this.back()));
    addEventListener("keydown", (event) => {
      if (
        !(event.ctrlKey || event.metaKey) ||
        event.key !== "z" ||
        event.target.isContentEditable ||
        !this.states.length
      )
        return;
      event.preventDefault();
      restore(this.back());
    });
  }

  /** Keep a state; numbers that change without a pause are one change. */
  keep(state, whole) {
    const text = JSON.stringify(state);
    const moment = performance.now();
    if (
      this.now !== null &&
      text !== this.now &&
      (whole || moment - this.last > PAUSE)
    )
      this.states.push(this.now);
    this.states.splice(0, this.states.length - UNDONE);
    Object.assign(this, { now: text, last: whole ? -Infinity : moment });
    this.button.disabled = this.states.length === 0;
  }

  /** The next change of a number is another one. */
  begin() {
    this.last = -Infinity;
  }

  back() {
    this.now = null;
    return JSON.parse(this.states.pop());
  }
}

// Dragging ---------------------------------------------------------------------------------------

/** What is under a point of the strip: a gauge, an end of a rod, or a rod. */
function holdAt(x, y) {
  const { frame, ends, gauges, arrows } = shown.strip;
  const arrow = arrows.find(
    ({ tip, y: at }) => Math.hypot(tip - x, at - y) < 1.5 * CLOSE,
  );
  if (arrow) return { body: arrow.body, arrow: true, side: 1 };
  const near = (place) => Math.abs(frame.across(place) - x) < CLOSE;
  const gauge = gauges.findIndex(
    ([gx, gy]) => Math.hypot(gx - x, gy - y) < 1.5 * CLOSE,
  );
  if (gauge >= 0) return { gauge, body: shown.scene.gauges[gauge].body };
  const inside = (reach) =>
    [...ends.keys()]
      .sort((a, b) => a - b)
      .find(
        (i) =>
          x >= frame.across(ends.get(i)[0]) - reach &&
          x <= frame.across(ends.get(i)[1]) + reach,
      );
  const body = inside(0) ?? inside(CLOSE);
  if (body === undefined || shown.scene.bodies[body].kind === "wall")
    return null;
  const side =
    shown.scene.bodies[body].kind !== "rod"
      ? 0
      : near(ends.get(body)[1])
        ? 1
        : near(ends.get(body)[0])
          ? -1
          : 0;
  return { body, side };
}

/** Write a number into its box, as if it were typed. */
function enter(path, number) {
  const box = byId(path);
  if (!box) return;
  box.value = number;
  box.dispatchEvent(new Event("input"));
}

function connectDragging(changed) {
  const strip = byId("rods");
  let held = null;
  strip.addEventListener("pointerdown", (event) => {
    held = shown.strip && holdAt(event.offsetX, event.offsetY);
    if (!held) return;
    strip.setPointerCapture(event.pointerId);
    past.begin();
    const path = draggedPath(held.body, held.arrow, held.side);
    Object.assign(held, {
      x: event.offsetX,
      path,
      from: byId(path) && byId(path).valueAsNumber,
    });
    shown.held = true;
  });
  strip.addEventListener("pointermove", (event) => {
    if (!shown.strip) return;
    const { frame, ends } = shown.strip;
    if (!held) {
      const found = holdAt(event.offsetX, event.offsetY);
      strip.style.cursor = !found
        ? ""
        : found.side || found.gauge >= 0
          ? "ew-resize"
          : "grab";
      return;
    }
    const place = frame.placeAt(event.offsetX);
    if (held.gauge >= 0) {
      const [low, high] = ends.get(held.body);
      enter(
        `gauges.${held.gauge}.fraction`,
        Math.round(
          100 * Math.max(0, Math.min(1, (place - low) / (high - low))),
        ),
      );
    } else if (held.arrow) {
      enter(
        held.path,
        Number((held.from + (event.offsetX - held.x) / shown.arrow).toFixed(1)),
      );
    } else if (held.side) {
      enter(
        held.path,
        Math.max(
          1,
          Math.round(
            held.from + 1000 * held.side * (place - frame.placeAt(held.x)),
          ),
        ),
      );
    } else if (held.scene !== shown.scene) {
      // not before the last change is seen
      const next =
        held.body +
        Math.sign(
          place - (ends.get(held.body)[0] + ends.get(held.body)[1]) / 2,
        );
      const beyond =
        ends.has(next) &&
        shown.scene.bodies[next].kind !== "wall" &&
        (place - (ends.get(next)[0] + ends.get(next)[1]) / 2) *
          (next - held.body) >
          0;
      if (!beyond) return;
      swap(design, held.body, next);
      held.body = next;
      held.scene = shown.scene;
      changed(true);
    }
  });
  for (const end of ["pointerup", "pointercancel"]) {
    strip.addEventListener(end, () => {
      if (held) {
        shown.held = false;
        zoomAll();
      }
      held = null;
    });
  }
}

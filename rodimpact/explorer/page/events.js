"use strict";
// Events of a collision, one sentence for each. Begin with `eventsOf`.

const SAME_TIME_RTOL = 1e-6; // part of the film; events with a smaller distance are one
const MAX_EVENTS = 24; // events up to which those at free ends are listed
const MAX_RESTING_NAMES = 2; // more bodies at rest are not named one by one

/** A text with a capital letter. */
const capital = (text) => text[0].toUpperCase() + text.slice(1);

/** All events of a scene in order, each with its time `t` and `text`. */
function eventsOf(scene) {
  const all = [{ t: scene.begin, text: beginningText(scene) }];
  for (const contact of scene.contacts) {
    all.push(...eventsOfContact(scene, contact));
  }
  const atEnds = scene.exact ? eventsAtEnds(scene) : [];
  if (all.length + atEnds.length <= MAX_EVENTS) {
    all.push(...atEnds);
  }
  all.push({ t: scene.end, text: endText(scene) });
  all.sort((a, b) => a.t - b.t);
  const events = [];
  for (const { t, text } of all) {
    const last = events.at(-1);
    if (last && t - last.t < SAME_TIME_RTOL * scene.end) {
      last.text += ` ${text}`;
    } else {
      events.push({ t, text });
    }
  }
  return events;
}

/** Index of the last event up to time t. */
const eventIndexAt = ({ events, end }, t) =>
  events.findLastIndex((event) => event.t <= t + SAME_TIME_RTOL * end);

// Sentences -------------------------------------------------------------------------------

/** Sentence on the velocities with which bodies come. */
function beginningText({ bodies }) {
  const moving = bodies.filter(({ approach }) => approach !== 0);
  const restingCount = bodies.length - moving.length;
  if (restingCount <= MAX_RESTING_NAMES) {
    return `${capital(bodies.map(approachText).join(", "))}.`;
  }
  const texts = moving.map(approachText);
  texts.push(
    moving.length > 0 ? "all others are at rest" : "all bodies are at rest",
  );
  return `${capital(texts.join(", "))}.`;
}

/** Words on the velocity with which a body comes. */
function approachText({ approach, name }) {
  if (approach === null) {
    return `${name} is in motion already`;
  }
  if (approach === 0) {
    return `${name} is at rest`;
  }
  return `${name} moves at ${quantity(approach, "m/s")}`;
}

/** Sentence on the velocities at the end; "" if only walls are there. */
function endText({ velocities }) {
  if (velocities.length === 0) {
    return "";
  }
  const texts = velocities.map(
    ({ name, text }) => `${name} has ${minus(text)}`,
  );
  return `In the end ${texts.join(", ")} on average.`;
}

/** Sentences on a contact that presses, touches or opens. */
function eventsOfContact(scene, contact) {
  if (contact.bonded) {
    return [];
  }
  const { index, spells } = contact;
  const bodies = scene.bodies.slice(index, index + 2);
  const events = [];
  spells.forEach((spell, k) => {
    let before = spell.state;
    if (k > 0) {
      before = spells[k - 1].state;
    } else if (spell.state === "pressing") {
      before = "touching";
    }
    if (spell.state === before) {
      return;
    }
    if (spell.state === "pressing") {
      events.push(...eventsOfPress(scene, contact, spell, before, bodies));
    } else {
      const text = releaseText(scene, bodies, before, spell.state);
      events.push({ t: spell.from, text });
    }
  });
  return events;
}

/** Names of two bodies. */
const pairText = ([left, right]) => `${left.name} and ${right.name}`;

/** Begin of a force; its peak, too, if the force is smooth. */
function eventsOfPress({ exact }, { force }, { from, to }, before, bodies) {
  const pair = pairText(bodies);
  const verb = before === "open" ? "meet" : "begin to press";
  const begin = `${capital(pair)} ${verb}`;
  if (exact) {
    const start = valueAt(force, from + SAME_TIME_RTOL * (to - from));
    const hasWall = bodies.some(({ kind }) => kind === "wall");
    const rods = hasWall ? "the rod" : "each";
    const text = `${begin} with a force of ${quantity(start, "N", 3)}: a wave of compression runs into ${rods}.`;
    return [{ t: from, text }];
  }
  let peak = 0; // point of the curve
  force.y.forEach((value, k) => {
    const isInside = force.t[k] >= from && force.t[k] <= to;
    if (isInside && value > force.y[peak]) {
      peak = k;
    }
  });
  const peakText = quantity(force.y[peak], "N", 3);
  return [
    { t: from, text: `${begin}; the contact force grows from zero.` },
    {
      t: force.t[peak],
      text: `The force between ${pair} reaches its peak: ${peakText}.`,
    },
  ];
}

/** Sentence on the end of a force, or of a touch without force. */
function releaseText({ exact, contacts }, bodies, before, state) {
  const pair = pairText(bodies);
  if (before === "touching") {
    return `The gap opens: ${pair} part.`;
  }
  const after =
    state === "open" ? "they part" : "they still touch, without force";
  const end = `force between ${pair} ends; ${after}.`;
  if (!exact) {
    return `The ${end}`;
  }
  const wave = contacts.length > 1 ? "A wave arrives" : "The wave is back";
  return `${wave} at the contact: the ${end}`;
}

/** Waves that arrive at the free ends of the row. */
function eventsAtEnds(scene) {
  const { bodies, lengths } = scene;
  return [
    ...eventsAtEnd(scene, 0, 0, "left"),
    ...eventsAtEnd(scene, bodies.length - 1, lengths.at(-1), "right"),
  ];
}

/** Waves that turn back at the end x of a body: changes of the velocity there. */
function eventsAtEnd(scene, body, x, side) {
  if (scene.bodies[body].kind !== "rod") {
    return [];
  }
  const { name } = scene.bodies[body];
  const states = statesAtEnd(scene, body, x);
  const events = [];
  for (let k = 1; k < states.length; k += 1) {
    const { t, velocity } = states[k];
    const isStart = t < SAME_TIME_RTOL * scene.end;
    if (isStart || velocity === states[k - 1].velocity) {
      continue;
    }
    let after = "stops";
    if (velocity) {
      after = `moves at ${quantity(velocity, "m/s", 3)}`;
    }
    const text = `A wave reaches the ${side} end of ${name} and turns back; the end ${after}.`;
    events.push({ t, text });
  }
  return events;
}

/** Velocities of an end of a rod, each from a time `t` on. */
function statesAtEnd({ tiling, lengths }, body, x) {
  const states = [];
  tiling.body.forEach((owner, polygon) => {
    if (owner !== body) {
      return;
    }
    const times = [];
    const end = tiling.start[polygon + 1];
    for (let k = tiling.start[polygon]; k < end; k += 1) {
      if (Math.abs(tiling.x[k] - x) < SAME_PLACE_RTOL * lengths[body]) {
        times.push(tiling.t[k]);
      }
    }
    if (times.length > 1) {
      const velocity = tiling.velocity[polygon];
      states.push({ t: Math.min(...times), velocity });
    }
  });
  return states.sort((a, b) => a.t - b.t);
}

// On the page -----------------------------------------------------------------------------

/** Time and sentence of an event. */
const eventText = ({ t, text }) => unbroken(`${quantity(t, "s")}: ${text}`);

/** Show the event at time t; a screen reader hears its sentence when it changes. */
function showEvent(scene, t) {
  const event = scene.events[Math.max(0, eventIndexAt(scene, t))];
  if (setText(byId("sentence"), eventText(event))) {
    markEvent(scene, t);
  }
}

/** Mark the event at time t in the list of all. */
function markEvent(scene, t) {
  const index = eventIndexAt(scene, t);
  byId("events")
    .querySelectorAll("button")
    .forEach((button, k) => {
      button.setAttribute("aria-current", String(k === index));
    });
}

/** List all events, where the list is open. */
function listEvents() {
  const { scene } = page;
  if (!byId("all-events").open || !scene) {
    return;
  }
  const texts = scene.events.map(eventText);
  const isNew = replaceTexts(byId("events"), texts, (text, k) => {
    const button = makeElement("button", { type: "button" }, text);
    button.addEventListener("click", () => goTo(page.scene.events[k].t));
    return makeElement("li", {}, button);
  });
  if (isNew) {
    markEvent(scene, currentTime());
  }
}

/** Go to the next event, or to the one before. */
function stepToEvent(direction) {
  const { events, end } = page.scene;
  const t = currentTime();
  let index = eventIndexAt(page.scene, t);
  const here = events[Math.max(0, index)];
  const isAtEvent = Math.abs(here.t - t) <= SAME_TIME_RTOL * end;
  if (direction > 0 || isAtEvent) {
    index += direction;
  }
  goTo(events[clamp(index, 0, events.length - 1)].t);
}

/** Let the buttons go from event to event. */
function connectEvents() {
  byId("all-events").addEventListener("toggle", listEvents);
  byId("event-before").addEventListener("click", () => stepToEvent(-1));
  byId("event-after").addEventListener("click", () => stepToEvent(1));
}

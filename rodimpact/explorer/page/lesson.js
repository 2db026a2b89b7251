"use strict";
// What happens, one sentence for each event; and a guess of e before it is shown.

const SAME = 1e-6; // of the film: events that are one
const MOST_EVENTS = 24; // with those at free ends
const MANY = 3; // bodies at rest that are named together

const capital = (text) => text[0].toUpperCase() + text.slice(1);

/** All events of a scene in order: { t, text }. */
function eventsOf(scene) {
  const found = [
    { t: scene.begin, text: beginning(scene) },
    ...scene.contacts.flatMap((c) => contactEvents(scene, c)),
  ];
  const ends = scene.exact ? endEvents(scene) : [];
  if (found.length + ends.length <= MOST_EVENTS) found.push(...ends);
  found.push({ t: scene.end, text: ending(scene) });
  found.sort((a, b) => a.t - b.t);
  const events = [];
  for (const { t, text } of found) {
    const last = events.at(-1);
    if (last && t - last.t < SAME * scene.end) last.text += ` ${text}`;
    else events.push({ t, text });
  }
  return events;
}

function beginning({ bodies }) {
  const resting = bodies.filter(({ approach }) => approach === 0);
  const named =
    resting.length < MANY
      ? bodies
      : bodies.filter((body) => !resting.includes(body));
  const moves = named.map(({ approach, name }) =>
    approach === null
      ? `${name} is in motion already`
      : approach === 0
        ? `${name} is at rest`
        : `${name} moves at ${quantity(approach, "m/s")}`,
  );
  if (named !== bodies)
    moves.push(
      named.length ? "all others are at rest" : "all bodies are at rest",
    );
  return `${capital(moves.join(", "))}.`;
}

/** The numbers of the set-up in one line, for paper: bodies and contacts from left to right. */
function givenOf({ bodies, contacts }) {
  const [numbers, names] = namesIn(bodies);
  const told = (key, value) =>
    typeof value === "number"
      ? `${toShown(value, FIELDS[key].power)} ${FIELDS[key].unit}`
      : `${FIELDS[key].name}: a profile`;
  const ofRod = ({ length, area, material }) =>
    `${told("length", length)} long, ${told("area", area)}, ${material}`;
  return bodies
    .flatMap((body, i) => {
      const pieces = body.kind === "rod" ? body.segments || [body] : [];
      const parts = pieces.map(ofRod);
      if (body.kind === "mass") parts.push(told("mass", body.mass));
      parts.push(told("velocity", body.velocity || 0));
      const name = fronts.name_of(body.kind, numbers[i]);
      const { law = "rigid", gap = 0, stiffness } = listOf(contacts)[i] || {};
      const between = [LAW_NAMES[law] || law];
      if (stiffness !== undefined)
        between.push(told(stiffnessField(law), stiffness));
      if (gap) between.push(`gap ${told("gap", gap)}`);
      const found = [`${capital(name)}: ${parts.join("; ")}.`];
      if (i + 1 < bodies.length)
        found.push(`Contact\u00a0${names[i]}: ${between.join(", ")}.`);
      return found;
    })
    .join(" ");
}

function ending(scene) {
  const leave = scene.results.flatMap(([name, value]) => {
    const [, body] = /^velocity of (\w+ \d+)/.exec(name) || [];
    return body ? [`${body} has ${minus(value)}`] : [];
  });
  return leave.length ? `In the end ${leave.join(", ")} on average.` : "";
}

/** What happens at a contact: it presses, it touches, it opens. */
function contactEvents(scene, contact) {
  if (contact.bonded) return [];
  const { index, spells, force } = contact;
  const pair = `${scene.bodies[index].name} and ${scene.bodies[index + 1].name}`;
  return spells.flatMap(({ from, to, state }, k) => {
    const before = k
      ? spells[k - 1].state
      : state === "pressing"
        ? "touching"
        : state;
    if (state === before) return [];
    if (state !== "pressing")
      return [{ t: from, text: released(scene, pair, before, state) }];
    const first = quantity(valueAt(force, from + SAME * (to - from)), "N", 3);
    const begin = before === "open" ? "meet" : "begin to press";
    if (scene.exact)
      return [
        {
          t: from,
          text: `${capital(pair)} ${begin}, with ${first}: a wave of compression runs into ${pair.includes("wall") ? "the rod" : "each"}.`,
        },
      ];
    const peak = force.y.reduce(
      (best, y, i) =>
        force.t[i] >= from && force.t[i] <= to && y > force.y[best] ? i : best,
      0,
    );
    return [
      {
        t: from,
        text: `${capital(pair)} ${begin}; the contact force grows from zero.`,
      },
      {
        t: force.t[peak],
        text: `The force between ${pair} reaches its peak: ${quantity(force.y[peak], "N", 3)}.`,
      },
    ];
  });
}

function released(scene, pair, before, state) {
  if (before === "touching") return `The gap opens: ${pair} part.`;
  const end = `force between ${pair} ends; ${state === "open" ? "they part" : "they still touch, without force"}.`;
  if (!scene.exact) return `The ${end}`;
  return `${scene.contacts.length > 1 ? "A wave arrives" : "The wave is back"} at the contact: the ${end}`;
}

/** Waves that arrive at the two ends of the row, where nothing holds back. */
function endEvents(scene) {
  const { tiling, bodies, lengths } = scene;
  const sides = [
    [0, 0],
    [bodies.length - 1, lengths.at(-1)],
  ].filter(([body]) => bodies[body].kind === "rod");
  return sides.flatMap(([end, place]) => {
    const spans = [];
    tiling.body.forEach((body, i) => {
      if (body !== end) return;
      const at = [];
      for (let k = tiling.start[i]; k < tiling.start[i + 1]; k += 1) {
        if (Math.abs(tiling.x[k] - place) < SAME * lengths[body])
          at.push(tiling.t[k]);
      }
      if (at.length > 1)
        spans.push({ t: Math.min(...at), velocity: tiling.velocity[i] });
    });
    spans.sort((a, b) => a.t - b.t);
    const side = place === 0 ? "left" : "right";
    return spans.slice(1).flatMap(({ t, velocity }, k) =>
      t < SAME * scene.end || velocity === spans[k].velocity
        ? []
        : [
            {
              t,
              text: `A wave reaches the ${side} end of ${scene.bodies[end].name} and turns back; the end ${velocity ? `now moves with ${quantity(velocity, "m/s", 3)}` : "stands still"}.`,
            },
          ],
    );
  });
}

/** Number of the last event that has happened. */
const eventAt = (scene, t) =>
  scene.events.findLastIndex((event) => event.t <= t + SAME * scene.end);

/** Show the sentence of the moment; a screen reader hears it when it changes. */
function showLesson(scene, t) {
  const { t: at, text } = scene.events[Math.max(0, eventAt(scene, t))];
  if (write(byId("sentence"), unbroken(`${quantity(at, "s")}: ${text}`)))
    markEvent(scene, t);
}

function markEvent(scene, t) {
  byId("events")
    .querySelectorAll("button")
    .forEach((button, k) =>
      button.setAttribute("aria-current", String(k === eventAt(scene, t))),
    );
}

/** List all events, where the list is open. */
function listEvents() {
  const { scene } = shown;
  if (!byId("all-events").open || !scene) return;
  const texts = scene.events.map(({ t, text }) =>
    unbroken(`${quantity(t, "s")}: ${text}`),
  );
  if (byId("events").dataset.shown === texts.join()) return;
  byId("events").dataset.shown = texts.join();
  byId("events").replaceChildren(
    ...scene.events.map(({ t }, k) => {
      const button = make("button", { type: "button" }, texts[k]);
      button.addEventListener("click", () => goTo(t));
      return make("li", {}, button);
    }),
  );
  markEvent(scene, now());
}

function goTo(t) {
  play(false);
  setShare(shareOfTime(t));
}

/** Go on to the next event, or back. */
function step(by) {
  const { events } = shown.scene;
  const at = eventAt(shown.scene, now());
  const here =
    Math.abs(events[Math.max(0, at)].t - now()) <= SAME * shown.scene.end;
  goTo(
    events[
      Math.max(0, Math.min(events.length - 1, at + (by < 0 && !here ? 0 : by)))
    ].t,
  );
}

// Guessing ---------------------------------------------------------------------------------------

/** Hide e and all that tells it, or show it. */
function hideResult(on) {
  if (shown.guessing === on) return;
  shown.guessing = on;
  document.documentElement.toggleAttribute("data-guess", on);
  byId("guess").hidden = !on;
  byId("guess-first").setAttribute("aria-pressed", String(on));
  byId("verdict").textContent = "";
  if (!on) return;
  play(false);
  zoomAll();
  setShare(0);
  askOrJudge(shown.scene);
  byId("guessed").value = "";
  byId("guessed").focus();
}

/** Let the question tell of the collision that is shown, and a verdict go with the e it judged. */
function askOrJudge(scene) {
  const question =
    "How fast do they part, as a share of the speed at which they meet?";
  if (shown.guessing) write(byId("asked"), `${beginning(scene)} ${question}`);
  else if (shown.judged !== scene.restitution.text) write(byId("verdict"), "");
}

/** Compare the guess with e, and let the film run; the reason is shown again. */
function reveal() {
  const guess = byId("guessed").valueAsNumber;
  const { value, text } = shown.scene.restitution;
  if (!Number.isFinite(guess)) return;
  hideResult(false);
  const off = Math.abs(guess - value);
  shown.judged = text;
  byId("verdict").textContent =
    `You said ${guess}; e is ${minus(text)}: ${off < 0.005 ? "right!" : `off by ${plainNumber(off, 2)}.`}`;
  byId("play").focus(); // the field of the guess is gone
  play(true);
}

function connectLesson() {
  byId("all-events").addEventListener("toggle", listEvents);
  byId("event-before").addEventListener("click", () => step(-1));
  byId("event-after").addEventListener("click", () => step(1));
  byId("guess-first").addEventListener("click", () =>
    hideResult(!shown.guessing),
  );
  byId("guess").addEventListener("submit", (event) => {
    event.preventDefault();
    reveal();
  });
}

"use strict";
// Numbers and sentences of a collision: e, the table, the reason and the notes. Begin
// with `showResults`.

const CLOSED_FORM_ATOL = 1e-12; // an e that is nearer to its closed form agrees with it

/** Write all numbers and sentences of a scene; without an e, its velocities in its place. */
function showResults(scene) {
  const { restitution } = scene;
  const hasE = restitution.value !== null;
  byId("restitution").replaceChildren(minus(restitution.number));
  if (restitution.error !== "") {
    const error = makeElement("small", {}, ` ± ${minus(restitution.error)}`);
    byId("restitution").append(error);
  }
  document.querySelector(".restitution").hidden = !hasE;
  byId("meaning").hidden = !hasE;
  byId("guess-first").hidden = !hasE;
  byId("after").hidden = hasE;
  setText(byId("after"), hasE ? "" : velocitiesText(scene));
  const now = hasE ? `Now: e = ${minus(restitution.text)}` : "Now";
  setText(byId("now-text"), unbroken(now));
  if (!hasE) {
    setGuessing(false);
  }
  updateGuess(scene);
  setText(byId("given"), unbroken(setupText(design.case)));
  byId("theory").textContent = theoryText(restitution);
  fillTable(byId("results"), scene.results);
  byId("by-contact").hidden = scene.by_contact.length === 0;
  fillTable(byId("by-contact").tBodies[0], scene.by_contact);
  setText(byId("reason"), minus(unbroken(scene.reason.join(" "))));
  replaceTexts(byId("notes"), notesOf(scene).map(unbroken), (text) =>
    makeElement("p", {}, text),
  );
}

/** The velocities after the collision, short; "" for a run that ends before. */
function velocitiesText({ final, velocities }) {
  if (!final) {
    return "";
  }
  const texts = velocities.map(
    ({ number, value }) => `v${subscript(number)}\u00a0=\u00a0${minus(value)}`,
  );
  return `${texts.join(", ")}\u00a0m/s`;
}

/** Why there is no e, or its closed form. */
function theoryText({ why, closed_form: closedForm }) {
  const sentences = [];
  if (why) {
    sentences.push(unbroken(why));
  }
  if (closedForm) {
    const number = plainNumber(closedForm.restitution, 6);
    sentences.push(`Closed form (${closedForm.source}): ${number}`);
  }
  return sentences.join(" ");
}

/** Sentences for an engineer: how the run ended, the method, and the accuracy of e. */
function notesOf({ notes, method, restitution, curve, roundness }) {
  const sentences = [...notes, `The method is "${method}".`];
  const { closed_form: closedForm, value: e } = restitution;
  if (e !== null && closedForm) {
    const error = Math.abs(e - closedForm.restitution);
    let agreement = `e differs from its closed form by ${plainNumber(error, 1)}.`;
    if (error < CLOSED_FORM_ATOL) {
      agreement = "e agrees with its closed form to 12 digits.";
    }
    sentences.push(agreement);
  }
  if (curve) {
    sentences.push(`The curve of e over l₁/l₂ is ${curve.source}.`);
  }
  if (roundness) {
    sentences.push(`The curve of e over κ is ${roundness.source}.`);
  }
  return sentences;
}

// The set-up, for paper -------------------------------------------------------------------

/** Numbers of the bodies and contacts, from left to right. */
function setupText({ bodies, contacts }) {
  const names = namesOf(bodies);
  const sentences = [];
  bodies.forEach((body, i) => {
    const name = capital(solver.name_of(body.kind, names.numbers[i]));
    sentences.push(`${name}: ${bodyText(body)}.`);
    if (i + 1 < bodies.length) {
      const contact = listOf(contacts)[i] || {};
      const numbers = contactText(contact);
      sentences.push(`Contact\u00a0${names.contacts[i]}: ${numbers}.`);
    }
  });
  return sentences.join(" ");
}

/** A number of a design with its unit. */
function fieldText(key, value) {
  const { name, unit, power } = FIELDS[key];
  if (typeof value !== "number") {
    return `${name}: a profile`;
  }
  return `${toShown(value, power)} ${unit}`;
}

/** Numbers of a body in words. */
function bodyText(body) {
  const texts = segmentsWithPaths(body).map(({ segment }) => {
    const { length, area, material } = segment;
    const lengthText = fieldText("length", length);
    return `${lengthText} long, ${fieldText("area", area)}, ${material}`;
  });
  if (body.kind === "mass") {
    texts.push(fieldText("mass", body.mass));
  }
  texts.push(fieldText("velocity", body.velocity || 0));
  return texts.join("; ");
}

/** Law and numbers of a contact in words. */
function contactText({ law = "rigid", gap = 0, stiffness }) {
  const texts = [LAW_NAMES[law] || law];
  if (stiffness !== undefined) {
    texts.push(fieldText(stiffnessField(law), stiffness));
  }
  if (gap) {
    texts.push(`gap ${fieldText("gap", gap)}`);
  }
  return texts.join(", ");
}

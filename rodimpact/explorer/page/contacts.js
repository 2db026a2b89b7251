"use strict";
// What a contact does over time: it is open, it touches, or it presses.

const SMALL = 1e-6; // of the peak force or largest gap: none

const largestOf = (values) => values.reduce((most, v) => Math.max(most, Math.abs(v)), 0);

/** Spells of one state each: { from, to, state }. */
function spellsOf({ force, gap }) {
  const times = [...new Set([...force.t, ...(gap ? gap.t : [])])].sort((a, b) => a - b);
  const [weak, narrow] = [SMALL * largestOf(force.y), gap ? SMALL * largestOf(gap.y) : 0];
  const spells = [];
  for (let k = 1; k < times.length; k += 1) {
    const middle = (times[k - 1] + times[k]) / 2;
    const state = Math.abs(valueAt(force, middle)) > weak ? "pressing"
      : gap && valueAt(gap, middle) > narrow ? "open" : "touching";
    const last = spells.at(-1);
    if (last && last.state === state) last.to = times[k];
    else spells.push({ from: times[k - 1], to: times[k], state });
  }
  return spells;
}

/** Say where faces touch without force after they have pressed: the gap opens later. */
function touching(scene) {
  return scene.contacts.flatMap(({ spells, bonded, force }) => {
    const [waits, last] = spells.slice(-2);
    if (bonded || spells.length < 2 || waits.state !== "touching" || last.state !== "open") return [];
    return [`${capital(force.name)}: the force ends at ${quantity(waits.from, "s")}; the faces touch `
      + `without force until the gap opens at ${quantity(waits.to, "s")}.`];
  });
}

function stateAt(contact, t) {
  const spell = contact.spells.find(({ to }) => t < to) || contact.spells.at(-1);
  return spell ? spell.state : "touching";
}

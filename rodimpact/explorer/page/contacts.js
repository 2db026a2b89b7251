"use strict";
// What a contact does over time: it is open, it touches, or it presses.

const largestOf = (values) => values.reduce((most, v) => Math.max(most, Math.abs(v)), 0);

function stateAt(contact, t) {
  const spell = contact.spells.find(({ to }) => t < to) || contact.spells.at(-1);
  return spell ? spell.state : "touching";
}

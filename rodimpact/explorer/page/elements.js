"use strict";
// Elements of the page: find, make and fill them. Only a text that differs is written,
// since the browser lays out the page again after each change.

const byId = (id) => document.getElementById(id);

/** Set the text of an element; return whether it has changed. */
function setText(element, text) {
  const differs = element.textContent !== text;
  if (differs) {
    element.textContent = text;
  }
  return differs;
}

/** A new element with attributes and children, elements or texts. */
function makeElement(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

/** Fill a table with rows of a name and values. */
function fillTable(table, entries) {
  while (table.children.length > entries.length) {
    table.lastElementChild.remove();
  }
  entries.forEach(([name, ...values], i) => {
    let row = table.children[i];
    if (!row) {
      row = makeElement("tr", {}, makeElement("th", { scope: "row" }));
      table.append(row);
    }
    setText(row.children[0], name);
    values.forEach((value, k) => {
      let cell = row.children[k + 1];
      if (!cell) {
        cell = makeElement("td");
        row.append(cell);
      }
      setText(cell, minus(value));
    });
  });
}

/**
 * Replace the children of an element, if their texts differ from those it has.
 *
 * Each child is made by `makeChild(text, k)`. Returns whether they were replaced.
 */
function replaceTexts(element, texts, makeChild) {
  const joined = texts.join();
  if (element.dataset.texts === joined) {
    return false;
  }
  element.dataset.texts = joined;
  element.replaceChildren(...texts.map(makeChild));
  return true;
}

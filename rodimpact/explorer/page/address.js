"use strict";
// The state of the page in its address: every number under its path,
// #case.bodies.0.length=0.4&view.quantity=stress. Begin with `readAddress`.

const ADDRESS_DELAY = 300; // ms without a change before the address is written
let addressTimer = 0;

// Trees as texts --------------------------------------------------------------------------

/** A path as text: its keys with dots between them, none within. */
const pathText = (path) =>
  path.map((key) => encodeURIComponent(key).replace(/\./g, "%2E")).join(".");

/** A value from its text: JSON, or else the text itself. */
function readValue(text) {
  try {
    return JSON.parse(text);
  } catch {
    return text;
  }
}

/** A value as text: a string has quotes only where it would be read as something else. */
function valueText(value) {
  if (typeof value === "string" && readValue(value) === value) {
    return value;
  }
  return JSON.stringify(value);
}

/** Items "path=value" of a tree of tables and lists. */
function itemsOf(tree, path = []) {
  if (typeof tree !== "object" || tree === null) {
    const text = encodeURIComponent(valueText(tree)).replace(/%20/g, "+");
    return [`${pathText(path)}=${text}`];
  }
  return Object.entries(tree).flatMap(([key, value]) =>
    itemsOf(value, [...path, key]),
  );
}

/** The tree of an address; throws URIError if the address cannot be read. */
function treeOf(address) {
  const tree = Object.create(null);
  for (const item of address.split("&")) {
    const [path, text = ""] = item.split(/=(.*)/s);
    const keys = path.split(".").map(decodeURIComponent);
    const lastKey = keys.pop();
    let table = tree;
    for (const key of keys) {
      if (typeof table[key] !== "object" || table[key] === null) {
        table[key] = Object.create(null);
      }
      table = table[key];
    }
    table[lastKey] = readValue(decodeURIComponent(text.replace(/\+/g, " ")));
  }
  return withLists(tree);
}

/** A tree whose tables with the keys 0, 1, 2, ... are lists. */
function withLists(tree) {
  if (typeof tree !== "object" || tree === null || Array.isArray(tree)) {
    return tree;
  }
  const keys = Object.keys(tree);
  for (const key of keys) {
    tree[key] = withLists(tree[key]);
  }
  const isList = keys.length > 0 && keys.every((key, i) => key === String(i));
  return isList ? keys.map((key) => tree[key]) : tree;
}

// State -----------------------------------------------------------------------------------

/** The design and the view as an address, without the #. */
function addressOfState() {
  const view = {
    quantity: page.quantity,
    time: Number(page.fraction.toFixed(3)),
  };
  if (!page.isDisplaced) {
    view.displaced = false;
  }
  const question = byId("question").textContent.trim();
  if (question) {
    view.question = question;
  }
  return itemsOf({ ...design, view }).join("&");
}

/** Write the state into the address when nothing has changed for a while. */
function keepAddress() {
  if (location.protocol === "about:") {
    return;
  } // a frame of a notebook has no address
  clearTimeout(addressTimer);
  addressTimer = setTimeout(() => {
    history.replaceState(null, "", `#${addressOfState()}`);
  }, ADDRESS_DELAY);
}

/** Take the state that the address holds; returns its design, or null. */
function readAddress() {
  let tree = {};
  try {
    tree = treeOf(location.hash.slice(1));
  } catch {
    const message = "The address of this page cannot be read.";
    showProblems([{ path: "", message }]);
  }
  const view = tree.view || {};
  if (view.time >= 0 && view.time <= 1) {
    page.fraction = view.time;
  }
  if (view.quantity) {
    setQuantity(view.quantity);
  }
  page.isDisplaced = view.displaced !== false;
  byId("displaced").checked = page.isDisplaced;
  const hasQuestion = view.question !== undefined;
  byId("question").textContent = hasQuestion ? String(view.question) : "";
  byId("asking").hidden = !byId("question").textContent;
  if (!tree.case || typeof tree.case !== "object") {
    return null;
  }
  return { case: tree.case, gauges: listOf(tree.gauges) };
}

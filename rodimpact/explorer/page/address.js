"use strict";
// The state in the address of the page: every number under its path,
// #case.bodies.0.length=0.4&view.quantity=stress

const pathText = (path) =>
  path.map((key) => encodeURIComponent(key).replace(/\./g, "%2E")).join(".");

function readValue(text) {
  try {
    return JSON.parse(text);
  } catch {
    return text;
  }
}

/** A value as text: a string with its marks where it would be read as another. */
const valueText = (value) =>
  readValue(value) === value && typeof value === "string"
    ? value
    : JSON.stringify(value);

function addressOf(tree, path = []) {
  if (typeof tree !== "object" || tree === null) {
    return [
      `${pathText(path)}=${encodeURIComponent(valueText(tree)).replace(/%20/g, "+")}`,
    ];
  }
  return Object.entries(tree).flatMap(([key, value]) =>
    addressOf(value, [...path, key]),
  );
}

/** The tree whose address this is; throws URIError for what is none. */
function treeOf(address) {
  const root = Object.create(null);
  for (const item of address.split("&")) {
    const [path, text = ""] = item.split(/=(.*)/s);
    const keys = path.split(".").map(decodeURIComponent);
    let place = root;
    for (const key of keys.slice(0, -1)) {
      if (typeof place[key] !== "object" || place[key] === null)
        place[key] = Object.create(null);
      place = place[key];
    }
    place[keys[keys.length - 1]] = readValue(
      decodeURIComponent(text.replace(/\+/g, " ")),
    );
  }
  return withLists(root);
}

/** Objects whose keys are 0, 1, 2, ... become lists. */
function withLists(tree) {
  if (typeof tree !== "object" || tree === null || Array.isArray(tree))
    return tree;
  const keys = Object.keys(tree);
  for (const key of keys) tree[key] = withLists(tree[key]);
  return keys.length && keys.every((key, i) => key === String(i))
    ? keys.map((key) => tree[key])
    : tree;
}

"use strict";
// Questions to the server, and the state in the address of the page.

async function ask(address, question) {
  const own = answerHere(address, question);
  if (own) return own;
  const answer = await fetch(address, {
    method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(question),
  });
  const data = await answer.json();
  return answer.ok ? { data } : { problems: data.problems };
}

const AT_ONCE = 2; // questions: while one is answered, the last answer is drawn

/** Few questions at a time; of those that come meanwhile the latest is asked next. */
class Line {
  constructor(address, receive) {
    Object.assign(this, { address, receive, waiting: null, busy: 0, oldest: 0, sent: 0 });
  }

  /** Ask; with `afresh` no answer to an earlier question is taken any more. */
  async ask(question, afresh = false) {
    this.waiting = question;
    if (afresh) this.oldest = this.sent + 1;
    if (this.busy >= AT_ONCE) return;
    this.busy += 1;
    while (this.waiting !== null) {
      const next = this.waiting;
      this.waiting = null;
      this.sent += 1;
      const number = this.sent;
      let answer;
      try {
        answer = await ask(this.address, next);
      } catch {
        answer = { problems: [{ path: "", message: "No answer: is rodimpact explore still running?" }] };
      }
      if (number < this.oldest) continue;
      this.oldest = number;
      this.receive(answer);
    }
    this.busy -= 1;
  }
}

// The address holds every number under its path: #case.bodies.0.length=0.4&view.quantity=stress

const pathText = (path) => path.map((key) => encodeURIComponent(key).replace(/\./g, "%2E")).join(".");

function valueText(value) {
  if (typeof value !== "string") return JSON.stringify(value);
  try {
    JSON.parse(value);
    return JSON.stringify(value); // text that would be read as a number
  } catch {
    return value;
  }
}

function addressOf(tree, path = []) {
  if (typeof tree !== "object" || tree === null) {
    return [`${pathText(path)}=${encodeURIComponent(valueText(tree)).replace(/%20/g, "+")}`];
  }
  return Object.entries(tree).flatMap(([key, value]) => addressOf(value, [...path, key]));
}

function readValue(text) {
  try {
    return JSON.parse(text);
  } catch {
    return text;
  }
}

/** The tree whose address this is; throws URIError for what is none. */
function treeOf(address) {
  const root = Object.create(null);
  for (const item of address.split("&")) {
    const [path, text = ""] = item.split(/=(.*)/s);
    const keys = path.split(".").map(decodeURIComponent);
    let place = root;
    for (const key of keys.slice(0, -1)) {
      if (typeof place[key] !== "object" || place[key] === null) place[key] = Object.create(null);
      place = place[key];
    }
    place[keys[keys.length - 1]] = readValue(decodeURIComponent(text.replace(/\+/g, " ")));
  }
  return withLists(root);
}

/** Objects whose keys are 0, 1, 2, ... become lists. */
function withLists(tree) {
  if (typeof tree !== "object" || tree === null || Array.isArray(tree)) return tree;
  const keys = Object.keys(tree);
  for (const key of keys) tree[key] = withLists(tree[key]);
  return keys.length && keys.every((key, i) => key === String(i)) ? keys.map((key) => tree[key]) : tree;
}

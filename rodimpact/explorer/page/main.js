"use strict";
// The page: what is shown, what moves it, and when it is drawn.

const byId = (id) => document.getElementById(id);
const start = JSON.parse(byId("embedded").textContent);

const shown = {
  scene: null,
  other: null,
  view: null,
  share: 0,
  playing: false,
  mark: null,
  quantity: "velocity",
  displaced: true,
  zoomed: false,
  held: false,
  fresh: true,
  guessing: false,
  frame: null,
  strip: null,
  theme: null,
  due: false,
  asked: false,
  frames: 0,
};
let [design, arrived, past, controls, keeping] = []; // not there yet

// Drawing ----------------------------------------------------------------------------------------

function readTheme() {
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  shown.theme = {
    size: shown.printing
      ? 12
      : Math.round(Math.min(17, parseFloat(style.fontSize) * 0.87)),
    series: [0, 1, 2, 3, 4].map((k) => colour(`series-${k}`)),
    name: document.documentElement.dataset.theme,
    stops: STOPS[document.documentElement.dataset.theme],
  };
  for (const name of ["paper", "ink", "faint", "line", "wrong"])
    shown.theme[name] = colour(name);
  for (const name of ["ink", "paper"])
    shown.theme[`${name}s`] = shown.theme[name]
      .match(/\w\w/g)
      .map((pair) => parseInt(pair, 16));
  if (shown.scene) showLegend();
}

function now() {
  const { begin, end } = filmSpan();
  return Math.min(end, begin + shown.share * (end - begin));
}

/** Draw in the next frame; solve before, if that is asked: once, however often a slider moves. */
function redraw() {
  if (shown.due) return;
  shown.due = true;
  requestAnimationFrame(() => {
    try {
      if (shown.asked) receive(sceneOf(design, shown.draft));
      if (shown.scene) draw();
    } finally {
      shown.due = false;
    }
  });
}

/** Ask for the scene of the design as it is now; what is under way for the one before ends. */
function askScene(draft = false) {
  clearTimeout(resting);
  curveTurn += 1;
  stopMap();
  Object.assign(shown, { asked: true, draft });
  redraw();
}

function draw() {
  const { scene, theme } = shown;
  const moment = shown.printing ? scene.begin : now(); // paper has the set-up
  const t = Math.max(scene.begin, Math.min(scene.end, moment));
  shown.frame = drawDiagram(
    new CanvasPen(byId("diagram")),
    scene,
    shown,
    t,
    shown.mark,
    theme,
  );
  shown.strip = drawRods(new CanvasPen(byId("rods")), scene, shown, t, theme);
  placeHandles(shown.strip);
  drawBeside(now(), theme);
  drawPlots(byId("plots"), scene, t, theme);
  byId("time").value = 1000 * shown.share;
  byId("time").setAttribute("aria-valuetext", quantity(now(), "s"));
  byId("now").value = quantity(now(), "s");
  showReading();
  showLesson(scene, t);
  shown.frames += 1;
  document.documentElement.dataset.frames = shown.frames;
}

/** Name the values that occur, from the least to the largest, beside their colours. */
function showLegend() {
  const { scene, theme, quantity: name } = shown;
  const reach = scene.reach[name];
  const [least, most] = scene.range[name].map((value) =>
    Math.abs(value) < FAINT * reach ? 0 : value,
  );
  const said = (value) =>
    `${value > 0 ? "+" : ""}${quantity(value, UNITS[name], 3)}`;
  const compressed = name === "stress" && least < 0 ? ", compressed" : "";
  write(byId("least"), least < most ? said(least) + compressed : "");
  write(byId("most"), said(most));
  const colours = Array.from({ length: 9 }, (_, k) =>
    css(colourOf((least + ((most - least) * k) / 8) / (reach || 1), theme)),
  );
  byId("colours").style.background =
    `linear-gradient(to right, ${colours.join(",")})`;
}

/** A sentence as the page has it: with µ, and without what only Python can be asked for. */
const plainly = (text) =>
  unbroken(
    text
      .replace(/ us\b/g, " µs")
      .replace(/[.;] [^.;]*(max_events|until=)[^.]*\./g, "."),
  );

/** What an engineer asks: how the run ended, the method, how close e is to its closed form, points of curves. */
function notesOf({ notes, method, restitution, curve, roundness }) {
  const { closed_form: known, value: e } = restitution;
  const found = [...notes, `The method is "${method}".`];
  if (e !== null && known) {
    const apart = Math.abs(e - known.restitution);
    found.push(
      apart < 1e-12
        ? "e agrees with its closed form to 12 digits."
        : `e differs from its closed form by ${plainNumber(apart, 1)}.`,
    );
  }
  if (curve) found.push(`The curve of e over l₁/l₂ is ${curve.source}.`);
  if (roundness) found.push(`The curve of e over κ is ${roundness.source}.`);
  return found.map(plainly);
}

/** The velocities in the end, short. */
function afterwards({ results }) {
  const found = results.flatMap(([name, value]) => {
    const [, number] = /^velocity of \w+ (\d+) after/.exec(name) || [];
    return number ? [[`v${lowered(number)}`, ...minus(value).split(/\s/)]] : [];
  });
  const same = found.every(([, , unit]) => unit === found[0][2]);
  return found
    .map(([name, number, unit], k) =>
      [name, "=", number, ...(same && k + 1 < found.length ? [] : [unit])].join(
        "\u00a0",
      ),
    )
    .join(", ");
}

function showNumbers(scene) {
  const { restitution: e } = scene;
  const [said, error] = minus(e.text).split(" ± ");
  byId("restitution").replaceChildren(
    said,
    ...(error ? [make("small", {}, ` ± ${error}`)] : []),
  );
  document.querySelector(".restitution").hidden = e.value === null;
  byId("guess-first").hidden = e.value === null;
  byId("after").hidden = e.value !== null;
  write(byId("after"), e.value !== null ? "" : afterwards(scene));
  write(
    byId("now-text"),
    unbroken(e.value === null ? "Now" : `Now: e = ${minus(e.text)}`),
  );
  if (e.value === null) hideResult(false);
  askOrJudge(scene);
  write(byId("given"), unbroken(givenOf(design.case)));
  const { closed_form: known } = e;
  const beside = known
    ? `Closed form (${known.source}): ${plainNumber(known.restitution, 6)}`
    : "";
  byId("theory").textContent = (e.why ? `${plainly(e.why)}. ` : "") + beside;
  fillTable(byId("results"), scene.results);
  byId("by-contact").hidden = scene.by_contact.length === 0;
  fillTable(byId("by-contact").tBodies[0], scene.by_contact);
  write(byId("reason"), minus(plainly(scene.reason.join(" "))));
  const notes = notesOf(scene);
  if (byId("notes").dataset.shown !== notes.join()) {
    byId("notes").dataset.shown = notes.join();
    byId("notes").replaceChildren(...notes.map((text) => make("p", {}, text)));
  }
}

/** Take a new scene. */
function show(scene) {
  shown.scene = prepare(scene);
  shareReach();
  if (!shown.zoomed && !shown.held) shown.view = wholeView(shown.scene);
  shown.scene.events = eventsOf(shown.scene);
  showNumbers(scene);
  showLegend();
  listEvents();
  namePaces();
  redraw();
}

// State ------------------------------------------------------------------------------------------

function stateAddress() {
  const view = {
    quantity: shown.quantity,
    time: Number(shown.share.toFixed(3)),
  };
  if (!shown.displaced) view.displaced = false;
  const question = byId("question").textContent.trim();
  if (question) view.question = question;
  return addressOf(design ? { ...design, view } : { view }).join("&");
}

function keepAddress() {
  if (location.protocol === "about:") return; // a frame of a notebook has no address
  clearTimeout(keeping);
  keeping = setTimeout(
    () => history.replaceState(null, "", `#${stateAddress()}`),
    300,
  );
}

function setQuantity(name) {
  shown.quantity = name in UNITS ? name : "velocity";
  document.querySelector(
    `input[name="quantity"][value="${shown.quantity}"]`,
  ).checked = true;
  if (shown.scene) showLegend();
  redraw();
}

/** Take the state that the address holds, if it holds one. */
function readAddress() {
  let tree = {};
  try {
    tree = treeOf(location.hash.slice(1));
  } catch {
    showProblems([
      { path: "", message: "The address of this page cannot be read." },
    ]);
  }
  const view = tree.view || {};
  if (view.time >= 0 && view.time <= 1) shown.share = view.time;
  if (view.quantity) setQuantity(view.quantity);
  shown.displaced = byId("displaced").checked = view.displaced !== false;
  byId("question").textContent =
    view.question === undefined ? "" : String(view.question);
  byId("asking").hidden = !byId("question").textContent;
  return tree.case && typeof tree.case === "object"
    ? { case: tree.case, gauges: listOf(tree.gauges) }
    : null;
}

function showProblems(problems) {
  const others = controls ? controls.showProblems(problems) : problems;
  byId("message").hidden = others.length === 0;
  byId("message").replaceChildren(
    ...others.map(({ path, message }) =>
      make("p", {}, path ? `${path}: ${message}` : message),
    ),
  );
}

function receive({ data, problems = [] }) {
  shown.asked = false;
  document.documentElement.removeAttribute("data-solving");
  showProblems(problems);
  document.documentElement.toggleAttribute("data-stale", !data);
  if (!data) return;
  show(data);
  if (arrived) arrived();
  arrived = null;
  controls.showDerived(data.bodies);
  showMap();
  tellFrame();
}

/** Tell the frame around the page, such as a notebook, the case file of what is shown; "" of the first design. */
function tellFrame() {
  if (parent === window) return;
  const first = JSON.stringify(design) === JSON.stringify(start.design);
  const rodimpact = first ? "" : tomlOf(design, start.materials);
  parent.postMessage({ rodimpact }, "*");
}

function changed(rebuild) {
  past.keep(design, rebuild);
  if (rebuild) controls.build(design);
  showPreset();
  askScene(!rebuild);
  keepAddress();
}

/** Begin with another design; `then` is called when its scene is there. */
function begin(next, then = null) {
  arrived = then;
  design = structuredClone(next);
  Object.assign(shown, { mark: null, zoomed: false, fresh: true });
  changed(true);
}

/** Name the collision, if it is one of those to begin with. */
function showPreset() {
  const text = JSON.stringify(design);
  const same = start.presets.find(
    (preset) => JSON.stringify(preset.design) === text,
  );
  byId("preset").value = same ? same.key : "";
  byId("remark").textContent = unbroken(same ? same.remark : "");
}

function offerPresets() {
  byId("preset").append(new Option("your own", ""));
  for (const { key, title } of start.presets)
    byId("preset").append(new Option(title, key));
  byId("preset").addEventListener("change", () => {
    const chosen = start.presets.find(
      ({ key }) => key === byId("preset").value,
    );
    if (chosen) begin(chosen.design);
  });
}

// Files ------------------------------------------------------------------------------------------

function download(name, kind, text) {
  const link = make("a", {
    href: URL.createObjectURL(new Blob([text], { type: kind })),
    download: name,
  });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

function saveSvg() {
  const pen = new SvgPen(900, 640);
  const { scene, theme } = shown;
  const frame = drawDiagram(pen, scene, shown, null, null, theme);
  const said = ["least", "most"].map((id) => byId(id).textContent);
  const colours = `colours: ${shown.quantity}, ${said.filter(Boolean).join(" to ")}; blue below 0, yellow above`;
  pen.text(frame.x, frame.bottom + 2.3 * theme.size, colours, {
    size: 0.8 * theme.size,
    colour: theme.faint,
    baseline: "top",
  });
  download(
    "rodimpact.svg",
    "image/svg+xml",
    pen.document(beginning(scene), theme.paper),
  );
}

// Beginning --------------------------------------------------------------------------------------

function setTheme(name) {
  document.documentElement.dataset.theme = name;
  byId("theme").setAttribute("aria-pressed", String(name === "dark"));
  readTheme();
  redraw();
}

function connect() {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  setTheme(dark.matches ? "dark" : "light");
  dark.addEventListener("change", () =>
    setTheme(dark.matches ? "dark" : "light"),
  );
  byId("theme").addEventListener("click", () =>
    setTheme(
      document.documentElement.dataset.theme === "dark" ? "light" : "dark",
    ),
  );
  byId("displaced").addEventListener("change", () => {
    shown.displaced = byId("displaced").checked;
    zoomAll();
    keepAddress();
  });
  byId("quantity").addEventListener("change", ({ target }) => {
    setQuantity(target.value);
    keepAddress();
  });
  byId("save-svg").addEventListener("click", saveSvg);
  byId("save-case").addEventListener("click", () =>
    download("case.toml", "application/toml", tomlOf(design, start.materials)),
  );
  byId("question").addEventListener("input", keepAddress);
  byId("ask").addEventListener("click", () => {
    byId("asking").hidden = false;
    byId("question").focus();
  });
  const menu = byId("menu");
  addEventListener("click", ({ target }) => {
    if (!menu.contains(target) || target.closest("button")) menu.open = false;
  });
  addEventListener("keydown", ({ key }) => {
    if (key === "Escape") menu.open = false;
  });
  connectDiagram();
  connectMap();
  connectRoundness();
  connectFilm();
  connectLesson();
  new ResizeObserver(() => {
    readTheme();
    redraw();
  }).observe(document.body);
  new ResizeObserver(([{ target }]) =>
    document.documentElement.style.setProperty(
      "--pinned",
      `${target.offsetHeight}px`,
    ),
  ).observe(byId("outcome"));
  matchMedia("print").addEventListener("change", ({ matches }) => {
    shown.printing = matches;
    if (matches) shown.screen = document.documentElement.dataset.theme;
    setTheme(matches ? "light" : shown.screen);
    if (shown.scene) draw();
  });
}

function beginPage() {
  controls = new Controls(byId("controls"), start.materials, changed);
  past = new History(byId("undo"), begin);
  offerPresets();
  connectTour();
  connectDragging(changed);
  byId("compare").addEventListener("click", () => keepBeside(!shown.other));
  begin(readAddress() || start.design);
  addEventListener("hashchange", () => begin(readAddress() || start.design));
}

connect();
beginPage();

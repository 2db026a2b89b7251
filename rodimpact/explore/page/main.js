"use strict";
// The page: what is shown, what moves it, and when it is drawn.

const byId = (id) => document.getElementById(id);
const embedded = byId("embedded") ? JSON.parse(byId("embedded").textContent) : null;

const MOST_ZOOM = 10000;
const shown = {
  scene: null, view: null, share: 0.35, playing: false, mark: null, quantity: "velocity", frame: null,
  theme: null, due: false, frames: 0,
};
let design = null;
let start = null;
let controls = null;
let scenes = null;
let curves = null;
let timers = { address: 0, curve: 0 };

// Drawing ----------------------------------------------------------------------------------------

function readTheme() {
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  shown.theme = {
    size: Math.round(Math.min(17, parseFloat(style.fontSize) * 0.87)),
    series: [0, 1, 2, 3, 4].map((k) => colour(`series-${k}`)),
  };
  for (const name of ["paper", "ink", "faint", "line", "wrong"]) shown.theme[name] = colour(name);
}

function now() {
  return shown.share * shown.scene.end;
}

function redraw() {
  if (shown.due || !shown.scene) return;
  shown.due = true;
  requestAnimationFrame(() => {
    shown.due = false;
    draw();
  });
}

function draw() {
  const { scene, view, quantity: name, theme } = shown;
  const t = now();
  shown.frame = drawDiagram(new CanvasPen(byId("diagram")), scene, view, name, t, shown.mark, theme);
  drawRods(new CanvasPen(byId("rods")), scene, view, name, t, theme);
  drawPlots(byId("plots"), scene, t, theme);
  byId("time").value = 1000 * shown.share;
  byId("time").setAttribute("aria-valuetext", quantity(t, "s"));
  byId("now").value = quantity(t, "s");
  showReading();
  shown.frames += 1;
  document.documentElement.dataset.frames = shown.frames;
}

/** What is under the reading mark, in words. */
function showReading() {
  const { scene, mark, frame } = shown;
  let text = "Point at the diagram to read velocity, stress, place and time.";
  if (mark) {
    const found = pick(scene, mark.place, mark.t, frame);
    text = `t = ${quantity(mark.t, "s")}: `;
    if (found) {
      const { velocity, stress } = scene.tiling;
      text += `${scene.bodies[found.body].title}, x = ${quantity(found.x, "m")} from its left end: `
        + `velocity ${quantity(velocity[found.polygon], "m/s")}, stress ${quantity(stress[found.polygon], "Pa")}`;
    } else {
      text += "no rod here";
    }
  }
  if (byId("readout").textContent !== text) byId("readout").textContent = text;
}

function showLegend() {
  const unit = UNITS[shown.quantity];
  const reach = shown.scene.reach[shown.quantity];
  byId("least").textContent = quantity(-reach, unit, 3);
  byId("most").textContent = `+${quantity(reach, unit, 3)}`;
}

function showNumbers(scene) {
  const { restitution: e } = scene;
  byId("restitution").value = e.text;
  const beside = e.closed_form === null ? "" : `Closed form (${e.source}): ${e.closed_text}`;
  const off = e.difference === undefined ? "" : `; difference ${e.difference}`;
  byId("theory").textContent = (e.why ? `${e.why}. ` : "") + beside + off;
  fillTable(byId("results"), scene.results);
  const notes = scene.notes.join("\n");
  if (byId("notes").dataset.shown !== notes) {
    byId("notes").dataset.shown = notes;
    byId("notes").replaceChildren(...scene.notes.map((text) => make("p", {}, text)));
  }
}

/** Take a new scene. */
function show(scene) {
  shown.scene = prepare(scene);
  if (!shown.zoomed) shown.view = wholeView(scene);
  showNumbers(scene);
  showLegend();
  redraw();
}

// Time -------------------------------------------------------------------------------------------

function play(on) {
  shown.playing = on;
  byId("play").textContent = on ? "Pause" : "Play";
  byId("play").setAttribute("aria-pressed", String(on));
  if (!on) return;
  if (shown.share >= 1) shown.share = 0;
  let last = performance.now();
  const advance = (moment) => {
    if (!shown.playing || !shown.scene) return;
    shown.share = Math.min(1, shown.share + Math.max(0, moment - last) / 1000 / Number(byId("pace").value));
    last = moment;
    draw();
    if (shown.share >= 1) play(false);
    else requestAnimationFrame(advance);
  };
  requestAnimationFrame(advance);
}

// Zoom and reading -------------------------------------------------------------------------------

/** Magnify about a place and a time. */
function zoom(factor, place, t) {
  const { view } = shown;
  const whole = wholeView(shown.scene);
  const scale = Math.min(factor, (view.right - view.left) / (whole.right - whole.left) * MOST_ZOOM);
  shown.view = {
    left: place + (view.left - place) / scale, right: place + (view.right - place) / scale,
    from: t + (view.from - t) / scale, to: t + (view.to - t) / scale,
  };
  keepInside(whole);
  redraw();
}

/** No view is wider than the whole, or beside it. */
function keepInside(whole) {
  const { view } = shown;
  for (const [low, high] of [["left", "right"], ["from", "to"]]) {
    const width = Math.min(view[high] - view[low], whole[high] - whole[low]);
    view[low] = Math.max(whole[low], Math.min(view[low], whole[high] - width));
    view[high] = view[low] + width;
  }
  shown.zoomed = view.right - view.left < 0.999 * (whole.right - whole.left);
}

function zoomAtMiddle(factor) {
  const { view, mark } = shown;
  zoom(factor, mark ? mark.place : (view.left + view.right) / 2, mark ? mark.t : (view.from + view.to) / 2);
}

function zoomAll() {
  shown.zoomed = false;
  shown.view = wholeView(shown.scene);
  redraw();
}

function pan(across, up) {
  const { view } = shown;
  const [dx, dt] = [across * (view.right - view.left), up * (view.to - view.from)];
  shown.view = { left: view.left + dx, right: view.right + dx, from: view.from + dt, to: view.to + dt };
  keepInside(wholeView(shown.scene));
  redraw();
}

function moveMark(across, up) {
  const { view } = shown;
  const mark = shown.mark || { place: (view.left + view.right) / 2, t: now() };
  const within = (value, low, high) => Math.max(low, Math.min(high, value));
  shown.mark = {
    place: within(mark.place + across * (view.right - view.left), view.left, view.right),
    t: within(mark.t + up * (view.to - view.from), view.from, view.to),
  };
  redraw();
}

function diagramKey(event) {
  const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  if (event.ctrlKey || event.altKey || event.metaKey || !shown.scene) return;
  const [across, up] = arrows[event.key] || [0, 0];
  if (across || up) (event.shiftKey ? pan : moveMark)(across / (event.shiftKey ? 10 : 50), up / (event.shiftKey ? 10 : 50));
  else if (event.key === "+" || event.key === "=") zoomAtMiddle(1.5);
  else if (event.key === "-") zoomAtMiddle(1 / 1.5);
  else if (event.key === "0") zoomAll();
  else if (event.key === "Escape") markAt(null);
  else return;
  event.preventDefault();
}

function markAt(event) {
  if (!shown.frame) return;
  const { frame } = shown;
  const [x, y] = event ? [event.offsetX, event.offsetY] : [-1, -1];
  const inside = x >= frame.x && x <= frame.right && y >= frame.y && y <= frame.bottom;
  shown.mark = inside ? { place: frame.placeAt(x), t: frame.timeAt(y) } : null;
  redraw();
}

function connectDiagram() {
  const diagram = byId("diagram");
  let held = null;
  diagram.addEventListener("wheel", (event) => {
    if (!shown.frame) return;
    event.preventDefault();
    zoom(1.0015 ** -event.deltaY, shown.frame.placeAt(event.offsetX), shown.frame.timeAt(event.offsetY));
  }, { passive: false });
  diagram.addEventListener("pointerdown", (event) => {
    held = [event.offsetX, event.offsetY];
    diagram.setPointerCapture(event.pointerId);
  });
  diagram.addEventListener("pointermove", (event) => {
    if (held && shown.zoomed) {
      pan((held[0] - event.offsetX) / shown.frame.width, (event.offsetY - held[1]) / shown.frame.height);
      held = [event.offsetX, event.offsetY];
    }
    markAt(event);
  });
  diagram.addEventListener("pointerup", () => { held = null; });
  diagram.addEventListener("pointerleave", () => markAt(null));
  diagram.addEventListener("keydown", diagramKey);
  byId("zoom-in").addEventListener("click", () => zoomAtMiddle(1.5));
  byId("zoom-out").addEventListener("click", () => zoomAtMiddle(1 / 1.5));
  byId("zoom-all").addEventListener("click", zoomAll);
}

// State ------------------------------------------------------------------------------------------

function stateAddress() {
  const view = { quantity: shown.quantity, time: Number(shown.share.toFixed(3)) };
  return addressOf(embedded ? { view } : { ...design, view }).join("&");
}

function keepAddress() {
  clearTimeout(timers.address);
  timers.address = setTimeout(() => history.replaceState(null, "", `#${stateAddress()}`), 300);
}

function setQuantity(name) {
  shown.quantity = name in UNITS ? name : "velocity";
  document.querySelector(`input[name="quantity"][value="${shown.quantity}"]`).checked = true;
  if (shown.scene) showLegend();
  redraw();
}

/** Take the state that the address holds, if it holds one. */
function readAddress() {
  let tree = {};
  try {
    tree = treeOf(location.hash.slice(1));
  } catch {
    showProblems([{ path: "", message: "The address of this page cannot be read." }]);
  }
  const view = tree.view || {};
  if (view.time >= 0 && view.time <= 1) shown.share = view.time;
  if (view.quantity) setQuantity(view.quantity);
  return tree.case && typeof tree.case === "object" ? { case: tree.case, gauges: listOf(tree.gauges) } : null;
}

function showProblems(problems) {
  const others = controls ? controls.showProblems(problems) : problems;
  byId("message").hidden = others.length === 0;
  byId("message").replaceChildren(...others.map(({ path, message }) =>
    make("p", {}, path ? `${path}: ${message}` : message)));
}

function receive({ data, problems = [] }) {
  showProblems(problems);
  document.documentElement.toggleAttribute("data-stale", !data);
  if (!data) return;
  show(data);
  controls.showDerived(data.bodies);
  clearTimeout(timers.curve);
  if (data.ratio !== null && !data.curve) timers.curve = setTimeout(() => curves.ask(design, true), 400);
}

function receiveCurve({ data }) {
  if (!data || !shown.scene || shown.scene.ratio === null) return;
  shown.scene.curve = data;
  redraw();
}

function changed(rebuild) {
  if (rebuild) controls.build(design);
  showPreset();
  scenes.ask(design);
  keepAddress();
}

/** Begin with another design. */
function begin(next) {
  design = structuredClone(next);
  shown.mark = null;
  shown.zoomed = false;
  controls.build(design);
  showPreset();
  scenes.ask(design, true);
  keepAddress();
}

/** Name the collision, if it is one of those to begin with. */
function showPreset() {
  const text = JSON.stringify(design);
  const same = start.presets.find((preset) => JSON.stringify(preset.design) === text);
  byId("preset").value = same ? same.key : "";
  byId("remark").textContent = same ? same.remark : "";
}

function offerPresets() {
  byId("preset").append(new Option("your own", ""));
  for (const { key, title } of start.presets) byId("preset").append(new Option(title, key));
  byId("preset").addEventListener("change", () => {
    const chosen = start.presets.find(({ key }) => key === byId("preset").value);
    if (chosen) begin(chosen.design);
  });
}

// Files ------------------------------------------------------------------------------------------

function download(name, kind, text) {
  const link = make("a", { href: URL.createObjectURL(new Blob([text], { type: kind })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

function saveSvg() {
  const pen = new SvgPen(900, 640);
  const { scene, theme } = shown;
  const frame = drawDiagram(pen, scene, shown.view, shown.quantity, now(), null, theme);
  const reach = quantity(scene.reach[shown.quantity], UNITS[shown.quantity], 3);
  pen.text(frame.x, frame.bottom + 1.5 * theme.size, `colours: ${shown.quantity}, blue −${reach}, yellow +${reach}`,
    { size: 0.85 * theme.size, colour: theme.faint, baseline: "top" });
  download("rodimpact.svg", "image/svg+xml", pen.document(shown.theme.paper));
}

async function saveCase() {
  const { data, problems } = await ask("/case", design);
  if (data) download("case.toml", "application/toml", data.toml);
  else showProblems(problems);
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
  dark.addEventListener("change", () => setTheme(dark.matches ? "dark" : "light"));
  byId("theme").addEventListener("click", () =>
    setTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark"));
  byId("colours").style.background = `linear-gradient(to right, ${STOPS.map((c) => `rgb(${c.join(",")})`).join(",")})`;
  for (const choice of document.querySelectorAll("input[name=quantity]")) {
    choice.addEventListener("change", () => {
      setQuantity(choice.value);
      keepAddress();
    });
  }
  byId("play").addEventListener("click", () => play(!shown.playing));
  byId("time").addEventListener("input", () => {
    play(false);
    shown.share = byId("time").valueAsNumber / 1000;
    redraw();
    keepAddress();
  });
  byId("save-svg").addEventListener("click", saveSvg);
  byId("save-case").addEventListener("click", saveCase);
  connectDiagram();
  new ResizeObserver(() => {
    readTheme();
    redraw();
  }).observe(document.body);
}

function beginOffline() {
  for (const element of document.querySelectorAll(".live")) element.hidden = true;
  document.querySelector("h1").textContent = document.title;
  readAddress();
  showGiven(byId("controls"), embedded.scene.bodies);
  show(embedded.scene);
}

async function beginLive() {
  start = await (await fetch("start.json")).json();
  scenes = new Line("/scene", receive);
  curves = new Line("/curve", receiveCurve);
  controls = new Controls(byId("controls"), start.materials, changed);
  offerPresets();
  begin(readAddress() || start.design);
  addEventListener("hashchange", () => begin(readAddress() || start.design));
}

connect();
if (embedded) beginOffline();
else beginLive();

"use strict";
// The page: its state, its design, and when it is solved and drawn. Begin with
// `designChanged`, `redraw` and, at the end, `beginPage`.

const embedded = JSON.parse(byId("embedded").textContent); // data from Python

const page = {
  scene: null, // all that is shown of the collision
  keptScene: null, // another collision beside it
  view: null, // places and times in the diagram
  fraction: 0, // part of the film up to the time that is shown
  mark: null, // place and time at which values are read
  quantity: "velocity", // what colours show
  judgedText: null, // e on which the verdict is
  theme: null,
  screenTheme: "light", // while the page is printed
  frame: null, // frame of the diagram
  strip: null, // frame and parts of the picture of the rods
  arrowScale: 0, // px for each m/s
  frameCount: 0,
  isDisplaced: true, // points are where they move to
  isZoomed: false,
  isDragging: false,
  isFresh: true, // the film of this design has not begun
  isPlaying: false,
  isGuessing: false,
  isPrinting: false,
  isDraft: false, // the next scene may be less accurate
  isSceneDue: false,
  isRedrawDue: false,
};
let design = null; // the tables of the case, and its gauges
let form = null;
let undoHistory = null;
let afterScene = null; // called once when the next scene is shown

// Solving and drawing ---------------------------------------------------------------------

/** Draw in the next frame. If a scene is due, solve it first, once for all changes. */
function redraw() {
  if (page.isRedrawDue) {
    return;
  }
  page.isRedrawDue = true;
  requestAnimationFrame(() => {
    try {
      if (page.isSceneDue) {
        showSolution(sceneOf(design, page.isDraft));
      }
      if (page.scene) {
        draw();
      }
    } finally {
      page.isRedrawDue = false;
    }
  });
}

/** Ask for the scene of the design as it is now; work for the one before ends. */
function requestScene(isDraft = false) {
  clearTimeout(restTimer);
  sceneCount += 1;
  stopMap();
  page.isSceneDue = true;
  page.isDraft = isDraft;
  redraw();
}

/** Draw all pictures of the scene at the time of the film, and the texts beside them. */
function draw() {
  const { scene, theme } = page;
  const time = currentTime();
  const shownTime = page.isPrinting ? scene.begin : time; // paper shows the set-up
  const t = clamp(shownTime, scene.begin, scene.end);
  const diagram = new CanvasPen(byId("diagram"));
  page.frame = drawDiagram(diagram, scene, page, t, page.mark, theme);
  page.strip = drawRods(new CanvasPen(byId("rods")), scene, page, t, theme);
  placeHandles(page.strip);
  drawKeptScene(time, theme);
  drawPlots(byId("plots"), scene, t, theme);
  byId("time").value = 1000 * page.fraction;
  byId("time").setAttribute("aria-valuetext", quantity(time, "s"));
  byId("now").value = quantity(time, "s");
  showReading();
  showEvent(scene, t);
  page.frameCount += 1;
  document.documentElement.dataset.frames = page.frameCount;
}

/** Show a scene, or the problems of the design; neither for a draft that took too long. */
function showSolution({ scene, problems = [] }) {
  page.isSceneDue = false;
  document.documentElement.removeAttribute("data-solving");
  showProblems(problems);
  document.documentElement.toggleAttribute("data-stale", !scene);
  if (!scene) {
    return;
  }
  showScene(scene);
  const callback = afterScene;
  afterScene = null;
  if (callback) {
    callback();
  }
  form.showDerived(scene.bodies);
  showMap();
  postCase();
}

/** Show a newly solved scene: its pictures in the next frame, its texts now. */
function showScene(scene) {
  page.scene = prepareScene(scene);
  shareScale();
  if (!page.isZoomed && !page.isDragging) {
    page.view = wholeView(scene);
  }
  scene.events = eventsOf(scene);
  showResults(scene);
  showLegend();
  listEvents();
  namePaces();
  redraw();
}

/** Show problems beside their fields, those without a field above the form. */
function showProblems(problems) {
  const others = form ? form.showProblems(problems) : problems;
  byId("message").hidden = others.length === 0;
  const paragraphs = others.map((problem) => {
    const text = problemInSiUnits(problem);
    const { path } = problem;
    return makeElement("p", {}, path ? `${path}: ${text}` : text);
  });
  byId("message").replaceChildren(...paragraphs);
}

// The design ------------------------------------------------------------------------------

/** Solve the design that has changed; `isWhole` is false for a number of the form. */
function designChanged(isWhole) {
  undoHistory.keep(design, isWhole);
  if (isWhole) {
    form.build(design);
  }
  showPreset();
  requestScene(!isWhole);
  keepAddress();
}

/** Show another design; `callback` is called when its scene is there. */
function showDesign(newDesign, callback = null) {
  afterScene = callback;
  design = structuredClone(newDesign);
  page.mark = null;
  page.isZoomed = false;
  page.isFresh = true;
  designChanged(true);
}

/** Name the collision, if it is a preset. */
function showPreset() {
  const text = JSON.stringify(design);
  const preset = embedded.presets.find(
    (candidate) => JSON.stringify(candidate.design) === text,
  );
  byId("preset").value = preset ? preset.key : "";
  byId("remark").textContent = preset ? unbroken(preset.remark) : "";
}

/** Offer the presets, and show the one that is chosen. */
function connectPresets() {
  const select = byId("preset");
  select.append(new Option("your own", ""));
  for (const { key, title } of embedded.presets) {
    select.append(new Option(title, key));
  }
  select.addEventListener("change", () => {
    const preset = embedded.presets.find(({ key }) => key === select.value);
    if (preset) {
      showDesign(preset.design);
    }
  });
}

// The view --------------------------------------------------------------------------------

/** Let colours show a quantity of `UNITS`; velocities for any other name. */
function setQuantity(name) {
  page.quantity = name in UNITS ? name : "velocity";
  const selector = `input[name="quantity"][value="${page.quantity}"]`;
  document.querySelector(selector).checked = true;
  if (page.scene) {
    showLegend();
  }
  redraw();
}

/** Take the light or the dark theme. */
function setTheme(name) {
  document.documentElement.dataset.theme = name;
  byId("theme").setAttribute("aria-pressed", String(name === "dark"));
  readTheme();
  redraw();
}

/** Follow the theme of the system, and the button. */
function connectTheme() {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const follow = () => setTheme(dark.matches ? "dark" : "light");
  follow();
  dark.addEventListener("change", follow);
  byId("theme").addEventListener("click", () => {
    const { theme } = document.documentElement.dataset;
    setTheme(theme === "dark" ? "light" : "dark");
  });
}

/** Let the controls of the view change it. */
function connectView() {
  byId("displaced").addEventListener("change", ({ target }) => {
    page.isDisplaced = target.checked;
    zoomAll();
    keepAddress();
  });
  byId("quantity").addEventListener("change", ({ target }) => {
    setQuantity(target.value);
    keepAddress();
  });
  byId("question").addEventListener("input", keepAddress);
  byId("ask").addEventListener("click", () => {
    byId("asking").hidden = false;
    byId("question").focus();
  });
  byId("compare").addEventListener("click", () => keepScene(!page.keptScene));
}

/** Close the menu after a choice, a click beside it, or Escape. */
function connectMenu() {
  const menu = byId("menu");
  addEventListener("click", ({ target }) => {
    if (!menu.contains(target) || target.closest("button")) {
      menu.open = false;
    }
  });
  addEventListener("keydown", ({ key }) => {
    if (key === "Escape") {
      menu.open = false;
    }
  });
}

/** Follow the size of the window, and print in the light theme. */
function connectWindow() {
  const sizeOfBody = new ResizeObserver(() => {
    readTheme();
    redraw();
  });
  sizeOfBody.observe(document.body);
  const sizeOfOutcome = new ResizeObserver(([{ target }]) => {
    const height = `${target.offsetHeight}px`;
    document.documentElement.style.setProperty("--pinned", height);
  });
  sizeOfOutcome.observe(byId("outcome"));
  matchMedia("print").addEventListener("change", ({ matches }) => {
    page.isPrinting = matches;
    if (matches) {
      page.screenTheme = document.documentElement.dataset.theme;
    }
    setTheme(matches ? "light" : page.screenTheme);
    if (page.scene) {
      draw();
    }
  });
}

// Beginning -------------------------------------------------------------------------------

/** Connect all parts of the page, and show the design of the address, or of Python. */
function beginPage() {
  connectTheme();
  connectView();
  connectMenu();
  connectWindow();
  connectFiles();
  connectDiagram();
  connectMap();
  connectRoundness();
  connectFilm();
  connectEvents();
  connectGuess();
  connectPresets();
  connectTour();
  connectDragging();
  form = new Form(byId("controls"), embedded.materials);
  undoHistory = new UndoHistory(byId("undo"), showDesign);
  const showAddress = () => showDesign(readAddress() || embedded.design);
  addEventListener("hashchange", showAddress);
  showAddress();
}

beginPage();

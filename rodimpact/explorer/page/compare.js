"use strict";
// Two collisions beside each other: the one shown, and one that was kept. They have one
// time and one scale of colours. Begin with `keepScene`.

/** The scene that is shown, and the one that was kept. */
const scenesShown = () =>
  page.keptScene ? [page.scene, page.keptScene] : [page.scene];

/** First and last time of the film of all scenes that are shown. */
function filmSpan() {
  const scenes = scenesShown();
  return {
    begin: Math.min(...scenes.map(({ begin }) => begin)),
    end: Math.max(...scenes.map(({ end }) => end)),
  };
}

/** Give all scenes one scale of colours, and one legend. */
function shareScale() {
  const scenes = scenesShown();
  const scale = {};
  const colourRange = {};
  for (const name of Object.keys(UNITS)) {
    scale[name] = Math.max(...scenes.map(({ largest }) => largest[name]));
    colourRange[name] = rangeOf(scenes.flatMap(({ ranges }) => ranges[name]));
  }
  for (const scene of scenes) {
    scene.scale = scale;
    scene.colourRange = colourRange;
    for (const grid of scene.grids || []) {
      grid.images = {};
      grid.viewKey = "";
    }
  }
}

/** Keep the present collision beside later ones, or put it away. */
function keepScene(isKept) {
  page.keptScene = isKept ? page.scene : null;
  byId("other").hidden = !isKept;
  document.documentElement.toggleAttribute("data-compare", isKept);
  byId("compare").setAttribute("aria-pressed", String(isKept));
  if (isKept) {
    const { restitution, events } = page.scene;
    let text = `e = ${minus(restitution.text)}`;
    if (restitution.value === null) {
      ({ text } = events.at(-1));
    }
    byId("other-text").textContent = unbroken(`Kept: ${text}`);
  }
  shareScale();
  showLegend();
  zoomAll();
}

/** Draw the collision that was kept, at time t of the film. */
function drawKeptScene(t, theme) {
  const { keptScene: scene } = page;
  if (!scene) {
    return;
  }
  const { left, right } = wholeView(scene);
  const { from, to } = page.view;
  const look = { ...page, view: { left, right, from, to } };
  const moment = clamp(t, scene.begin, scene.end);
  const diagram = new CanvasPen(byId("other-diagram"));
  drawDiagram(diagram, scene, look, moment, null, theme);
  drawRods(new CanvasPen(byId("other-rods")), scene, look, moment, theme);
}

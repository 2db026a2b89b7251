"use strict";
// Two collisions side by side: the one shown, and one that was kept, at the same time and in the same colours.

const compared = () =>
  shown.other ? [shown.scene, shown.other] : [shown.scene];

/** First and last moment of the film of all that is shown. */
function filmSpan() {
  return {
    begin: Math.min(...compared().map(({ begin }) => begin)),
    end: Math.max(...compared().map(({ end }) => end)),
  };
}

/** One scale of colours for both, and one legend. */
function shareReach() {
  for (const scene of compared()) {
    scene.range = Object.fromEntries(
      Object.keys(UNITS).map((name) => [
        name,
        rangeIn(compared().flatMap(({ ownRange }) => ownRange[name])),
      ]),
    );
    scene.reach = Object.fromEntries(
      Object.keys(UNITS).map((name) => [
        name,
        Math.max(...compared().map(({ own }) => own[name])),
      ]),
    );
    for (const grid of scene.grids || []) grid.images = {};
  }
}

/** Keep the collision shown beside those to come, or put it away. */
function keepBeside(on) {
  shown.other = on ? shown.scene : null;
  byId("other").hidden = !on;
  document.documentElement.toggleAttribute("data-compare", on);
  byId("compare").setAttribute("aria-pressed", String(on));
  if (on) {
    const { restitution, events } = shown.scene;
    const e =
      restitution.value === null
        ? events.at(-1).text
        : `e = ${minus(restitution.text)}`;
    byId("other-text").textContent = unbroken(`Kept: ${e}`);
  }
  shareReach();
  showLegend();
  zoomAll();
}

function drawBeside(t, theme) {
  const { other } = shown;
  if (!other) return;
  const { left, right } = wholeView(other);
  const look = {
    ...shown,
    view: { left, right, from: shown.view.from, to: shown.view.to },
  };
  const moment = Math.max(other.begin, Math.min(other.end, t));
  drawDiagram(
    new CanvasPen(byId("other-diagram")),
    other,
    look,
    moment,
    null,
    theme,
  );
  drawRods(new CanvasPen(byId("other-rods")), other, look, moment, theme);
}

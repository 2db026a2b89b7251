"use strict";
// A tour of the textbook's box in six steps.

// the collision of a step, and its moment in shares of the force duration; -1 is before it
const TOUR = [
  [
    "identical",
    -1,
    "Two identical rods. Rod 1 moves at speed v, rod 2 is at rest. No force acts yet.",
  ],
  [
    "identical",
    0.25,
    "They touch, and sound waves of compression start to both sides. Between the two fronts all material is compressed and moves with v/2; no wave has reached the rest of the rods yet.",
  ],
  [
    "identical",
    0.5,
    "The fronts reach the far ends: both rods are compressed everywhere and move with v/2. At the free ends each wave of compression turns back as a wave that takes the compression away.",
  ],
  [
    "identical",
    1,
    "The waves meet at the contact, and the rods part. Rod 1 is at rest, rod 2 moves at v, and no vibration is left: e = 1.",
  ],
  [
    "wall",
    1,
    "A rod on a rigid wall: the wave runs to the free end and back, and the rod leaves as fast as it came. Again e = 1. Both examples mislead: elastic rods rarely collide like that.",
  ],
  [
    "unequal",
    1,
    "Rods of different length: rod 1, the short one, stops when its wave is back. In rod 2 waves keep running from end to end. Their vibration energy is missing from the motion of rod 2 as a whole, so e = l₁/l₂ < 1, though no energy is lost in the material.",
  ],
];
let [tourStep, own] = [-1, null]; // own: what was shown before the tour

function showTour(k) {
  if (tourStep < 0 && k >= 0)
    own = { design: structuredClone(design), share: shown.share };
  const ended = tourStep >= 0 && k < 0;
  tourStep = k;
  byId("tour").hidden = k < 0;
  byId("tour-open").setAttribute("aria-pressed", String(k >= 0));
  if (ended) {
    const { share } = own;
    begin(own.design, () => setShare(share));
    byId("tour-open").focus();
  }
  if (k < 0) return;
  hideResult(false); // the tour tells e
  const [key, moment, text] = TOUR[k];
  byId("tour-text").textContent = unbroken(
    `${k + 1} of ${TOUR.length}. ${text}`,
  );
  byId("tour-back").disabled = k === 0;
  byId("tour-next").textContent = k === TOUR.length - 1 ? "End" : "Next";
  begin(start.presets.find((preset) => preset.key === key).design, () => {
    const { scene } = shown;
    const pressing = scene.contacts[0].spells.find(
      ({ state }) => state === "pressing",
    );
    goTo(
      moment < 0
        ? scene.begin
        : pressing.from + moment * (pressing.to - pressing.from),
    );
  });
}

function connectTour() {
  byId("tour-open").addEventListener("click", () =>
    showTour(tourStep < 0 ? 0 : -1),
  );
  byId("tour-back").addEventListener("click", () => showTour(tourStep - 1));
  byId("tour-next").addEventListener("click", () =>
    showTour(tourStep + 1 < TOUR.length ? tourStep + 1 : -1),
  );
  byId("tour-end").addEventListener("click", () => showTour(-1));
  addEventListener("keydown", ({ key }) => {
    if (key === "Escape" && tourStep >= 0) showTour(-1);
  });
}

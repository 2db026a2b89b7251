"use strict";
// A tour of the textbook's box in six steps. Begin with `showStep`.

const NO_STEP = -1;
const BEFORE_CONTACT = -1; // moment of a step

// Each step has the key of its collision, and its moment as a fraction of the force
// duration.
const TOUR = [
  {
    key: "identical",
    moment: BEFORE_CONTACT,
    text: "Two identical rods. Rod 1 moves at speed v, rod 2 is at rest. No force acts yet.",
  },
  {
    key: "identical",
    moment: 0.25,
    text: "They touch, and sound waves of compression start to both sides. Between the two fronts all material is compressed and moves with v/2; no wave has reached the rest of the rods yet.",
  },
  {
    key: "identical",
    moment: 0.5,
    text: "The fronts reach the far ends: both rods are compressed everywhere and move with v/2. At the free ends each wave of compression turns back as a wave that takes the compression away.",
  },
  {
    key: "identical",
    moment: 1,
    text: "The waves meet at the contact, and the rods part. Rod 1 is at rest, rod 2 moves at v, and no vibration is left: e = 1.",
  },
  {
    key: "wall",
    moment: 1,
    text: "A rod on a rigid wall: the wave runs to the free end and back, and the rod leaves as fast as it came. Again e = 1. Both examples mislead: elastic rods rarely collide like that.",
  },
  {
    key: "unequal",
    moment: 1,
    text: "Rods of different length: rod 1, the short one, stops when its wave is back. In rod 2 waves keep running from end to end. Their vibration energy is missing from the motion of rod 2 as a whole, so e = l₁/l₂ < 1, though no energy is lost in the material.",
  },
];
const tour = { step: NO_STEP, before: null }; // before: design and time before the tour

const isTouring = () => tour.step !== NO_STEP;

/** Show a step of the tour. */
function showStep(step) {
  if (!isTouring()) {
    const { fraction } = page;
    tour.before = { design: structuredClone(design), fraction };
  }
  tour.step = step;
  showTourBar();
  setGuessing(false); // the tour tells e
  const { key, moment, text } = TOUR[step];
  byId("tour-text").textContent = unbroken(
    `${step + 1} of ${TOUR.length}. ${text}`,
  );
  byId("tour-back").disabled = step === 0;
  const isLast = step === TOUR.length - 1;
  byId("tour-next").textContent = isLast ? "End" : "Next";
  const preset = embedded.presets.find((candidate) => candidate.key === key);
  showDesign(preset.design, () => goTo(timeOfMoment(page.scene, moment)));
}

/** Time of a moment of a step: before contact, or a fraction of the first force. */
function timeOfMoment({ begin, contacts }, moment) {
  if (moment === BEFORE_CONTACT) {
    return begin;
  }
  const { from, to } = contacts[0].spells.find(
    ({ state }) => state === "pressing",
  );
  return from + moment * (to - from);
}

/** End the tour: the design and the time before it come back. */
function endTour() {
  if (!isTouring()) {
    return;
  }
  tour.step = NO_STEP;
  showTourBar();
  const { design: designBefore, fraction } = tour.before;
  showDesign(designBefore, () => setFraction(fraction));
  byId("tour-open").focus();
}

/** Show the bar of the tour, or hide it when the tour has ended. */
function showTourBar() {
  byId("tour").hidden = !isTouring();
  byId("tour-open").setAttribute("aria-pressed", String(isTouring()));
}

/** Let the buttons begin and end the tour and go through its steps; Escape ends it. */
function connectTour() {
  byId("tour-open").addEventListener("click", () => {
    if (isTouring()) {
      endTour();
    } else {
      showStep(0);
    }
  });
  byId("tour-back").addEventListener("click", () => showStep(tour.step - 1));
  byId("tour-next").addEventListener("click", () => {
    if (tour.step + 1 < TOUR.length) {
      showStep(tour.step + 1);
    } else {
      endTour();
    }
  });
  byId("tour-end").addEventListener("click", endTour);
  addEventListener("keydown", ({ key }) => {
    if (key === "Escape") {
      endTour();
    }
  });
}

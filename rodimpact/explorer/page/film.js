"use strict";
// The film: it plays, pauses, goes from event to event, and stops at the end. Begin with
// `play`.

const REAL_PACE = 1e5; // times slower than the collision: pace "100,000 × slower"
const STEP_SECONDS = 8; // pace of the film while it plays to the next event
const INPUTS = "button, input, select, textarea, summary, [contenteditable]";

/** Seconds that the whole film lasts. */
function filmSeconds() {
  const { begin, end } = filmSpan();
  const { value: pace } = byId("pace");
  if (pace === "real") {
    return (end - begin) * REAL_PACE;
  }
  if (pace === "step") {
    return STEP_SECONDS;
  }
  return Number(pace);
}

/** Name how much slower than the collision each pace is. */
function namePaces() {
  const { begin, end } = filmSpan();
  for (const option of byId("pace").options) {
    const seconds = Number(option.value);
    if (!seconds) {
      continue;
    }
    const factor = Number((seconds / (end - begin)).toPrecision(2));
    const grouped = String(factor).replace(/\B(?=(\d{3})+$)/g, ",");
    setText(option, `${seconds} s: ${grouped} × slower`);
  }
}

/** Time of the collision that the page shows, s. */
function currentTime() {
  const { begin, end } = filmSpan();
  return Math.min(end, begin + page.fraction * (end - begin));
}

/** Fraction of the film at time t. */
function fractionAt(t) {
  const { begin, end } = filmSpan();
  return (t - begin) / (end - begin);
}

/** Show the collision at a fraction of the film. */
function setFraction(fraction) {
  page.fraction = clamp(fraction, 0, 1);
  page.isFresh = false;
  page.mark = null;
  redraw();
  keepAddress();
}

/** Stop the film at time t. */
function goTo(t) {
  play(false);
  setFraction(fractionAt(t));
}

/** Play the film from where it is, from its begin if it has ended; or pause it. */
function play(isPlaying) {
  page.isPlaying = isPlaying;
  byId("play").textContent = isPlaying ? "Pause" : "Play";
  byId("play").setAttribute("aria-pressed", String(isPlaying));
  if (!isPlaying) {
    return;
  }
  if (page.fraction >= 1 || page.isFresh) {
    page.fraction = 0;
  }
  page.isFresh = false;
  page.mark = null;
  const stop = stopOfFilm();
  let lastMoment = performance.now();
  const advance = (moment) => {
    if (!page.isPlaying || !page.scene) {
      return;
    }
    const seconds = Math.max(0, moment - lastMoment) / 1000;
    lastMoment = moment;
    const fraction = page.fraction + seconds / filmSeconds();
    page.fraction = Math.min(stop, fraction);
    draw();
    if (page.fraction >= stop) {
      play(false);
    } else {
      requestAnimationFrame(advance);
    }
  };
  requestAnimationFrame(advance);
}

/** Fraction of the film at which it stops: its end, or the next event. */
function stopOfFilm() {
  if (byId("pace").value !== "step") {
    return 1;
  }
  const { scene } = page;
  const next = scene.events[eventIndexAt(scene, currentTime()) + 1];
  return next ? fractionAt(next.t) : 1;
}

/** Let the button and the space bar play and pause, and the slider set the time. */
function connectFilm() {
  byId("play").addEventListener("click", () => play(!page.isPlaying));
  byId("time").addEventListener("input", () => {
    play(false);
    setFraction(byId("time").valueAsNumber / 1000);
  });
  addEventListener("keydown", (event) => {
    if (event.key !== " " || event.target.closest(INPUTS)) {
      return;
    }
    event.preventDefault();
    play(!page.isPlaying);
  });
}

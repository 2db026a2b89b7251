"use strict";
// The film: it plays, pauses, steps from event to event, and holds at the end.

const REAL = 1e5; // how much slower than the collision the pace "100,000 × slower" is

/** How long the whole film lasts, in s. */
function filmTime() {
  const { begin, end } = filmSpan();
  const pace = byId("pace").value;
  return pace === "real"
    ? (end - begin) * REAL
    : pace === "step"
      ? 8
      : Number(pace);
}

/** Say how much slower than the collision each pace is. */
function namePaces() {
  const { begin, end } = filmSpan();
  for (const option of byId("pace").options) {
    const seconds = Number(option.value);
    if (seconds)
      write(
        option,
        `${seconds} s: ${String(Number((seconds / (end - begin)).toPrecision(2))).replace(/\B(?=(\d{3})+$)/g, ",")} × slower`,
      );
  }
}

function shareOfTime(t) {
  const { begin, end } = filmSpan();
  return (t - begin) / (end - begin);
}

function setShare(share) {
  Object.assign(shown, {
    share: Math.max(0, Math.min(1, share)),
    fresh: false,
    mark: null,
  });
  redraw();
  keepAddress();
}

function play(on) {
  shown.playing = on;
  byId("play").textContent = on ? "Pause" : "Play";
  byId("play").setAttribute("aria-pressed", String(on));
  if (!on) return;
  if (shown.share >= 1 || shown.fresh) shown.share = 0;
  Object.assign(shown, { fresh: false, mark: null });
  let last = performance.now();
  const { scene } = shown;
  const next =
    byId("pace").value === "step"
      ? scene.events[eventAt(scene, now()) + 1]
      : null;
  const stop = next ? shareOfTime(next.t) : 1;
  const advance = (moment) => {
    if (!shown.playing || !shown.scene) return;
    shown.share = Math.min(
      stop,
      shown.share + Math.max(0, moment - last) / 1000 / filmTime(),
    );
    last = moment;
    draw();
    if (shown.share >= stop) play(false);
    else requestAnimationFrame(advance);
  };
  requestAnimationFrame(advance);
}

function connectFilm() {
  byId("play").addEventListener("click", () => play(!shown.playing));
  byId("time").addEventListener("input", () => {
    play(false);
    setShare(byId("time").valueAsNumber / 1000);
  });
  addEventListener("keydown", (event) => {
    if (
      event.key !== " " ||
      event.target.closest(
        "button, input, select, textarea, summary, [contenteditable]",
      )
    )
      return;
    event.preventDefault();
    play(!shown.playing);
  });
}

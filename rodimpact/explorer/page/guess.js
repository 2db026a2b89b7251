"use strict";
// A guess of e before it is shown. Begin with `setGuessing`.

const QUESTION =
  "How fast do they part, as a share of the speed at which they meet?";
const RIGHT_GUESS_ATOL = 0.005; // a guess that is nearer to e is right

/** Hide e and all that tells it, or show it. */
function setGuessing(isGuessing) {
  if (page.isGuessing === isGuessing) {
    return;
  }
  page.isGuessing = isGuessing;
  document.documentElement.toggleAttribute("data-guess", isGuessing);
  byId("guess").hidden = !isGuessing;
  byId("guess-first").setAttribute("aria-pressed", String(isGuessing));
  byId("verdict").textContent = "";
  if (!isGuessing) {
    return;
  }
  play(false);
  zoomAll();
  setFraction(0);
  updateGuess(page.scene);
  byId("guessed").value = "";
  byId("guessed").focus();
}

/** Ask for the collision that is shown, and remove the verdict on another one. */
function updateGuess(scene) {
  if (page.isGuessing) {
    setText(byId("asked"), `${beginningText(scene)} ${QUESTION}`);
  } else if (page.judgedText !== scene.restitution.text) {
    setText(byId("verdict"), "");
  }
}

/** Compare the guess with e, and let the film run. */
function reveal() {
  const guess = byId("guessed").valueAsNumber;
  const { value, text } = page.scene.restitution;
  if (!Number.isFinite(guess)) {
    return;
  }
  setGuessing(false);
  page.judgedText = text;
  const error = Math.abs(guess - value);
  let verdict = "right!";
  if (error >= RIGHT_GUESS_ATOL) {
    verdict = `off by ${plainNumber(error, 2)}.`;
  }
  byId("verdict").textContent =
    `You said ${guess}; e is ${minus(text)}: ${verdict}`;
  byId("play").focus(); // the field of the guess is gone
  play(true);
}

/** Let the button ask for a guess, and the form compare it with e. */
function connectGuess() {
  byId("guess-first").addEventListener("click", () =>
    setGuessing(!page.isGuessing),
  );
  byId("guess").addEventListener("submit", (event) => {
    event.preventDefault();
    reveal();
  });
}

"""The page of an animation: one file with all its frames, and a few lines that play them."""

PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
body { margin: 0.5rem; background: {paper}; color: {ink}; font: 1rem/1.5 sans-serif; }
main { max-width: {width}px; margin: auto; }
canvas { width: 100%; display: block; }
form { display: flex; flex-wrap: wrap; gap: 0.5rem 1rem; align-items: center; }
#when { flex: 1 1 12rem; }
button { min-width: 5rem; }
output { min-width: 8rem; font-variant-numeric: tabular-nums; }
</style>
</head>
<body>
<main>
<canvas id="screen" width="{width}" height="{height}" role="img" aria-label="{title}"></canvas>
<form onsubmit="return false">
<button type="button" id="play">Pause</button>
<input type="range" id="when" min="0" value="0" step="1" aria-label="time">
<output id="clock" for="when"></output>
<label>speed <select id="speed">
<option value="0.1">1/10</option><option value="0.25">1/4</option><option value="0.5">1/2</option>
<option value="1" selected>1</option><option value="2">2</option>
</select></label>
</form>
<noscript>This film needs JavaScript.</noscript>
</main>
<script>
"use strict";
const clocks = {clocks};
const pictures = [
{frames}].map(data => {
  const picture = new Image();
  picture.src = "data:image/png;base64," + data;
  return picture;
});
const [screen, play, when, clock, speed] =
  ["screen", "play", "when", "clock", "speed"].map(id => document.getElementById(id));
const pen = screen.getContext("2d");
when.max = pictures.length - 1;
let playing = true, shown = 0, drawn = -1, last = null;  // each picture adds to the one before

function show() {
  const number = Math.floor(shown);
  when.value = number;
  clock.value = clocks[number];
  when.setAttribute("aria-valuetext", clocks[number]);
  if (number < drawn) drawn = -1;
  for (; drawn < number && pictures[drawn + 1].complete; drawn++)
    pen.drawImage(pictures[drawn + 1], 0, 0);
  if (drawn < number) pictures[drawn + 1].onload = show;
}

function run(on) {
  playing = on;
  last = null;
  play.textContent = on ? "Pause" : "Play";
}

function tick(now) {
  if (playing && last !== null) {
    shown = (shown + (now - last) / 1000 * {fps} * speed.value) % pictures.length;
    show();
  }
  last = playing ? now : null;
  requestAnimationFrame(tick);
}

play.onclick = () => run(!playing);
when.oninput = () => { run(false); shown = Number(when.value); show(); };
document.onkeydown = event => {
  if (event.key === " " && event.target === document.body) {
    event.preventDefault();
    run(!playing);
  }
};
if (matchMedia("(prefers-reduced-motion: reduce)").matches) run(false);
show();
requestAnimationFrame(tick);
</script>
</body>
</html>
"""

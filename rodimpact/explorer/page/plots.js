"use strict";
// Curves over time, and e over the ratio of the lengths.

/** Value of a curve at time t. */
const valueAt = (series, t) => fronts.value_at(series, t);

/** Range of values with 0 in it and some air around. */
function rangeOf(plot) {
  let [low, high] = [0, 0];
  for (const { y } of plot.series)
    for (const v of y) [low, high] = [Math.min(low, v), Math.max(high, v)];
  const air = 0.06 * (high - low) || 1;
  return [low < 0 ? low - air : 0, high > 0 ? high + air : low < 0 ? 0 : air];
}

const plotFrame = (pen, size, ends) =>
  frameOf(
    pen,
    { left: ends.x0, right: ends.x1, from: ends.y0, to: ends.y1 },
    size,
  );

/** Let a pointer on a curve move the time. */
function scrubOn(canvas) {
  const follow = ({ offsetX }) => {
    const { x, width } = canvas.frame;
    play(false);
    setShare(
      shareOfTime(
        shown.scene.begin +
          ((offsetX - x) / width) * (shown.scene.end - shown.scene.begin),
      ),
    );
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    follow(event);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (event.buttons) follow(event);
  });
}

/** One figure of curves over time. */
function drawPlot(pen, plot, { begin, end }, now, theme) {
  const [low, high] = rangeOf(plot);
  const frame = plotFrame(pen, theme.size, {
    x0: begin,
    x1: end,
    y0: low,
    y1: high,
  });
  pen.inside(frame.x, frame.y - 2, frame.width, frame.height + 4, () => {
    pen.line(
      [
        [frame.x, frame.up(0)],
        [frame.right, frame.up(0)],
      ],
      theme.line,
      1,
    );
    plot.series.forEach((series, k) => {
      const points = series.t.map((t, i) => [
        frame.across(t),
        frame.up(series.y[i]),
      ]);
      pen.line(
        points,
        theme.series[k % theme.series.length],
        2,
        k >= theme.series.length ? [6, 3] : [],
      );
    });
    if (!shown.printing)
      pen.line(
        [
          [frame.across(now), frame.y],
          [frame.across(now), frame.bottom],
        ],
        theme.wrong,
        2,
      );
  });
  drawFrame(pen, frame, theme.size, theme, {
    x: [begin, end, "s", "time"],
    y: [low, high, plot.unit, ""],
  });
  return frame;
}

/** e over l1/l2, and over the roundness of the ends. */
function drawCurves(scene, theme) {
  const { curve, ratio, roundness } = scene;
  drawCurve(
    "curve",
    curve && {
      ...curve,
      here: ratio,
      from: 0,
      title: "e over l₁/l₂",
      name: "l₁/l₂",
      said: `here l₁/l₂ = ${plainNumber(ratio, 4)}`,
    },
    scene,
    theme,
  );
  drawCurve(
    "roundness",
    roundness && {
      ...roundness,
      title: "e over the roundness of the ends",
      name: "log₁₀ κ, κ = stiffness of ends / rod",
      said:
        roundness.here === null
          ? "rigid ends: κ is infinite"
          : `here κ = ${plainNumber(10 ** roundness.here, 3)}`,
    },
    scene,
    theme,
  );
  const slider = byId("ends");
  if (!roundness) return;
  if (document.activeElement !== slider)
    slider.value = roundness.here ?? slider.max;
  slider.setAttribute(
    "aria-valuetext",
    roundness.here === null
      ? "rigid"
      : `kappa ${plainNumber(10 ** roundness.here, 3)}`,
  );
}

/** Let a slider round the ends, which then meet by Hertz's law; at its right end they are rigid. */
function connectRoundness() {
  byId("ends").addEventListener("input", ({ target }) => {
    const [{ gap = 0, law } = {}] = listOf(design.case.contacts);
    const stiffness = Number(
      (shown.scene.roundness.unit * 10 ** target.valueAsNumber).toPrecision(3),
    );
    const rigid = target.value === target.max;
    const before = law || "rigid";
    design.case.contacts = [
      rigid ? { gap, law: "rigid" } : { gap, law: "hertz", stiffness },
    ];
    if (!rigid && before === "hertz")
      enter("contacts.0.stiffness", toShown(stiffness, FIELDS.hertz.power));
    else if (before !== design.case.contacts[0].law) changed(true);
  });
}

/** e over one number, and the collision shown. */
function drawCurve(id, curve, { restitution }, theme) {
  byId(`plot-${id}`).hidden = !curve;
  if (!curve) return;
  const {
    ratios,
    values,
    outdated,
    here,
    from = ratios[0],
    title,
    name,
    said,
  } = curve;
  caption(byId(`plot-${id}`).firstElementChild, title, [[said, theme.wrong]]);
  const pen = new CanvasPen(byId(id));
  if (!ratios.length) return;
  const right = ratios.at(-1);
  const most = Math.max(1, ...values.filter((e) => e !== null));
  const frame = plotFrame(pen, theme.size, {
    x0: from,
    x1: right,
    y0: 0,
    y1: 1.08 * most,
  });
  let points = [];
  const strokes = [points];
  ratios.forEach((ratio, i) => {
    if (values[i] === null) strokes.push((points = []));
    else points.push([frame.across(ratio), frame.up(values[i])]);
  });
  const colour = outdated ? theme.line : theme.series[0];
  for (const stroke of strokes) if (stroke.length) pen.line(stroke, colour, 2);
  const beyond = 0.01 * (right - from); // a slider at its end may be a rounding outside
  if (
    restitution.value !== null &&
    here !== null &&
    here >= from - beyond &&
    here <= right + beyond
  ) {
    pen.disc(
      frame.across(here),
      frame.up(restitution.value),
      0.42 * theme.size,
      theme.wrong,
    );
  }
  drawFrame(pen, frame, theme.size, theme, {
    x: [from, right, "", name],
    y: [0, 1.08 * most, "", "e"],
  });
}

/** Caption: the title, and each curve with its value at the time shown. */
function caption(element, title, entries) {
  if (element.children.length !== entries.length + 1) {
    element.replaceChildren(
      make("strong"),
      ...entries.map(() => make("span", {}, make("i"), "")),
    );
  }
  write(element.firstChild, title);
  entries.forEach(([text, colour], k) => {
    const { firstChild: swatch, lastChild: said } = element.children[k + 1];
    if (said.data !== text) said.data = text;
    swatch.style.borderColor = colour;
  });
}

/** Draw all curves; figures are made anew only when there are others. */
function drawPlots(holder, scene, now, theme) {
  drawCurves(scene, theme);
  const keys = scene.plots.map((plot) => plot.key).join();
  if (holder.dataset.keys !== keys) {
    holder.dataset.keys = keys;
    holder.replaceChildren(
      ...scene.plots.map(({ key, title }) =>
        make(
          "figure",
          { id: `plot-${key}` },
          make("figcaption"),
          make("canvas", { role: "img", "aria-label": `${title} over time` }),
        ),
      ),
    );
    holder.querySelectorAll("canvas").forEach(scrubOn);
  }
  scene.plots.forEach((plot, i) => {
    const [text, canvas] = holder.children[i].children;
    const least = 1e-9 * largestOf(plot.series.flatMap(({ y }) => y)); // less is rounding
    const told = (value) =>
      quantity(Math.abs(value) < least ? 0 : value, plot.unit, 3);
    caption(
      text,
      plot.title,
      plot.series.map((series, k) => [
        shown.printing
          ? series.name
          : `${series.name}: ${told(valueAt(series, now))}`,
        theme.series[k % theme.series.length],
      ]),
    );
    canvas.frame = drawPlot(new CanvasPen(canvas), plot, scene, now, theme);
  });
}

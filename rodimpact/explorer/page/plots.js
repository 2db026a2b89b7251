"use strict";
// Figures of curves: over time, and of e over one number. Begin with `drawPlots`.

const PLOT_MARGIN = 0.06; // above and below curves, in their range
const ROUNDING_OF_CURVES = 1e-9; // smaller values, relative to the largest one, are 0

/** Range of the values of curves with 0 in it, and with a margin. */
function plotRange(curves) {
  let low = 0;
  let high = 0;
  for (const { y } of curves) {
    for (const value of y) {
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
  }
  const margin = PLOT_MARGIN * (high - low) || 1;
  if (low < 0) {
    low -= margin;
  }
  if (high > 0 || low === 0) {
    high += margin;
  }
  return [low, high];
}

/** Frame of a figure with the axes x and y, each with `low` and `high`. */
const frameOfPlot = (pen, { x, y }, { size }) =>
  frameOf(pen, { left: x.low, right: x.high, from: y.low, to: y.high }, size);

/** Let a pointer on a figure move the time. */
function scrubOn(canvas) {
  const follow = ({ offsetX }) => {
    const { x, width } = canvas.frame;
    const { begin, end } = page.scene;
    const t = begin + ((offsetX - x) / width) * (end - begin);
    goTo(t);
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    follow(event);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (event.buttons) {
      follow(event);
    }
  });
}

/** Set a caption: the title, and each curve with its value at the time shown. */
function setCaption(element, title, entries) {
  if (element.children.length !== entries.length + 1) {
    const labels = entries.map(() =>
      makeElement("span", {}, makeElement("i"), ""),
    );
    element.replaceChildren(makeElement("strong"), ...labels);
  }
  setText(element.firstChild, title);
  entries.forEach(([text, colour], k) => {
    const { firstChild: swatch, lastChild: label } = element.children[k + 1];
    if (label.data !== text) {
      label.data = text;
    }
    swatch.style.borderColor = colour;
  });
}

// Over time -------------------------------------------------------------------------------

/** Draw all figures; their elements are made anew only if there are others. */
function drawPlots(holder, scene, t, theme) {
  drawRestitutionCurves(scene, theme);
  const keys = scene.plots.map(({ key }) => key).join();
  if (holder.dataset.keys !== keys) {
    holder.dataset.keys = keys;
    holder.replaceChildren(...scene.plots.map(makeFigure));
    holder.querySelectorAll("canvas").forEach(scrubOn);
  }
  scene.plots.forEach((plot, i) => {
    const [caption, canvas] = holder.children[i].children;
    setCaption(caption, plot.title, labelsOfCurves(plot, t, theme));
    canvas.frame = drawPlot(new CanvasPen(canvas), plot, scene, t, theme);
  });
}

/** A new figure with a caption and a canvas. */
function makeFigure({ key, title }) {
  const canvas = makeElement("canvas", {
    role: "img",
    "aria-label": `${title} over time`,
  });
  const caption = makeElement("figcaption");
  return makeElement("figure", { id: `plot-${key}` }, caption, canvas);
}

/** Text and colour of each curve of a figure, with its value at time t. */
function labelsOfCurves({ series, unit }, t, theme) {
  const zero = ROUNDING_OF_CURVES * largestOf(series.flatMap(({ y }) => y));
  return series.map((curve, k) => {
    const { colour } = styleOfCurve(k, theme);
    if (page.isPrinting) {
      return [curve.name, colour];
    }
    let value = valueAt(curve, t);
    if (Math.abs(value) < zero) {
      value = 0;
    }
    return [`${curve.name}: ${quantity(value, unit, 3)}`, colour];
  });
}

/** Draw one figure of curves over time; returns its frame. */
function drawPlot(pen, { series, unit }, { begin, end }, t, theme) {
  const [low, high] = plotRange(series);
  const axes = {
    x: { low: begin, high: end, unit: "s", name: "time" },
    y: { low, high, unit, name: "" },
  };
  const frame = frameOfPlot(pen, axes, theme);
  pen.inside(frame.x, frame.y - 2, frame.width, frame.height + 4, () => {
    const zero = frame.up(0);
    pen.segment([frame.x, zero], [frame.right, zero], theme.line);
    series.forEach((curve, k) => {
      const { colour, dash } = styleOfCurve(k, theme);
      const points = curve.t.map((time, i) => [
        frame.across(time),
        frame.up(curve.y[i]),
      ]);
      pen.line(points, colour, 2, dash);
    });
    if (page.isPrinting) {
      return;
    }
    const x = frame.across(t);
    pen.segment([x, frame.y], [x, frame.bottom], theme.accent, 2);
  });
  drawAxes(pen, frame, theme, axes);
  return frame;
}

// e over one number -----------------------------------------------------------------------

/** Draw e over l1/l2, and over the roundness of the ends. */
function drawRestitutionCurves(scene, theme) {
  const { curve, ratio, roundness } = scene;
  byId("plot-curve").hidden = !curve;
  byId("plot-roundness").hidden = !roundness;
  if (curve) {
    const texts = {
      title: "e over l₁/l₂",
      name: "l₁/l₂",
      label: `here l₁/l₂ = ${plainNumber(ratio, 4)}`,
    };
    const lengths = { ...curve, here: ratio, low: 0 };
    drawRestitution("curve", lengths, texts, scene, theme);
  }
  if (roundness) {
    const isRigid = roundness.here === null;
    const kappa = isRigid ? "" : plainNumber(10 ** roundness.here, 3);
    const texts = {
      title: "e over the roundness of the ends",
      name: "log₁₀ κ, κ = stiffness of ends / rod",
      label: isRigid ? "rigid ends: κ is infinite" : `here κ = ${kappa}`,
    };
    const ends = { ...roundness, low: roundness.points[0] };
    drawRestitution("roundness", ends, texts, scene, theme);
    const slider = byId("ends");
    if (document.activeElement !== slider) {
      slider.value = roundness.here ?? slider.max;
    }
    slider.setAttribute("aria-valuetext", isRigid ? "rigid" : `kappa ${kappa}`);
  }
}

/** Draw a curve of e, and the collision shown as a dot on it. */
function drawRestitution(id, curve, texts, { restitution }, theme) {
  const { points, values, isOutdated, here, low } = curve;
  const caption = byId(`plot-${id}`).firstElementChild;
  setCaption(caption, texts.title, [[texts.label, theme.accent]]);
  const pen = new CanvasPen(byId(id));
  if (points.length === 0) {
    return;
  }
  const high = points.at(-1);
  const largest = Math.max(1, ...values.filter((e) => e !== null));
  const axes = {
    x: { low, high, unit: "", name: texts.name },
    y: { low: 0, high: 1.08 * largest, unit: "", name: "e" },
  };
  const frame = frameOfPlot(pen, axes, theme);
  const colour = isOutdated ? theme.line : theme.series[0];
  for (const stroke of strokesOf(points, values)) {
    const line = stroke.map(([x, e]) => [frame.across(x), frame.up(e)]);
    pen.line(line, colour, 2);
  }
  const e = restitution.value;
  const margin = 0.01 * (high - low); // a slider at its end may be outside by rounding
  const isInside = here >= low - margin && here <= high + margin;
  if (e !== null && here !== null && isInside) {
    const x = frame.across(here);
    pen.disc(x, frame.up(e), 0.42 * theme.size, theme.accent);
  }
  drawAxes(pen, frame, theme, axes);
}

/** Points [x, e] of the parts of a curve between places where there is no e. */
function strokesOf(points, values) {
  let stroke = [];
  const strokes = [stroke];
  points.forEach((x, i) => {
    if (values[i] === null) {
      stroke = [];
      strokes.push(stroke);
    } else {
      stroke.push([x, values[i]]);
    }
  });
  return strokes.filter(({ length }) => length > 0);
}

/** Let a slider round the ends, which then meet by Hertz's law; its right end is rigid. */
function connectRoundness() {
  byId("ends").addEventListener("input", ({ target }) => {
    const [contact = {}] = listOf(design.case.contacts);
    const { gap = 0, law: lawBefore = "rigid" } = contact;
    if (target.value === target.max) {
      design.case.contacts = [{ gap, law: "rigid" }];
      if (lawBefore !== "rigid") {
        designChanged(true);
      }
      return;
    }
    const kappa = 10 ** target.valueAsNumber;
    const { unit } = page.scene.roundness;
    const stiffness = Number((unit * kappa).toPrecision(3));
    design.case.contacts = [{ gap, law: "hertz", stiffness }];
    if (lawBefore === "hertz") {
      const number = toShown(stiffness, FIELDS.hertz.power);
      enterNumber("contacts.0.stiffness", number);
    } else {
      designChanged(true);
    }
  });
}

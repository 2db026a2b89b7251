"use strict";
// The rods, masses and walls at one time, above the diagram: its polygons, cut there.
// Begin with `drawRods`.

const SWELLING = 0.22; // growth of the radius where a rod is compressed most
const ARROW_LENGTH = 0.11; // part of the width: the arrow of the largest velocity

/**
 * Draw the bodies at time t, on the axis of the diagram.
 *
 * Returns the strip: its `frame`, the `middle` and the `radius` of rods, the `ends` of the
 * bodies, and the `gauges` and `arrows` that were drawn.
 */
function drawRods(pen, scene, look, t, theme) {
  const { view, quantity: name } = look;
  const strip = {
    frame: frameOf(pen, view, theme.size, scene),
    middle: 0.57 * pen.height,
    radius: 0.19 * pen.height,
    ends: endsAt(scene, t, look),
    outlines: new Map(), // steps [x, radius] along each rod
    gauges: [],
    arrows: [],
  };
  const { frame } = strip;
  pen.inside(frame.x, 0, frame.width, pen.height, () => {
    const isSmooth = scene.grids && t > 0;
    drawCuts(pen, scene, strip, look, t, theme);
    if (isSmooth) {
      drawRodsOfGrids(pen, scene, strip, name, t, theme);
    }
    outlineBodies(pen, scene, strip, theme);
    const textOf = t <= 0 ? velocityText : () => "";
    const names = { frame, ends: strip.ends, y: 0.7 * theme.size };
    nameBodies(pen, scene, names, theme, textOf);
    drawArrows(pen, scene, strip, t, theme);
    if (t <= 0) {
      drawLengths(pen, scene, strip, theme);
    }
    for (const contact of scene.contacts) {
      drawContactOfRods(pen, strip, contact, t, theme);
    }
    drawGauges(pen, scene, strip, theme);
  });
  return strip;
}

/** Text on the velocity of a body before contact; "" if it has several. */
const velocityText = ({ approach }) =>
  approach === null ? "" : `, ${quantity(approach, "m/s", 3)}`;

/** Pieces of rods between fronts; they swell where they are compressed. */
function drawCuts(pen, scene, strip, look, t, theme) {
  const { frame, middle, radius, outlines } = strip;
  const hasGrids = scene.grids && t > 0; // they have the colours
  const { tiling } = scene;
  const places = placesOf(scene, look.isDisplaced);
  for (const { polygon, low, high } of cutPolygons(scene, t, places)) {
    const body = tiling.body[polygon];
    const first = tiling.start[polygon];
    const x = (tiling.x[first] + tiling.x[first + 1]) / 2;
    const swelling = SWELLING * fractionOf(scene, "stress", polygon);
    const height = radius * radiusAt(scene, body, x) * (1 - swelling);
    const left = frame.across(low);
    const right = frame.across(high);
    const steps = outlines.get(body) || [];
    steps.push([left, height], [right, height]);
    outlines.set(body, steps);
    if (hasGrids) {
      continue;
    }
    const value = fractionOf(scene, look.quantity, polygon);
    const fill = css(colourOf(value, theme));
    const topLeft = [left, middle - height];
    pen.rectangle(topLeft, [right, middle + height], fill, fill, 0.5);
  }
}

/** Outlines of rods; masses and walls are filled. */
function outlineBodies(pen, scene, strip, theme) {
  const { frame, middle, radius, ends, outlines } = strip;
  const fills = { rod: "transparent", mass: theme.faint, wall: theme.line };
  scene.bodies.forEach(({ kind }, i) => {
    const [left, right] = ends.get(i).map(frame.across);
    const edge = outlines.get(i) || [
      [left, radius],
      [right, radius],
    ];
    const upper = edge.map(([x, height]) => [x, middle - height]);
    const lower = edge.map(([x, height]) => [x, middle + height]).reverse();
    pen.polygon([...upper, ...lower], fills[kind], theme.ink, 1.2);
  });
}

/** Names above the bodies: each as much of its name as there is room for. */
function nameBodies(pen, scene, { frame, ends, y }, theme, textOf = () => "") {
  const size = 0.8 * theme.size;
  const seen = scene.bodies.map((_, i) => {
    const [left, right] = ends.get(i).map(frame.across);
    return [Math.max(left, frame.x), Math.min(right, frame.right)];
  });
  const centres = seen.map(([left, right]) => (left + right) / 2);
  scene.bodies.forEach((body, i) => {
    const [seenLeft, seenRight] = seen[i];
    if (seenRight < seenLeft) {
      return;
    }
    const isLast = i === centres.length - 1;
    let left = 0;
    let right = pen.width;
    if (i > 0) {
      left = (centres[i - 1] + centres[i]) / 2;
    }
    if (!isLast) {
      right = (centres[i] + centres[i + 1]) / 2;
    }
    const { kind, title, number } = body;
    const whole = kind === "wall" ? title : title + textOf(body);
    for (const text of [whole, title, number]) {
      const half = (0.58 * size * text.length) / 2;
      const inside = Math.min(centres[i], frame.right - half);
      const x = Math.max(inside, frame.x + half);
      const room = half + size / 2;
      if (x - room >= left && x + room <= right) {
        pen.text(x, y, text, { size, colour: theme.faint, align: "center" });
        return;
      }
    }
  });
}

/** Mean velocities as arrows above rods and masses; before contact they can be dragged. */
function drawArrows(pen, scene, strip, t, theme) {
  const { frame, middle, radius, ends, arrows } = strip;
  const top = middle - radius * (1 + SWELLING) - 0.3 * theme.size;
  const y = Math.min(1.75 * theme.size, top);
  if (!page.isDragging) {
    const fastest = scene.largest.velocity || 1;
    page.arrowScale = (ARROW_LENGTH * frame.width) / fastest;
  }
  const bodies = [];
  scene.bodies.forEach(({ kind }, body) => {
    if (kind !== "wall") {
      bodies.push(body);
    }
  });
  bodies.forEach((body, k) => {
    const { approach } = scene.bodies[body];
    const canDrag = t <= 0 && approach !== null;
    const velocity = canDrag
      ? approach
      : meanVelocity(scene, scene.centres[k], t);
    const [left, right] = ends.get(body);
    const x = frame.across((left + right) / 2);
    const tip = x + page.arrowScale * velocity;
    drawArrow(pen, x, tip, y, t <= 0, theme);
    if (canDrag) {
      arrows.push({ body, tip, y });
    }
  });
}

/** Velocity of a centre of mass at time t: the slope of its path in the picture. */
function meanVelocity(scene, path, t) {
  const step = 0.004 * (scene.end - scene.begin);
  const from = Math.max(path.t[0], t - step);
  const to = Math.min(path.t.at(-1), t + step);
  const slope = (valueAt(path, to) - valueAt(path, from)) / (to - from);
  return scene.row.frame + slope / scene.row.magnification;
}

/** An arrow; a short one is a dot, which can be dragged, or nothing. */
function drawArrow(pen, x, tip, y, hasDot, theme) {
  const [colour] = theme.series;
  const size = 0.36 * theme.size;
  if (Math.abs(tip - x) < 3) {
    if (hasDot) {
      pen.disc(x, y, size, colour);
    }
    return;
  }
  const head = Math.sign(tip - x) * size;
  pen.segment([x, y], [tip - head, y], colour, 2.4);
  pen.triangle(tip + head, tip - head, y, size, colour);
}

/** Lengths of the rods below them, between arrow heads, where there is room. */
function drawLengths(pen, scene, strip, theme) {
  const { frame, middle, radius, ends } = strip;
  const y = middle + radius * (1 + SWELLING) + 0.9 * theme.size;
  const head = 0.3 * theme.size;
  const size = 0.8 * theme.size;
  scene.bodies.forEach(({ kind, number }, body) => {
    if (kind !== "rod") {
      return;
    }
    const [left, right] = ends.get(body).map(frame.across);
    const length = quantity(scene.lengths[body], "m");
    const texts = [`l${subscript(number)} = ${length}`, length];
    const room = right - left - 5 * head;
    const text = texts.find((label) => 0.6 * size * label.length < room);
    pen.segment([left, y], [right, y], theme.faint);
    pen.triangle(left, left + 2 * head, y, head, theme.faint);
    pen.triangle(right, right - 2 * head, y, head, theme.faint);
    if (!text) {
      return;
    }
    const half = 0.32 * size * text.length + 0.3 * size;
    const centre = (left + right) / 2;
    const topLeft = [centre - half, y - size];
    pen.rectangle(topLeft, [centre + half, y + size], theme.paper);
    pen.text(centre, y, text, { size, colour: theme.ink, align: "center" });
  });
}

/** A contact: arrow heads where it presses, and its spring. */
function drawContactOfRods(pen, strip, contact, t, theme) {
  if (contact.bonded) {
    return;
  }
  const { frame, middle, radius, ends } = strip;
  const leftFace = ends.get(contact.index)[1];
  const rightFace = ends.get(contact.index + 1)[0];
  const left = frame.across(leftFace);
  const right = frame.across(rightFace);
  if (contact.room) {
    const reach = Math.min(right, frame.across(leftFace + contact.room));
    const turns = [0.1, 0.3, 0.5, 0.7, 0.9].map((fraction, k) => {
      const side = k % 2 ? 0.5 : -0.5;
      return [left + fraction * (reach - left), middle + side * radius];
    });
    const spring = [[left, middle], ...turns, [reach, middle]];
    pen.line(spring, theme.ink, 1.4);
  }
  if (stateAt(contact, t) !== "pressing") {
    return;
  }
  const x = (left + right) / 2;
  const y = middle + radius * (1 + SWELLING) + 0.45 * theme.size;
  const size = 0.4 * theme.size;
  for (const side of [-1, 1]) {
    pen.triangle(x + side, x + side * 2.4 * size, y, size, theme.accent);
  }
}

/** Strain gauges on the rods: triangles that point at them. */
function drawGauges(pen, scene, strip, theme) {
  const { frame, middle, radius, ends, gauges } = strip;
  const size = 0.4 * theme.size;
  for (const { body, fraction } of scene.gauges) {
    const [low, high] = ends.get(body);
    const x = frame.across(low + fraction * (high - low));
    const length = scene.lengths[body];
    const top = middle - radius * radiusAt(scene, body, fraction * length);
    gauges.push([x, top]);
  }
  for (const [x, top] of gauges) {
    const corners = [
      [x, top + size],
      [x - size, top - 0.6 * size],
      [x + size, top - 0.6 * size],
    ];
    pen.polygon(corners, theme.series[0], theme.paper, 1);
  }
}

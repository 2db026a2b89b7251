"use strict";
// The rods, masses and walls at one time: the polygons of the diagram, cut there.

const THICKER = 0.22; // of a rod, where it is compressed most
const ARROW = 0.11; // of the width: an arrow of the largest velocity

/** The rods, masses and walls at one time, below the diagram and on the same axis; where all is. */
function drawRods(pen, scene, look, now, theme) {
  const { view, quantity: name, displaced } = look;
  const frame = frameOf(pen, view, theme.size, scene);
  const [middle, half] = [0.57 * pen.height, 0.19 * pen.height];
  const [gauges, ends, outlines] = [[], endsAt(scene, now, look), new Map()];
  const strip = { frame, middle, half, gauges, ends, outlines, arrows: [] };
  pen.inside(frame.x, 0, frame.width, pen.height, () => {
    for (const { polygon, low, high } of slice(
      scene,
      now,
      placesOf(scene, displaced),
    )) {
      const body = scene.tiling.body[polygon];
      const x =
        (scene.tiling.x[scene.tiling.start[polygon]] +
          scene.tiling.x[scene.tiling.start[polygon] + 1]) /
        2;
      const thick =
        half *
        widthAt(scene, body, x) *
        (1 - THICKER * shareOf(scene, "stress", polygon));
      const box = [low, high].map((place) => [frame.across(place), thick]);
      outlines.set(body, [...(outlines.get(body) || []), ...box]);
      if (scene.grids && now > 0) continue;
      const [[x0], [x1]] = box;
      const fill = css(colourOf(shareOf(scene, name, polygon), theme));
      pen.polygon(
        [
          [x0, middle - thick],
          [x1, middle - thick],
          [x1, middle + thick],
          [x0, middle + thick],
        ],
        fill,
        fill,
        0.5,
      );
    }
    if (scene.grids && now > 0) drawSlices(pen, scene, strip, name, now, theme);
    scene.bodies.forEach((body, i) => {
      const [x0, x1] = ends.get(i).map(frame.across);
      const fill = body.path
        ? body.kind === "mass"
          ? theme.faint
          : theme.line
        : "transparent";
      const upper = outlines.get(i) || [
        [x0, half],
        [x1, half],
      ];
      pen.polygon(
        [
          ...upper.map(([x, h]) => [x, middle - h]),
          ...upper.map(([x, h]) => [x, middle + h]).reverse(),
        ],
        fill,
        theme.ink,
        1.2,
      );
    });
    nameBodies(
      pen,
      scene,
      frame,
      ends,
      0.7 * theme.size,
      theme,
      now <= 0
        ? ({ approach }) =>
            approach === null ? "" : `, ${quantity(approach, "m/s", 3)}`
        : null,
    );
    drawArrows(pen, scene, strip, now, theme);
    if (now <= 0) drawLengths(pen, scene, strip, theme);
    for (const contact of scene.contacts)
      drawContact(pen, strip, contact, now, theme);
    for (const { body, fraction } of scene.gauges) {
      const [low, high] = ends.get(body);
      gauges.push([
        frame.across(low + fraction * (high - low)),
        middle - half * widthAt(scene, body, fraction * scene.lengths[body]),
      ]);
    }
    for (const [x, y] of gauges) drawGauge(pen, x, y, theme);
  });
  return strip;
}

const placesOf = (scene, displaced) => (displaced ? scene.place : scene.rest);

/** Least and largest of the values of a polygon at time t. */
function chord({ tiling: { start, t: times } }, i, t, values) {
  let [low, high] = [Infinity, -Infinity];
  for (let k = start[i]; k < start[i + 1]; k += 1) {
    const next = k + 1 < start[i + 1] ? k + 1 : start[i];
    const [a, b] = [times[k], times[next]];
    if ((a - t) * (b - t) > 0) continue;
    const value =
      values[k] +
      (values[next] - values[k]) * (a === b ? 0 : (t - a) / (b - a));
    [low, high] = [Math.min(low, value), Math.max(high, value)];
  }
  return [low, high];
}

/** Cut the polygons at time t: pieces of rods, from left to right, each with its polygon. */
function slice(scene, t, places = scene.place) {
  const pieces = [];
  for (let i = 0; i < scene.tiling.body.length; i += 1) {
    const [low, high] = chord(scene, i, t, places);
    if (high - low > 1e-9 * scene.length)
      pieces.push({ polygon: i, low, high });
  }
  return pieces.sort((a, b) => a.low - b.low);
}

/** Left and right end of every body at time t. */
function endsAt(scene, t, { view, displaced }) {
  const ends = new Map();
  for (const { polygon, low, high } of slice(
    scene,
    t,
    placesOf(scene, displaced),
  )) {
    const body = scene.tiling.body[polygon];
    const [least, most] = ends.get(body) || [low, high];
    ends.set(body, [Math.min(least, low), Math.max(most, high)]);
  }
  scene.bodies.forEach((body, i) => {
    if (body.path) ends.set(i, endsOfSolid(scene, i, t, view, displaced));
  });
  return ends;
}

/** Rods of cells, smooth from end to end. */
function drawSlices(
  pen,
  scene,
  { frame, middle, half, ends, outlines },
  name,
  now,
  theme,
) {
  for (const grid of scene.grids) {
    const [low, high] = ends.get(grid.body);
    const long = scene.lengths[grid.body];
    const [x0, x1] = [grid.left, grid.right].map((x) =>
      frame.across(low + ((high - low) * x) / long),
    );
    const row = Math.max(
      0,
      Math.min(grid.rows - 1, (now / scene.end) * grid.rows - 0.5),
    );
    const thickest = half * (1 + THICKER);
    pen.image(
      imageOf(scene, grid, name, theme, row),
      x0,
      middle - thickest,
      x1 - x0,
      2 * thickest,
    );
  }
  for (const [body, points] of outlines) {
    // hide what is outside of the outline
    const smooth = points
      .filter((_, k) => k % 2 === 0)
      .map(([x, h], k) => [(x + points[2 * k + 1][0]) / 2, h]);
    const outline = [
      [points[0][0], smooth[0][1]],
      ...smooth,
      [points.at(-1)[0], smooth.at(-1)[1]],
    ];
    outlines.set(body, outline);
    for (const side of [-1, 1]) {
      const edge = middle + side * half * (1 + 2 * THICKER);
      pen.polygon(
        [
          ...outline.map(([x, h]) => [x, middle + side * h]),
          [outline.at(-1)[0] + 1, edge],
          [outline[0][0] - 1, edge],
        ],
        theme.paper,
        theme.paper,
        1,
      );
    }
  }
}

/** Velocity of each rod and mass as a whole: an arrow above it; before they meet it can be dragged. */
function drawArrows(
  pen,
  scene,
  { frame, middle, half, ends, arrows },
  now,
  theme,
) {
  const y = Math.min(
    1.75 * theme.size,
    middle - half * (1 + THICKER) - 0.3 * theme.size,
  );
  if (!shown.held)
    shown.arrow = (ARROW * frame.width) / (scene.own.velocity || 1);
  const h = 0.004 * (scene.end - scene.begin);
  let k = 0;
  scene.bodies.forEach(({ kind, approach }, body) => {
    if (kind === "wall") return;
    const path = scene.centres[k++];
    const [from, to] = [
      Math.max(path.t[0], now - h),
      Math.min(path.t.at(-1), now + h),
    ];
    const mean =
      scene.row.frame +
      (valueAt(path, to) - valueAt(path, from)) /
        (to - from) /
        scene.row.magnification;
    const velocity = now <= 0 && approach !== null ? approach : mean;
    const x = frame.across((ends.get(body)[0] + ends.get(body)[1]) / 2);
    const [tip, w] = [x + shown.arrow * velocity, 0.36 * theme.size];
    const way = Math.sign(tip - x);
    if (Math.abs(tip - x) < 3) {
      if (now <= 0) pen.disc(x, y, w, theme.series[0]);
    } else {
      pen.line(
        [
          [x, y],
          [tip - way * w, y],
        ],
        theme.series[0],
        2.4,
      );
      pen.polygon(
        [
          [tip + way * w, y],
          [tip - way * w, y - w],
          [tip - way * w, y + w],
        ],
        theme.series[0],
        null,
      );
    }
    if (now <= 0 && approach !== null) arrows.push({ body, tip, y });
  });
}

/** Lengths of the rods below them, between marks, where there is room. */
function drawLengths(pen, scene, { frame, middle, half, ends }, theme) {
  const [y, w, size] = [
    middle + half * (1 + THICKER) + 0.9 * theme.size,
    0.3 * theme.size,
    0.8 * theme.size,
  ];
  scene.bodies.forEach(({ kind, title }, body) => {
    if (kind !== "rod") return;
    const [x0, x1] = ends.get(body).map(frame.across);
    const long = quantity(scene.lengths[body], "m");
    const text = [`l${lowered(title.replace(/\D+/, ""))} = ${long}`, long].find(
      (said) => 0.6 * size * said.length < x1 - x0 - 6 * w,
    );
    pen.line(
      [
        [x0, y],
        [x1, y],
      ],
      theme.faint,
      1,
    );
    for (const [x, side] of [
      [x0, 1],
      [x1, -1],
    ])
      pen.polygon(
        [
          [x, y],
          [x + side * 2 * w, y - w],
          [x + side * 2 * w, y + w],
        ],
        theme.faint,
        null,
      );
    if (!text) return;
    const [half, centre] = [0.32 * size * text.length, (x0 + x1) / 2];
    pen.polygon(
      [
        [centre - half, y - size],
        [centre + half, y - size],
        [centre + half, y + size],
        [centre - half, y + size],
      ],
      theme.paper,
      null,
    );
    pen.text(centre, y, text, { size, colour: theme.ink, align: "center" });
  });
}

/** Names above the rods: each as much of its name as there is room for. */
function nameBodies(pen, scene, frame, ends, y, theme, more = null) {
  const size = 0.8 * theme.size;
  const wide = (text) => 0.58 * size * text.length;
  const seen = scene.bodies.map((_, i) => {
    const [x0, x1] = ends.get(i).map(frame.across);
    return [Math.max(x0, frame.x), Math.min(x1, frame.right)];
  });
  const centres = seen.map(([from, to]) => (from + to) / 2);
  scene.bodies.forEach((body, i) => {
    const [from, to] = seen[i];
    if (to < from) return;
    const left = i > 0 ? (centres[i - 1] + centres[i]) / 2 : 0;
    const last = i === centres.length - 1;
    const right = last ? pen.width : (centres[i] + centres[i + 1]) / 2;
    const { kind, title } = body;
    const whole = title + (more && kind !== "wall" ? more(body) : "");
    for (const text of [whole, title, title.replace(/\D+/, "")]) {
      const half = wide(text) / 2;
      const inside = Math.min(centres[i], frame.right - half);
      const x = Math.max(inside, frame.x + half);
      if (x - half - size / 2 < left || x + half + size / 2 > right) continue;
      pen.text(x, y, text, { size, colour: theme.faint, align: "center" });
      return;
    }
  });
}

function endsOfSolid(scene, i, now, view, displaced) {
  const body = scene.bodies[i];
  const face = displaced
    ? valueAt(pathOf(scene, i, 0, body.path), now)
    : scene.row.left[i];
  if (body.kind === "mass") return [face, face + scene.lengths[i]];
  const deep = 0.06 * (view.right - view.left);
  return i ? [face, face + deep] : [face - deep, face];
}

/** A contact of the strip: arrow heads where it presses, a spring where it has one. */
function drawContact(pen, { frame, middle, half, ends }, contact, now, theme) {
  if (contact.bonded) return;
  const [left, right] = [ends.get(contact.index), ends.get(contact.index + 1)];
  const [x0, x1] = [frame.across(left[1]), frame.across(right[0])];
  if (contact.room) {
    const reach = Math.min(x1, frame.across(left[1] + contact.room));
    const turns = [0.1, 0.3, 0.5, 0.7, 0.9].map((share, k) => [
      x0 + share * (reach - x0),
      middle + (k % 2 ? 0.5 : -0.5) * half,
    ]);
    pen.line([[x0, middle], ...turns, [reach, middle]], theme.ink, 1.4);
  }
  if (stateAt(contact, now) !== "pressing") return;
  const [x, y, w] = [
    (x0 + x1) / 2,
    middle + half * (1 + THICKER) + 0.45 * theme.size,
    0.4 * theme.size,
  ];
  for (const side of [-1, 1])
    pen.polygon(
      [
        [x + side, y],
        [x + side * 2.4 * w, y - w],
        [x + side * 2.4 * w, y + w],
      ],
      theme.wrong,
      null,
    );
}

function drawGauge(pen, x, top, theme) {
  const w = 0.4 * theme.size;
  pen.polygon(
    [
      [x, top + w],
      [x - w, top - 0.6 * w],
      [x + w, top - 0.6 * w],
    ],
    theme.series[0],
    theme.paper,
    1,
  );
}

"use strict";
// The row in space and time: polygons in the colours of their values, contacts, axes.

const STOPS = {
  // blue, nearly the paper's colour at 0, yellow
  light: [
    [22, 37, 110],
    [112, 132, 196],
    [244, 244, 241],
    [238, 198, 84],
    [196, 134, 0],
  ],
  dark: [
    [157, 183, 255],
    [78, 98, 160],
    [38, 43, 51],
    [150, 122, 48],
    [255, 233, 74],
  ],
};
const UNITS = { velocity: "m/s", stress: "Pa" };
const SPARSE = 80; // polygons, to write values into
const SHADES = 256; // of a smooth picture
const [EDGE, WALL] = [0.02, 0.055]; // beside the row, and where a wall is drawn: in its lengths
const FORCE = { from: 40, width: 7.5 }; // the force stands beside a diagram so wide, so wide: in heights of letters
const FAINT = 1e-9; // of the largest value: the legend calls it 0
const CROWDED = 400; // polygons from which lines would hide the colours

/** Colour of a number from -1 to 1. */
function colourOf(share, { stops }) {
  const at = Math.max(0, Math.min(1, (share + 1) / 2)) * (stops.length - 1);
  const i = Math.min(stops.length - 2, Math.floor(at));
  return stops[i].map((c, k) =>
    Math.round(c + (stops[i + 1][k] - c) * (at - i)),
  );
}

const css = (colour) => `rgb(${colour.join(",")})`;

const isDark = ([red, green, blue]) =>
  0.3 * red + 0.59 * green + 0.11 * blue < 115;

function shareOf(scene, name, polygon) {
  const reach = scene.reach[name];
  return reach > 0 ? scene.tiling[name][polygon] / reach : 0;
}

/** What all of the scene needs: places from left to right, times from first to last. */
function wholeView(scene) {
  const [low, high] = shown.displaced ? scene.row.span : scene.whole;
  const [first, last] = [scene.bodies[0], scene.bodies.at(-1)].map(
    ({ kind }) => (kind === "wall" ? WALL : EDGE) * (high - low),
  );
  return {
    left: low - first,
    right: high + last,
    from: filmSpan().begin,
    to: filmSpan().end,
  };
}

/** A frame in a drawing, with room for the names and marks of a scene; the pixels of places and times in it. */
function frameOf(pen, view, size, scene = null) {
  const [top, edge] = [
    scene && pen.named ? 1.6 : 0.6,
    scene && scene.marks.length ? 2.9 : 0.8,
  ];
  const beside =
    scene && pen.width > FORCE.from * size ? FORCE.width * size : 0;
  const frame = {
    x: 4.2 * size,
    y: top * size,
    right: pen.width - edge * size - beside,
    bottom: pen.height - 3.2 * size,
  };
  if (beside)
    frame.force = {
      x: pen.width - beside + 0.6 * size,
      right: pen.width - 0.9 * size,
    };
  frame.width = Math.max(1, frame.right - frame.x);
  frame.height = Math.max(1, frame.bottom - frame.y);
  frame.across = (place) =>
    frame.x + ((place - view.left) / (view.right - view.left)) * frame.width;
  frame.up = (t) =>
    frame.bottom - ((t - view.from) / (view.to - view.from)) * frame.height;
  frame.placeAt = (px) =>
    view.left + ((px - frame.x) / frame.width) * (view.right - view.left);
  frame.timeAt = (py) =>
    view.from + ((frame.bottom - py) / frame.height) * (view.to - view.from);
  return frame;
}

function cornersOf(scene, i, frame) {
  const corners = [];
  for (let k = scene.tiling.start[i]; k < scene.tiling.start[i + 1]; k += 1) {
    corners.push([frame.across(frame.places[k]), frame.up(scene.tiling.t[k])]);
  }
  return corners;
}

/** Write values into polygons, where there is room, above all lines. */
function writeValues(pen, scene, frame, name, theme) {
  const [power, size] = [
    powerFor(scene.reach[name], UNITS[name]),
    0.85 * theme.size,
  ];
  for (let i = 0; i < scene.tiling.body.length; i += 1) {
    const [corners, colour] = [
      cornersOf(scene, i, frame),
      colourOf(shareOf(scene, name, i), theme),
    ];
    const text = plainNumber(
      Math.round((scene.tiling[name][i] / 10 ** power) * 1e4) / 1e4,
      3,
    );
    const [x, y] = [0, 1].map(
      (axis) => corners.reduce((sum, c) => sum + c[axis], 0) / corners.length,
    );
    const [half, tall] = [0.3 * size * text.length + 3, 0.6 * size];
    const wide = [y - tall, y + tall].map((at) =>
      chord(scene, i, frame.timeAt(at), frame.places).map(frame.across),
    );
    if (!wide.every(([low, high]) => low <= x - half && high >= x + half))
      continue;
    pen.polygon(
      [
        [x - half, y - tall],
        [x + half, y - tall],
        [x + half, y + tall],
        [x - half, y + tall],
      ],
      css(colour),
      null,
    );
    pen.text(x, y, text, {
      size,
      colour: isDark(colour) ? "#ffffff" : "#101010",
      align: "center",
    });
  }
}

/** Paths of walls and masses through space and time. */
function drawSolids(pen, scene, frame, theme) {
  scene.bodies.forEach(({ path, kind }, i) => {
    if (!path) return;
    const along = (x) =>
      pathOf(scene, i, x, path).y.map((place, k) => [
        frame.across(frame.displaced ? place : scene.row.left[i] + x),
        frame.up(path.t[k]),
      ]);
    const near = along(0);
    const far =
      kind === "mass"
        ? along(scene.lengths[i])
        : near.map(([, y]) => [i ? pen.width : 0, y]);
    pen.polygon(
      [...near, ...far.reverse()],
      kind === "mass" ? theme.faint : theme.line,
      theme.ink,
      0.7,
    );
  });
}

/** Cells as one smooth picture each; `row` picks one time, interpolated. */
function imageOf(scene, grid, name, theme, row = null) {
  const { across, first } = grid;
  const high = row === null ? grid.rows : 1;
  const image = document.createElement("canvas");
  Object.assign(image, { width: across, height: high });
  const pixels = new ImageData(across, high);
  const colours = Array.from({ length: SHADES + 1 }, (_, k) => [
    ...colourOf((2 * k) / SHADES - 1, theme),
    255,
  ]);
  for (let j = 0; j < high; j += 1) {
    const from = row === null ? high - 1 - j : Math.floor(row);
    const next = row === null ? from : Math.min(grid.rows - 1, from + 1);
    for (let i = 0; i < across; i += 1) {
      let share = shareOf(scene, name, first + from * across + i);
      if (row !== null)
        share +=
          (shareOf(scene, name, first + next * across + i) - share) *
          (row - from);
      pixels.data.set(
        colours[Math.round(((share + 1) / 2) * SHADES)],
        4 * (j * across + i),
      );
    }
  }
  image.getContext("2d").putImageData(pixels, 0, 0);
  return image;
}

/** The picture of a grid between the ends of its segment, as they move. */
function displacedImage(scene, grid, image, frame) {
  const canvas = make("canvas", {
    width: Math.ceil(frame.width),
    height: Math.ceil(frame.height),
  });
  const smooth = make("canvas", {
    width: 4 * grid.across,
    height: 8 * grid.rows,
  });
  smooth.getContext("2d").drawImage(image, 0, 0, smooth.width, smooth.height);
  const pen = canvas.getContext("2d");
  for (let y = 0; y < canvas.height; y += 1) {
    const share = frame.timeAt(frame.y + y + 0.5) / scene.end;
    if (share < 0 || share >= 1) continue;
    const row = Math.floor(share * grid.rows);
    const first = 4 * (grid.first + row * grid.across);
    const last = first + 4 * (grid.across - 1);
    const between = (low, high) =>
      frame.across(
        scene.place[low] +
          (scene.place[high] - scene.place[low]) * (share * grid.rows - row),
      ) - frame.x;
    const [x0, x1] = [between(first, first + 3), between(last + 1, last + 2)];
    const inside = Math.max(4, (1 - share) * smooth.height); // edges of a scaled picture fade
    const from = Math.min(smooth.height - 5, inside);
    pen.drawImage(smooth, 0, from, smooth.width, 1, x0, y, x1 - x0, 1);
  }
  return canvas;
}

function drawGrids(pen, scene, frame, name, theme) {
  const key = name + theme.name;
  for (const grid of scene.grids) {
    grid.images ||= {};
    grid.images[key] ||= imageOf(scene, grid, name, theme);
    if (frame.displaced) {
      const at = [
        key,
        pen.width,
        pen.height,
        frame.placeAt(0),
        frame.placeAt(1),
        frame.timeAt(0),
        frame.timeAt(1),
      ].join();
      if (grid.at !== at)
        Object.assign(grid, {
          at,
          moved: displacedImage(scene, grid, grid.images[key], frame),
        });
      pen.image(grid.moved, frame.x, frame.y, frame.width, frame.height);
      continue;
    }
    const [x0, x1] = [grid.left, grid.right].map((x) =>
      frame.across(scene.row.left[grid.body] + x),
    );
    const [y0, y1] = [frame.up(scene.end), frame.up(0)];
    pen.image(grid.images[key], x0, y0, x1 - x0, y1 - y0);
  }
}

/** Polygons of one colour each, with lines between them where they are few. */
function drawPolygons(pen, scene, frame, name, theme, from) {
  const count = scene.tiling.body.length;
  const draw = (lineOf) => {
    for (let i = from; i < count; i += 1) {
      const fill = css(colourOf(shareOf(scene, name, i), theme));
      pen.polygon(cornersOf(scene, i, frame), fill, lineOf(fill), 0.7);
    }
  };
  if (scene.grids) draw((fill) => fill);
  else if (count > CROWDED) pen.seamless(() => draw(() => null));
  else draw(() => theme.ink);
}

/** Edges of rods that stay where they are. */
function outlineRods(pen, scene, frame, theme) {
  const [y0, y1] = [frame.up(scene.begin), frame.up(scene.end)];
  scene.bodies.forEach(({ path }, i) => {
    const [x0, x1] = [0, scene.lengths[i]].map((x) =>
      frame.across(scene.row.left[i] + x),
    );
    if (!path)
      pen.line(
        [
          [x0, y0],
          [x0, y1],
          [x1, y1],
          [x1, y0],
        ],
        theme.ink,
        0.7,
      );
  });
}

/** A spring in the diagram: the darker, the harder it presses. */
function drawSpring(pen, frame, contact, faces, { from, to }, theme) {
  const most = largestOf(contact.force.y);
  for (let k = 0; k < 40; k += 1) {
    const [t0, t1] = [
      from + ((to - from) * k) / 40,
      from + ((to - from) * (k + 1)) / 40,
    ];
    const share = Math.abs(valueAt(contact.force, (t0 + t1) / 2)) / most;
    const shade = css(
      theme.inks.map((c, i) =>
        Math.round(theme.papers[i] + (c - theme.papers[i]) * 0.75 * share),
      ),
    );
    const corners = [
      [0, t0],
      [1, t0],
      [1, t1],
      [0, t1],
    ].map(([side, t]) => [faces[side](t), frame.up(t)]);
    pen.polygon(corners, shade, shade);
  }
}

/** Contacts over time: a thick line where they press, none where they are open; springs as bands. */
function drawContacts(pen, scene, frame, theme) {
  for (const contact of scene.contacts) {
    if (contact.bonded) continue;
    const right = scene.row.left[contact.index + 1];
    const faces = contact.faces.map(
      (face, side) => (t) =>
        frame.across(
          frame.displaced
            ? valueAt(face, t)
            : right - (side ? 0 : contact.room || 0),
        ),
    );
    for (const { from, to, state } of contact.spells) {
      if (contact.room) {
        if (state === "pressing")
          drawSpring(pen, frame, contact, faces, { from, to }, theme);
        continue;
      }
      const times = [
        from,
        ...contact.faces[1].t.filter((t) => t > from && t < to),
        to,
      ];
      const line = times.map((t) => [faces[1](t), frame.up(t)]);
      if (state === "open" && frame.displaced) continue; // the gap itself is seen
      if (state === "open") {
        pen.line(line, theme.ink, 6);
        pen.line(line, theme.paper, 4.5);
      } else pen.line(line, theme.ink, state === "pressing" ? 3.5 : 1);
    }
  }
}

/** The diagram: every polygon in the colour of its value, axes, and the chosen time, if there is one. */
function drawDiagram(pen, scene, look, now, mark, theme) {
  const { view, quantity: name, displaced } = look;
  const frame = frameOf(pen, view, theme.size, scene);
  Object.assign(frame, { displaced, places: placesOf(scene, displaced) });
  pen.inside(frame.x, frame.y, frame.width, frame.height, () => {
    drawSolids(pen, scene, frame, theme);
    if (scene.grids) drawGrids(pen, scene, frame, name, theme);
    drawPolygons(pen, scene, frame, name, theme, scene.grids ? scene.cells : 0);
    if (!displaced) outlineRods(pen, scene, frame, theme);
    drawContacts(pen, scene, frame, theme);
    for (const { t, y } of displaced ? scene.centres : []) {
      const path = t.map((at, k) => [frame.across(y[k]), frame.up(at)]);
      for (const [colour, width] of [
        [theme.paper, 3],
        [theme.ink, 1.2],
      ])
        pen.line(path, colour, width, [7, 5]);
    }
    if (scene.tiling.body.length <= SPARSE)
      writeValues(pen, scene, frame, name, theme);
    if (mark) drawMark(pen, frame, mark, theme);
  });
  const across = shown.guessing ? frame : frame.force || frame;
  if (across === frame.force) drawForceBeside(pen, scene, frame, view, theme);
  if (now !== null && !shown.printing && now >= view.from && now <= view.to)
    pen.line(
      [
        [frame.x, frame.up(now)],
        [across.right, frame.up(now)],
      ],
      theme.wrong,
      2,
    );
  if (shown.guessing)
    pen.inside(frame.x, 0, pen.width, frame.bottom, () =>
      hideFuture(pen, scene, frame, theme),
    );
  const springs = scene.contacts.some((contact) => contact.room)
    ? "springs drawn wide"
    : "";
  const note = displaced
    ? `${scene.row.note}, dashed: centres of mass`
    : "before it moves";
  drawFrame(pen, frame, theme.size, theme, {
    x: [view.left, view.right, "m", "place"],
    y: [view.from, view.to, "s", "time"],
    note: [note, springs].filter(Boolean).join(", "),
  });
  if (pen.named)
    nameBodies(
      pen,
      scene,
      frame,
      endsAt(scene, Math.min(view.to, scene.end), look),
      0.8 * theme.size,
      theme,
    );
  drawMarks(pen, scene, frame, view, theme);
  for (const { t } of shown.guessing ? [] : scene.events) {
    if (t >= view.from && t <= view.to)
      pen.disc(frame.x, frame.up(t), 0.3 * theme.size, theme.series[0]);
  }
  if (now !== null && !shown.printing)
    drawGrip(pen, frame.x, frame.up(now), theme);
  return frame;
}

/** Contact forces beside the diagram: time runs upward on its axis, so that one line crosses both. */
function drawForceBeside(pen, scene, frame, view, theme) {
  const { x, right } = frame.force;
  const [y, bottom, size] = [frame.y, frame.bottom, 0.85 * theme.size];
  const forces = scene.contacts.map(({ force }) => force);
  const [low, high] = rangeOf({ series: forces });
  const across = (force) => x + ((force - low) / (high - low)) * (right - x);
  const ink = { size, colour: theme.faint };
  const rule = (from, to) => pen.line([from, to], theme.line, 1);
  rule([across(0), y], [across(0), bottom]);
  for (const { t } of scene.marks)
    if (t >= view.from && t <= view.to)
      pen.line(
        [
          [x, frame.up(t)],
          [right, frame.up(t)],
        ],
        theme.faint,
        0.8,
        [2, 3],
      );
  pen.inside(x - 1, y, right - x + 2, bottom - y, () =>
    forces.forEach((force, k) =>
      pen.line(
        force.t.map((t, i) => [across(force.y[i]), frame.up(t)]),
        theme.series[k % theme.series.length],
        2,
        k >= theme.series.length ? [6, 3] : [],
      ),
    ),
  );
  pen.line(
    [
      [x, bottom],
      [right, bottom],
    ],
    theme.faint,
    1,
  );
  const { ticks, unit } = labelledTicks(low, high, 2, "N");
  for (const [value, label] of ticks) {
    pen.line(
      [
        [across(value), bottom],
        [across(value), bottom + 4],
      ],
      theme.faint,
      1,
    );
    pen.text(across(value), bottom + 6, label, {
      ...ink,
      align: "center",
      baseline: "top",
    });
  }
  pen.text((x + right) / 2, bottom + 1.5 * theme.size, `force, ${unit}`, {
    ...ink,
    align: "center",
    baseline: "top",
  });
}

/** What the time is dragged by. */
function drawGrip(pen, x, y, theme) {
  const w = 0.5 * theme.size;
  pen.polygon(
    [
      [x + 1.2 * w, y],
      [x - w, y - w],
      [x - w, y + w],
    ],
    theme.wrong,
    theme.paper,
    1,
  );
}

/** Cover all that follows the first touch, until e is guessed. */
function hideFuture(pen, { contacts }, frame, theme) {
  const y = frame.up(
    Math.min(
      ...contacts.map(
        ({ spells }) => spells.find(({ state }) => state !== "open").from,
      ),
    ),
  );
  pen.polygon(
    [
      [frame.x, -1],
      [pen.width, -1],
      [pen.width, y],
      [frame.x, y],
    ],
    theme.paper,
    null,
  );
  if (shown.printing) return; // a pupil draws the waves there
  pen.text((frame.x + frame.right) / 2, (frame.y + y) / 2, "?", {
    size: 5 * theme.size,
    colour: theme.faint,
    align: "center",
  });
}

/** Ticks at the right edge: when the first waves are back. */
function drawMarks(pen, { marks }, frame, view, theme) {
  let before = Infinity;
  for (const { t, text } of shown.guessing ? [] : marks) {
    if (t < view.from || t > view.to) continue;
    const y = frame.up(t);
    pen.line(
      [
        [frame.right - 6, y],
        [frame.right + 3, y],
      ],
      theme.ink,
      1.4,
    );
    before = Math.abs(y - before) < theme.size ? before - theme.size : y;
    pen.text(frame.right + 5, before, text, {
      size: 0.85 * theme.size,
      colour: theme.ink,
    });
  }
}

function drawMark(pen, frame, mark, theme) {
  const [x, y] = [frame.across(mark.place), frame.up(mark.t)];
  pen.line(
    [
      [x, frame.y],
      [x, frame.bottom],
    ],
    theme.ink,
    0.8,
    [3, 3],
  );
  pen.line(
    [
      [frame.x, y],
      [frame.right, y],
    ],
    theme.ink,
    0.8,
    [3, 3],
  );
}

/** Axes with ticks in one SI prefix each. */
function drawFrame(pen, frame, size, theme, axes) {
  const ink = { size: 0.85 * size, colour: theme.faint };
  pen.line(
    [
      [frame.x, frame.y],
      [frame.x, frame.bottom],
      [frame.right, frame.bottom],
    ],
    theme.faint,
    1,
  );
  const [x0, x1, xUnit, xName] = axes.x;
  const xs = labelledTicks(
    x0,
    x1,
    Math.max(2, frame.width / (5.5 * size)),
    xUnit,
  );
  for (const [value, label] of xs.ticks) {
    const px = frame.x + ((value - x0) / (x1 - x0)) * frame.width;
    pen.line(
      [
        [px, frame.bottom],
        [px, frame.bottom + 4],
      ],
      theme.faint,
      1,
    );
    pen.text(
      Math.min(px, pen.width - 0.33 * ink.size * label.length),
      frame.bottom + 6,
      label,
      { ...ink, align: "center", baseline: "top" },
    );
  }
  const unit = xs.unit ? `, ${xs.unit}` : "";
  const notes = axes.note
    ? [axes.note, ...axes.note.split(", ").slice(0, 1)].map(
        (note) => ` (${note})`,
      )
    : [];
  const middle = (frame.x + frame.right) / 2;
  const name =
    [...notes, ""]
      .map((note) => xName + unit + note)
      .find(
        (said) =>
          0.53 * ink.size * said.length <
          2 * Math.min(middle, pen.width - middle),
      ) || xName;
  pen.text(middle, frame.bottom + 1.5 * size, name, {
    ...ink,
    size: Math.min(
      ink.size,
      (2 * Math.min(middle, pen.width - middle)) / (0.55 * name.length),
    ),
    align: "center",
    baseline: "top",
  });
  const [y0, y1, yUnit, yName] = axes.y;
  const ys = labelledTicks(
    y0,
    y1,
    Math.max(2, frame.height / (2.6 * size)),
    yUnit,
  );
  for (const [value, label] of ys.ticks) {
    const py = frame.bottom - ((value - y0) / (y1 - y0)) * frame.height;
    pen.line(
      [
        [frame.x - 4, py],
        [frame.x, py],
      ],
      theme.faint,
      1,
    );
    pen.text(frame.x - 6, py, label, { ...ink, align: "right" });
  }
  pen.text(
    0.7 * size,
    (frame.y + frame.bottom) / 2,
    [yName, ys.unit].filter(Boolean).join(", "),
    { ...ink, align: "center", turned: true },
  );
}

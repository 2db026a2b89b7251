"use strict";
// The space-time diagram: polygons in the colours of their values, contacts, and marks.
// Begin with `drawDiagram`.

const MAX_POLYGONS_WITH_VALUES = 80; // values are written into fewer polygons only
const MAX_POLYGONS_WITH_EDGES = 400; // edges of more would hide the colours
const MARGIN = { end: 0.02, wall: 0.055 }; // space beside the row, as parts of its length
const SPRING_SHADES = 40; // polygons that draw a spring in one spell

/** View of a whole scene: places from left to right, times from first to last. */
function wholeView(scene) {
  const [low, high] = page.isDisplaced ? scene.row.span : scene.restSpan;
  const margin = ({ kind }) =>
    (kind === "wall" ? MARGIN.wall : MARGIN.end) * (high - low);
  const { begin, end } = filmSpan();
  return {
    left: low - margin(scene.bodies[0]),
    right: high + margin(scene.bodies.at(-1)),
    from: begin,
    to: end,
  };
}

/**
 * Draw the diagram; returns its frame.
 *
 * `look` has the `view`, the `quantity` that colours show, and whether points are where
 * they move to. The time t, and a mark, are null where nothing is chosen.
 */
function drawDiagram(pen, scene, look, t, mark, theme) {
  const { view, quantity: name, isDisplaced } = look;
  const frame = frameOf(pen, view, theme.size, scene);
  frame.isDisplaced = isDisplaced;
  frame.places = placesOf(scene, isDisplaced);
  pen.inside(frame.x, frame.y, frame.width, frame.height, () => {
    drawBodies(pen, scene, frame, name, theme);
    drawContacts(pen, scene, frame, theme);
    if (isDisplaced) {
      drawCentres(pen, scene, frame, theme);
    }
    if (scene.tiling.body.length <= MAX_POLYGONS_WITH_VALUES) {
      writeValues(pen, scene, frame, name, theme);
    }
    if (mark) {
      drawReadingMark(pen, frame, mark, theme);
    }
  });
  const hasForces = frame.force && !page.isGuessing;
  if (hasForces) {
    drawForces(pen, scene, frame, view, theme);
  }
  const hasTime = t !== null && !page.isPrinting;
  if (hasTime && t >= view.from && t <= view.to) {
    const y = frame.up(t);
    const right = hasForces ? frame.force.right : frame.right;
    pen.segment([frame.x, y], [right, y], theme.accent, 2);
  }
  if (page.isGuessing) {
    pen.inside(frame.x, 0, pen.width, frame.bottom, () =>
      hideFuture(pen, scene, frame, theme),
    );
  }
  drawAxes(pen, frame, theme, {
    x: {
      low: view.left,
      high: view.right,
      unit: "m",
      name: "place",
      notes: notesOfDiagram(scene, isDisplaced),
    },
    y: { low: view.from, high: view.to, unit: "s", name: "time" },
  });
  if (pen.hasNames) {
    const ends = endsAt(scene, Math.min(view.to, scene.end), look);
    nameBodies(pen, scene, { frame, ends, y: 0.8 * theme.size }, theme);
  }
  if (!page.isGuessing) {
    drawMarks(pen, scene, frame, view, theme);
    drawEvents(pen, scene, frame, view, theme);
  }
  if (hasTime) {
    drawGrip(pen, frame.x, frame.up(t), theme);
  }
  return frame;
}

/** Notes on the axis of x: how the picture differs from true scale. */
function notesOfDiagram({ row, contacts }, isDisplaced) {
  const notes = ["before it moves"];
  if (isDisplaced) {
    notes.splice(0, 1, ...row.notes, "dashed: centres of mass");
  }
  if (contacts.some(({ room }) => room)) {
    notes.push("springs drawn wide");
  } else if (contacts.some(({ bonded }) => !bonded)) {
    notes.push("thick: contact force");
  }
  return notes;
}

// Bodies ----------------------------------------------------------------------------------

/** All bodies through space and time, in the colours of the quantity of this name. */
function drawBodies(pen, scene, frame, name, theme) {
  drawSolids(pen, scene, frame, theme);
  if (scene.grids) {
    drawGrids(pen, scene, frame, name, theme);
  }
  drawPolygons(pen, scene, frame, name, theme);
  if (!frame.isDisplaced) {
    outlineRods(pen, scene, frame, theme);
  }
}

/** Paths of walls and masses through space and time. */
function drawSolids(pen, scene, frame, theme) {
  scene.bodies.forEach(({ path, kind }, i) => {
    if (!path) {
      return;
    }
    const pointsOf = (x) =>
      pathOf(scene, i, x, path).y.map((place, k) => {
        const shown = frame.isDisplaced ? place : scene.row.left[i] + x;
        return [frame.across(shown), frame.up(path.t[k])];
      });
    const near = pointsOf(0);
    if (kind === "mass") {
      const far = pointsOf(scene.lengths[i]).reverse();
      pen.polygon([...near, ...far], theme.faint, theme.ink, 0.7);
      return;
    }
    const edge = i > 0 ? pen.width : 0;
    const far = near.map(([, y]) => [edge, y]).reverse();
    pen.polygon([...near, ...far], theme.line, theme.ink, 0.7);
  });
}

/** Corners of a polygon in pixels [x, y]. */
function cornersOf({ tiling }, polygon, frame) {
  const corners = [];
  const end = tiling.start[polygon + 1];
  for (let k = tiling.start[polygon]; k < end; k += 1) {
    corners.push([frame.across(frame.places[k]), frame.up(tiling.t[k])]);
  }
  return corners;
}

/** Polygons of one colour each, with edges between them where they are few. */
function drawPolygons(pen, scene, frame, name, theme) {
  const count = scene.tiling.body.length;
  const first = scene.grids ? scene.cellCount : 0; // grids have pictures of their cells
  const drawWithEdges = (edgeOf) => {
    for (let polygon = first; polygon < count; polygon += 1) {
      const fill = css(colourOf(fractionOf(scene, name, polygon), theme));
      const corners = cornersOf(scene, polygon, frame);
      pen.polygon(corners, fill, edgeOf(fill), 0.7);
    }
  };
  if (scene.grids) {
    drawWithEdges((fill) => fill);
  } else if (count > MAX_POLYGONS_WITH_EDGES) {
    pen.seamless(() => drawWithEdges(() => null));
  } else {
    drawWithEdges(() => theme.ink);
  }
}

/** Edges of rods that stay where they are. */
function outlineRods(pen, scene, frame, theme) {
  const first = frame.up(scene.begin);
  const last = frame.up(scene.end);
  scene.bodies.forEach(({ path }, i) => {
    if (path) {
      return;
    }
    const left = frame.across(scene.row.left[i]);
    const right = frame.across(scene.row.left[i] + scene.lengths[i]);
    const corners = [
      [left, first],
      [left, last],
      [right, last],
      [right, first],
    ];
    pen.line(corners, theme.ink, 0.7);
  });
}

/** Dashed paths of the centres of mass, on a lighter line. */
function drawCentres(pen, scene, frame, theme) {
  for (const { t, y } of scene.centres) {
    const path = t.map((time, k) => [frame.across(y[k]), frame.up(time)]);
    pen.line(path, theme.paper, 3, [7, 5]);
    pen.line(path, theme.ink, 1.2, [7, 5]);
  }
}

/** Write values into polygons, where there is room, above all lines. */
function writeValues(pen, scene, frame, name, theme) {
  const power = powerFor(scene.scale[name], UNITS[name]);
  const size = 0.85 * theme.size;
  const halfHeight = 0.6 * size;
  scene.tiling.body.forEach((_, polygon) => {
    const value = scene.tiling[name][polygon] / 10 ** power;
    const text = plainNumber(Math.round(value * 1e4) / 1e4, 3);
    const halfWidth = 0.3 * size * text.length + 3;
    const [x, y] = middleOf(cornersOf(scene, polygon, frame));
    const hasRoom = [y - halfHeight, y + halfHeight].every((edge) => {
      const time = frame.timeAt(edge);
      const [low, high] = rangeAt(scene, polygon, time, frame.places);
      const left = frame.across(low);
      const right = frame.across(high);
      return left <= x - halfWidth && right >= x + halfWidth;
    });
    if (!hasRoom) {
      return;
    }
    const colour = colourOf(fractionOf(scene, name, polygon), theme);
    const topLeft = [x - halfWidth, y - halfHeight];
    const bottomRight = [x + halfWidth, y + halfHeight];
    pen.rectangle(topLeft, bottomRight, css(colour));
    pen.text(x, y, text, {
      size,
      colour: isDark(colour) ? "#ffffff" : "#101010",
      align: "center",
    });
  });
}

/** Mean of some points [x, y]. */
function middleOf(points) {
  const mean = (axis) =>
    points.reduce((sum, point) => sum + point[axis], 0) / points.length;
  return [mean(0), mean(1)];
}

// Contacts --------------------------------------------------------------------------------

/** Contacts over time: thick lines where they press, none where they are open; springs. */
function drawContacts(pen, scene, frame, theme) {
  for (const contact of scene.contacts) {
    if (contact.bonded) {
      continue;
    }
    const faces = facesInFrame(scene, contact, frame);
    for (const spell of contact.spells) {
      if (!contact.room) {
        drawSpell(pen, contact, faces[1], spell, frame, theme);
      } else if (spell.state === "pressing") {
        drawSpring(pen, contact, faces, spell, frame, theme);
      }
    }
  }
}

/** Pixels of the left and the right face of a contact, as functions of time. */
function facesInFrame(scene, contact, frame) {
  const rightPlace = scene.row.left[contact.index + 1];
  const restPlaces = [rightPlace - (contact.room || 0), rightPlace];
  return contact.faces.map((face, side) => (t) => {
    if (!frame.isDisplaced) {
      return frame.across(restPlaces[side]);
    }
    return frame.across(valueAt(face, t));
  });
}

/** A contact without a spring in one of its states. */
function drawSpell(pen, contact, rightFace, { from, to, state }, frame, theme) {
  if (state === "open" && frame.isDisplaced) {
    return;
  } // the gap itself is seen
  const inside = contact.faces[1].t.filter((t) => t > from && t < to);
  const line = [from, ...inside, to].map((t) => [rightFace(t), frame.up(t)]);
  if (state === "open") {
    pen.line(line, theme.ink, 6);
    pen.line(line, theme.paper, 4.5);
  } else {
    pen.line(line, theme.ink, state === "pressing" ? 3.5 : 1);
  }
}

/** A spring: the darker, the harder it presses. */
function drawSpring(pen, contact, [leftFace, rightFace], spell, frame, theme) {
  const { from, to } = spell;
  const peakForce = largestOf(contact.force.y);
  for (let k = 0; k < SPRING_SHADES; k += 1) {
    const start = from + ((to - from) * k) / SPRING_SHADES;
    const end = from + ((to - from) * (k + 1)) / SPRING_SHADES;
    const force = Math.abs(valueAt(contact.force, (start + end) / 2));
    const shade = css(shadeOfForce(force / peakForce, theme));
    const corners = [
      [leftFace(start), frame.up(start)],
      [rightFace(start), frame.up(start)],
      [rightFace(end), frame.up(end)],
      [leftFace(end), frame.up(end)],
    ];
    pen.polygon(corners, shade, shade);
  }
}

/** Colour of a spring: that of the paper without force, dark at the peak force. */
const shadeOfForce = (fraction, { inkChannels, paperChannels }) =>
  paperChannels.map((paper, k) =>
    Math.round(paper + (inkChannels[k] - paper) * 0.75 * fraction),
  );

/** Contact forces beside the diagram, on its axis of time, so that one line crosses both. */
function drawForces(pen, scene, frame, view, theme) {
  const { x, right } = frame.force;
  const { y, bottom } = frame;
  const forces = scene.contacts.map(({ force }) => force);
  const [low, high] = plotRange(forces);
  const across = (force) => x + ((force - low) / (high - low)) * (right - x);
  pen.segment([across(0), y], [across(0), bottom], theme.line);
  for (const { t } of scene.marks) {
    if (t >= view.from && t <= view.to) {
      const markY = frame.up(t);
      pen.segment([x, markY], [right, markY], theme.faint, 0.8, [2, 3]);
    }
  }
  pen.inside(x - 1, y, right - x + 2, bottom - y, () => {
    forces.forEach((force, k) => {
      const { colour, dash } = styleOfCurve(k, theme);
      const points = force.t.map((t, i) => [across(force.y[i]), frame.up(t)]);
      pen.line(points, colour, 2, dash);
    });
  });
  pen.segment([x, bottom], [right, bottom], theme.faint);
  const style = {
    size: 0.85 * theme.size,
    colour: theme.faint,
    align: "center",
    baseline: "top",
  };
  const { ticks, unit } = labelledTicks(low, high, 2, "N");
  let rightmost = -Infinity; // right end of the labels so far
  for (const [value, label] of ticks) {
    const px = across(value);
    const halfWidth = 0.3 * style.size * label.length;
    pen.segment([px, bottom], [px, bottom + TICK], theme.faint);
    if (px - halfWidth > rightmost + 0.3 * style.size) {
      pen.text(px, bottom + 6, label, style);
      rightmost = px + halfWidth;
    }
  }
  const labelY = bottom + 1.5 * theme.size;
  pen.text((x + right) / 2, labelY, `force, ${unit}`, style);
}

// Marks -----------------------------------------------------------------------------------

/** Cover all that follows the first touch, until e is guessed. */
function hideFuture(pen, { contacts }, frame, theme) {
  const touches = contacts.map(
    ({ spells }) => spells.find(({ state }) => state !== "open").from,
  );
  const y = frame.up(Math.min(...touches));
  pen.rectangle([frame.x, -1], [pen.width, y], theme.paper);
  if (page.isPrinting) {
    return;
  } // pupils draw the waves there
  pen.text((frame.x + frame.right) / 2, (frame.y + y) / 2, "?", {
    size: 5 * theme.size,
    colour: theme.faint,
    align: "center",
  });
}

/** Arrow heads at the right edge, at the times at which the first waves are back. */
function drawMarks(pen, { marks }, frame, view, theme) {
  let labelY = Infinity;
  for (const { t, text } of marks) {
    if (t < view.from || t > view.to) {
      continue;
    }
    const y = frame.up(t);
    const headEnd = frame.right + 0.45 * theme.size; // a dash would look like a minus
    pen.triangle(frame.right, headEnd, y, 0.25 * theme.size, theme.faint);
    const isNearLast = Math.abs(y - labelY) < theme.size;
    labelY = isNearLast ? labelY - theme.size : y;
    pen.text(frame.right + 0.6 * theme.size, labelY, text, {
      size: 0.85 * theme.size,
      colour: theme.ink,
    });
  }
}

/** A dot on the axis of time for each event. */
function drawEvents(pen, { events }, frame, view, theme) {
  for (const { t } of events) {
    if (t >= view.from && t <= view.to) {
      pen.disc(frame.x, frame.up(t), 0.3 * theme.size, theme.series[0]);
    }
  }
}

/** The cross of dashed lines at which values are read. */
function drawReadingMark(pen, frame, mark, theme) {
  const x = frame.across(mark.place);
  const y = frame.up(mark.t);
  pen.segment([x, frame.y], [x, frame.bottom], theme.ink, 0.8, [3, 3]);
  pen.segment([frame.x, y], [frame.right, y], theme.ink, 0.8, [3, 3]);
}

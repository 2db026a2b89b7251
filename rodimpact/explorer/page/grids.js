"use strict";
// Pictures of grids of cells: smooth colours in the diagram and in the rods. Begin with
// `drawGrids` and `drawRodsOfGrids`.

const SHADES = 256; // colours of a smooth picture

/** Colours of numbers from -1 to 1, as pixels. */
function shadesOf(theme) {
  const shades = [];
  for (let k = 0; k <= SHADES; k += 1) {
    shades.push([...colourOf((2 * k) / SHADES - 1, theme), 255]);
  }
  return shades;
}

/** Canvas with one pixel for each value, from -1 to 1, of rows from the top down. */
function canvasOf(rows, theme) {
  const shades = shadesOf(theme);
  const width = rows[0].length;
  const canvas = makeElement("canvas", { width, height: rows.length });
  const pixels = new ImageData(width, rows.length);
  rows.forEach((row, j) => {
    row.forEach((value, i) => {
      const shade = shades[Math.round(((value + 1) / 2) * SHADES)];
      pixels.data.set(shade, 4 * (j * width + i));
    });
  });
  canvas.getContext("2d").putImageData(pixels, 0, 0);
  return canvas;
}

/** Values of a row of cells, as fractions of the scale. */
function valuesOfRow(scene, grid, name, row) {
  const firstCell = grid.first + row * grid.across;
  return Array.from({ length: grid.across }, (_, i) =>
    fractionOf(scene, name, firstCell + i),
  );
}

/** All cells of a grid as one picture; time runs upward. */
function imageOfGrid(scene, grid, name, theme) {
  const rows = [];
  for (let j = grid.rows - 1; j >= 0; j -= 1) {
    rows.push(valuesOfRow(scene, grid, name, j));
  }
  return canvasOf(rows, theme);
}

/** One row of cells as a picture, interpolated between two rows. */
function imageOfTime(scene, grid, name, theme, row) {
  const below = Math.floor(row);
  const above = Math.min(grid.rows - 1, below + 1);
  const later = valuesOfRow(scene, grid, name, above);
  const values = valuesOfRow(scene, grid, name, below).map(
    (value, i) => value + (later[i] - value) * (row - below),
  );
  return canvasOf([values], theme);
}

/** The picture of a grid between the ends of its segment, as they move. */
function displacedImage(scene, grid, image, frame) {
  const canvas = makeElement("canvas", {
    width: Math.ceil(frame.width),
    height: Math.ceil(frame.height),
  });
  const smooth = makeElement("canvas", {
    width: 4 * grid.across,
    height: 8 * grid.rows,
  });
  smooth.getContext("2d").drawImage(image, 0, 0, smooth.width, smooth.height);
  const context = canvas.getContext("2d");
  const { places } = scene;
  for (let y = 0; y < canvas.height; y += 1) {
    const fraction = frame.timeAt(frame.y + y + 0.5) / scene.end;
    if (fraction < 0 || fraction >= 1) {
      continue;
    }
    const position = fraction * grid.rows;
    const row = Math.floor(position);
    const first = 4 * (grid.first + row * grid.across); // corner of the first cell
    const last = first + 4 * (grid.across - 1);
    const between = (below, above) => {
      const change = (places[above] - places[below]) * (position - row);
      return frame.across(places[below] + change) - frame.x;
    };
    const left = between(first, first + 3);
    const right = between(last + 1, last + 2);
    // The first and last rows of pixels fade in a picture that is scaled.
    const pixelRow = Math.max(4, (1 - fraction) * smooth.height);
    const source = Math.min(smooth.height - 5, pixelRow);
    context.drawImage(
      smooth,
      0,
      source,
      smooth.width,
      1,
      left,
      y,
      right - left,
      1,
    );
  }
  return canvas;
}

/** All grids in the diagram. Pictures are kept until the view or the theme changes. */
function drawGrids(pen, scene, frame, name, theme) {
  const key = name + theme.name;
  for (const grid of scene.grids) {
    grid.images ||= {};
    grid.images[key] ||= imageOfGrid(scene, grid, name, theme);
    const image = grid.images[key];
    if (frame.isDisplaced) {
      const viewKey = [
        key,
        pen.width,
        pen.height,
        frame.placeAt(0),
        frame.placeAt(1),
        frame.timeAt(0),
        frame.timeAt(1),
      ].join();
      if (grid.viewKey !== viewKey) {
        grid.viewKey = viewKey;
        grid.displaced = displacedImage(scene, grid, image, frame);
      }
      pen.image(grid.displaced, frame.x, frame.y, frame.width, frame.height);
    } else {
      const left = frame.across(scene.row.left[grid.body] + grid.left);
      const right = frame.across(scene.row.left[grid.body] + grid.right);
      const top = frame.up(scene.end);
      pen.image(image, left, top, right - left, frame.up(0) - top);
    }
  }
}

/** Rods of grids at time t, smooth from end to end. */
function drawRodsOfGrids(pen, scene, strip, name, t, theme) {
  const { frame, middle, radius, ends, outlines } = strip;
  const largestRadius = radius * (1 + SWELLING);
  for (const grid of scene.grids) {
    const [low, high] = ends.get(grid.body);
    const length = scene.lengths[grid.body];
    const across = (x) => frame.across(low + ((high - low) * x) / length);
    const left = across(grid.left);
    const row = clamp((t / scene.end) * grid.rows - 0.5, 0, grid.rows - 1);
    const image = imageOfTime(scene, grid, name, theme, row);
    const top = middle - largestRadius;
    const width = across(grid.right) - left;
    pen.image(image, left, top, width, 2 * largestRadius);
  }
  for (const [body, steps] of outlines) {
    const outline = smoothOutline(steps);
    outlines.set(body, outline);
    hideOutside(pen, outline, strip, theme);
  }
}

/** An outline [x, radius] through the middles of its steps, from end to end. */
function smoothOutline(steps) {
  const middles = [];
  for (let k = 0; k < steps.length; k += 2) {
    const [left, radius] = steps[k];
    const [right] = steps[k + 1];
    middles.push([(left + right) / 2, radius]);
  }
  const first = [steps[0][0], middles[0][1]];
  const last = [steps.at(-1)[0], middles.at(-1)[1]];
  return [first, ...middles, last];
}

/** Hide what a picture of grids has above and below the outline of its rod. */
function hideOutside(pen, outline, { middle, radius }, theme) {
  for (const side of [-1, 1]) {
    const edge = middle + side * radius * (1 + 2 * SWELLING);
    const corners = outline.map(([x, height]) => [x, middle + side * height]);
    corners.push([outline.at(-1)[0] + 1, edge]);
    corners.push([outline[0][0] - 1, edge]);
    pen.polygon(corners, theme.paper, theme.paper, 1);
  }
}

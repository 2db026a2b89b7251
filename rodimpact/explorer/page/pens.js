"use strict";
// Pens: one way to draw, on a canvas or into SVG. Lengths are CSS pixels. Begin with
// `Pen`, whose methods both pens have.

const FONT = 'system-ui, "DejaVu Sans", sans-serif';
const PRINT_PIXELS = 3; // pixels of a canvas on paper for each CSS pixel

// Sizes of canvases are remembered: asking for one after a text has changed makes the
// browser lay out the page again.
const sizes = new WeakMap();
const sizeWatch = new ResizeObserver((entries) => {
  for (const { target } of entries) {
    sizes.set(target, clientSize(target));
  }
  redraw();
});

const clientSize = ({ clientWidth, clientHeight }) => [
  clientWidth,
  clientHeight,
];

/** Size of a canvas. On paper it is another, which the style fixes for its texts. */
function sizeOf(canvas) {
  if (page.isPrinting) {
    return clientSize(canvas);
  }
  if (!sizes.has(canvas)) {
    sizes.set(canvas, clientSize(canvas));
    sizeWatch.observe(canvas);
  }
  return sizes.get(canvas);
}

/** Shapes that both pens draw with their `polygon` and `line`. */
class Pen {
  /** A straight line between two points [x, y]. */
  segment(from, to, colour, width = 1, dash = []) {
    this.line([from, to], colour, width, dash);
  }

  /** A rectangle between two opposite corners [x, y]. */
  rectangle([left, top], [right, bottom], fill, stroke = null, width = 1) {
    const corners = [
      [left, top],
      [right, top],
      [right, bottom],
      [left, bottom],
    ];
    this.polygon(corners, fill, stroke, width);
  }

  /** A triangle with its tip at x, its base at `base`, and a height. */
  triangle(x, base, y, halfHeight, fill, stroke = null) {
    const corners = [
      [x, y],
      [base, y - halfHeight],
      [base, y + halfHeight],
    ];
    this.polygon(corners, fill, stroke);
  }
}

/** Draws on a canvas. */
class CanvasPen extends Pen {
  /** Clears the canvas, and fits its pixels to its size on the screen or on paper. */
  constructor(canvas) {
    super();
    const ratio = page.isPrinting ? PRINT_PIXELS : window.devicePixelRatio || 1;
    const [width, height] = sizeOf(canvas);
    const pixelWidth = Math.round(width * ratio);
    const pixelHeight = Math.round(height * ratio);
    if (canvas.width !== pixelWidth || canvas.height !== pixelHeight) {
      canvas.width = pixelWidth;
      canvas.height = pixelHeight;
    }
    this.width = width;
    this.height = height;
    this.context = canvas.getContext("2d");
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.context.clearRect(0, 0, width, height);
  }

  /** Begin a path along points [x, y]. */
  trace([[x0, y0], ...points]) {
    this.context.beginPath();
    this.context.moveTo(x0, y0);
    for (const [x, y] of points) {
      this.context.lineTo(x, y);
    }
  }

  polygon(points, fill, stroke, width = 1) {
    this.trace(points);
    this.context.closePath();
    this.context.fillStyle = fill;
    this.context.fill();
    if (stroke) {
      this.strokePath(stroke, width);
    }
  }

  line(points, colour, width = 1, dash = []) {
    if (points.length === 0) {
      return;
    }
    this.trace(points);
    this.context.setLineDash(dash);
    this.strokePath(colour, width);
    this.context.setLineDash([]);
  }

  strokePath(colour, width) {
    this.context.strokeStyle = colour;
    this.context.lineWidth = width;
    this.context.lineJoin = "round";
    this.context.stroke();
  }

  disc(x, y, radius, fill) {
    this.context.beginPath();
    this.context.arc(x, y, radius, 0, 2 * Math.PI);
    this.context.fillStyle = fill;
    this.context.fill();
  }

  /** A text at a point; its style has `size`, `colour`, `align`, `baseline`, `isUpright`. */
  text(x, y, text, style) {
    const { size, colour, align = "left", baseline = "middle" } = style;
    this.context.font = `${size}px ${FONT}`;
    this.context.fillStyle = colour;
    this.context.textAlign = align;
    this.context.textBaseline = baseline;
    this.context.save();
    this.context.translate(x, y);
    if (style.isUpright) {
      this.context.rotate(-Math.PI / 2);
    }
    this.context.fillText(text, 0, 0);
    this.context.restore();
  }

  /** Draw polygons that tile an empty part of the picture, so that no edges are seen. */
  seamless(draw) {
    this.context.globalCompositeOperation = "lighter"; // colours of shared edges add up
    draw();
    this.context.globalCompositeOperation = "source-over";
  }

  image(canvas, x, y, width, height) {
    this.context.drawImage(canvas, x, y, width, height);
  }

  /** Draw inside a rectangle only. */
  inside(x, y, width, height, draw) {
    this.context.save();
    this.context.beginPath();
    this.context.rect(x, y, width, height);
    this.context.clip();
    draw();
    this.context.restore();
  }
}

const escapeXml = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;");

/** Collects the parts of an SVG drawing, with the methods of `CanvasPen`. */
class SvgPen extends Pen {
  constructor(width, height) {
    super();
    this.width = width;
    this.height = height;
    this.hasNames = true; // names of the bodies stand above the diagram
    this.parts = [];
    this.clipCount = 0;
  }

  /** Path data of a line through points [x, y]: M moves, L draws. */
  path(points) {
    return points
      .map(([x, y], i) => `${i ? "L" : "M"}${x.toFixed(2)} ${y.toFixed(2)}`)
      .join("");
  }

  polygon(points, fill, stroke, width = 1) {
    let edge = "";
    if (stroke) {
      edge = ` stroke="${stroke}" stroke-width="${width}" stroke-linejoin="round"`;
    }
    this.parts.push(`<path d="${this.path(points)}Z" fill="${fill}"${edge}/>`);
  }

  line(points, colour, width = 1, dash = []) {
    let dashes = "";
    if (dash.length) {
      dashes = ` stroke-dasharray="${dash.join(" ")}"`;
    }
    this.parts.push(
      `<path d="${this.path(points)}" fill="none" stroke="${colour}" stroke-width="${width}"${dashes}/>`,
    );
  }

  disc(x, y, radius, fill) {
    this.parts.push(
      `<circle cx="${x.toFixed(2)}" cy="${y.toFixed(2)}" r="${radius}" fill="${fill}"/>`,
    );
  }

  text(x, y, text, style) {
    const { size, colour, align = "left", baseline = "middle" } = style;
    const anchor = { left: "start", center: "middle", right: "end" }[align];
    // SVG draws from the base line of the letters, which lies so far below the point.
    const drop = { middle: 0.35, top: 0.8, bottom: -0.1 }[baseline] * size;
    const turn = style.isUpright ? " rotate(-90)" : "";
    this.parts.push(
      `<text transform="translate(${x.toFixed(2)} ${y.toFixed(2)})${turn}" y="${drop.toFixed(2)}" font-size="${size}" text-anchor="${anchor}" fill="${colour}">${escapeXml(text)}</text>`,
    );
  }

  seamless(draw) {
    this.parts.push('<g shape-rendering="crispEdges">');
    draw();
    this.parts.push("</g>");
  }

  image(canvas, x, y, width, height) {
    this.parts.push(
      `<image x="${x}" y="${y}" width="${width}" height="${height}" preserveAspectRatio="none" href="${canvas.toDataURL()}"/>`,
    );
  }

  inside(x, y, width, height, draw) {
    this.clipCount += 1;
    const name = `frame-${this.clipCount}`;
    this.parts.push(
      `<clipPath id="${name}"><rect x="${x}" y="${y}" width="${width}" height="${height}"/></clipPath><g clip-path="url(#${name})">`,
    );
    draw();
    this.parts.push("</g>");
  }

  /** The whole drawing. */
  document(title, paper) {
    const size = `width="${this.width}" height="${this.height}" viewBox="0 0 ${this.width} ${this.height}"`;
    return (
      `<svg xmlns="http://www.w3.org/2000/svg" ${size} font-family="sans-serif">` +
      `<title>${escapeXml(title)}</title><rect width="100%" height="100%" fill="${paper}"/>${this.parts.join("")}</svg>\n`
    );
  }
}

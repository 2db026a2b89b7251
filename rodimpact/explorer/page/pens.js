"use strict";
// One way to draw, on a canvas or into SVG; lengths in CSS pixels.

const FONT = 'system-ui, "DejaVu Sans", sans-serif';

// sizes are kept: to ask for one after a text has changed makes the browser lay out the page again
const sizes = new WeakMap();
const sizeWatch = new ResizeObserver((entries) => {
  for (const { target } of entries)
    sizes.set(target, [target.clientWidth, target.clientHeight]);
  redraw();
});

/** Size of a canvas; on paper it is another, which the style fixes, so that its text keeps its size. */
function sizeOf(canvas) {
  if (shown.printing) return [canvas.clientWidth, canvas.clientHeight];
  if (!sizes.has(canvas)) {
    sizes.set(canvas, [canvas.clientWidth, canvas.clientHeight]);
    sizeWatch.observe(canvas);
  }
  return sizes.get(canvas);
}

class CanvasPen {
  constructor(canvas) {
    const ratio = shown.printing ? 3 : window.devicePixelRatio || 1;
    [this.width, this.height] = sizeOf(canvas);
    const [w, h] = [
      Math.round(this.width * ratio),
      Math.round(this.height * ratio),
    ];
    if (canvas.width !== w || canvas.height !== h)
      Object.assign(canvas, { width: w, height: h });
    this.context = canvas.getContext("2d");
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.context.clearRect(0, 0, this.width, this.height);
  }

  trace(points, closed) {
    const c = this.context;
    c.beginPath();
    points.forEach(([x, y], i) => (i ? c.lineTo(x, y) : c.moveTo(x, y)));
    if (closed) c.closePath();
  }

  polygon(points, fill, stroke, width = 1) {
    this.trace(points, true);
    this.context.fillStyle = fill;
    this.context.fill();
    if (!stroke) return;
    Object.assign(this.context, {
      strokeStyle: stroke,
      lineWidth: width,
      lineJoin: "round",
    });
    this.context.stroke();
  }

  line(points, stroke, width = 1, dash = []) {
    this.trace(points, false);
    Object.assign(this.context, {
      strokeStyle: stroke,
      lineWidth: width,
      lineJoin: "round",
    });
    this.context.setLineDash(dash);
    this.context.stroke();
    this.context.setLineDash([]);
  }

  disc(x, y, radius, fill) {
    this.context.beginPath();
    this.context.arc(x, y, radius, 0, 2 * Math.PI);
    this.context.fillStyle = fill;
    this.context.fill();
  }

  text(
    x,
    y,
    text,
    { size, colour, align = "left", baseline = "middle", turned = false },
  ) {
    const c = this.context;
    Object.assign(c, {
      font: `${size}px ${FONT}`,
      fillStyle: colour,
      textAlign: align,
      textBaseline: baseline,
    });
    c.save();
    c.translate(x, y);
    if (turned) c.rotate(-Math.PI / 2);
    c.fillText(text, 0, 0);
    c.restore();
  }

  /** Draw what tiles an empty part of the picture: edges that two share add up, and none is seen. */
  seamless(draw) {
    this.context.globalCompositeOperation = "lighter";
    draw();
    this.context.globalCompositeOperation = "source-over";
  }

  image(canvas, x, y, width, height) {
    this.context.drawImage(canvas, x, y, width, height);
  }

  inside(x, y, width, height, draw) {
    this.context.save();
    this.context.beginPath();
    this.context.rect(x, y, width, height);
    this.context.clip();
    draw();
    this.context.restore();
  }
}

const safe = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;");

class SvgPen {
  constructor(width, height) {
    Object.assign(this, { width, height, parts: [], clips: 0, named: true });
  }

  path(points, closed) {
    const steps = points.map(
      ([x, y], i) => `${i ? "L" : "M"}${x.toFixed(2)} ${y.toFixed(2)}`,
    );
    return steps.join("") + (closed ? "Z" : "");
  }

  polygon(points, fill, stroke, width = 1) {
    const edge = stroke
      ? ` stroke="${stroke}" stroke-width="${width}" stroke-linejoin="round"`
      : "";
    this.parts.push(
      `<path d="${this.path(points, true)}" fill="${fill}"${edge}/>`,
    );
  }

  line(points, stroke, width = 1, dash = []) {
    const dashes = dash.length ? ` stroke-dasharray="${dash.join(" ")}"` : "";
    this.parts.push(
      `<path d="${this.path(points, false)}" fill="none" stroke="${stroke}" stroke-width="${width}"${dashes}/>`,
    );
  }

  disc(x, y, radius, fill) {
    this.parts.push(
      `<circle cx="${x.toFixed(2)}" cy="${y.toFixed(2)}" r="${radius}" fill="${fill}"/>`,
    );
  }

  text(
    x,
    y,
    text,
    { size, colour, align = "left", baseline = "middle", turned = false },
  ) {
    const anchor = { left: "start", center: "middle", right: "end" }[align];
    const drop = { middle: 0.35, top: 0.8, bottom: -0.1 }[baseline] * size;
    const turn = turned ? " rotate(-90)" : "";
    this.parts.push(
      `<text transform="translate(${x.toFixed(2)} ${y.toFixed(2)})${turn}" y="${drop.toFixed(2)}" font-size="${size}" text-anchor="${anchor}" fill="${colour}">${safe(text)}</text>`,
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
    this.clips += 1;
    const name = `frame-${this.clips}`;
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
      `<title>${safe(title)}</title><rect width="100%" height="100%" fill="${paper}"/>${this.parts.join("")}</svg>\n`
    );
  }
}

"use strict";
// Files to save: the diagram as SVG, and the case. Begin with `connectFiles`.

const SVG_SIZE = { width: 900, height: 640 };
const URL_LIFETIME = 10000; // ms in which a browser must have taken the file

/** Let the browser save a text as a file. */
function download(name, type, text) {
  const href = URL.createObjectURL(new Blob([text], { type }));
  makeElement("a", { href, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(href), URL_LIFETIME);
}

/** Save the diagram without the time, with a line that explains its colours. */
function saveSvg() {
  const { scene, theme } = page;
  const pen = new SvgPen(SVG_SIZE.width, SVG_SIZE.height);
  const frame = drawDiagram(pen, scene, page, null, null, theme);
  const limits = [byId("least").textContent, byId("most").textContent];
  const range = limits.filter(Boolean).join(" to ");
  const legend = `colours: ${page.quantity}, ${range}; blue below 0, yellow above`;
  pen.text(frame.x, frame.bottom + 2.3 * theme.size, legend, {
    size: 0.8 * theme.size,
    colour: theme.faint,
    baseline: "top",
  });
  const picture = pen.document(beginningText(scene), theme.paper);
  download("rodimpact.svg", "image/svg+xml", picture);
}

/** Save the case file of the design. */
function saveCase() {
  const text = tomlOf(design, embedded.materials);
  download("case.toml", "application/toml", text);
}

/** Post the case file of what is shown to the frame around the page, such as a notebook. */
function postCase() {
  if (parent === window) {
    return;
  }
  const isFirst = JSON.stringify(design) === JSON.stringify(embedded.design);
  const rodimpact = isFirst ? "" : tomlOf(design, embedded.materials);
  parent.postMessage({ rodimpact }, "*");
}

/** Let the buttons save the files. */
function connectFiles() {
  byId("save-svg").addEventListener("click", saveSvg);
  byId("save-case").addEventListener("click", saveCase);
}

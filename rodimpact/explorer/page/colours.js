"use strict";
// Colours: the theme of the page, and the scale of velocities and stresses. Begin with
// `colourOf`.

// stops of the scale: blue, nearly the paper's colour at 0, yellow
const STOPS = {
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
const UNITS = { velocity: "m/s", stress: "Pa" }; // units of the quantities that colours show
const ZERO_RTOL = 1e-9; // the legend calls values below this part of the scale 0
const LEGEND_STEPS = 8;
const DARK_LUMINANCE = 115; // white letters are read on darker colours

/** Colour, red, green and blue, of a number from -1 to 1. */
function colourOf(fraction, { stops }) {
  const position = clamp((fraction + 1) / 2, 0, 1) * (stops.length - 1);
  const i = Math.min(stops.length - 2, Math.floor(position));
  return stops[i].map((channel, k) => {
    const change = (stops[i + 1][k] - channel) * (position - i);
    return Math.round(channel + change);
  });
}

const css = (colour) => `rgb(${colour.join(",")})`;

const isDark = ([red, green, blue]) =>
  0.3 * red + 0.59 * green + 0.11 * blue < DARK_LUMINANCE;

/** Value of a polygon as a fraction of the scale, from -1 to 1. */
function fractionOf(scene, quantityName, polygon) {
  const scale = scene.scale[quantityName];
  return scale > 0 ? scene.tiling[quantityName][polygon] / scale : 0;
}

/** Background of evenly spaced colours, for an element. */
const gradient = (colours) => `linear-gradient(to right, ${colours.join(",")})`;

/** Read sizes and colours of the page's style. */
function readTheme() {
  const root = document.documentElement;
  const style = getComputedStyle(root);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  const channels = (name) =>
    colour(name)
      .match(/\w\w/g)
      .map((pair) => parseInt(pair, 16));
  const { theme: name } = root.dataset;
  let size = 12; // px, of letters
  if (!page.isPrinting) {
    size = Math.round(Math.min(17, parseFloat(style.fontSize) * 0.87));
  }
  page.theme = {
    size,
    name,
    stops: STOPS[name],
    series: [0, 1, 2, 3, 4].map((k) => colour(`series-${k}`)),
    paper: colour("paper"),
    ink: colour("ink"),
    faint: colour("faint"),
    line: colour("line"),
    accent: colour("wrong"),
    inkChannels: channels("ink"),
    paperChannels: channels("paper"),
  };
  if (page.scene) {
    showLegend();
  }
}

/** Colour and dash of curve k in a figure. */
function styleOfCurve(k, { series }) {
  const dash = k >= series.length ? [6, 3] : [];
  return { colour: series[k % series.length], dash };
}

/** Name the values that occur, from the smallest to the largest, beside their colours. */
function showLegend() {
  const { scene, theme, quantity: name } = page;
  const scale = scene.scale[name];
  const [low, high] = scene.colourRange[name].map((value) =>
    Math.abs(value) < ZERO_RTOL * scale ? 0 : value,
  );
  const label = (value) => {
    const sign = value > 0 ? "+" : "";
    return sign + quantity(value, UNITS[name], 3);
  };
  let lowest = "";
  if (low < high) {
    lowest = label(low);
  }
  if (low < high && low < 0 && name === "stress") {
    lowest += ", compressed";
  }
  setText(byId("least"), lowest);
  setText(byId("most"), label(high));
  const colours = [];
  for (let k = 0; k <= LEGEND_STEPS; k += 1) {
    const value = low + ((high - low) * k) / LEGEND_STEPS;
    colours.push(css(colourOf(value / (scale || 1), theme)));
  }
  byId("colours").style.background = gradient(colours);
}

// Amplitudes of a report in the unit chosen (unit-choice.js): what the page states in µm 0-peak (a sentence of the
// diagnosis: um), and nothing else, is told in it.
"use strict";
const STATED = /(?:(\d[\d.]*)( ± | to )?(\d[\d.]*)?[ \u00a0])?[uµ]m 0-peak/g;

// A number of as many digits as it is written with, two at least.
function told(number) {
  const digits = number.replace(".", "").replace(/^0+/, "").length;
  const text = (Number(number) * UNITS.get(unit)).toPrecision(Math.max(digits, 2));
  return text.includes("e") ? String(Number(text)) : text;
}

const inWords = (words) => words.replace(STATED, (_, value, between = "", other) =>
  [value ? told(value) + between + (other ? told(other) : "") + " " : "", unit].join(""));

// Words
const written = new Map(); // text node or cell -> what the page says

function texts(root) {
  const walker = document.createTreeWalker(root, NodeFilter.SHOW_TEXT);
  const found = [];
  while (walker.nextNode()) if (/[uµ]m 0-peak/.test(walker.currentNode.data)) found.push(walker.currentNode);
  return found.filter((node) => !node.parentElement.closest("script, .canvas, figure.plot:not([data-amplitude])"));
}

function collect() {
  for (const node of texts(document.querySelector("main"))) written.set(node, node.data);
  for (const cell of document.querySelectorAll("td.amplitude")) written.set(cell.firstChild, cell.textContent);
}

function tell() {
  if (!written.size) collect();
  for (const [node, words] of written) {
    const isCell = node.parentElement.classList.contains("amplitude");
    node.data = isCell ? words.replace(/\d+(?:\.\d+)?/g, told) : inWords(words);
    if (isCell && "name" in node.parentElement.dataset) node.parentElement.dataset.name = inWords(named(node.parentElement));
  }
}

function named(cell) { // the heading of a cell of a stacked table, as the page says it
  cell.dataset.written ??= cell.dataset.name;
  return cell.dataset.written;
}

// Figures
const ARRAYS = { f4: Float32Array, f8: Float64Array, i1: Int8Array, u1: Uint8Array, i2: Int16Array, u2: Uint16Array, i4: Int32Array };

function numbers(values) { // as Plotly writes them: plain, or packed with their type and shape
  if (!values?.bdata) return values;
  const flat = Array.from(new ARRAYS[values.dtype](Uint8Array.from(atob(values.bdata), (c) => c.charCodeAt(0)).buffer));
  const columns = values.shape && Number(String(values.shape).split(",")[1]);
  return columns ? Array.from({ length: flat.length / columns }, (_, i) => flat.slice(i * columns, (i + 1) * columns)) : flat;
}

const scaled = (values, by) => values.map((one) => (Array.isArray(one) ? scaled(one, by) : one === null ? null : one * by));

function round(value) { // down to 1, 2 or 5 of its decade
  const decade = 10 ** Math.floor(Math.log10(value));
  return decade * [5, 2, 1].find((first) => first * decade <= value);
}

// A figure from the page with its amplitudes in the unit chosen; layout.meta says which they are.
function inUnit(figure) {
  const { amplitude, axes } = figure.layout.meta ?? {}, by = UNITS.get(unit);
  if (!amplitude || by === 1) return figure;
  for (const trace of figure.data.filter(({ yaxis = "y" }) => !axes || axes.includes(yaxis))) {
    trace[amplitude] = scaled(numbers(trace[amplitude]), by);
    if (trace.hovertemplate) trace.hovertemplate = trace.hovertemplate.replaceAll("µm", unit);
    if (amplitude !== "z") continue;
    Object.assign(trace, { customdata: scaled(numbers(trace.customdata), by), zmin: trace.zmin * by, zmax: trace.zmax * by });
    trace.colorbar.title.text = unit;
  }
  for (const [name, axis] of Object.entries(figure.layout)) {
    if (!name.startsWith("yaxis")) continue;
    if (axis.title?.text) axis.title.text = axis.title.text.replace(WRITTEN, unit);
    if (axis.ticksuffix) axis.ticksuffix = axis.ticksuffix.replace("µm", unit);
  }
  const radius = figure.layout.polar?.radialaxis;
  if (radius?.tickvals) radius.tickvals = [1, 2, 3].map((n) => n * round(radius.tickvals[0] * by)); // none at the centre
  return figure;
}

offerUnits(() => {
  tell();
  globalThis.rotorReport?.redraw();
});
if (unit !== WRITTEN) tell();

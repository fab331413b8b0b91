// Unpacks plotly.js, draws every figure of the page from the data beside it, and fits them to window and paper.
// the buttons are listed one by one: the default set has one that would send the figure to a server
const buttons = [["zoom2d", "pan2d", "resetScale2d"], ["toImage"]];
// on a telephone they would lie over titles and legends, and fingers need none
const shown = innerWidth < 600 ? false : "hover";
const config = { responsive: true, displaylogo: false, displayModeBar: shown, modeBarButtons: buttons };
// CSS pixels within the margins of A4 (182 mm) and Letter (188 mm); plots are lower than on the screen by these factors
const PAPER = document.body.classList.contains("sheet")
  ? { width: 715, whole: 0.72, beside: 0.84, lowest: 110 } // all of it on one page, which has narrower margins
  : { width: 680, whole: 0.72, beside: 0.84, lowest: 170 };

const canvases = () => [...document.querySelectorAll(".canvas")];
const waiting = () => canvases().filter((canvas) => !canvas.data);

async function unpack() {
  const packed = Uint8Array.from(atob(document.getElementById("plotly").textContent), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const script = document.createElement("script");
  script.textContent = await new Response(stream).text();
  document.head.append(script);
}

function figureOf(canvas) {
  const source = document.querySelector(`script[data-figure="${canvas.id}"]`);
  return inUnit(JSON.parse(source.textContent)); // units.js
}

function draw(canvas) {
  const figure = figureOf(canvas);
  canvas.style.height = figure.layout.height + "px";
  Plotly.newPlot(canvas, figure.data, figure.layout, config);
  // the words above the plot say what it shows; its letters one by one say nothing
  canvas.querySelectorAll("svg").forEach((svg) => svg.setAttribute("aria-hidden", "true"));
}

// One after the other with a pause between, so that the page can be read and scrolled meanwhile.
async function drawAll() {
  for (const canvas of canvases()) {
    if (!canvas.data) draw(canvas);
    await new Promise((done) => setTimeout(done));
  }
}

async function main() {
  try {
    await unpack();
  } catch (error) {
    document.getElementById("no-plots").hidden = false; // a browser without DecompressionStream
    throw error;
  }
  await drawAll();
  if (logarithmic) logarithmic.disabled = false;
}

const logarithmic = document.getElementById("log-amplitude");
globalThis.rotorReport = { drawn: main(), redraw };

// What shows amplitudes, in another unit.
function redraw() {
  for (const canvas of document.querySelectorAll("[data-amplitude] .canvas")) {
    if (!canvas.data) continue;
    const { data, layout } = figureOf(canvas);
    Plotly.react(canvas, data, layout, config);
  }
  if (logarithmic?.checked) logarithmic.dispatchEvent(new Event("change"));
}

logarithmic?.addEventListener("change", () => {
  const type = logarithmic.checked ? "log" : "linear";
  const range = { "yaxis.type": type, "yaxis.autorange": true, "yaxis.rangemode": logarithmic.checked ? "normal" : "tozero" };
  document.querySelectorAll(".canvas[id^=bode-]").forEach((canvas) => Plotly.relayout(canvas, range));
});

// A plot in a folded part is drawn as wide as nothing; it gets its width when it is unfolded.
document.addEventListener("toggle", (event) => {
  event.target.querySelectorAll?.(".canvas").forEach((canvas) => canvas.data && Plotly.Plots.resize(canvas));
}, true);

// On paper nothing can be unfolded, and the page is narrower than the screen. The browser lays out the paper only after
// this, so the width is not measured but given.
let unfolded = [];

function forPaper(canvas) {
  const share = Number(canvas.dataset.share);
  canvas.dataset.height = canvas.layout.height;
  const height = Math.max(PAPER.lowest, (share < 1 ? PAPER.beside : PAPER.whole) * canvas.layout.height);
  canvas.style.height = canvas.style.minHeight = height + "px";
  Plotly.relayout(canvas, { autosize: false, width: share * PAPER.width, height });
}

function forScreen(canvas) {
  const height = Number(canvas.dataset.height);
  canvas.style.height = canvas.style.minHeight = height + "px";
  Plotly.relayout(canvas, { autosize: true, width: null, height });
}

addEventListener("beforeprint", () => {
  unfolded = [...document.querySelectorAll("details:not([open]):not(.screen)")];
  unfolded.forEach((details) => (details.open = true));
  if (!globalThis.Plotly) return;
  waiting().forEach(draw);
  canvases().forEach(forPaper);
});
addEventListener("afterprint", () => {
  unfolded.forEach((details) => (details.open = false));
  if (globalThis.Plotly) canvases().forEach(forScreen);
});

// Draws every figure of the page from the data beside it, keeps it as wide as its place, and offers a log amplitude.
"use strict";
// the buttons are listed one by one: the default set has one that would send the figure to a server
const buttons = [["zoom2d", "pan2d", "resetScale2d"], ["toImage"]];
const config = { responsive: true, displaylogo: false, displayModeBar: "hover", modeBarButtons: buttons };

function canvases() {
  return document.querySelectorAll(".canvas");
}

for (const source of document.querySelectorAll("script[data-figure]")) {
  const figure = JSON.parse(source.textContent);
  const canvas = document.getElementById(source.dataset.figure);
  const height = figure.layout.height;
  canvas.style.height = height + "px";
  Plotly.newPlot(canvas, figure.data, figure.layout, config);
}

document.getElementById("log-amplitude")?.addEventListener("change", (event) => {
  const type = event.target.checked ? "log" : "linear";
  const range = { "yaxis.type": type, "yaxis.autorange": true, "yaxis.rangemode": type === "log" ? "normal" : "tozero" };
  document.querySelectorAll("#bode .canvas").forEach((canvas) => Plotly.relayout(canvas, range));
});

// On paper nothing can be unfolded, and the page is narrower than the screen.
addEventListener("beforeprint", () => {
  document.querySelectorAll("details").forEach((details) => (details.open = true));
  canvases().forEach((canvas) => Plotly.Plots.resize(canvas));
});
addEventListener("afterprint", () => canvases().forEach((canvas) => Plotly.Plots.resize(canvas)));

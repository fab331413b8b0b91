// Plots of a lab's page: trends of a quantity, and Bode plots of chosen runs. plotly.js and a run's curves are loaded when
// they are wanted. What this takes from lab.js: runs, trends, byId, state, shown, chosen, mark and the small helpers.
"use strict";
const COLOURS = ["#3182bd", "#e6792b", "#1a9e77", "#d0609f", "#8c6bb1", "#808890"]; // told apart by colour-blind readers
const LINE = "rgba(128,136,144,0.9)", GRID = "rgba(128,136,144,0.25)";
const curves = new Map(); // run -> what its script holds
globalThis.rotorLab = { take: (id, table) => curves.set(id, table) };

// Scripts beside the page
const scripts = new Map();

function load(address) {
  if (!scripts.has(address)) {
    scripts.set(address, new Promise((done, fail) => {
      const lost = () => { scripts.delete(address); fail(new Error(`${address} is missing beside this page`)); };
      document.head.append(make("script", { src: address, onload: done, onerror: lost }));
    }));
  }
  return scripts.get(address);
}

// Plots. The buttons are listed one by one: the default set has one that would send the figure to a server.
const CONFIG = { responsive: true, displaylogo: false, modeBarButtons: [["zoom2d", "pan2d", "resetScale2d"], ["toImage"]] };
const plotText = (text) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;"); // Plotly would take it for HTML
const axis = (more) => ({ gridcolor: GRID, linecolor: LINE, zeroline: false, automargin: true, ...more });
const frame = (more) => ({
  margin: { l: 62, r: 14, t: 34, b: 46 }, paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", hovermode: "closest",
  font: { family: "system-ui, sans-serif", size: 12 }, modebar: { orientation: "v", bgcolor: "rgba(0,0,0,0)" },
  legend: { orientation: "h", y: 1, yanchor: "bottom", x: 0, bgcolor: "rgba(0,0,0,0)" }, ...more,
});

async function plot(canvas, caption, traces, layout) {
  try {
    await load("plotly.min.js");
  } catch (error) {
    caption.textContent = error.message;
    return;
  }
  await Plotly.react(canvas, traces, layout, CONFIG);
  canvas.querySelectorAll("svg").forEach((svg) => svg.setAttribute("aria-hidden", "true")); // the words around it say what it shows
}

// Trends
let walk = []; // points that are drawn: { run, value, low, high }, oldest first
const trendOf = () => trends.find((trend) => trend.name === state.trend);
const pointText = ({ run, value, low, high }) =>
  `${timeText(run.t)}: ${withUnit(digits(value, 4), unitOf(trendOf()))}${known(low) && known(high) ? ` (${digits(low, 4)} to ${digits(high, 4)})` : ""}, ${run.file}`;
const GROUPS = [["adequate", "#3182bd", "circle"], ["another verdict", "#e6792b", "diamond"], ["not diagnosed", "#808890", "square"]];
const groupOf = (run) => (outcome(run) === "adequate" ? 0 : run.verdict ? 1 : 2);

function traceOf([name, color, symbol], points) {
  const array = points.map(({ value, high }) => (known(high) ? high - value : 0));
  const arrayminus = points.map(({ value, low }) => (known(low) ? value - low : 0));
  return {
    name, mode: "markers", marker: { color, symbol, size: 6 }, x: points.map(({ run }) => timeText(run.t)), y: points.map(({ value }) => value),
    customdata: points.map(({ run }) => run.id), text: points.map((point) => plotText(pointText(point))), hovertemplate: "%{text}<extra></extra>",
    error_y: { type: "data", symmetric: false, array, arrayminus, thickness: 1, width: 0, color }, showlegend: points.length > 0,
  };
}

function ring() {
  const points = walk.filter(({ run }, i) => run.id === state.run || i === Number(at("point").value));
  const marker = { color: points.map(({ run }) => (run.id === state.run ? "#d0609f" : LINE)), symbol: "circle-open", size: 14, line: { width: 2.5 } };
  return { mode: "markers", marker, x: points.map(({ run }) => timeText(run.t)), y: points.map(({ value }) => value), hoverinfo: "skip", showlegend: false };
}

function moveRing() {
  const canvas = at("trend-plot"), { x, y, marker } = ring();
  if (canvas.data) Plotly.restyle(canvas, { x: [x], y: [y], "marker.color": [marker.color] }, canvas.data.length - 1);
}

async function showTrend() {
  const trend = trendOf(), rig = state.of;
  at("walk").hidden = at("trend-plot").hidden = !trend;
  if (!trend) at("trend-caption").textContent = "No run has values to follow.";
  if (!trend || !seen.has("trends")) return;
  const passed = new Set(shown);
  walk = trend.points.map((point) => inUnit(trend, point)).map(([index, value, low, high]) => ({ run: byId.get(runs[index].id), value, low, high }))
    .filter(({ run }) => run.rig === rig && known(run.t) && passed.has(run)).sort((one, other) => one.run.t - other.run.t);
  Object.assign(at("point"), { max: Math.max(walk.length - 1, 0), value: walk.length });
  at("walk").hidden = at("trend-plot").hidden = walk.length === 0;
  const bars = walk.some(({ low }) => known(low)) ? "bars are 95 % intervals" : "no interval is stated for it";
  const inWhat = trend.unit && `, ${unitOf(trend)}`;
  at("trend-caption").textContent = walk.length ? `${trend.label}${inWhat}: ${walk.length} runs of ${rig}; ${bars}` : `No run of ${rig} that passes the filter has a value of: ${trend.label}`;
  sayPoint();
  if (!walk.length) return;
  const ends = [walk[0], walk.at(-1)].map(({ run }) => timeText(run.t));
  const lines = (trend.lines[rig] ?? []).map(([value, name], i) => [inUnit(trend, [i, value])[1], name]).map(([y, name], i) => ({
    name: plotText(name), mode: "lines", x: ends, y: [y, y], line: { color: LINE, width: 1.5, dash: ["dash", "dot", "dashdot"][i % 3] }, hoverinfo: "skip",
  }));
  const groups = GROUPS.map((group, i) => traceOf(group, walk.filter(({ run }) => groupOf(run) === i)));
  const layout = frame({ xaxis: axis({ type: "date" }), yaxis: axis({ title: { text: plotText(unitOf(trend) || trend.label) } }), uirevision: trend.name + rig + unitOf(trend) });
  const canvas = at("trend-plot");
  await plot(canvas, at("trend-caption"), [...lines, ...groups, ring()], layout);
  canvas.removeAllListeners?.("plotly_click");
  canvas.on?.("plotly_click", ({ points }) => points[0].customdata && mark(byId.get(points[0].customdata)));
}

function sayPoint() {
  const point = walk[Number(at("point").value)];
  at("at").textContent = point ? pointText(point) : "";
  at("point").ariaValueText = at("at").textContent;
}

// Bode plots

function overlay(run) {
  const others = chosen().filter((one) => one !== run);
  state.bode = (others.length < chosen().length ? others : [...others, run]).map(({ id }) => id).join(" ");
  const inTable = document.activeElement?.closest("#rows");
  showTable();
  if (inTable) at(`run-${run.id}`)?.querySelector("input")?.focus({ preventScroll: true });
  showBode();
}

function listChosen() {
  const items = chosen().map((run, i) => {
    const swatch = make("span", { className: "swatch" });
    swatch.style.background = COLOURS[i];
    const leave = make("button", { type: "button", ariaLabel: `Leave out ${run.file}`, onclick: () => { overlay(run); at("bode-words").focus(); } }, "×");
    return make("li", {}, swatch, `${run.file}, ${timeText(run.t)}`, leave);
  });
  at("chosen").replaceChildren(...items);
  const link = at("to-bode");
  link.hidden = !items.length;
  link.textContent = `Bode plots of ${items.length} run${items.length > 1 ? "s" : ""}${items.length === MOST ? ", the most" : ""}`;
}

async function showBode() {
  listChosen();
  const its = chosen();
  for (const id of ["bode-controls", "bode-figure", "peaks-box"]) at(id).hidden = !its.length;
  at("bode-words").textContent = its.length ? `${its.length} of at most ${MOST} runs.` : `Choose up to ${MOST} runs by the boxes in the table.`;
  if (!its.length || !seen.has("bode")) return;
  const loaded = await Promise.allSettled(its.map((run) => load(run.bode)));
  if (its.some((run, i) => run !== chosen()[i])) return; // chosen otherwise meanwhile
  const lost = loaded.filter(({ reason }) => reason).map(({ reason }) => reason.message + ".");
  at("bode-words").textContent = [`${its.length} of at most ${MOST} runs.`, ...lost].join(" ");
  const probes = [...new Set(its.flatMap((run) => curves.get(run.id)?.probes.map(({ name }) => name) ?? []))];
  if (!probes.length) return;
  fill(at("probe"), probes.map((name) => [name, name]), probes.includes(at("probe").value) ? at("probe").value : probes[0]);
  await drawBode(its);
}

async function drawBode(its) {
  const probe = at("probe").value, direction = at("direction").value;
  const drawn = its.flatMap((run, i) => {
    const its = curves.get(run.id)?.probes.find(({ name }) => name === probe)?.curves ?? [];
    return its.filter((curve) => !direction || curve.direction === Number(direction)).map((curve) => ({ run, curve, colour: COLOURS[i] }));
  });
  const start = phaseStart(drawn.map(({ curve }) => curve));
  const raw = its.some((run) => curves.get(run.id) && !curves.get(run.id).slow_roll_subtracted);
  at("bode-caption").textContent = `Probe ${probe} at 1X, ${raw ? "slow roll not subtracted in all of them" : "slow roll subtracted"}; lines are dashed where the speed falls`;
  const quarters = [...Array(13).keys()].map((i) => 90 * (i - 4));
  const layout = frame({
    showlegend: false, xaxis: axis({ title: { text: "speed, rpm" }, anchor: "y2" }), yaxis: axis({ domain: [0.42, 1], title: { text: unit }, rangemode: "tozero" }),
    yaxis2: axis({ domain: [0, 0.36], title: { text: "lag, °" }, tickvals: quarters, ticktext: quarters.map((lag) => (lag + 360) % 360) }), uirevision: probe + unit,
  });
  at("peaks-unit").textContent = unit;
  at("peaks").replaceChildren(...drawn.map(({ run, curve }) => peakRow(run, curve)));
  await plot(at("bode-plot"), at("bode-caption"), drawn.flatMap((one) => bodeTraces(one, start)), layout);
}

function bodeTraces({ run, curve, colour }, start) {
  const wrapped = curve.lag.map((lag) => (known(lag) ? start + ((((lag - start) % 360) + 360) % 360) : null));
  const lag = wrapped.map((value, i) => (known(wrapped[i - 1]) && Math.abs(value - wrapped[i - 1]) > 180 ? null : value)); // no line across the plot
  const name = plotText(`${run.file}, ${curve.run}`);
  const look = { mode: "lines", line: { color: colour, width: 1.6, dash: curve.direction < 0 ? "dash" : "solid" }, x: curve.rpm, name };
  return [
    { ...look, y: curve.amplitude.map(told), hovertemplate: `%{x:.0f} rpm: %{y:.3g} ${unit}<extra>%{fullData.name}</extra>` },
    { ...look, y: lag, yaxis: "y2", customdata: curve.lag, hovertemplate: "%{x:.0f} rpm: %{customdata:.1f}°<extra>%{fullData.name}</extra>" },
  ];
}

// Where the phase axis begins: in the middle of the widest gap between the lags of the stronger vectors, see curves.py.
function phaseStart(its) {
  const largest = Math.max(...its.flatMap(({ amplitude }) => amplitude));
  const lags = its.flatMap(({ amplitude, lag }) => lag.filter((value, i) => known(value) && amplitude[i] > 0.1 * largest)).sort((a, b) => a - b);
  if (!lags.length) return 0;
  const gaps = lags.map((lag, i) => (lags[i + 1] ?? lags[0] + 360) - lag);
  const widest = gaps.indexOf(Math.max(...gaps)), middle = lags[widest] + gaps[widest] / 2;
  return Math.round(middle / 45) * 45 - (middle > 180 ? 360 : 0);
}

function peakRow(run, curve) {
  const top = curve.amplitude.indexOf(Math.max(...curve.amplitude));
  const cells = [curve.run, digits(told(curve.amplitude[top]), 4), digits(curve.rpm[top], 4), digits(curve.lag[top], 3)];
  return make("tr", {}, make("th", { scope: "row" }, run.file), ...cells.map((cell) => make("td", {}, cell)));
}

// A plot is drawn when it comes into view.
const seen = new Set();

function watchPlots() {
  const watch = new IntersectionObserver((entries) => {
    for (const { target } of entries.filter(({ isIntersecting }) => isIntersecting)) {
      watch.unobserve(target);
      seen.add(target.id);
      if (target.id === "trends") showTrend();
      else showBode();
    }
  }, { rootMargin: "100px" });
  ["trends", "bode"].forEach((id) => watch.observe(at(id)));
}

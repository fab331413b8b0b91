// The runs of a lab: table, filter, address, and what happens when something is chosen. lab-plots.js draws trends and Bode plots.
"use strict";
const { runs, trends } = JSON.parse(document.getElementById("data").textContent);
const MOST = 6; // runs in one Bode plot
const TONES = { adequate: "good", named: "bad", tied: "bad", described: "bad", unexplained: "bad", failed: "bad" };

const at = (id) => document.getElementById(id);
const known = (value) => value !== undefined && value !== null && value !== "";
const byId = new Map(runs.map((run, index) => [run.id, { ...run, index }]));
const outcome = (run) => (run.status === "failed" ? "failed" : run.verdict || "not diagnosed");
for (const run of byId.values()) {
  const said = [run.file, run.rig, outcome(run), run.step, run.sentence, ...(run.causes ?? [])];
  run.words = said.filter(known).join(" ").toLowerCase();
}

function make(tag, properties = {}, ...inside) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...inside.filter((part) => known(part) && part !== false));
  return element;
}

// What the address remembers: a link to the page shows what was seen.
const count = (values) => values.reduce((counts, value) => counts.set(value, (counts.get(value) ?? 0) + 1), new Map());
const mostFrequent = (values) => [...count(values)].reduce((one, other) => (other[1] > one[1] ? other : one), ["", 0])[0];
const USUAL = { text: "", verdict: "", rig: "", sort: "-t", trend: trends[0]?.name ?? "", of: mostFrequent(runs.map((run) => run.rig)), bode: "", run: "", size: "25" };
let state = { ...USUAL };
let page = 0, shown = []; // of the table; all runs that pass the filter, in its order
const perPage = () => Number(state.size) || Math.max(shown.length, 1); // "all" has no number

const chosen = () => state.bode.split(" ").map((id) => byId.get(id)).filter((run) => run?.bode);

function readAddress() {
  const given = new URLSearchParams(location.hash.slice(1));
  state = Object.fromEntries(Object.entries(USUAL).map(([name, usual]) => [name, given.get(name) ?? usual]));
  if (!trends.some((trend) => trend.name === state.trend)) state.trend = USUAL.trend;
  state.bode = chosen().slice(0, MOST).map((run) => run.id).join(" ");
}

// Runs an action once nothing more has come for a moment: a letter typed wants neither a new address nor a new plot at once.
function settle(action) {
  let waiting;
  return () => { clearTimeout(waiting); waiting = setTimeout(action, 150); };
}

const writeAddress = settle(() => {
  const told = Object.entries(state).filter(([name, value]) => value !== USUAL[name]);
  history.replaceState(null, "", "#" + new URLSearchParams(told));
});

// Numbers and times as text
function plusMinus([value, sigma] = []) {
  if (!known(value)) return "–";
  if (!(sigma > 0)) return String(value);
  const decimals = 1 - Math.floor(Math.log10(sigma)), step = 10 ** decimals;
  const round = (number) => (Math.round(number * step) / step).toFixed(Math.max(decimals, 0));
  return `${round(value)} ± ${round(sigma)}`;
}

function timeText(t) {
  if (!known(t)) return "–";
  const day = new Date(t), two = (number) => String(number).padStart(2, "0");
  return `${day.getFullYear()}-${two(day.getMonth() + 1)}-${two(day.getDate())} ${two(day.getHours())}:${two(day.getMinutes())}`;
}

function digits(number, count) {
  const text = known(number) ? number.toPrecision(count) : "–";
  return text.includes("e") ? String(Number(text)) : text;
}

const told = (um) => (known(um) ? um * UNITS.get(unit) : um); // an amplitude [µm 0-peak] in the unit chosen
const told3 = (um) => digits(told(um), 3);
const withUnit = (text, unit) => text + (unit === "°" || !unit ? unit : ` ${unit}`);

// The table
const estimate = (name, label) => ({
  name, label, kind: "number", value: (run) => run[name]?.[0],
  cell: (run) => [plusMinus(run[name]), run[name]?.[2] && make("small", {}, run[name][2])],
});
const COLUMNS = [
  { name: "file", label: "file", value: (run) => run.file },
  { name: "t", label: "recorded", kind: "time", value: (run) => run.t, cell: (run) => [timeText(run.t)] },
  { name: "rig", label: "rig", kind: "rig-name", value: (run) => run.rig, cell: (run) => [run.rig] },
  { name: "verdict", label: "verdict", value: outcome, cell: (run) => [make("span", { className: TONES[outcome(run)] ?? "unsure" }, outcome(run))] },
  { name: "status", label: "status", kind: "status", value: (run) => `${run.status} ${run.step ?? ""}`, cell: statusCell },
  estimate("kxx", "kxx, kN/m"), estimate("cxx", "cxx, N s/m"), estimate("u", "u, g mm"),
  { name: "critical", label: "critical speed, rpm", kind: "number", value: (run) => run.critical, cell: (run) => [digits(run.critical, 4), run.where && make("small", {}, run.where)] },
  { name: "q", label: "Q", kind: "number", value: (run) => run.q, cell: (run) => [digits(run.q, 3)] },
  { name: "residual", get label() { return `residual, ${unit}`; }, kind: "number", value: (run) => run.residual, cell: (run) => [told3(run.residual)] },
];

function statusCell(run) {
  if (run.status === "failed") return [`failed${run.step ? " after " + run.step : ""}`, run.sentence && make("small", {}, run.sentence)];
  const link = run.report && make("a", { href: run.report, ariaLabel: `report of ${run.file}` }, "report");
  return [run.status, (link || run.step) && ": ", link || run.step];
}

const collator = new Intl.Collator(undefined, { numeric: true });

function choose() {
  const wanted = state.text.toLowerCase().split(/\s+/).filter(Boolean);
  const passes = (run) =>
    wanted.every((word) => run.words.includes(word)) && (!state.verdict || outcome(run) === state.verdict) && (!state.rig || run.rig === state.rig);
  const down = state.sort.startsWith("-"), name = state.sort.replace("-", "");
  const value = (COLUMNS.find((column) => column.name === name) ?? COLUMNS[1]).value;
  const compare = (one, other) => {
    const a = value(one), b = value(other);
    if (!known(a) || !known(b)) return known(b) - known(a); // what is not known comes last, either way
    return (down ? -1 : 1) * (typeof a === "number" ? a - b : collator.compare(a, b));
  };
  shown = [...byId.values()].filter(passes).sort(compare);
}

function showHead() {
  const heads = COLUMNS.map(({ name, label, kind }) => {
    const head = make("th", { scope: "col", className: kind === "number" ? "" : kind ?? "" }, make("button", { type: "button", onclick: () => sortBy(name) }, label));
    if (state.sort.replace("-", "") === name) head.ariaSort = state.sort.startsWith("-") ? "descending" : "ascending";
    head.dataset.column = name;
    return head;
  });
  at("head").replaceChildren(make("th", { scope: "col" }, "Bode"), ...heads);
}

function sortBy(name) {
  state.sort = state.sort === name ? "-" + name : name;
  page = 0;
  showTable();
  at("head").querySelector(`[data-column="${name}"] button`).focus();
}

function showTable() {
  choose();
  showHead();
  const step = perPage(), pages = Math.max(Math.ceil(shown.length / step), 1);
  page = Math.min(page, pages - 1);
  at("rows").replaceChildren(...shown.slice(page * step, (page + 1) * step).flatMap(rowsOf));
  at("count").textContent = `${shown.length} of ${runs.length} runs`;
  at("pages").textContent = `page ${page + 1} of ${pages}`;
  at("previous").disabled = page === 0;
  at("next").disabled = page >= pages - 1;
  writeAddress();
}

function rowsOf(run) {
  const open = run.id === state.run;
  const button = make("button", { type: "button", ariaExpanded: String(open), onclick: () => toggle(run) }, ...brokenAtSlashes(run.file));
  const cells = COLUMNS.slice(1).map((column) => make("td", { className: column.kind ?? "" }, ...column.cell(run)));
  const row = make("tr", { className: open ? "open" : "", id: `run-${run.id}` }, make("td", {}, run.bode && checkbox(run)), make("th", { scope: "row" }, button), ...cells);
  return open ? [row, make("tr", { className: "more" }, make("td", { colSpan: COLUMNS.length + 1 }, allOf(run)))] : [row];
}

const brokenAtSlashes = (path) => path.split(/(?<=\/)/).flatMap((part, i) => (i ? [make("wbr"), part] : [part]));

function checkbox(run) {
  const checked = chosen().includes(run);
  return make("input", { type: "checkbox", checked, disabled: !checked && chosen().length >= MOST, ariaLabel: `Bode plot of ${run.file}`, onchange: () => overlay(run) });
}

function toggle(run) {
  state.run = state.run === run.id ? "" : run.id;
  showTable();
  at(`run-${run.id}`).querySelector("th button").focus({ preventScroll: true });
  moveRing();
}

// All that is known of a run: what the table has no column for
const pointOf = ({ points }, run) => points.find(([index]) => index === run.index) ?? [];
const unitOf = (trend) => (trend.unit === WRITTEN ? unit : trend.unit);
const inUnit = (trend, [index, ...values]) => [index, ...(trend.unit === WRITTEN ? values.map(told) : values)];

function valuesOf(run) {
  return trends.filter(({ group }) => group !== "Peaks").flatMap((trend) => {
    const [, value, low, high] = inUnit(trend, pointOf(trend, run));
    if (!known(value)) return [];
    const interval = known(low) && known(high) ? ` (${digits(low, 4)} to ${digits(high, 4)})` : "";
    const band = ["Fit", "Whole sweep"].includes(trend.group) ? "" : `, ${trend.group}`;
    return [[trend.label + band, withUnit(digits(value, 4), unitOf(trend)) + interval]];
  });
}

function peaksOf(run) {
  const places = new Map(); // probe and sweep -> its values by their kind
  for (const trend of trends.filter(({ group }) => group === "Peaks")) {
    const [kind, ...place] = trend.name.split(" "), [, value] = pointOf(trend, run);
    if (known(value)) places.set(place.join(" "), { ...places.get(place.join(" ")), [kind]: value });
  }
  return [...places].map(([place, { peak, critical, factor }]) => {
    const words = [known(peak) && `${told3(peak)} ${unit}`, known(critical) && `at ${digits(critical, 4)} rpm`, known(factor) && `Q ${digits(factor, 3)}`];
    return [`largest 1X, ${place}`, words.filter(Boolean).join(", ").replace(", at", " at")];
  });
}

function allOf(run) {
  const facts = [...valuesOf(run), ...peaksOf(run)];
  if (run.undetermined) facts.push(["not determined by this data", run.undetermined.join(", ")]);
  if (run.speeds) facts.push(["speeds, rpm", run.speeds.map((speed) => digits(speed, 4)).join(" to ")]);
  if (known(run.seconds)) facts.push(["duration, s", digits(run.seconds, 4)]);
  facts.push(["code", run.code ?? "–"], ["config", run.config ?? "–"]);
  const list = facts.map(([name, value]) => make("div", {}, make("dt", {}, name), make("dd", {}, value)));
  const untold = (run.causes ?? []).filter((words) => !run.sentence?.includes(words));
  const causes = untold.length > 0 && make("ul", {}, ...untold.map((words) => make("li", {}, words)));
  return make("div", { className: "all" }, run.sentence && make("p", {}, run.sentence), causes, make("dl", {}, ...list));
}

function mark(run) {
  state.run = run.id;
  const place = shown.indexOf(run);
  if (place >= 0) page = Math.floor(place / perPage());
  showTable();
  const row = at(`run-${run.id}`);
  row?.scrollIntoView({ block: "center" });
  row?.querySelector("th button").focus({ preventScroll: true });
  moveRing();
}

// Lists, and what happens when something is chosen
function fill(select, options, value) {
  select.replaceChildren(...options.map(([of, label]) => make("option", { value: of }, label)));
  select.value = value;
}

function counted(values, all) {
  const sorted = [...count(values)].sort(([one], [other]) => collator.compare(one, other));
  return [...(all ? [["", all]] : []), ...sorted.map(([value, count]) => [value, `${value} (${count})`])];
}

function fillLists() {
  at("text").value = state.text;
  at("size").value = state.size;
  fill(at("verdict"), counted(runs.map(outcome), "all"), state.verdict);
  fill(at("rig"), counted(runs.map((run) => run.rig), "all"), state.rig);
  const rigs = counted(runs.map((run) => run.rig));
  if (!rigs.some(([rig]) => rig === state.of)) state.of = state.rig || USUAL.of;
  fill(at("trend-rig"), rigs, state.of);
  const groups = [...new Set(trends.map(({ group }) => group))].map((label) =>
    make("optgroup", { label }, ...trends.filter(({ group }) => group === label).map((trend) => make("option", { value: trend.name }, trend.label))));
  at("quantity").replaceChildren(...groups);
  at("quantity").value = state.trend;
}

const showTrendSoon = settle(() => showTrend());

function refilter() {
  page = 0;
  showTable();
  showTrendSoon();
}

function listen() {
  for (const name of ["text", "verdict", "rig"]) at(name).addEventListener("input", () => { state[name] = at(name).value; if (name === "rig" && state.rig) at("trend-rig").value = state.of = state.rig; refilter(); });
  at("clear").addEventListener("click", () => { Object.assign(state, { text: "", verdict: "", rig: "" }); fillLists(); refilter(); });
  at("size").addEventListener("change", () => { state.size = at("size").value; page = 0; showTable(); });
  at("previous").addEventListener("click", () => { page -= 1; showTable(); });
  at("next").addEventListener("click", () => { page += 1; showTable(); });
  at("quantity").addEventListener("change", () => { state.trend = at("quantity").value; writeAddress(); showTrend(); });
  at("trend-rig").addEventListener("change", () => { state.of = at("trend-rig").value; writeAddress(); showTrend(); });
  at("point").addEventListener("input", () => { sayPoint(); moveRing(); });
  at("point").addEventListener("keydown", (event) => {
    if (event.key !== "Enter") return;
    event.preventDefault(); // or it would press the button that gets the focus
    at("mark").click();
  });
  at("mark").addEventListener("click", () => mark(walk[Number(at("point").value)].run));
  for (const name of ["probe", "direction"]) at(name).addEventListener("change", () => drawBode(chosen()));
  document.querySelectorAll("form").forEach((form) => form.addEventListener("submit", (event) => event.preventDefault()));
  document.addEventListener("click", (event) => { // links within the page leave the address as it is
    const target = event.target.closest?.('a[href^="#"]')?.getAttribute("href").slice(1);
    if (!target) return;
    event.preventDefault();
    Object.assign(at(target), { tabIndex: -1 }).focus();
    at(target).scrollIntoView();
  });
  addEventListener("hashchange", begin);
}

function begin() {
  readAddress();
  fillLists();
  choose();
  const place = shown.findIndex((run) => run.id === state.run);
  page = place < 0 ? 0 : Math.floor(place / perPage());
  showTable();
  showTrend();
  showBode();
}

offerUnits(() => { showTable(); showTrend(); showBode(); });
begin();
listen();
// ms from the request to the table's first paint; the plots come after it
rotorLab.shown = new Promise((done) => requestAnimationFrame(() => setTimeout(() => done(performance.now()))));
rotorLab.shown.then(watchPlots);

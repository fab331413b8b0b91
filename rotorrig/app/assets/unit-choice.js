// The unit in which a page tells amplitudes: pages state µm 0-peak, and a reader chooses another.
"use strict";
const WRITTEN = "µm 0-peak";
const UNITS = new Map([[WRITTEN, 1], ["µm pp", 2], ["mil pp", 2 / 25.4], ["mil 0-peak", 1 / 25.4]]);
const KEPT = "rotor-amplitude-unit"; // where the browser keeps the reader's choice for the next page
const chooser = document.getElementById("units");
let unit = WRITTEN;

function setUnit(wanted) {
  unit = UNITS.has(wanted) ? wanted : WRITTEN;
  chooser.value = unit;
}

// Lists the units, with the one of before or of the page chosen; whenever another is, `changed` is called.
function offerUnits(changed) {
  chooser.append(...[...UNITS.keys()].map((name) => new Option(name)));
  chooser.closest("label").hidden = false;
  let kept = null;
  try { kept = localStorage.getItem(KEPT); } catch { /* a browser that keeps nothing */ }
  setUnit(kept ?? document.body.dataset.units);
  chooser.addEventListener("change", () => {
    setUnit(chooser.value);
    try { localStorage.setItem(KEPT, unit); } catch { /* as above */ }
    changed();
  });
}

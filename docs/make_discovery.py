"""The picture of docs/discovery.md: what a report shows of a force that is missing. `python -m docs.make_discovery`.

A simulated rig whose bearing stands on a pedestal, with two planes and a trial mass, diagnosed without any known cause.
"""

import sys
import tempfile
from importlib import resources
from pathlib import Path

from plotly.offline import get_plotlyjs

from benchmarks.parts.blind.cases import Case
from benchmarks.parts.blind.measured import measured
from docs.browser import screenshot
from docs.origin import origin, save_png
from rotorrig.app.report.sections import missing_section
from rotorrig.identify import diagnose
from rotorrig.rig import RigError
from rotorrig.sims.effects import catalogue

COMMAND = "python -m docs.make_discovery"
OUT = Path(__file__).parent / "img" / "discovery.png"
RECORDINGS = Path(__file__).parents[1] / ".cache" / "blind"
PAGE = (1000, 1390)  # CSS pixels


def main() -> None:
    """Make the picture; a missing browser ends in one sentence."""
    responses = measured(Case(design="P2", faults=("pedestal",), seed=0), RECORDINGS).responses
    rig = responses[0].rig
    found = diagnose(responses, without={effect.name for effect in catalogue(rig)})
    print(found.sentence)
    section = missing_section(found, rig)
    if section is None:
        sys.exit("error: nothing was looked for, want a rig whose base model fails")
    with tempfile.TemporaryDirectory(prefix="rotor-picture-") as folder:
        page = Path(folder, "page.html")
        page.write_text(_page(section.html), encoding="utf-8")
        try:
            save_png(screenshot(page, PAGE), OUT, origin=origin(COMMAND, rig.hash))
        except RigError as error:
            sys.exit(f"error: {error}")


def _page(section: str) -> str:
    assets = resources.files("rotorrig.app").joinpath("assets")
    style = assets.joinpath("report.css").read_text(encoding="utf-8")
    return f"""<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><style>{style}
:root {{ color-scheme: light; }} body {{ padding: 4px 24px; }}
</style></head><body>{section}<script>{get_plotlyjs()}</script><script>
for (const data of document.querySelectorAll("script[data-figure]")) {{
  const figure = JSON.parse(data.textContent);
  Plotly.newPlot(data.dataset.figure, figure.data, figure.layout, {{ displayModeBar: false, responsive: true }});
}}
</script></body></html>"""


if __name__ == "__main__":
    main()

"""`python -m docs.make_chea_table7`: the pictures of docs/chea-table7.md, from runs of Table 7 looked at step by step.

A minute of CPU. The searches are those of benchmarks/chea_table7.py with the same seeds: one of each objective, f2
that finds the true minimum, f1 and f3 that lose it. Not made again by the tests: where a sum of amplitudes has kinks or
a flat valley, the last digit of a machine's linear algebra decides where a local search ends.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.parts.identification.seed_stages import Basin, Seen, place, watch
from benchmarks.parts.identification.table7 import ROOT, TRUTH, steady
from docs.chea_drawing import counted
from docs.origin import origin
from docs.svg_plot import COLOURS, FAINT, INK, Figure, Panel
from rotorrig.identify.base_model import ObjectiveName
from rotorrig.rig.config import load

Array = NDArray[np.float64]

COMMAND = "python -m docs.make_chea_table7"
IMAGES = Path(__file__).parent / "img"
#: objective -> the seed drawn
DRAWN: dict[ObjectiveName, int] = {"f1": 4, "f2": 1, "f3": 1}
LOOKED_AT = 40  # founders whose basin is shown
PAIRS = ((0, 1), (2, 3))  # kxx and kyy, cxx and cyy
NAMES = ("kxx", "kyy", "cxx", "cyy", "u")
UNITS = ("N/m", "N/m", "N s/m", "N s/m", "kg m")
SIDE, STEP, TOP, DOWN = 180, 250, 40, 250  # px
IN_BASIN = COLOURS[0]


def main() -> None:
    """Draw all three."""
    config = load(ROOT / "benchmarks/lalanne.toml").hash
    for objective, seed in DRAWN.items():
        figure = draw(watch(objective, seed), Basin(objective))
        figure.save(IMAGES / f"chea-table7-{objective}.svg", origin=origin(COMMAND, config))


def draw(seen: Seen, basin: Basin) -> Figure:
    """Draw founders, mature population and local searches of a run, over two parameters at a time."""
    figure = Figure(width=770, height=TOP + DOWN * len(PAIRS) + 44)
    looked_at = seen.founders[:LOOKED_AT]
    there = np.array([basin.leads_there(u) for u in looked_at])
    for row, pair in enumerate(PAIRS):
        titles = (
            f"{len(seen.founders)} founders",
            f"mature: {len(seen.mature)} points, {counted(len(seen.clusters), 'cluster')}",
            f"{len(seen.descents)} local searches",
        )
        panels = [_panel(figure, column, row, pair, title) for column, title in enumerate(titles)]
        _founders(panels[0], seen.founders, looked_at[there], pair)
        _mature(panels[1], seen, pair)
        _descents(panels[2], seen, pair)
        for panel in panels:
            panel.rings(place_log(place(TRUTH)[None], pair), colour=COLOURS[1], radius=6, width=2)
    y = TOP + DOWN * len(PAIRS) + 10
    blue = (IN_BASIN, f"in the basin of the true minimum, of {LOOKED_AT} founders looked at; local searches")
    figure.key_row(52, y, [blue])
    figure.circle(57, y + 16, 5, stroke=COLOURS[1])
    figure.words(68, y + 20, "true minimum", size=12)
    figure.words(170, y + 20, "× best of a cluster, end of a local search", size=12)
    figure.words(440, y + 20, "dashed: reduced boxes; other colours: clusters", size=12)
    return figure


def _panel(figure: Figure, column: int, row: int, pair: tuple[int, int], title: str) -> Panel:
    low, high = (place_log(np.full((1, 5), end), pair)[0] for end in (0.0, 1.0))
    labels = [f"log₁₀ {NAMES[i]} [{UNITS[i]}]" for i in pair]
    return figure.panel(
        (52 + STEP * column, TOP + DOWN * row, SIDE, SIDE),
        x=(float(low[0]), float(high[0])),
        y=(float(low[1]), float(high[1])),
        title="" if row else title,
        xlabel=labels[0],
        ylabel="" if column else labels[1],
    )


def _founders(panel: Panel, founders: Array, there: Array, pair: tuple[int, int]) -> None:
    panel.points(place_log(founders, pair), colour=FAINT, size=2.5)
    panel.points(place_log(there, pair), colour=IN_BASIN, size=5)


def _mature(panel: Panel, seen: Seen, pair: tuple[int, int]) -> None:
    for j, points in enumerate(seen.clusters):
        colour = COLOURS[2:][j % len(COLOURS[2:])]
        panel.points(place_log(points, pair), colour=colour, size=4)
    panel.crosses(place_log(seen.heads, pair), colour=INK)
    for box in seen.boxes:
        corners = place_log(box, pair)
        panel.box(corners[0], corners[1])


def _descents(panel: Panel, seen: Seen, pair: tuple[int, int]) -> None:
    for start, end in seen.descents:
        ends = place_log(np.stack([start, end]), pair)
        panel.line(*ends.T, colour=COLOURS[0], width=1.2)
        panel.points(ends[:1], colour=COLOURS[0], size=5)
    panel.crosses(place_log(np.array([end for _, end in seen.descents]).reshape(-1, 5), pair), colour=INK)


def place_log(u: Array, pair: tuple[int, int]) -> Array:
    """Return the common logarithms of two parameters at points (n, 5) of the unit cube, (n, 2)."""
    bounds = np.log10([*steady().space.bounds, *((a.low, a.high) for a in steady().space.amounts)])
    return (bounds[:, 0] + u * np.diff(bounds).ravel())[:, pair]


if __name__ == "__main__":
    main()

"""The pictures of chea.md, drawn from runs of the search: `python docs/make_chea_pictures.py`.

docs/img/chea-*.svg. The same on every run: all randomness is seeded.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from chea_runs import (
    BANANA,
    MULTIMODAL,
    PEAKS,
    RASTRIGIN,
    Function,
    Stage,
    answered,
    bred,
    clustered,
    watched,
)
from numpy.typing import NDArray
from scipy.spatial.distance import cdist
from svg_plot import COLOURS, FAINT, HAIR, INK, Figure, Panel

from rotorrig.identify.chea.art_knn import classify
from rotorrig.identify.chea.clustering import cef
from rotorrig.identify.chea.far_search import farthest
from rotorrig.identify.chea.genetic import gray_to_integer
from rotorrig.identify.chea.record import Record
from rotorrig.identify.chea.settings import SEED
from rotorrig.identify.chea.sqp import descend

Array = NDArray[np.float64]

IMAGES = Path(__file__).parent / "img"


def main() -> None:
    """Draw every picture."""
    IMAGES.mkdir(exist_ok=True)
    pictures = {
        "operators": operators,
        "generations": generations,
        "maturity": maturity,
        "art-knn": similarities,
        "sqp": descents,
        "far-search": far_search,
        "fig6": six_panels,
        "modern": modern,
    }
    for name, draw in pictures.items():
        draw().save(IMAGES / f"chea-{name}.svg")


# Section 2.1


def operators() -> Figure:
    """Two chromosomes, their children, and how much of a generation is new."""
    figure = Figure(width=800, height=270)
    rng = np.random.default_rng(3)
    parents = rng.integers(0, 2, (2, 2 * SEED.bits), dtype=np.uint8)
    cut, flipped = 15, 6
    origin = np.repeat([[0], [1]], 2 * SEED.bits, axis=1)
    swapped = np.where(np.arange(2 * SEED.bits) >= cut, origin[::-1], origin)
    children = np.take_along_axis(parents, swapped, axis=0)
    mutated = children[:1].copy()
    mutated[0, flipped] ^= 1
    rows = [*zip(parents, origin, strict=True), *zip(children, swapped, strict=True), (mutated[0], swapped[0])]
    figure.words(20, 26, "Crossover at one place, mutation of one bit; 12 bits per parameter")
    for (bits, whose), y, name in zip(
        rows, (50, 74, 118, 142, 186), ("parent 1", "parent 2", "child 1", "child 2", "child 1, mutated"), strict=True
    ):
        _chromosome(figure, 122, y, bits, whose, name, marked=flipped if "mutated" in name else None)
    figure.words(122 + 14 * cut, 235, "cut", size=12, anchor="middle")
    figure.box((122 + 14 * cut - 0.5, 42, 1, 180), fill=INK)
    panel = figure.panel(
        (615, 42, 165, 170), x=(0, 8), y=(0, 1), title="New in a generation", xlabel="generation", ylabel="share"
    )
    _new_individuals(panel)
    return figure


def _chromosome(
    figure: Figure,
    x: float,
    y: float,
    bits: NDArray[np.uint8],
    whose: NDArray[np.int_],
    name: str,
    *,
    marked: int | None,
) -> None:
    figure.words(x - 10, y + 13, name, size=12, anchor="end")
    for i, (bit, parent) in enumerate(zip(bits, whose, strict=True)):
        fill = ("#cfe3f1", "#f8dcc6")[parent]
        figure.box((x + 14 * i, y, 13, 17), fill=fill, stroke=INK if i == marked else "none")
        figure.words(x + 14 * i + 6.5, y + 13, str(bit), size=11, anchor="middle")
    place = gray_to_integer(bits.reshape(2, SEED.bits)) / (2**SEED.bits - 1)
    figure.words(x + 14 * len(bits) + 8, y + 13, f"({place[0]:.2f}, {place[1]:.2f})", size=12)


def _new_individuals(panel: Panel) -> None:
    generation = np.arange(9)
    panel.line(generation[1:], SEED.mutation * np.exp(-generation[1:] / 2), colour=FAINT, dash="4 3")
    panel.note(3.2, 0.62, "0.8 exp(-i/2)", colour=FAINT)
    for function, colour in zip((BANANA, MULTIMODAL, RASTRIGIN), COLOURS, strict=False):
        shares = []
        for seed in range(20):
            calls = [len(colony_record.points) for _, colony_record in bred(function, seed, generations=8)]
            shares.append(np.diff(calls, prepend=0) / SEED.population)
        panel.line(generation, np.mean(shares, axis=0), colour=colour)
    for i, (function, colour) in enumerate(zip((BANANA, MULTIMODAL, RASTRIGIN), COLOURS, strict=False)):
        panel.note(3.2, 0.92 - 0.09 * i, function.name, colour=colour)


def generations() -> Figure:
    """Fig. 2: a population gathers about the minima of eq. (3)."""
    figure = Figure(width=800, height=240)
    kept = []
    for colony, _ in bred(MULTIMODAL, 5, generations=SEED.max_generations):
        kept.append((colony.points, clustered(colony)))
        if kept[-1][1].cef < SEED.cef_stop:
            break
    for column, generation in enumerate(np.linspace(0, len(kept) - 1, 4).astype(int)):
        points, found = kept[generation]
        panel = _square(
            figure, column, MULTIMODAL, f"generation {generation}", levels=(-14, -9, -4),
            xlabel=f"{_counted(found.labels.max() + 1, 'cluster')}, CEF {found.cef:.2g}",
        )  # fmt: skip
        _by_cluster(panel, MULTIMODAL, points, found.labels)
    return figure


def maturity() -> Figure:
    """Maturity: the clustering evaluation function over generations, and over the similarity."""
    figure = Figure(width=800, height=300)
    left = figure.panel(
        (58, 34, 300, 215), x=(0, 12), y=(0.01, 100), log=True,
        title="least CEF of each generation", xlabel="generation", ylabel="CEF",
    )  # fmt: skip
    left.line([0, 12], [SEED.cef_stop] * 2, colour=INK, width=1, dash="4 3")
    left.note(11.8, 0.23, "mature below 0.2", anchor="end")
    for i, (function, colour) in enumerate(zip((BANANA, MULTIMODAL, RASTRIGIN), COLOURS, strict=False)):
        for seed in range(3):
            values = [clustered(colony).cef for colony, _ in bred(function, seed, generations=12)]
            left.line(range(len(values)), np.maximum(values, 1e-3), colour=colour, width=1.2)
        left.note(11.8, 60 / 1.8**i, function.name, colour=colour, anchor="end")
    right = figure.panel(
        (438, 34, 300, 215), x=(0.38, 0.92), y=(0.01, 100), log=True,
        title="CEF over similarity: eq. (3), generations 0 to 8", xlabel="similarity ρ", ylabel="CEF",
    )  # fmt: skip
    right.line([0.38, 0.92], [SEED.cef_stop] * 2, colour=INK, width=1, dash="4 3")
    for (colony, _), colour in zip(bred(MULTIMODAL, 5, generations=8), _shades(9), strict=True):
        scan = [(rho, _cef(colony.points, rho)) for rho in SEED.similarities]
        rho, values = np.array(scan).T
        right.line(rho, np.maximum(values, 1e-3), colour=colour)
        best = int(values.argmin())
        right.points([[rho[best], max(values[best], 1e-3)]], colour=colour, size=7)
        if colony.generation % 2 == 0:
            figure.words(745, 48 + 16 * colony.generation / 2, f"gen. {colony.generation}", size=12, colour=colour)
    return figure


# Sections 2.2 and 2.3


def similarities() -> Figure:
    """One population classified at four similarities."""
    figure = Figure(width=800, height=240)
    colony = next(colony for colony, _ in bred(MULTIMODAL, 5, generations=3) if colony.generation == 3)
    for column, rho in enumerate((0.5, 0.7, 0.8, 0.9)):
        labels = classify(colony.points, similarity=rho)
        words = f"{_counted(labels.max() + 1, 'cluster')}, CEF {_cef(colony.points, rho):.2g}"
        panel = _square(figure, column, MULTIMODAL, f"similarity {rho:g}", levels=(), xlabel=words)
        _by_cluster(panel, MULTIMODAL, colony.points, labels)
        for j in range(labels.max() + 1):
            centre = MULTIMODAL.place(colony.points[labels == j].mean(axis=0))
            panel.circle(centre, (1 - rho) * np.sqrt(2) * 2 * MULTIMODAL.half, colour=FAINT)
    return figure


# Section 2.4


def descents() -> Figure:
    """SQP from the best of each cluster, and along the banana's valley."""
    figure = Figure(width=800, height=282)
    colony = next(colony for colony, _ in bred(MULTIMODAL, 5, generations=30) if clustered(colony).cef < 0.2)
    left = _square(figure, 0, MULTIMODAL, "from each cluster", levels=(-14, -9, -4), side=200, step=254)
    found = clustered(colony)
    for j, members in enumerate(found.members()):
        best = members[colony.fun[members].argmin()]
        path = _descent(MULTIMODAL, colony.points[best])
        left.points(MULTIMODAL.place(colony.points[members]), colour=COLOURS[j % 8], size=2.5)
        left.line(*MULTIMODAL.place(path).T, colour=INK, width=1.2)
        left.rings(MULTIMODAL.place(path[-1:]), radius=5)
    middle = _square(figure, 1, BANANA, "along the banana", levels=(1, 10, 100, 700), side=200, step=254)
    right = figure.panel(
        (580, 34, 200, 200), x=(0, 120), y=(1e-14, 1e4), log=True, title="lowest f of each descent", xlabel="calls"
    )
    for start, colour in zip(((-1.5, -1.0), (-1.2, 1.0), (0.5, -1.5)), COLOURS, strict=False):
        path = _descent(BANANA, np.array(start) / 4 + 0.5)
        middle.line(*BANANA.place(path).T, colour=colour)
        middle.rings([start], colour=colour, radius=4)
        right.line(np.arange(len(path)), np.maximum(np.minimum.accumulate(BANANA.at(path)), 1e-16), colour=colour)
    middle.crosses([[1, 1]])
    return figure


def _descent(function: Function, start: Array) -> Array:
    """Return all points evaluated on a descent from `start`, (n, 2), finite differences included."""
    record = Record(2, same_point=SEED.same_point)
    record.add(start[None], function.at(start[None]))
    end, _ = answered(descend(record, start, float(record.values[0])), function, record)
    return np.vstack([record.points, end])


# Section 2.5


def far_search() -> Figure:
    """Points far from all previous ones, beside plain random points."""
    figure = Figure(width=800, height=282)
    gathered = 0.5 + 0.1 * np.random.default_rng(1).standard_normal((60, 2))
    counts = np.unique(np.geomspace(5, 400, 15).astype(int))
    panel = figure.panel(
        (580, 34, 200, 200), x=(0, 400), y=(0, 0.4), title="largest hole left, mean of 10", xlabel="points",
        ylabel="radius (edge of the cube: 1)",
    )  # fmt: skip
    probes = np.stack(np.meshgrid(*[np.linspace(0, 1, 61)] * 2), axis=-1).reshape(-1, 2)
    for column, (candidates, name) in enumerate(((1, "plain random"), (SEED.far_candidates, "best of five"))):
        colour = COLOURS[1 - column]
        holes = []
        for seed in range(10):
            points = _far_points(gathered, candidates, counts[-1], np.random.default_rng(seed))
            reach = np.minimum.accumulate(cdist(probes, np.vstack([gathered, points])), axis=1)
            holes.append([reach[:, len(gathered) + n - 1].max() for n in counts])
        panel.line(counts, np.mean(holes, axis=0), colour=colour)
        panel.note(390, 0.34 - 0.03 * column, name, colour=colour, anchor="end")
        square = figure.panel((48 + 254 * column, 34, 200, 200), x=(0, 1), y=(0, 1), title=f"100 points, {name}")
        points = _far_points(gathered, candidates, 100, np.random.default_rng(0))
        square.points(gathered, colour=FAINT, size=3)
        square.points(points, colour=colour, size=4)
    return figure


def _far_points(before: Array, candidates: int, n: int, rng: np.random.Generator) -> Array:
    points = before
    for _ in range(n):
        points = np.vstack([points, farthest(rng.random((candidates, 2)), points)])
    return points[len(before) :]


# Section 3


def six_panels() -> Figure:
    """Fig. 6: the chapter's own procedure on Rastrigin's function, from the first seed that reduces its bounds."""
    stages = next(found for seed in range(100) if len(found := watched(RASTRIGIN, seed, "seed")) > 3)
    first, second = stages[0], stages[2]
    figure = Figure(width=800, height=540)
    everywhere = np.stack(np.meshgrid(np.arange(-4, 5), np.arange(-4, 5)), axis=-1).reshape(-1, 2)

    def panel(i: int, title: str) -> Panel:
        drawn = _square(figure, i % 3, RASTRIGIN, title, levels=(), top=34 + 268 * (i // 3), side=196, step=262)
        drawn.points(everywhere, colour=HAIR, size=6)
        return drawn

    panel(0, "(a) first generation").points(RASTRIGIN.place(first.batches[0]), size=3)
    gathered = panel(1, f"(b) GA ends after generation {len(first.batches) - 1}")
    gathered.points(RASTRIGIN.place(np.vstack(first.batches[-3:])), size=3)
    _ends(panel(2, "(c) local searches from there"), stages[1], known=None)
    reduced = panel(3, "(d) GA on reduced bounds")
    box = second.batches[0]
    reduced.box(RASTRIGIN.place(box.min(axis=0)), RASTRIGIN.place(box.max(axis=0)))
    reduced.points(RASTRIGIN.place(np.vstack(second.batches[-3:])), size=3)
    _ends(panel(4, "(e) local searches there"), stages[3], known=stages[1].minima)
    last = panel(5, "(f) random search, and the list")
    last.points(RASTRIGIN.place(stages[-1].points), colour=COLOURS[4], size=2.5)
    last.crosses(RASTRIGIN.place(stages[-1].minima), colour=COLOURS[1])
    return figure


def _ends(panel: Panel, stage: Stage, *, known: Array | None) -> None:
    for path in stage.batches:
        panel.line(*RASTRIGIN.place(path).T, colour=COLOURS[0], width=1.2)
        panel.points(RASTRIGIN.place(path[:1]), colour=COLOURS[0], size=5)
    new = stage.minima if known is None else stage.minima[cdist(stage.minima, known).min(axis=1) > SEED.same_point]
    panel.crosses(RASTRIGIN.place(new), colour=COLOURS[1])


def modern() -> Figure:
    """Section "The modern profile": where it looked, what it lists and how the best fell, on eqs. (3) and (4)."""
    figure = Figure(width=800, height=310)
    stages = [watched(function, 0, "modern") for function in (MULTIMODAL, RASTRIGIN)]
    names = list(dict.fromkeys(stage.name for found in stages for stage in found))
    colour = dict(zip(names, COLOURS, strict=False))
    right = figure.panel(
        (580, 34, 200, 200), x=(0, max(sum(len(stage.points) for stage in found) for found in stages)),
        y=(1e-12, 100), log=True, title="lowest f above the minimum", xlabel="calls",
    )  # fmt: skip
    for column, (function, found) in enumerate(zip((MULTIMODAL, RASTRIGIN), stages, strict=True)):
        calls = sum(len(stage.points) for stage in found)
        panel = _square(figure, column, function, f"{function.name}, {calls} calls", levels=(), side=200, step=254)
        for stage in found:
            panel.points(function.place(stage.points), colour=colour[stage.name], size=3.5)
        panel.rings(function.place(found[-1].minima), radius=5, width=1.2)
        values = function.at(np.vstack([stage.points for stage in found]))
        lowest = MULTIMODAL.fun(PEAKS).min() if function is MULTIMODAL else 0.0
        right.line(np.arange(calls), np.maximum(np.minimum.accumulate(values) - lowest, 1e-13), colour=INK,
                   dash="none" if column else "4 3")  # fmt: skip
    for i, name in enumerate(names):
        figure.key(48 + 90 * i, 290, [(colour[name], name)])
    figure.words(780, 290, "○ listed minimum; dashed: multi-modal", size=12, anchor="end")
    return figure


def _cef(points: Array, similarity: float) -> float:
    return cef(points, classify(points, similarity=similarity), similarity=similarity, settings=SEED)


def _square(
    figure: Figure,
    column: int,
    function: Function,
    title: str,
    *,
    levels: Sequence[float],
    side: float = 152,
    step: float = 192,
    top: float = 34,
    xlabel: str = "x₁",
) -> Panel:
    panel = figure.panel(
        (48 + step * column, top, side, side), x=function.ends, y=function.ends, title=title, xlabel=xlabel,
        ylabel="" if column else "x₂",
    )  # fmt: skip
    panel.levels(function.fun, levels)
    return panel


def _counted(n: int, what: str) -> str:
    return f"{n} {what}{'' if n == 1 else 's'}"


def _by_cluster(panel: Panel, function: Function, points: Array, labels: NDArray[np.intp]) -> None:
    for j in range(labels.max() + 1):
        panel.points(function.place(points[labels == j]), colour=COLOURS[j % len(COLOURS)], size=3.5)


def _shades(n: int) -> list[str]:
    """Return colours from light to dark blue."""
    return [f"hsl(205, 80%, {75 - 50 * i / (n - 1):.0f}%)" for i in range(n)]


if __name__ == "__main__":
    main()

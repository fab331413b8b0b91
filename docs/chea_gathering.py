"""Pictures of sections 2.1 to 2.3 of chea.md: a population gathers, is clustered, and is mature."""

import numpy as np
from numpy.typing import NDArray

from docs.chea_drawing import coloured_by_cluster, counted, square
from docs.chea_runs import BANANA, MULTIMODAL, RASTRIGIN, bred, clustered
from docs.svg_plot import COLOURS, FAINT, INK, Figure, Panel
from rotorrig.identify.chea import SEED
from rotorrig.identify.chea.chapter.art_knn import classify
from rotorrig.identify.chea.chapter.clustering import cef
from rotorrig.identify.chea.chapter.genetic import gray_to_integer

Array = NDArray[np.float64]


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
        panel = square(
            figure, column, MULTIMODAL, f"generation {generation}", levels=(-14, -9, -4),
            xlabel=f"{counted(found.labels.max() + 1, 'cluster')}, CEF {found.cef:.2g}",
        )  # fmt: skip
        coloured_by_cluster(panel, MULTIMODAL, points, found.labels)
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


def similarities() -> Figure:
    """One population classified at four similarities."""
    figure = Figure(width=800, height=240)
    colony = next(colony for colony, _ in bred(MULTIMODAL, 5, generations=3) if colony.generation == 3)
    for column, rho in enumerate((0.5, 0.7, 0.8, 0.9)):
        labels = classify(colony.points, similarity=rho)
        words = f"{counted(labels.max() + 1, 'cluster')}, CEF {_cef(colony.points, rho):.2g}"
        panel = square(figure, column, MULTIMODAL, f"similarity {rho:g}", levels=(), xlabel=words)
        coloured_by_cluster(panel, MULTIMODAL, colony.points, labels)
        for j in range(labels.max() + 1):
            centre = MULTIMODAL.place(colony.points[labels == j].mean(axis=0))
            panel.circle(centre, (1 - rho) * np.sqrt(2) * 2 * MULTIMODAL.half, colour=FAINT)
    return figure


def _cef(points: Array, similarity: float) -> float:
    return cef(points, classify(points, similarity=similarity), similarity=similarity, settings=SEED)


def _shades(n: int) -> list[str]:
    """Return colours from light to dark blue."""
    return [f"hsl(205, 80%, {75 - 50 * i / (n - 1):.0f}%)" for i in range(n)]

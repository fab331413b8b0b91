"""The chapter's Fig. 3, the structure of ART-KNN, with the neurons that a population has made it store."""

from collections.abc import Iterable

import numpy as np

from docs.chea_runs import MULTIMODAL, bred, clustered
from docs.svg_plot import COLOURS, HAIR, INK, Figure
from rotorrig.identify.chea.chapter.art_knn import classify

GENERATION, FOUNDERS = 4, 5  # the first that is mature, of the run whose populations docs/chea.md draws
LEFT, RIGHT = 34.0, 354.0  # px, ends of the attentional subsystem
DISCERNED, COMPARED = 92.0, 196.0  # px, height of its layers
BETWEEN = (LEFT + RIGHT) / 2
NODE = 11.0  # px
ORIENTING = (406.0, 120.0, 108.0, 48.0)
UP, DOWN, RESET = COLOURS[0], COLOURS[2], COLOURS[1]


def network() -> Figure:
    """Fig. 3: both layers and the orienting subsystem, and how the discernment layer grew with the population."""
    figure = Figure(width=800, height=310)
    *_, (colony, _) = bred(MULTIMODAL, FOUNDERS, generations=GENERATION)
    found = clustered(colony)
    neurons = int(found.labels.max()) + 1
    _attentional(figure, neurons)
    _orienting(figure, found.similarity)
    best_first = colony.points[colony.fun.argsort(kind="stable")]
    shown = np.arange(1, len(best_first) + 1)
    grown = [classify(best_first[:n], similarity=found.similarity).max() + 1 for n in shown]
    panel = figure.panel(
        (590, 40, 180, 200), x=(0, len(best_first)), y=(0, neurons + 1), title="neurons",
        xlabel=f"individuals seen, of generation {GENERATION}",
    )  # fmt: skip
    panel.line(np.repeat(shown, 2)[1:], np.repeat(grown, 2)[:-1], colour=INK)
    return figure


def _attentional(figure: Figure, neurons: int) -> None:
    """Draw the two layers; each node of one is connected to each node of the other, both ways."""
    stored = np.linspace(LEFT + 22, RIGHT - 62, neurons)
    new = RIGHT - 20
    inputs = (BETWEEN - 60, BETWEEN + 60)
    figure.box((LEFT - 14, 30, RIGHT - LEFT + 28, 204), fill="#f7f7f7", stroke=HAIR)
    figure.words(LEFT - 4, 50, "attentional subsystem", size=12)
    for x in inputs:
        for z in stored:
            figure.path([(x - 2, COMPARED), (z - 2, DISCERNED)], colour=UP, width=0.7)
            figure.path([(x + 2, COMPARED), (z + 2, DISCERNED)], colour=DOWN, width=0.7)
        figure.path([(x, COMPARED), (new, DISCERNED)], colour=RESET, width=0.7, dash="3 3")
        figure.path([(x, 262), (x, COMPARED + NODE + 2)], colour=INK, arrow=True)
    _nodes(figure, stored, DISCERNED, stroke=INK)
    _nodes(figure, [new], DISCERNED, stroke=RESET)
    _nodes(figure, inputs, COMPARED, stroke=INK)
    figure.words(LEFT - 4, DISCERNED - 18, f"discernment layer, {neurons} neurons", size=12)
    figure.words(new, DISCERNED - 18, "next", size=12, colour=RESET, anchor="middle")
    figure.words(BETWEEN, COMPARED + 30, "comparison layer", size=12, anchor="middle")
    for x, name in zip(inputs, ("x₁", "x₂"), strict=True):
        figure.words(x, 278, name, anchor="middle")
    figure.words(BETWEEN, 278, "individual", size=12, anchor="middle")
    figure.key_row(LEFT - 14, 300, [(UP, "bottom-up"), (DOWN, "top-down: weights"), (RESET, "on a mismatch")])


def _nodes(figure: Figure, places: Iterable[float], height: float, *, stroke: str) -> None:
    for x in places:
        figure.circle(x, height, NODE, fill="#fff", stroke=stroke)


def _orienting(figure: Figure, similarity: float) -> None:
    """Draw what lets the winner learn, or calls for a new neuron."""
    x, y, width, height = ORIENTING
    middle = x + width / 2
    figure.box(ORIENTING, fill="#f7f7f7", stroke=INK)
    figure.words(middle, y + 20, "orienting", size=12, anchor="middle")
    figure.words(middle, y + 36, "subsystem", size=12, anchor="middle")
    figure.path([(RIGHT + 14, COMPARED), (middle, COMPARED), (middle, y + height + 2)], colour=INK, arrow=True)
    figure.words(RIGHT + 22, COMPARED + 16, "alike by at least", size=12)
    figure.words(RIGHT + 22, COMPARED + 31, f"ρ = {similarity:.2g}?", size=12)
    figure.path([(middle, y), (middle, DISCERNED), (RIGHT + 16, DISCERNED)], colour=RESET, arrow=True)
    figure.words(middle, DISCERNED - 8, "no: reset", size=12, colour=RESET, anchor="middle")

"""Pictures of sections 2.4 and 2.5 of chea.md: local searches, and points far from all others."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from docs.chea_drawing import square
from docs.chea_runs import BANANA, MULTIMODAL, Function, answered, bred, clustered
from docs.svg_plot import COLOURS, FAINT, INK, Figure
from rotorrig.identify.chea import SEED
from rotorrig.identify.chea.session import Record
from rotorrig.identify.chea.steps import descend, farthest

Array = NDArray[np.float64]

CLOSE = 1e-4  # of f: nearer to the minimum, what differences round to shows in the picture


def descents() -> Figure:
    """SQP from the best of each cluster, and along the banana's valley."""
    figure = Figure(width=800, height=282)
    colony = next(colony for colony, _ in bred(MULTIMODAL, 5, generations=30) if clustered(colony).cef < 0.2)
    left = square(figure, 0, MULTIMODAL, "from each cluster", levels=(-14, -9, -4), side=200, step=254)
    found = clustered(colony)
    for j, members in enumerate(found.members()):
        best = members[colony.fun[members].argmin()]
        path = _descent(MULTIMODAL, colony.points[best])
        left.points(MULTIMODAL.place(colony.points[members]), colour=COLOURS[j % 8], size=2.5)
        left.line(*MULTIMODAL.place(path).T, colour=INK, width=1.2)
        left.rings(MULTIMODAL.place(path[-1:]), radius=5)
    middle = square(figure, 1, BANANA, "along the banana", levels=(1, 10, 100, 700), side=200, step=254)
    right = figure.panel(
        (580, 34, 200, 200), x=(0, 150), y=(CLOSE, 1e4), log=True, title="lowest f of each descent", xlabel="calls"
    )
    for start, colour in zip(((-1.5, -1.0), (-1.2, 1.0), (0.5, -1.5)), COLOURS, strict=False):
        path = _descent(BANANA, np.array(start) / 4 + 0.5)
        path = path[: 1 + int(np.argmax(BANANA.at(path) < CLOSE))]
        middle.line(*BANANA.place(path).T, colour=colour)
        middle.rings([start], colour=colour, radius=4)
        right.line(np.arange(len(path)), np.maximum(np.minimum.accumulate(BANANA.at(path)), CLOSE), colour=colour)
    middle.crosses([[1, 1]])
    return figure


def _descent(function: Function, start: Array) -> Array:
    """Return all points evaluated on a descent from `start`, (n, 2), finite differences included."""
    record = Record(2, same_point=SEED.same_point)
    record.add(start[None], function.at(start[None]))
    end, _ = answered(descend(record, start, float(record.values[0])), function, record)
    return np.vstack([record.points, end])


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

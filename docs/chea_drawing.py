"""What several pictures of chea.md share: a function's box seen from above, points in their clusters' colours."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from docs.chea_runs import Function
from docs.svg_plot import COLOURS, Figure, Panel

Array = NDArray[np.float64]


def square(
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
    """Return the panel of a function's box, number `column` from the left, with its contours at `levels`."""
    panel = figure.panel(
        (48 + step * column, top, side, side), x=function.ends, y=function.ends, title=title, xlabel=xlabel,
        ylabel="" if column else "x₂",
    )  # fmt: skip
    panel.levels(function.fun, levels)
    return panel


def coloured_by_cluster(panel: Panel, function: Function, points: Array, labels: NDArray[np.intp]) -> None:
    """Draw points (n, 2) of the unit cube, those of a cluster in one colour."""
    for j in range(labels.max() + 1):
        panel.points(function.place(points[labels == j]), colour=COLOURS[j % len(COLOURS)], size=3.5)


def counted(n: int, what: str) -> str:
    """Return a number and its noun.

    >>> counted(1, "cluster"), counted(3, "cluster")
    ('1 cluster', '3 clusters')
    """
    return f"{n} {what}{'' if n == 1 else 's'}"

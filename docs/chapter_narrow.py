"""The chapter's Fig. 4, a narrow and deep minimum, and how often its algorithm finds it with its far points."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from docs.chea_drawing import square
from docs.chea_runs import Function, watched
from docs.svg_plot import COLOURS, INK, Figure
from rotorrig.identify.chea import SEED, chea

Array = NDArray[np.float64]

WIDE, NARROW = np.array([-0.35, -0.25]), np.array([0.55, 0.45])
DRAWN = 0.05  # half width of the well: where its slope is steepest
WIDTHS = (0.02, 0.03, 0.05, 0.07, 0.1)
RUNS = 40
SEEN = 0.02  # in both parameters: a minimum of the list as near as this is the narrow one
GATHERED, AFTERWARDS, WITHOUT = COLOURS[2], COLOURS[4], COLOURS[0]


def well(width: float) -> Function:
    """Return a bowl with a well aside, 2 deep where the bowl is 1.3 high."""

    def fun(x: Array) -> Array:
        bowl = ((x - WIDE) ** 2).sum(axis=1)
        return np.asarray(bowl - 2 * np.exp(-((x - NARROW) ** 2).sum(axis=1) / (2 * width**2)))

    return Function("narrow", fun, 1.0)


def found(width: float, *, far: bool) -> float:
    """Return the share of runs that list the narrow minimum, with the far points or without [%]."""
    settings = SEED if far else replace(SEED, far_iterations=0)
    function = well(width)
    hits = 0
    for seed in range(RUNS):
        run = chea(function.fun, [function.ends] * 2, rng=seed, profile="seed", settings=settings, vectorized=True)
        hits += bool((np.abs(run.xl - NARROW).max(axis=1) < SEEN).any())
    return 100 * hits / RUNS


def narrow_minimum() -> Figure:
    """Fig. 4: the objective along a line, the points of a run, and the share of runs that find the minimum."""
    figure = Figure(width=800, height=310)
    function = well(DRAWN)
    share = np.linspace(-0.6, 1.4, 801)
    line = WIDE + share[:, None] * (NARROW - WIDE)
    panel = figure.panel((48, 34, 200, 200), x=(-0.6, 1.4), y=(-1, 1.5), title="through both minima",
                         xlabel="from the wide one (0) to the narrow one (1)", ylabel="f")  # fmt: skip
    panel.line(*panel.straightened(share, function.fun(line), within=0.2), colour=INK)
    calls = square(figure, 1, function, "points of a run", levels=(-0.5, 0.1, 0.4, 0.8, 1.3, 2), side=200, step=266)
    for stage in watched(function, 0, "seed"):
        calls.points(function.place(stage.points), colour=GATHERED if stage.name == "genetic" else AFTERWARDS, size=3)
    calls.rings([WIDE, NARROW], radius=7)
    right = figure.panel((580, 34, 200, 200), x=(0, 0.11), y=(0, 105), title=f"found, of {RUNS} runs [%]",
                         xlabel="half width of the narrow one (box: 2)")  # fmt: skip
    for far, colour in ((True, AFTERWARDS), (False, WITHOUT)):
        shares = [found(width, far=far) for width in WIDTHS]
        right.line(WIDTHS, shares, colour=colour)
        right.points(np.column_stack([WIDTHS, shares]), colour=colour, size=6)
    figure.key_row(314, 294, [(GATHERED, "genetic algorithm"), (AFTERWARDS, "after it")])
    figure.key_row(580, 294, [(AFTERWARDS, "with far points"), (WITHOUT, "without")])
    return figure

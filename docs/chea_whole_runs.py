"""Pictures of section 3 of chea.md and of the modern profile: whole searches, step by step."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from docs.chea_drawing import square
from docs.chea_runs import MULTIMODAL, PEAKS, RASTRIGIN, Stage, watched
from docs.svg_plot import COLOURS, HAIR, INK, Figure, Panel
from rotorrig.identify.chea import SEED

Array = NDArray[np.float64]


def six_panels() -> Figure:
    """Fig. 6: the chapter's own procedure on Rastrigin's function, from the first seed that reduces its bounds."""
    stages = next(found for seed in range(100) if len(found := watched(RASTRIGIN, seed, "seed")) > 3)
    first, second = stages[0], stages[2]
    figure = Figure(width=800, height=540)
    everywhere = np.stack(np.meshgrid(np.arange(-4, 5), np.arange(-4, 5)), axis=-1).reshape(-1, 2)

    def panel(i: int, title: str) -> Panel:
        drawn = square(figure, i % 3, RASTRIGIN, title, levels=(), top=34 + 268 * (i // 3), side=196, step=262)
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
        panel = square(figure, column, function, f"{function.name}, {calls} calls", levels=(), side=200, step=254)
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

"""What benchmarks/chea_tables.py prints and writes."""

import sys
import textwrap
from collections.abc import Callable, Sequence

import numpy as np
import scipy

from benchmarks.parts.chea.chapter import CHAPTER, Printed
from benchmarks.parts.chea.functions import cases_beyond, chapter_cases
from benchmarks.parts.chea.peers import CHEA, METHODS, Method
from benchmarks.parts.chea.score import ONE_PLACE, Score
from benchmarks.parts.tables import markdown
from rotorrig.rig import code_version

Scores = dict[str, dict[str, Score | None]]  # method -> function -> what it came to; None: not run

TITLES = {
    "f1": "f1, the banana, on the chapter's box (Table 2)",
    "f2": "f2, four global minima, on the chapter's box (Table 3)",
    "f3": "f3, Rastrigin, on the chapter's box (Table 4)",
    "f1s": "f1s, on a box shifted by up to 40 % of its half width",
    "f2s": "f2s, shifted by up to 40 %: all four stay inside",
    "f3s": "f3s, shifted by up to 60 %",
    "f3r": "f3r, shifted as f3s and rotated by any angle",
}
HEAD = ("calls", "median", "max", "f", "x", "worst error", "success", "minima", "all global")


def page(
    chapter: Scores,
    beyond: Scores,
    methods: Sequence[Method],
    *,
    seeds: int,
    peer_seeds: int,
    dimensions: int,
    calls_per_dimension: int,
) -> str:
    """Return docs/chea-tables.md."""
    entries = [f"- {label(m.name)} ({m.package} {m.version or 'not installed'}): {m.settings}" for m in methods]
    listed = "\n".join(textwrap.fill(entry, 120, subsequent_indent="  ") for entry in entries)
    text = f"""# CHEA beside its peers

Written by `benchmarks/chea_tables.py --write`; do not edit. rotorrig {code_version()}, numpy {np.__version__}, scipy
{scipy.__version__}, Python {sys.version.split()[0]}.

The functions are those of the chapter's Tables 2 to 4, misprints put right, as minimisation (the chapter maximises
f2). One wrapper around the function counts every call, those of finite differences included. Each seed has its own
shift and angle, the same for every method. {seeds} runs of CHEA, {peer_seeds} of each peer. Every method has one set of
settings for all functions, and runs to its natural end; where it has none, to the budget named:

{listed}

Columns:

- calls: mean, median and largest. f: mean of the best values. x: mean of the best points, each as measured from the
  global minimum nearest to it. worst error: of any parameter in any run.
- success: the best point is within 1e-3 of a global minimum in every parameter. all global: every global minimum has a
  point this close in the list of minima.
- minima: how many the method lists. A point counts if the function is nowhere lower on a circle of radius 1e-3
  about it, as far as that lies in the box; points within {ONE_PLACE:g} of the half width count as one. A method that
  returns one point lists one. Some show what they met to a callback; that is not a list either.
- The chapter's rows are as printed; empty where it is silent. Its EGA and ASA were other programs than the elitist
  genetic algorithm here and dual_annealing, the successor of its kind.

"""
    text += "\n\n".join(tables(chapter))
    if dimensions:
        text += _beyond(beyond, dimensions, calls_per_dimension)
    return text + "\n"


def tables(scores: Scores) -> list[str]:
    """Return a table per function of the chapter, with the chapter's own rows below."""
    return [_table(case.name, scores) for case in chapter_cases()]


def dimension_tables(scores: Scores) -> list[str]:
    """Return the tables of success, of calls, and of the share found where there are several global minima."""
    count = {case.name: case.minima.count for case in cases_beyond()}
    several = {name: f"{name} ({n:,})" for name, n in count.items() if n > 1}
    alone = {name: name for name in count}
    return [
        _matrix("success, % of runs", alone, scores, lambda score: f"{100 * score.success:.0f}"),
        _matrix("calls, mean", alone, scores, lambda score: f"{score.calls:,.0f}"),
        _matrix("global minima listed, % of them", several, scores, lambda score: _percent(score.share)),
    ]


def _beyond(scores: Scores, runs: int, calls_per_dimension: int) -> str:
    found = "\n\n".join(dimension_tables(scores))
    return f"""

## Beyond the chapter

The number behind a name is that of dimensions; {runs} runs of every method. The budget is {calls_per_dimension:,} calls
per dimension for all alike; a method that ends before is left to end. Stopped there, CHEA and the multistart still have
their lists, the others their best point. A point finds a minimum if it is within 1e-3 of the half width of the box in
every parameter. The boxes of Ackley, Griewank, Levy and Rastrigin, whose minima lie in or near the middle, are shifted
by up to 60 %, and Rastrigin is rotated; Schwefel's, which would let in deeper minima, has the signs of its parameters
turned at random. The number of global minima is in brackets where there are several. shgo triangulates its points: in
the dimensions without figures that takes minutes, or more memory than there is.

{found}"""


def _table(case: str, scores: Scores) -> str:
    rows = [(label(name), *_cells(found[case])) for name, found in scores.items()]
    printed = [(f"{name}, the chapter's", *_printed(found[case])) for name, found in CHAPTER.items() if case in found]
    return markdown((TITLES[case], *HEAD), rows + printed)


def _cells(score: Score | None) -> tuple[str, ...]:
    if score is None:
        return ("not installed", *("" for _ in HEAD[1:]))
    return (
        f"{score.calls:,.0f}",
        f"{score.calls_median:,.0f}",
        f"{score.calls_max:,}",
        _value(score.fun),
        _point(score.x),
        f"{score.worst:.0e}",
        f"{100 * score.success:.0f} %",
        f"{score.minima:.1f}",
        f"{100 * score.all_globals:.0f} %",
    )


def _printed(row: Printed) -> tuple[str, ...]:
    share = ["" if part is None else f"{100 * part:.0f} %" for part in (row.success, row.all_globals)]
    return (f"{row.calls:,}", "", "", _value(row.fun), _point(row.x), "", share[0], str(row.minima), share[1])


def _matrix(title: str, rows: dict[str, str], scores: Scores, cell: Callable[[Score], str]) -> str:
    def text(score: Score | None) -> str:
        return "-" if score is None else cell(score)

    head = (title, *(label(name) for name in scores))
    return markdown(head, [(shown, *(text(found[name]) for found in scores.values())) for name, shown in rows.items()])


def _percent(part: float) -> str:
    """Return two digits, or whole percents from ten on; shares may be as small as one in 6^10."""
    return f"{100 * part:.0f}" if part >= 0.1 else f"{100 * part:.2g}"


def label(name: str) -> str:
    """Return the name of a method as printed."""
    return f"CHEA {name}" if METHODS[name] in CHEA else name


def _value(fun: float) -> str:
    return f"{fun:.5f}" if abs(fun) > 0.01 else f"{fun:.1e}"


def _point(x: Sequence[float]) -> str:
    return ", ".join(f"{value + 0.0:.4f}" for value in np.round(x, 4))

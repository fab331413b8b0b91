"""docs/chea-table7.md: Table 7 by the chapter's algorithm, from the runs kept in docs/chea-table7.json."""

import json

import numpy as np

from benchmarks.chea_table7 import KEPT, restore
from benchmarks.parts.identification import seed_table7
from benchmarks.parts.identification.seed_stages import PATIENCE, SAMPLE
from benchmarks.parts.identification.table7 import EXACT, OBJECTIVES, oracle_response


def text() -> str:
    """Return the page."""
    kept = json.loads(KEPT.read_text(encoding="utf-8"))
    measured = {name: restore(kept[name]) for name in OBJECTIVES}
    found = measured["f1"]
    return _PAGE.format(
        version=kept["version"],
        exact=f"{EXACT:.1%}",
        sample=SAMPLE,
        patience=PATIENCE,
        **{kind: len(rows) for kind, rows in found.items()},
        rates=seed_table7.rates(measured),
        steps=seed_table7.steps(measured),
        losses=seed_table7.losses(measured),
        share_f1=_vertical(2),
        share_f3=_vertical(1),
    )


_PAGE = """# Table 7 by the chapter's algorithm

Written by `make docs` from docs/chea-table7.json, which `benchmarks/chea_table7.py --write` measures; do not edit.
rotorrig {version}.

The chapter identifies the rotor of Lalanne and Ferraris from amplitudes without noise, on f1, f2 and f3, and finds all
five parameters exactly in about 3,000 calls. Here the same is tried by the same algorithm, `profile="seed"` with the
control parameters of Table 6, on values alone and within the box of eq. (20). What the chapter leaves open is chosen
[once, for all functions](chea-choices.md). A search may take twice the chapter's calls and is exact if all parameters
are within {exact}. Data: the response another program computed, 75 speeds, nodes 2 and 12, so that the least f1, f2 and
f3 are not quite nothing.

## How often it is exact

{runs} runs on Table 7's data; {truths} on random truths of the box, of which those parameters count that the data
determine. "after": calls until a point was exact, of the runs that were. Bounds are of 95 % confidence.

{rates}

How far searches with residuals and their derivatives come: [identification](identification.md).

## What becomes of the true minimum

{stages} of these runs, every step looked at; means. A point is in the basin of the true minimum if least squares on
the objective's residuals, {patience} evaluations, lead from there to it; of founders and of mature individuals {sample}
each are tried.

{steps}

Which step lost it. A run that began a local search in the basin and did not end at the minimum lost it there; one that
began none lost it in the genetic algorithm if no mature individual tried is in the basin, by its reduced boxes if
these leave the minimum out, else by its choice of starts among the clusters.

{losses}

## One run each, seen from above

Left the founders, in the middle the first mature population, its clusters and the bounds reduced to them, right the
local searches of the whole run; stiffness above, damping below.

**f1, lost by the genetic algorithm.** The peaks of the vertical response are the taller ones: they make {share_f1} of
the sum of squares of the amplitudes, {share_f3} of their sum. Many of the founders looked at are in the basin, of
the mature individuals tried none: most have kyy three to five times too large, and the dampings of other basins. Most
local searches from there end at the lower bounds of both dampings or near, with less than a hundredth of the unbalance.

![f1: founders, mature population and local searches over stiffness and over damping](img/chea-table7-f1.svg)

**f2, found.** Logarithms weigh all speeds alike, and both stiffnesses are right once the population is mature. What is
left is a valley toward the damping. Four local searches follow it to the end, the others stop in it; the reduced bounds
do not hold the minimum, which has been found by then.

![f2: founders, mature population and local searches over stiffness and over damping](img/chea-table7-f2.svg)

**f3, shut out by the reduced bounds.** The population gathers in one cluster, where kxx is about right and kyy four to
six decades too small. Its local searches disagree, so the search goes on in bounds reduced to it, and these end four
decades below the true kyy.

![f3: founders, mature population and local searches over stiffness and over damping](img/chea-table7-f3.svg)

In none of the three is the random search begun: local searches take all calls that the genetic algorithm leaves, 400
to 1,000 each, against 1,300 for all three of them in the chapter. [Fig. 8](chapter.md#fig-8-history-of-the-objective)
shows the values.
"""


def _vertical(power: int) -> str:
    """Return the share that the vertical amplitudes have in the sum of all, or of their squares."""
    parts = (np.abs(oracle_response()) ** power).sum(axis=0)  # X2, Y2, X12, Y12
    return f"{parts[1::2].sum() / parts.sum():.0%}"

"""docs/identification.md: the tables of identification as a reader of the chapter would look for them."""

import sys
import textwrap
from collections.abc import Sequence

import numpy as np
import scipy

from rotorrig.rig import code_version

_TABLE7 = """
The rotor of Lalanne and Ferraris, 75 speeds from 200 to 15,000 rpm, amplitudes at nodes 2 and 12, the bounds of
eq. (20). The data were computed by another program. A call is one response, with its derivatives where they are used;
each response of a finite difference counts as a call. {seeds} runs of every search. "f1", "f2" and "f3" see only the
value of the objective: rounds of CHEA, and a descent along the valley of its best point, until the fit is exact to 1e-6
of the amplitudes. "vector": the search that uses residuals and their derivatives. The chapter's own algorithm on the
same data has [a page of its own](chea-table7.md)."""

_TABLE8 = """
Each amplitude of Table 7's data times 1 + 0.1 N(0, 1), drawn anew each time. Errors are |error| of the minimum found
with the residual vector, medians and quartiles over the draws. "global minimum": how often a search ended within 1e-6
of the lowest value found by any search, including a brute-force multistart ({starts} starts) and a descent from the
true values. In "black box" CHEA sees only the value of the objective. Which of the chapter's errors come from its
objective, and which from its optimiser, is inferred from our draws; its own noise is not known."""

_TABLE10 = """
The chapter's rig cannot be measured again; simulated rigs stand in, a different one for every seed: coefficients,
unbalance and nameplate drawn within their tolerances, probes with errors of gain, angle and linearity, runout. One
plane of two probes, run-up with a row every 20 rpm from 480 to 2140 rpm, slow-roll vector at 500 rpm, bearing force
such that the 1X amplitude fluctuates by 5 % as in Fig. 12. f1 to f3 use the amplitudes minus the slow roll; "residual"
is `rotor identify` on the vectors. The chapter's errors are relative to static tests of the stiffness; it has no
reference for the damping. Bounds are standard deviations, medians over the rigs; "nameplate exact": noise alone."""


def page(table7: str, table8: str, table10: str, *, more: Sequence[str], seeds: int, starts: int) -> str:
    """Return the page; `more` are further sections. Table 7 is of `seeds` runs, Table 8 checked from `starts`."""
    sections = [
        _introduced(_TABLE7.format(seeds=seeds), table7),
        _introduced(_TABLE8.format(starts=starts), table8),
        _introduced(_TABLE10, table10),
        *more,
    ]
    body = "\n\n".join(section.replace("### ", "## ") for section in sections)
    return _wrapped(f"""# Identification: the chapter's Tables 7, 8 and 10

Written by `benchmarks/identification.py --write`; do not edit. rotorrig {code_version()}, numpy {np.__version__}, \
scipy {scipy.__version__}, Python {sys.version.split()[0]}.

{body}
""")


def _introduced(words: str, section: str) -> str:
    """Put an introduction below the heading of a section."""
    heading, _, rest = section.partition("\n\n")
    return f"{heading}\n\n{' '.join(words.split())}\n\n{rest}"


def _wrapped(text: str) -> str:
    """Break paragraphs and list items at 120 columns; tables and headings stay."""
    return "\n".join(
        line
        if line.startswith(("|", "#"))
        else textwrap.fill(line, 120, subsequent_indent="  " if line.startswith("- ") else "")
        for line in text.split("\n")
    )

"""What the blind benchmark found, as text for a terminal and as docs/blind.md."""

from collections import Counter
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

from benchmarks.parts.blind.cases import Design
from benchmarks.parts.blind.names import effect_of
from benchmarks.parts.blind.score import Rate, Score, rates
from benchmarks.parts.tables import markdown
from rotorrig.identify.verdict import VERDICT

WORDS = {
    "detectable": f"detectable: lam >= {VERDICT.detectable:g}",
    "nameable": f"nameable: lam >= {VERDICT.nameable:g} to the nearest rival",
    "detected": "found wrong, of the detectable",
    "top1": "right cause ranked first, of the nameable",
    "in_set": "right cause among those named, of the detectable",
    "in_set_nameable": "right cause among those named, of the nameable",
    "tied_not_nameable": "tied with the right set, of the detectable not nameable",
    "wrong_unique": "one cause named for certain, and wrong",
    "another_beside": "the right cause named, and one that is not there beside it",
    "false_alarm": "false alarms, of the healthy",
    "outsiders_unexplained": "called unexplained, of the outsiders found wrong",
    "pairs_contained": "both causes named, of the pairs",
    "pairs_contained_nameable": "both causes named, of the pairs each of which could be named if it were alone",
    "heldout_at_floor": "error on unseen data after extension <= 1.2 noise floors",
    "coverage95": "hidden parameters inside their 95 % intervals",
    "failed": "ended in an error",
}
GOALS: Mapping[Design, Mapping[str, str]] = {
    "P1": {"nameable": ">= 50 %", "in_set": ">= 97 %"},
    "P2": {
        "nameable": ">= 50 %",
        "detected": ">= 98 %",
        "top1": ">= 92 %",
        "in_set_nameable": ">= 98 %",
        "wrong_unique": "<= 1 %",
        "false_alarm": "<= 2 %",
        "outsiders_unexplained": ">= 80 %",
        "pairs_contained": ">= 90 %",
        "coverage95": "90 to 98 %",
    },
}
FIGURE_GOALS = {
    "heldout_over_floor": "<= 1.2",
    "rms_sigma": "<= 1.3",
    "mean_sigma": "-0.3 to 0.3",
    "seconds_per_case": "<= 30",
}
DESIGN_WORDS: dict[Design, str] = {
    "P1": "one plane of two probes; slow roll, speed-up and coast-down, 480 to 3600 rpm",
    "P2": "two planes; the same, and again with a trial mass of 12 g mm at 90 deg on the disk",
}
NO_CAUSE = ("adequate", "cannot tell", "unexplained", "failed")

Judged = Mapping[Design, Sequence[Score]]
Summaries = Mapping[Design, Mapping[str, Any]]


def text(judged: Judged, summaries: Summaries) -> str:
    """Return the figures of every design and the verdicts by fault."""
    return "\n\n".join(
        f"## {design}: {DESIGN_WORDS[design]}\n\n{figures(design, scores, summaries[design])}\n\n{verdicts(scores)}"
        for design, scores in judged.items()
    )


def page(judged: Judged, summaries: Summaries, *, versions: Sequence[str]) -> str:
    """Return docs/blind.md."""
    sections = "\n\n".join(
        f"{text({design: scores}, summaries)}\n\n{confusion(scores)}" for design, scores in judged.items()
    )
    made = f"{datetime.now(UTC):%Y-%m-%d}, rotorrig {', '.join(versions) or 'of no case'}"
    detectable, nameable = VERDICT.detectable, VERDICT.nameable
    return f"""# Hidden faults, and how often they are found

Written by `benchmarks/blind.py --write` (`make blind`) on {made}; do not edit.

Each case is another simulated rig of `configs/rk4.toml`, with every nameplate error within its tolerance and a fault
of a size drawn from the range its file in `sims/plant/faults` states. Its truth is sealed before the sweep and opened
after the diagnosis was written. The simulated rig shares no model with the analysis. A case counts as detectable if
the analysis's own model of the effect, at that size, leaves lam >= {detectable:g} of weighted misfit to a refitted
base, and as nameable if it leaves {nameable:g} to the nearest rival. Bounds are those of Clopper and Pearson, 95 %.
Errors of stiffness and unbalance are counted in the standard deviations that the fit states, the priors of the
nameplate in them, over the cases that were named rightly.

{sections}
"""


def figures(design: Design, scores: Sequence[Score], summary: Mapping[str, Any]) -> str:
    """Return the table of rates, and the figures that are no rates below it."""
    goals = GOALS.get(design, {})
    rows = [[WORDS[name], *_cells(rate), goals.get(name, "")] for name, rate in rates(scores).items()]
    table = markdown(["", "share", "cases", "95 % bounds", "to reach"], rows)
    return f"{table}\n\n{_others(summary)}\n{_complete(scores, summary)}"


def _complete(scores: Sequence[Score], summary: Mapping[str, Any]) -> str:
    """Say how much of the run has been done."""
    modelled = [s for s in scores if s.kind in ("single", "pair")]
    found = sum(s.lam is not None for s in modelled)
    lines = [
        f"- cases run: {summary['cases']} of {summary['wanted']} asked for",
        f"- lam was computed for {found} of {len(modelled)} cases of faults that an effect models",
    ]
    if found < len(modelled):
        lines[-1] += "; the others are in no rate of the detectable or the nameable"
    return "\n".join(lines)


def _others(summary: Mapping[str, Any]) -> str:
    """Return the figures that are no rates, each with how many cases or estimates are behind it."""
    lines = [
        _figure("error on unseen data after extension, median", "heldout_over_floor", "noise floors", summary),
        _figure("stiffness and unbalance error, rms", "rms_sigma", "Cramer-Rao standard deviations", summary),
        _figure("the same, mean", "mean_sigma", "Cramer-Rao standard deviations", summary),
        _figure("diagnosis, mean", "seconds_per_case", "s a case", summary),
    ]
    return "\n".join(f"- {line}" for line in lines)


def verdicts(scores: Sequence[Score]) -> str:
    """Return the verdicts by what was hidden."""
    rows = []
    for hidden, mine in _by_hidden(scores).items():
        counts = Counter(_outcome(s) for s in mine)
        rows.append([hidden, str(len(mine)), *_able(mine), *(str(counts[o] or "") for o in OUTCOMES)])
    return markdown(["hidden", "cases", "detectable", "nameable", *OUTCOMES], rows)


def _able(mine: Sequence[Score]) -> list[str]:
    """Return how many of the cases of a fault could be detected and named; "?": of none it is known."""
    if mine[0].kind not in ("single", "pair"):
        return ["", ""]
    if all(s.lam is None for s in mine):
        return ["?", "?"]
    return [str(sum(s.detectable for s in mine)), str(sum(s.nameable for s in mine))]


OUTCOMES = ("named, right", "named, wrong", "tied, right", "tied, wrong", *NO_CAUSE)


def _outcome(s: Score) -> str:
    if s.verdict in NO_CAUSE:
        return s.verdict
    return f"{s.verdict}, {'right' if s.in_set else 'wrong'}"


def confusion(scores: Sequence[Score]) -> str:
    """Return the confusion matrix: what was hidden by which effect was ranked first, or which verdict named none."""
    taken = {hidden: Counter(_taken_for(s) for s in mine) for hidden, mine in _by_hidden(scores).items()}
    seen = {name for counts in taken.values() for name in counts}
    columns = [*sorted(seen - set(NO_CAUSE)), *(name for name in NO_CAUSE if name in seen)]
    letters = [_letters(i) for i in range(len(columns))]
    rows = [[hidden, *(str(counts[name] or "") for name in columns)] for hidden, counts in taken.items()]
    legend = ", ".join(f"{letter} {name}" for letter, name in zip(letters, columns, strict=True))
    return f"### Taken for\n\n{markdown(['hidden', *letters], rows)}\n\n{legend}."


def _taken_for(s: Score) -> str:
    return s.verdict if s.verdict in NO_CAUSE else effect_of(s.first)


def _letters(i: int) -> str:
    """Return the name of a column: A to Z, then AA.

    >>> [_letters(i) for i in (0, 25, 26)]
    ['A', 'Z', 'AA']
    """
    return (_letters(i // 26 - 1) if i >= 26 else "") + chr(ord("A") + i % 26)


def _by_hidden(scores: Sequence[Score]) -> dict[str, list[Score]]:
    """Group by fault, pairs together."""
    groups: dict[str, list[Score]] = {}
    for s in scores:
        hidden = "two faults" if s.kind == "pair" else s.case.faults[0] if s.case.faults else "healthy"
        groups.setdefault(hidden, []).append(s)
    return groups


def _cells(rate: Rate) -> list[str]:
    low, high = rate.bounds
    if rate.share is None:
        return ["", "0 of 0", ""]
    return [f"{rate.share:.1%}", f"{rate.hits} of {rate.of}", f"{low:.1%} to {high:.1%}"]


def _figure(words: str, name: str, unit: str, summary: Mapping[str, Any]) -> str:
    value, of = summary[name], summary["counts"][name]["of"]
    if value is None:
        return f"{words}: not measured"
    return f"{words}: {value:.2f} {unit} (of {of}; to reach: {FIGURE_GOALS[name]})"

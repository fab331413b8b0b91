"""What the blind benchmark found, as text for a terminal and as docs/blind.md."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from benchmarks.parts.blind.cases import Design
from benchmarks.parts.blind.names import effect_of
from benchmarks.parts.blind.records import Attempt
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
    "named_right_all": "right cause named for certain and no other, of all single faults",
    "in_set_all": "right cause among those named, of all single faults",
    "tied_not_nameable": "tied with the right set, of the detectable not nameable",
    "wrong_unique": "named for certain and none of it right, of single faults and pairs",
    "wrong_unique_all": "a cause named for certain that is not there, of all cases of every kind",
    "another_beside": "the right cause named, and one that is not there beside it",
    "false_alarm": "false alarms: a cause named on a healthy rig",
    "healthy_found_wrong": "healthy rigs whose model was found wrong, named or not",
    "deviants_false_alarm": "a fault named where the nameplate is wrong",
    "deviants_named": "the wrong dimension named, off by what it is off",
    "outsiders_unexplained": "called unexplained or described, of the outsiders found wrong",
    "pairs_contained": "both causes named, of the pairs",
    "pairs_contained_nameable": "both causes named, of the pairs each of which could be named if it were alone",
    "heldout_at_floor": "error on unseen data after extension <= 1.2 noise floors",
    "coverage95": "hidden parameters inside their 95 % intervals",
    "coverage_k_u": "stiffness and unbalance inside their 95 % intervals, of what was adequate or named",
    "cut_short": "diagnoses that came to the end of their time",
    "failed": "ended in an error",
    "killed": "killed at the harness's limit of time",
}
P2_GOALS = {
    "nameable": ">= 70 %",
    "detected": ">= 98 %",
    "top1": ">= 92 %",
    "in_set_nameable": ">= 98 %",
    "wrong_unique_all": "<= 1 %",
    "false_alarm": "<= 2 %",
    "outsiders_unexplained": ">= 80 %",
    "pairs_contained": ">= 60 %",
    "coverage95": "90 to 98 %",
    "coverage_k_u": "90 to 98 %",
}
GOALS: Mapping[Design, Mapping[str, str]] = {"P1": {**P2_GOALS, "top1": ">= 75 %"}, "P2": P2_GOALS}
BY_RIG = ("nameable", "detected", "top1", "in_set_nameable", "wrong_unique_all", "false_alarm", "coverage_k_u")
FIGURES = {
    "heldout_over_floor": ("error on unseen data after extension, median", "noise floors", "<= 1.2"),
    "sigma_rms": ("error of stiffness and unbalance, rms, of what was adequate or named", "stated sigmas", ""),
    "rms_sigma": ("the same of what was named rightly", "stated sigmas", "<= 1.3"),
    "mean_sigma": ("its mean", "stated sigmas", "-0.3 to 0.3"),
    "seconds_per_case": ("diagnosis, mean", "s", "<= 30"),
    "seconds_p95": ("95 % of the diagnoses within", "s", "<= 90"),
    "seconds_worst": ("the longest", "s", "<= 300"),
    "cpu_per_case": ("of which the processor's own time, mean", "s", ""),
}
DESIGN_WORDS: dict[Design, str] = {
    "P1": "one plane of two probes; slow roll, speed-up and coast-down",
    "P2": "two planes; the same, and again with a trial mass at 90 deg on a disk",
}
NO_CAUSE = ("adequate", "cannot tell", "described", "unexplained", "failed", "killed")

Judged = Mapping[Design, Sequence[Score]]
Summaries = Mapping[Design, Mapping[str, Any]]


def text(judged: Judged, summaries: Summaries) -> str:
    """Return the figures of every design, those of the drawn rigs beside the RK4's, and the verdicts by fault."""
    return "\n\n".join(
        f"## {design}: {DESIGN_WORDS[design]}\n\n{figures(design, scores, summaries[design])}\n\n"
        f"{by_rig(scores)}\n\n{verdicts(scores)}"
        if scores
        else f"## {design}: {DESIGN_WORDS[design]}\n\nNo case is kept."
        for design, scores in judged.items()
    )


def page(judged: Judged, summaries: Summaries, *, attempts: Sequence[Attempt], told: Attempt | None) -> str:
    """Return docs/blind.md."""
    sections = "\n\n".join(
        text({design: scores}, summaries) + (f"\n\n{confusion(scores)}" if scores else "")
        for design, scores in judged.items()
    )
    detectable, nameable = VERDICT.detectable, VERDICT.nameable
    return f"""# Hidden faults, and how often they are found

Written by `benchmarks/blind.py --write` (`make blind`) from the cases kept in `benchmarks/parts/blind/results`; do not
edit.

Each case is another simulated rig, with the errors of its nameplate, and what no nameplate speaks of, drawn as
`sims/plant/deviations.py` says, and a fault of a size drawn from the range its file in `sims/plant/faults` states. The
range begins where two planes and a trial mass begin to show the fault on the RK4 (lam of 25, on development seeds). Two
of three are rigs of `configs/rk4.toml`; the third is a rig of its own: one disk, two, or one overhung, on a shaft of 8
to 20 mm (`benchmarks/parts/blind/rigs/drawn.py` says where its ranges come from), with the faults to its measure. Its
truth is sealed before the sweep and opened after the diagnosis was written; a case whose sweep trips is drawn again.
The simulated rig shares no model with the analysis. No rig with a known fault put in by hand was measured.

A case counts as detectable if the analysis's own model of the effect, at that size, leaves lam >= {detectable:g} of
weighted misfit to a refitted base, and as nameable if it leaves {nameable:g} to the nearest rival. Outsiders are faults
that no effect models; deviants are healthy rigs in which one position, the shaft's diameter, a hub or a bearing's
resistance to tilt is far from the nameplate. A dimension that is off is named right if its 95 % interval holds by how
much, in a healthy rig too, where it is not asked for. Bounds are those of Clopper and Pearson, 95 %. Errors of
stiffness and unbalance are counted in the standard deviations that the fit states, the priors of the nameplate in them.

## Attempts

Development uses seeds 0 to 99. The seeds of an examination had been run by nobody when it was begun; once its cases are
looked at, they are development, and the next attempt takes new ones. Cases of another version of the code than the
attempt's are not counted; the version is a digest of the sources.

{list_attempts(attempts, judged)}

{f"What follows is of attempt {told.number}." if told else "No case was run yet."}

{sections}
"""


def list_attempts(attempts: Sequence[Attempt], judged: Judged) -> str:
    """Return every attempt: when, on what, what was found, and why it no longer stands."""
    now = dict(sorted(Counter(s.verdict for scores in judged.values() for s in scores).items()))
    lines = []
    for each in attempts:
        counts = each.verdicts if each.superseded else now
        none = "no case is kept" if each.superseded else "no case yet"
        found = ", ".join(f"{count} {verdict}" for verdict, count in counts.items()) or none
        ended = f"Superseded on {each.until}: {each.superseded}." if each.superseded else "It stands."
        about = f"begun on {each.begun}, version {each.version}, seeds from {each.first_seed}"
        lines.append(f"- **Attempt {each.number}**, {about}: {found}. {ended}")
    return "\n".join(lines)


def figures(design: Design, scores: Sequence[Score], summary: Mapping[str, Any]) -> str:
    """Return the table of rates, and the figures that are no rates below it."""
    goals = GOALS.get(design, {})
    rows = [[WORDS[name], *_cells(rate), goals.get(name, "")] for name, rate in rates(scores).items()]
    table = markdown(["", "share", "cases", "95 % bounds", "to reach"], rows)
    return f"{table}\n\n{_others(summary)}\n{_complete(scores, summary)}"


def by_rig(scores: Sequence[Score]) -> str:
    """Return some of the rates for the RK4 and for the drawn rigs, each by itself."""
    parts = (rates([s for s in scores if s.case.is_drawn == drawn]) for drawn in (False, True))
    rk4, drawn = parts
    rows = [[WORDS[name], *_cells(rk4[name]), *_cells(drawn[name])] for name in BY_RIG]
    return markdown(["", "RK4", "cases", "95 % bounds", "drawn rigs", "cases", "95 % bounds"], rows)


def _complete(scores: Sequence[Score], summary: Mapping[str, Any]) -> str:
    """Say how much of the run has been done."""
    modelled = [s for s in scores if s.kind in ("single", "pair")]
    found = sum(s.lam is not None for s in modelled)
    lines = [
        f"- cases run: {summary['cases']} of {summary['wanted']} asked for; "
        f"{summary['drawn_again']} sweeps tripped and were drawn again",
        f"- lam was computed for {found} of {len(modelled)} cases of faults that an effect models",
    ]
    if found < len(modelled):
        lines[-1] += "; the others are in no rate of the detectable or the nameable"
    return "\n".join(lines)


def _others(summary: Mapping[str, Any]) -> str:
    """Return the figures that are no rates, each with how many cases or estimates are behind it."""
    return "\n".join(f"- {_figure(name, summary)}" for name in FIGURES)


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
    """Group by fault or wrong dimension, pairs together."""
    groups: dict[str, list[Score]] = {}
    for s in scores:
        hidden = "two faults" if s.kind == "pair" else s.case.name.rpartition("-")[0]
        groups.setdefault(hidden, []).append(s)
    return groups


def _cells(rate: Rate) -> list[str]:
    low, high = rate.bounds
    if rate.share is None:
        return ["", "0 of 0", ""]
    return [f"{rate.share:.1%}", f"{rate.hits} of {rate.of}", f"{low:.1%} to {high:.1%}"]


def _figure(name: str, summary: Mapping[str, Any]) -> str:
    words, unit, goal = FIGURES[name]
    value, of = summary[name], summary["counts"][name]["of"]
    if value is None:
        return f"{words}: not measured"
    return f"{words}: {value:.2f} {unit} (of {of}{f'; to reach: {goal}' if goal else ''})"

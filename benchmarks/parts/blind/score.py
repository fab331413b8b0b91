"""What a diagnosis is worth against the truth of its case, and the rates of many.

Only here, and in what calls it, is a sealed file opened: after the diagnosis has been written. A case is detectable if
its effect, at its size, would leave lam >= 25 of the weighted misfit to a refitted base model, and nameable if it would
leave >= 16 to its nearest rival (lam.py); where that was not computed, it is in no rate that asks for it.
"""

import math
import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from scipy.stats import binomtest

from benchmarks.parts.blind.cases import Case, Kind
from benchmarks.parts.blind.lam import Lam
from benchmarks.parts.blind.names import Answer, answer
from rotorrig.identify.verdict import VERDICT
from rotorrig.sims.plant import Truth, expected_estimates

WITHIN = 1.959964  # standard deviations: 95 %
JUDGED = ("kxx", "kyy", "u")  # stiffness and unbalance, against their Cramer-Rao bound
FAILED = "failed"  # for a verdict, of a case whose diagnosis ended in an error
_FOUND_WRONG = ("named", "tied", "unexplained")


@dataclass(frozen=True, slots=True, kw_only=True)
class Score:
    """One case, judged."""

    case: Case
    verdict: str  # of the diagnosis; FAILED if there is none
    first: str = ""  # label of the cause ranked first, of a model found wrong
    chosen: frozenset[str] = frozenset()  # labels that were taken up
    named: frozenset[str] = frozenset()  # those, and what is tied with one
    right: tuple[frozenset[str], ...] = ()  # of every hidden fault, the labels that are the right answer
    lam: Lam | None = None  # what the data could show of it, of two faults of each; None: not computed
    over_floor: float | None = None  # error of the extended model on unseen data over the noise floor
    covered: tuple[bool, ...] = ()  # hidden parameters inside their 95 % intervals
    errors: tuple[float, ...] = ()  # of `JUDGED`, in standard deviations
    seconds: float = math.nan  # of the diagnosis
    error: str = ""  # why there is none

    @property
    def kind(self) -> Kind:
        """What was asked."""
        return self.case.kind

    @property
    def detected(self) -> bool:
        """The model was found wrong."""
        return self.verdict in _FOUND_WRONG

    @property
    def top1(self) -> bool:
        """The right cause came first."""
        return any(self.first in labels for labels in self.right)

    @property
    def in_set(self) -> bool:
        """Every hidden fault is among those named."""
        return self.detected and bool(self.right) and all(labels & self.named for labels in self.right)

    @property
    def wrong_unique(self) -> bool:
        """One cause was named for certain, and it is not the right one."""
        return self.verdict == "named" and not any(labels & self.named for labels in self.right)

    @property
    def more_than_hidden(self) -> bool:
        """A cause was taken up that is none of the hidden ones."""
        return self.detected and bool(self.chosen - frozenset().union(*self.right))

    @property
    def detectable(self) -> bool:
        """The data can tell it from a healthy rig, as far as is known."""
        return self.lam is not None and self.lam["lam"] >= VERDICT.detectable

    @property
    def nameable(self) -> bool:
        """The data can tell it from every other effect, as far as is known."""
        return self.detectable and self.lam is not None and self.lam["rival_lam"] >= VERDICT.nameable


@dataclass(frozen=True, slots=True, kw_only=True)
class Rate:
    """So many of so many, and the 95 % bounds of Clopper and Pearson."""

    hits: int
    of: int

    @property
    def share(self) -> float | None:
        """Hits over cases; None if there are none."""
        return self.hits / self.of if self.of else None

    @property
    def bounds(self) -> tuple[float, float]:
        """What the share could be."""
        if not self.of:
            return 0.0, 1.0
        low, high = binomtest(self.hits, self.of).proportion_ci(0.95, method="exact")
        return float(low), float(high)


def score(
    case: Case,
    diagnosis: Mapping[str, Any],
    truth: Truth,
    *,
    seconds: float = math.nan,
    lam: Lam | None = None,
) -> Score:
    """Judge the content of a diagnosis.json by the truth it did not see. `lam` is what lam.py computed."""
    answers = [answer(case.rig, truth, fault) for fault in truth.faults]
    causes = diagnosis["causes"]
    chosen = frozenset(cause["label"] for cause in causes if cause["chosen"])
    found_wrong = diagnosis["verdict"] in _FOUND_WRONG
    scored = Score(
        case=case,
        verdict=diagnosis["verdict"],
        first=causes[0]["label"] if causes and found_wrong and diagnosis["verdict"] != "unexplained" else "",
        chosen=chosen,
        named=chosen.union(*diagnosis["tied"]),
        right=tuple(frozenset(a.labels) for a in answers),
        lam=lam,
        seconds=seconds,
    )
    if not (scored.in_set and scored.verdict == "named"):
        return scored
    return _with_figures(scored, diagnosis, answers, expected_estimates(case.rig, truth))


def summarise(scores: Sequence[Score], *, wanted: int | None = None) -> dict[str, Any]:
    """Return the figures of one design: plain numbers, and under "counts" what they are made of.

    `wanted` is how many cases were asked for, if not those that are scored.
    """
    found = rates(scores)
    errors = [error for s in scores for error in s.errors]
    over = [s.over_floor for s in scores if s.over_floor is not None]
    times = [s.seconds for s in scores if math.isfinite(s.seconds)]
    return {
        "cases": len(scores),
        "wanted": len(scores) if wanted is None else wanted,
        **{name: rate.share for name, rate in found.items()},
        "heldout_over_floor": statistics.median(over) if over else None,
        "rms_sigma": math.sqrt(sum(e * e for e in errors) / len(errors)) if errors else None,
        "mean_sigma": sum(errors) / len(errors) if errors else None,
        "seconds_per_case": sum(times) / len(times) if times else None,
        "counts": {
            **{name: _counted(rate) for name, rate in found.items()},
            "heldout_over_floor": {"of": len(over)},
            "rms_sigma": {"of": len(errors)},
            "mean_sigma": {"of": len(errors)},
            "seconds_per_case": {"of": len(times)},
        },
    }


def rates(scores: Sequence[Score]) -> dict[str, Rate]:
    """Return every rate by its name, in the order of the page."""
    single = [s for s in scores if s.kind == "single"]
    known = [s for s in single if s.lam is not None]
    healthy = [s for s in scores if s.kind == "healthy" and s.verdict != FAILED]
    outsiders = [s for s in scores if s.kind == "outsider"]
    pairs = [s for s in scores if s.kind == "pair"]
    detectable = [s for s in single if s.detectable]
    nameable = [s for s in single if s.nameable]
    over = [s.over_floor for s in scores if s.over_floor is not None]
    covered = [hit for s in single for hit in s.covered]
    return {
        "detectable": _rate(known, lambda s: s.detectable),
        "nameable": _rate(known, lambda s: s.nameable),
        "detected": _rate(detectable, lambda s: s.detected),
        "top1": _rate(nameable, lambda s: s.top1),
        "in_set": _rate(detectable, lambda s: s.in_set),
        "in_set_nameable": _rate(nameable, lambda s: s.in_set),
        "tied_not_nameable": _rate(
            [s for s in detectable if not s.nameable], lambda s: s.verdict == "tied" and s.in_set
        ),
        "wrong_unique": _rate([*single, *pairs], lambda s: s.wrong_unique),
        "another_beside": _rate([s for s in single if s.in_set], lambda s: s.verdict == "named" and s.more_than_hidden),
        "false_alarm": _rate(healthy, lambda s: s.detected),
        "outsiders_unexplained": _rate([s for s in outsiders if s.detected], lambda s: s.verdict == "unexplained"),
        "pairs_contained": _rate(pairs, lambda s: s.in_set),
        "pairs_contained_nameable": _rate([s for s in pairs if s.nameable], lambda s: s.in_set),
        "heldout_at_floor": Rate(hits=sum(ratio <= 1.2 for ratio in over), of=len(over)),
        "coverage95": Rate(hits=sum(covered), of=len(covered)),
        "failed": _rate(scores, lambda s: s.verdict == FAILED),
    }


def _with_figures(
    scored: Score, diagnosis: Mapping[str, Any], answers: Sequence[Answer], sought: Mapping[str, float]
) -> Score:
    """Add how good the figures of a rightly named extension are."""
    causes = {cause["label"]: cause for cause in diagnosis["causes"] if cause["chosen"]}
    gain = diagnosis["gain"]
    disturbed = {name for a in answers for name in a.disturbed}
    base = {name: row for name, row in gain.get("base", {}).items() if name in JUDGED and name not in disturbed}
    return replace(
        scored,
        over_floor=gain.get("over_noise_floor"),
        covered=tuple(
            _inside(causes[a.exact], name, a.theta[name]) for a in answers if a.exact in causes for name in a.same
        ),
        errors=tuple((row["after"] - sought[name]) / row["sigma"] for name, row in base.items() if row["sigma"]),
    )


def _inside(cause: Mapping[str, Any], name: str, true: float) -> bool:
    """Return whether the 95 % interval of a cause's parameter holds the true value; one without end does."""
    sigma = cause["sigmas"][name]
    return sigma is None or abs(cause["theta"][name] - true) <= WITHIN * sigma


def _rate(scores: Sequence[Score], hit: Callable[[Score], bool]) -> Rate:
    return Rate(hits=sum(map(hit, scores)), of=len(scores))


def _counted(rate: Rate) -> dict[str, float]:
    low, high = rate.bounds
    return {"hits": rate.hits, "of": rate.of, "low": low, "high": high}

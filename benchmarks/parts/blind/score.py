"""What a diagnosis is worth against the truth of its case, and the rates of many: from the lines that are kept, alone.

A case is detectable if its effect, at its size, would leave lam >= 25 of the weighted misfit to a refitted base model,
and nameable if it would leave >= 16 to its nearest rival (lam.py); where that was not computed, it is in no rate that
asks for it. A case that crashed or was killed has found nothing.
"""

import math
import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import binomtest

from benchmarks.parts.blind.cases import Case, Kind
from benchmarks.parts.blind.estimates import is_judged
from benchmarks.parts.blind.lam import Lam
from rotorrig.identify.verdict import VERDICT

WITHIN = 1.959964  # standard deviations: 95 %
FAILED, KILLED = "failed", "killed"  # for a verdict: ended in an error, took longer than a case may
NONE = (FAILED, KILLED)
_FOUND_WRONG = ("named", "tied", "described", "unexplained")
_NO_NAME = ("described", "unexplained")  # rightly of an outsider
_NAMING = ("named", "tied")


@dataclass(frozen=True, slots=True, kw_only=True)
class Score:
    """One case, judged."""

    case: Case
    verdict: str  # of the diagnosis; FAILED or KILLED if there is none
    first: str = ""  # label of the cause ranked first, where one was named
    chosen: frozenset[str] = frozenset()  # labels that were taken up
    ties: tuple[frozenset[str], ...] = ()  # sets of labels that the data cannot separate
    right: tuple[frozenset[str], ...] = ()  # of everything hidden that has to be named, the labels that are right
    allowed: frozenset[str] = frozenset()  # labels that are right and were not asked for
    lam: Lam | None = None  # what the data could show of it, of two faults of each; None: not computed
    over_floor: float | None = None  # error of the extended model on unseen data over the noise floor
    covered: tuple[bool, ...] = ()  # hidden parameters of what was rightly named inside their 95 % intervals
    errors: tuple[float, ...] = ()  # of stiffness and unbalance, in standard deviations
    seconds: float = math.nan  # of the diagnosis, by the clock
    cpu: float = math.nan  # the same of the processor: others may have been at work beside it
    cut_short: bool = False  # it came to the end of its time
    again: int = 0  # times it had been drawn before, and tripped
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
    def named(self) -> frozenset[str]:
        """The labels taken up and those tied with one, where anything was named."""
        return self.chosen.union(*self.ties) if self.verdict in _NAMING else frozenset()

    @property
    def top1(self) -> bool:
        """The right cause came first."""
        return any(self.first in labels for labels in self.right)

    @property
    def in_set(self) -> bool:
        """Everything hidden is among what was named."""
        return bool(self.right) and all(labels & self.named for labels in self.right)

    @property
    def named_right(self) -> bool:
        """Everything hidden was named for certain, and nothing else."""
        return self.verdict == "named" and self.in_set and not self.wrong_name

    @property
    def wrong_unique(self) -> bool:
        """Causes were named for certain, and none of them is right."""
        return self.verdict == "named" and not any(labels & self.chosen for labels in self.right)

    @property
    def wrong_name(self) -> bool:
        """A cause was named for certain, tied with no other, that is not there: beside a right one too."""
        return self.verdict in _NAMING and bool(self.chosen.difference(self._there, *self.ties))

    @property
    def false_alarm(self) -> bool:
        """A cause was named, for certain or in a tie, or a force described, and neither it nor its rivals are there."""
        return self.verdict in (*_NAMING, "described") and any(
            not self._there.intersection({label}.union(*(tie for tie in self.ties if label in tie)))
            for label in self.chosen
        )

    @property
    def detectable(self) -> bool:
        """The data can tell it from a healthy rig, as far as is known."""
        return self.lam is not None and self.lam["lam"] >= VERDICT.detectable

    @property
    def nameable(self) -> bool:
        """The data can tell it from every other effect, as far as is known."""
        return self.detectable and self.lam is not None and self.lam["rival_lam"] >= VERDICT.nameable

    @property
    def _there(self) -> frozenset[str]:
        return self.allowed.union(*self.right)


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


def score(record: Mapping[str, Any]) -> Score:
    """Judge one line."""
    case = Case(design=record["design"], faults=tuple(record["faults"]), deviant=record["deviant"], seed=record["seed"])
    verdict = record.get("verdict", KILLED)
    if verdict in NONE:
        return Score(case=case, verdict=verdict, again=record.get("again", 0), error=record.get("error", ""))
    hidden, chosen = record["hidden"], record["chosen"]
    disturbed = {name for answer in hidden for name in answer["disturbed"]}
    judged = {n: row for n, row in record.get("base", {}).items() if is_judged(n) and n not in disturbed}
    return Score(
        case=case,
        verdict=verdict,
        first=record["first"] if verdict in _NAMING else "",
        chosen=frozenset(chosen),
        ties=tuple(frozenset(tie) for tie in record["tied"]),
        right=tuple(_right_labels(answer, chosen) for answer in hidden if answer["asked"]),
        allowed=frozenset().union(*(_right_labels(answer, chosen) for answer in hidden if not answer["asked"])),
        lam=record.get("lam"),
        over_floor=record["over_floor"] if verdict == "named" else None,
        covered=_covered(hidden, chosen) if verdict == "named" else (),
        errors=tuple((got - true) / sigma for got, sigma, true in judged.values() if sigma),
        seconds=record["seconds"],
        cpu=record["seconds_cpu"],
        cut_short=record["cut_short"],
        again=record["again"],
    )


def summarise(scores: Sequence[Score], *, wanted: int | None = None) -> dict[str, Any]:
    """Return the figures of one design: plain numbers, and under "counts" what they are made of.

    `wanted` is how many cases were asked for, if not those that are scored.
    """
    found = rates(scores)
    right = [error for s in scores if s.verdict == "named" and s.in_set for error in s.errors]
    every = [error for s in scores for error in s.errors]
    over = [s.over_floor for s in scores if s.over_floor is not None and s.in_set]
    times = [s.seconds for s in scores if math.isfinite(s.seconds)]
    worked = [s.cpu for s in scores if math.isfinite(s.cpu)]
    return {
        "cases": len(scores),
        "wanted": len(scores) if wanted is None else wanted,
        **{name: rate.share for name, rate in found.items()},
        "heldout_over_floor": statistics.median(over) if over else None,
        "rms_sigma": _rms(right),
        "mean_sigma": sum(right) / len(right) if right else None,
        "sigma_rms": _rms(every),
        "seconds_per_case": sum(times) / len(times) if times else None,
        "seconds_p95": float(np.percentile(times, 95)) if times else None,
        "seconds_worst": max(times, default=None),
        "cpu_per_case": sum(worked) / len(worked) if worked else None,
        "drawn_again": sum(s.again for s in scores),
        "counts": {
            **{name: _counted(rate) for name, rate in found.items()},
            "heldout_over_floor": {"of": len(over)},
            "rms_sigma": {"of": len(right)},
            "mean_sigma": {"of": len(right)},
            "sigma_rms": {"of": len(every)},
            **{
                name: {"of": len(times)}
                for name in ("seconds_per_case", "seconds_p95", "seconds_worst", "cpu_per_case")
            },
        },
    }


def rates(scores: Sequence[Score]) -> dict[str, Rate]:
    """Return every rate by its name, in the order of the page."""
    kinds: dict[str, list[Score]] = {kind: [s for s in scores if s.kind == kind] for kind in _KINDS}
    single, pairs, outsiders, deviants = (kinds[kind] for kind in ("single", "pair", "outsider", "deviant"))
    known = [s for s in single if s.lam is not None]
    healthy = [s for s in kinds["healthy"] if s.verdict not in NONE]  # one that crashed is no proof of silence
    detectable, nameable = ([s for s in single if able(s)] for able in (_detectable, _nameable))
    over = [s.over_floor for s in scores if s.over_floor is not None and s.in_set]
    covered = [hit for s in single for hit in s.covered]
    errors = [error for s in scores for error in s.errors]
    return {
        "detectable": _rate(known, _detectable),
        "nameable": _rate(known, _nameable),
        "detected": _rate(detectable, lambda s: s.detected),
        "top1": _rate(nameable, lambda s: s.top1),
        "in_set": _rate(detectable, lambda s: s.in_set),
        "in_set_nameable": _rate(nameable, lambda s: s.in_set),
        "named_right_all": _rate(single, lambda s: s.named_right),
        "in_set_all": _rate(single, lambda s: s.in_set),
        "tied_not_nameable": _rate(
            [s for s in detectable if not s.nameable], lambda s: s.verdict == "tied" and s.in_set
        ),
        "wrong_unique": _rate([*single, *pairs], lambda s: s.wrong_unique),
        "wrong_unique_all": _rate(scores, lambda s: s.wrong_name),
        "another_beside": _rate([s for s in single if s.in_set], lambda s: s.verdict == "named" and s.wrong_name),
        "false_alarm": _rate(healthy, lambda s: s.false_alarm),
        "healthy_found_wrong": _rate(healthy, lambda s: s.detected),
        "deviants_false_alarm": _rate(deviants, lambda s: s.false_alarm),
        "deviants_named": _rate(deviants, lambda s: s.named_right),
        "outsiders_unexplained": _rate([s for s in outsiders if s.detected], lambda s: s.verdict in _NO_NAME),
        "pairs_contained": _rate(pairs, lambda s: s.in_set),
        "pairs_contained_nameable": _rate([s for s in pairs if s.nameable], lambda s: s.in_set),
        "heldout_at_floor": Rate(hits=sum(ratio <= 1.2 for ratio in over), of=len(over)),
        "coverage95": Rate(hits=sum(covered), of=len(covered)),
        "coverage_k_u": Rate(hits=sum(abs(error) <= WITHIN for error in errors), of=len(errors)),
        "cut_short": _rate(scores, lambda s: s.cut_short),
        "failed": _rate(scores, lambda s: s.verdict == FAILED),
        "killed": _rate(scores, lambda s: s.verdict == KILLED),
    }


_KINDS: tuple[Kind, ...] = ("healthy", "single", "pair", "outsider", "deviant")


def _right_labels(answer: Mapping[str, Any], chosen: Mapping[str, Any]) -> frozenset[str]:
    """Return the labels that are right for something hidden; where the interval has to hold it, only if it does."""
    labels = frozenset(answer["labels"])
    if not answer["interval"] or answer["exact"] not in chosen:
        return labels
    found = chosen[answer["exact"]]
    held = [_holds(found, name, answer["theta"][name]) for name in answer["same"] if name in found["theta"]]
    return labels if held and all(held) else labels - {answer["exact"]}


def _covered(hidden: Sequence[Mapping[str, Any]], chosen: Mapping[str, Any]) -> tuple[bool, ...]:
    """Return for every hidden parameter of a cause that was named whether its interval holds it."""
    return tuple(
        _holds(chosen[answer["exact"]], name, answer["theta"][name])
        for answer in hidden
        if answer["exact"] in chosen
        for name in answer["same"]
    )


def _holds(cause: Mapping[str, Any], name: str, true: float) -> bool:
    """Return whether the 95 % interval of a cause's parameter holds the true value; one without end does."""
    sigma = cause["sigmas"][name]
    return sigma is None or abs(cause["theta"][name] - true) <= WITHIN * sigma


def _detectable(s: Score) -> bool:
    return s.detectable


def _nameable(s: Score) -> bool:
    return s.nameable


def _rms(errors: Sequence[float]) -> float | None:
    return math.sqrt(sum(error * error for error in errors) / len(errors)) if errors else None


def _rate(scores: Sequence[Score], hit: Callable[[Score], bool]) -> Rate:
    return Rate(hits=sum(map(hit, scores)), of=len(scores))


def _counted(rate: Rate) -> dict[str, float]:
    low, high = rate.bounds
    return {"hits": rate.hits, "of": rate.of, "low": low, "high": high}

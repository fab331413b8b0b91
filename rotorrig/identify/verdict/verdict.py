"""Verdict from fits: the causes ranked, those the data cannot tell apart, and the conclusion."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from rotorrig.identify.causes import SELECTION, Candidate, Selection, SelectionStep, plausible
from rotorrig.identify.least_squares import Stop
from rotorrig.identify.verdict.cause import Cause, ParameterValue
from rotorrig.identify.verdict.cross_validation import Prediction
from rotorrig.identify.verdict.gain import Predictions, explains_nearly_all, is_too_much
from rotorrig.identify.verdict.settings import VERDICT
from rotorrig.sims.effects import Effect, Parameter, magnitudes


class Verdict(StrEnum):
    """Conclusion of a diagnosis."""

    ADEQUATE = "adequate"
    NAMED = "named"
    TIED = "tied"
    DESCRIBED = "described"  # no known cause, but a force or reading by a law that predicts
    UNEXPLAINED = "unexplained"
    CANNOT_TELL = "cannot tell"


@dataclass(frozen=True, slots=True, kw_only=True)
class HiddenEffect:
    """An effect that the data would not show at its typical size."""

    effect: str  # its label, where it would show best
    smallest: float  # size that would show, of its first unknown; infinite: none
    unit: str  # of that size
    missing: str  # the measurements that would show it, in words


def conclude(
    selection: Selection,
    *,
    adequate_before: bool,
    adequate_after: bool,
    visible: float,
    predictions: Predictions,
    misstated: int = 0,
    eases_priors: bool = False,
) -> Verdict:
    """Draw the verdict; `visible` is the share of the known effects that this data could show.

    If the extended model predicts data no fit saw no better than the base, or finds another rotor in each part of the
    data, it is no explanation; nor is it one if, beside its causes, so much of the nameplate would have to be wrong
    (`misstated` statements) that more than `SELECTION.most` things would be. `eases_priors`: see `is_supported`.
    """
    if is_too_much(selection, misstated):
        return Verdict.UNEXPLAINED
    if selection.problem.effects == selection.start.effects:
        if not adequate_before:
            return Verdict.UNEXPLAINED
        return Verdict.ADEQUATE if visible >= VERDICT.enough_visible else Verdict.CANNOT_TELL
    explained = adequate_after or explains_nearly_all(selection, predictions.before, predictions.after)
    if not (explained and is_supported(selection, predictions, eases_priors=eases_priors)):
        return Verdict.UNEXPLAINED
    return Verdict.TIED if tied_labels(selection) else Verdict.NAMED


def is_supported(selection: Selection, predictions: Predictions, *, eases_priors: bool = False) -> bool:
    """Say whether unseen data are predicted better, and disjoint parts of the data agree on the rotor.

    Where causes are tied it is enough that one of them predicts no worse. What every fit has as a nuisance is no better
    predicted by a cause of that name: there it is the evidence that decides. It decides, too, on causes without which
    the base takes statements of the nameplate for wrong, or probes and runout for what they hardly can be, and predicts
    as well by that (`eases_priors`); these may predict no worse. A bow seen as runout is the same in every fold.
    """
    causes = selection.problem.effects[len(selection.start.effects) :]
    if causes and all(effect.as_nuisance for effect in causes):
        return predictions.agreed
    if eases_priors and not predictions.before.is_better_than(predictions.after):
        return predictions.agreed
    tied = [label for group in tied_labels(selection) for label in group]
    return predictions.agreed and (predictions.better or (bool(tied) and predictions.one_no_worse(tied)))


def tied_labels(selection: Selection) -> tuple[tuple[str, ...], ...]:
    """Return the sets of labels that fit alike, one for every chosen effect with a rival that is another cause."""
    return tuple(tuple(candidate.effect.label for candidate in group) for group in tied_candidates(selection))


def tied_candidates(selection: Selection) -> list[list[Candidate]]:
    """Return the sets of `tied_labels` as candidates, the chosen one first."""
    ties = []
    for effect in selection.problem.effects:
        if (step := _step_of(selection, effect)) is None:
            continue
        best = step.tried[0]
        rivals = _rivals(step, best)
        if any(is_another_cause(rival.effect, best.effect) for rival in rivals):
            ties.append([best, *rivals])
    return ties


def is_another_cause(effect: Effect, best: Effect) -> bool:
    """Say whether it is another cause: another kind, or the same of another probe; not the next place on the shaft."""
    return effect.name != best.name or "probes" in effect.acts_on


def _step_of(selection: Selection, effect: Effect) -> SelectionStep | None:
    """Return the last step in which an effect was the best; None of one that the config brings."""
    return next((s for s in reversed(selection.steps) if s.tried and s.tried[0].effect is effect), None)


def _rivals(step: SelectionStep, best: Candidate) -> list[Candidate]:
    """Return what fits nearly as well; beside a cause that is barely detected that need not be detected itself."""
    near = (c for c in step.tried[1:] if best.evidence - c.evidence < VERDICT.nameable)
    return [c for c in near if c.evidence > SELECTION.enough]


def visible_share(selection: Selection) -> float:
    """Return the share of the known effects, by name, that this data could show at their typical size."""
    seen = _visible(selection)
    return sum(lam >= VERDICT.detectable for _, lam in seen.values()) / max(len(seen), 1)


def hidden_effects(selection: Selection) -> tuple[HiddenEffect, ...]:
    """Return the effects that this data would not show at their typical size, with the size that it would."""
    return tuple(
        HiddenEffect(
            effect=effect.label,
            smallest=effect.parameters[0].size * float(np.sqrt(VERDICT.detectable / lam)) if lam > 0 else math.inf,
            unit=effect.parameters[0].unit,
            missing=_missing(selection, effect),
        )
        for effect, lam in _visible(selection).values()
        if lam < VERDICT.detectable
    )


def _visible(selection: Selection) -> dict[str, tuple[Effect, float]]:
    """Return by effect's name the place where it would show best, and lambda there at its typical size."""
    best: dict[str, tuple[Effect, float]] = {}
    for score in selection.steps[0].scores if selection.steps else ():
        if score.effect.needs_starts:
            continue  # no first order: what it would show depends on the motion
        name = score.effect.name
        if name not in best or score.visible > best[name][1]:
            best[name] = score.effect, score.visible
    return best


def _missing(selection: Selection, effect: Effect) -> str:
    """Return the measurement whose absence hides an effect, as far as the recordings tell."""
    recordings = selection.problem.recordings
    response = recordings[0].response
    planes = {round(response.rig.probe(name).position, 6) for name in response.read}
    wanted = []
    if any(order not in recordings[0].orders for order in effect.orders):
        wanted.append(f"vectors at {' and '.join(f'{n}X' for n in effect.orders if n not in recordings[0].orders)}")
    if len(planes) < 2:
        wanted.append("a second plane of probes")
    if not any(recording.trial for recording in recordings):
        wanted.append("a run with a known trial mass")
    if not recordings[0].swept:
        wanted.append("the times of the rows")
    return ", ".join(wanted)


def rank_causes(selection: Selection, predictions: dict[str, tuple[Prediction, Prediction]]) -> tuple[Cause, ...]:
    """Rank the causes: the chosen effects as finally fitted, then every other one that was fitted, by its evidence.

    One that is tied is that of the step it is tied in, any other that of the first step it was tried in.
    `predictions` holds the errors on unseen data before and after, by label, of those they were measured for.
    """
    final = selection.problem
    chosen = [
        _cause(step.tried[0], selection, i, predictions, chosen=True)
        for i, effect in enumerate(final.effects)
        if (step := _step_of(selection, effect)) is not None
    ]
    chosen.sort(key=lambda cause: -cause.evidence)
    names = {cause.label for cause in chosen}
    others: dict[str, Cause] = {}
    tied = [rival for _, *rivals in tied_candidates(selection) for rival in rivals]  # beside the one they are tied with
    for candidate in (*tied, *(candidate for step in selection.steps for candidate in step.tried)):
        if candidate.effect.label not in names:
            others.setdefault(candidate.effect.label, _cause(candidate, None, -1, predictions, chosen=False))
    return (*chosen, *sorted(others.values(), key=lambda cause: (not cause.plausible, -cause.evidence)))


def _cause(
    candidate: Candidate,
    selection: Selection | None,
    index: int,
    predictions: dict[str, tuple[Prediction, Prediction]],
    *,
    chosen: bool,
) -> Cause:
    problem, polished = (
        (selection.problem, selection.polished) if selection else (candidate.problem, candidate.polished)
    )
    effect = candidate.effect
    names = problem.parameters
    theta = names.of_effect(polished.p, index)
    sigmas = names.of_effect(polished.sigma, index) | {q.name: q.spread for q in effect.parameters if q.grid_searched}
    before, after = predictions.get(effect.label, (None, None))
    return Cause(
        label=effect.label,
        effect=effect.name,
        where=effect.where,
        title=effect.title,
        words=effect.words(theta),
        chosen=chosen,
        plausible=plausible(candidate),
        evidence=candidate.evidence,
        lam=candidate.lam,
        heldout_before=before.error if before else float("nan"),
        heldout_after=after.error if after else float("nan"),
        parameters=parameter_values(effect.parameters, theta, sigmas),
        theta=theta,
        sigmas=sigmas,
        given_up=candidate.polished.stop is Stop.GIVEN_UP,
    )


def parameter_values(
    parameters: Sequence[Parameter], theta: dict[str, float], sigmas: dict[str, float]
) -> dict[str, ParameterValue]:
    """Return what a person reads: phasors as magnitude and angle, each with its standard deviation."""
    values = {}
    for name, value, unit in magnitudes(tuple(parameters), theta):
        stem = name.removesuffix(" angle")
        if f"{stem} re" in theta:
            spread = float(np.hypot(sigmas[f"{stem} re"], sigmas[f"{stem} im"]) / np.sqrt(2))
            size = abs(complex(theta[f"{stem} re"], theta[f"{stem} im"]))
            sigma = spread if name == stem else spread / max(size, 1e-300)
        else:
            sigma = sigmas[name]
        values[name] = ParameterValue(value=value, unit=unit, sigma=sigma)
    return values

"""Gain by the extended model: prediction of data no fit saw, and what the base parameters had absorbed."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from rotorrig.identify.base_fit import AssessedFit
from rotorrig.identify.causes import Candidate, Selection, is_significant
from rotorrig.identify.extended_model import Recording
from rotorrig.identify.least_squares import Stop
from rotorrig.identify.verdict.cross_validation import Prediction, cross_validate, measure_prediction
from rotorrig.identify.verdict.settings import VERDICT


@dataclass(frozen=True, slots=True, kw_only=True)
class Shift:
    """A parameter of the base model, SI, before the model was extended and after."""

    before: float
    after: float
    sigma: float  # one standard deviation of `after`
    unit: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Gain:
    """Gain by the extended model on data no fit saw."""

    heldout_before: float  # m, rms prediction error of the base
    heldout_after: float  # m, of the extended model
    noise_floor: float  # m, the same of noise alone
    on: str  # the unseen data, in words
    base: dict[str, Shift]  # by name: what the base's parameters had absorbed

    @property
    def over_noise_floor(self) -> float:
        """The error of the extended model as a multiple of the noise floor."""
        return self.heldout_after / self.noise_floor


@dataclass(frozen=True, slots=True, kw_only=True)
class Predictions:
    """Of unseen data: by the base, by the extended model, and by the base with single causes."""

    before: Prediction
    after: Prediction
    by_label: dict[str, tuple[Prediction, Prediction]]
    on: str  # the unseen data, in words

    @property
    def better(self) -> bool:
        """True if the extended model predicts better than the base, by more than the standard error of that.

        At all orders, in standard deviations; blocks of neighbouring rows count as independent.
        """
        lower = self.before.blocks - self.after.blocks
        return float(lower.sum()) > float(lower.std(ddof=1)) * math.sqrt(len(lower))

    def one_no_worse(self, labels: Iterable[str]) -> bool:
        """Say whether the extended model, or one of these causes alone, predicts no worse than the base."""
        pairs = [(self.before, self.after), *(self.by_label[label] for label in labels if label in self.by_label)]
        return any(after.blocks.sum() <= before.blocks.sum() for before, after in pairs)


def predict_unseen(selection: Selection, *, holdout: Recording | None = None) -> Predictions:
    """Measure predictions of `holdout`, or cross-validate over blocks of speeds."""
    steps = selection.steps
    base = steps[0].before if steps else selection.base
    problem = selection.start
    if holdout:
        holdout = problem.on([holdout]).expecting_error(base.p).recordings[0]

    def of(candidate: Candidate | None) -> Prediction:
        p, where = (base.p, problem) if candidate is None else (candidate.polished.p, candidate.problem)
        return measure_prediction(where.on([holdout]), p) if holdout else cross_validate(where, p)

    before = of(None)
    able = [c for c in (steps[0].tried if steps else ()) if _is_complete(c) and is_significant(c)]
    tried = able[: VERDICT.measured]
    by_label = {candidate.effect.label: (before, of(candidate)) for candidate in tried}
    after = before
    if tried and selection.problem is tried[0].problem:
        after = by_label[tried[0].effect.label][1]
    elif selection.problem.effects != problem.effects:
        p, where = selection.polished.p, selection.problem
        after = measure_prediction(where.on([holdout]), p) if holdout else cross_validate(where, p)
    on = "the recording no fit saw" if holdout else "blocks of speeds in turn"
    return Predictions(before=before, after=after, by_label=by_label, on=on)


def _is_complete(candidate: Candidate) -> bool:
    return candidate.polished.stop is not Stop.GIVEN_UP


def measure_gain(base: AssessedFit, selection: Selection, unseen: Predictions) -> Gain:
    """Return what the extended model of `selection` bought over the base."""
    return Gain(
        heldout_before=unseen.before.error,
        heldout_after=unseen.after.error,
        noise_floor=unseen.after.floor,
        on=unseen.on,
        base=_shifts(base, selection),
    )


def _shifts(base: AssessedFit, selection: Selection) -> dict[str, Shift]:
    """Return by name what the extension moved of the base: coefficients, then unbalances by their magnitude."""
    names = base.problem.parameters.base
    before, after = names.values(base.polished.p[: len(names)]), names.values(selection.polished.p[: len(names)])
    slopes = names.space.slopes(after)
    sigma = selection.polished.sigma[names.sought] * slopes
    units = [unknown.unit for unknown in names.space.unknowns]
    shifts = {
        name: Shift(before=float(b), after=float(a), sigma=float(s), unit=unit)
        for name, b, a, s, unit in zip(names.space.names, before, after, sigma, units, strict=True)
    }
    spread = selection.polished.sigma[names.unbalance].reshape(-1, 2)
    old, new = (names.amounts(fit.p[: len(names)]) for fit in (base.polished, selection.polished))
    for i, (amount, plane) in enumerate(zip(names.space.amounts, names.space.planes, strict=True)):
        sigma_of_amount = float(np.hypot(*spread[i]) / np.sqrt(2))
        shifts[amount.name] = Shift(before=abs(old[plane]), after=abs(new[plane]), sigma=sigma_of_amount, unit="kg m")
    return shifts

"""Gain by the extended model: prediction of data no fit saw, and what the base parameters had absorbed."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rotorrig.identify.base_fit import AssessedFit
from rotorrig.identify.base_model import Reals
from rotorrig.identify.causes import SELECTION, Candidate, Selection, is_significant, leave_out, plausible, price
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.identify.least_squares import Stop
from rotorrig.identify.verdict.cross_validation import Prediction, Unseen, pool_folds
from rotorrig.identify.verdict.disjoint_parts import Agreement, measure_agreement
from rotorrig.identify.verdict.part_fits import PartFits
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
    freed: Prediction | None = None  # by the base with what the causes have of its nuisances free; None: they have none
    by_label: dict[str, tuple[Prediction, Prediction]]
    chosen_again: Prediction | None = None  # by the first cause, chosen anew by each fit; None: nothing to choose from
    agreement: Agreement | None = None  # of disjoint parts of the data; None: no model that explains it was found
    on: str  # the unseen data, in words

    @property
    def agreed(self) -> bool:
        """True if the extended model finds one and the same rotor in disjoint parts of the data."""
        return self.agreement is None or self.agreement.p >= VERDICT.agreeing

    @property
    def better(self) -> bool:
        """True if the extended model predicts better than the base, by more than the standard error of that.

        So does the first cause if each fit chooses it by its own rows: what is hidden from a fit has then no part in
        the choice either. Causes that only set a nuisance of the base free predict no better, and have no part in it.
        """
        before = self.freed or self.before
        return all(by.is_better_than(before) for by in (self.after, self.chosen_again) if by is not None)

    def one_no_worse(self, labels: Iterable[str]) -> bool:
        """Say whether the extended model, or one of these causes alone, predicts no worse than the base."""
        pairs = [(self.before, self.after), *(self.by_label[label] for label in labels if label in self.by_label)]
        return any(after.blocks.sum() <= before.blocks.sum() for before, after in pairs)


def leave_out_idle(selection: Selection, unseen: Unseen) -> Selection:
    """Leave out, the one of least use first, every cause without which unseen data are predicted as well.

    As well: the error rises by no more than the standard error of that. Two causes may predict better than none by the
    merit of one: beside a bow a small step of unbalance takes up what the model of the bow leaves, at the rows it is
    fitted to and at no others. The last one is left to the verdict, as is what every fit has as a nuisance.
    """
    kept = len(selection.start.effects)
    while len(selection.problem.effects) > kept + 1:
        problem, polished = selection.problem, selection.polished
        asked = [effect for effect in problem.effects[kept:] if not effect.as_nuisance]
        if not asked:
            break
        whole = unseen.measure(problem, polished.p)
        smaller = [leave_out(problem, polished, [effect]) for effect in asked]
        without = [unseen.measure(model, fit.p) for model, fit in smaller]
        least = min(range(len(smaller)), key=lambda i: without[i].blocks.sum())
        if whole.is_better_than(without[least]):
            break
        problem, polished = smaller[least]
        selection = replace(selection, problem=problem, polished=polished)
    return selection


def leave_out_excess(selection: Selection, misstated: Callable[[Selection], int]) -> Selection:
    """Leave out the causes of least evidence until, with what of the nameplate is `misstated`, they are few enough.

    Where the base is adequate without any of them, the least of many are the first to be doubted.
    """
    kept = len(selection.start.effects)
    while len(selection.problem.effects) - kept > 0 and is_too_much(selection, misstated(selection)):
        problem = selection.problem
        each = [(effect, *leave_out(problem, selection.polished, [effect])) for effect in problem.effects[kept:]]
        _, smaller, fit = min(each, key=lambda of: of[2].chi2 - price(problem, of[0]))
        selection = replace(selection, problem=smaller, polished=fit)
    return selection


def is_too_much(selection: Selection, misstated: int) -> bool:
    """Say whether causes and statements of the nameplate that would have to be wrong are more than `SELECTION.most`."""
    return len(selection.problem.effects) - len(selection.start.effects) + misstated > SELECTION.most


def predict_unseen(selection: Selection, unseen: Unseen, *, adequate: bool, misstated: int = 0) -> Predictions:
    """Measure predictions by the base, by the extended model and by single causes.

    Whether parts of the data agree is asked only of an extended model that is `adequate` or explains nearly all, by not
    too many causes and statements that would be `misstated`: it takes as long as all else here, and of what explains
    too little or by too much it decides nothing.
    """
    steps = selection.steps
    base = steps[0].before if steps else selection.base
    extended = selection.problem.effects != selection.start.effects
    final = PartFits(selection.problem, selection.polished.p) if extended else None

    def of(model: ExtendedProblem, p: Reals) -> Prediction:
        return unseen.measure(model, p, fits=final)

    before = of(selection.start, base.p)
    tried = _worth_predicting(steps[0].tried if steps else ())
    fits = {c.effect.label: selection.polished if c.problem is selection.problem else c.polished for c in tried}
    by_label = {c.effect.label: (before, of(c.problem, fits[c.effect.label].p)) for c in tried}
    after, agreed = before, None
    if final:
        known = tried and selection.problem is tried[0].problem
        after = by_label[tried[0].effect.label][1] if known else of(selection.problem, selection.polished.p)
        explains = adequate or explains_nearly_all(selection, before, after)
        if explains and not is_too_much(selection, misstated):
            explained = selection.base.chi2 - selection.polished.chi2
            agreed = measure_agreement(selection.problem, selection.polished.p, explained=explained, fits=final)
    again = None
    if before.folds and tried and not tried[0].effect.as_nuisance:
        offered = [(price(c.problem, c.effect), by_label[c.effect.label][1]) for c in tried if plausible(c)]
        again = choose_again([(0.0, before), *offered])
    return Predictions(
        before=before,
        after=after,
        freed=_predict_freed(selection, unseen),
        by_label=by_label,
        chosen_again=again,
        agreement=agreed,
        on=unseen.on,
    )


def explains_nearly_all(selection: Selection, before: Prediction, after: Prediction) -> bool:
    """Say whether the causes explain the residual as well as a law may be known, in unseen data too.

    A pedestal rocks besides, a shaft is bent by no parabola; of a force law 3X is not followed, and 2X and 3X act back
    on the first order only as if they came and went slowly. So all but a little of chi2 has to be explained, or of the
    mean square of what is wrong with 1X in unseen data.
    """
    left = selection.polished.chi2 - selection.polished.dof
    of_chi2 = left < VERDICT.left_over * (selection.base.chi2 - selection.base.dof)
    of_motion = after.excess < VERDICT.left_over * before.excess
    return (of_chi2 or of_motion) and after.over_expected < VERDICT.over_expected


def _predict_freed(selection: Selection, unseen: Unseen) -> Prediction | None:
    """Return the prediction without those causes that no fit has as a nuisance; None where that is the base's."""
    causes = selection.problem.effects[len(selection.start.effects) :]
    others = [effect for effect in causes if not effect.as_nuisance]
    if not 0 < len(others) < len(causes):
        return None
    problem, fit = leave_out(selection.problem, selection.polished, others)
    return unseen.measure(problem, fit.p)


def _worth_predicting(tried: Sequence[Candidate]) -> list[Candidate]:
    """Return the causes, best first, that a part of the rows might choose, and a few that are told."""
    able = [c for c in tried if c.polished.stop is not Stop.GIVEN_UP and is_significant(c)]
    return [
        c
        for i, c in enumerate(able)
        if i < VERDICT.measured or (plausible(c) and able[0].evidence - c.evidence < VERDICT.might_lead)
    ]


def choose_again(models: Sequence[tuple[float, Prediction]]) -> Prediction:
    """Return the prediction if in every fold that model is taken which suits the rows shown there best.

    `models` are the prices of their unknowns and their predictions; all have the same folds.
    """
    folds = range(len(models[0][1].folds))
    best = [min(models, key=lambda model: model[1].folds[i].shown + model[0])[1] for i in folds]
    return pool_folds([found.folds[i] for i, found in enumerate(best)])


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

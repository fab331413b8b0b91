"""Cross-validation: prediction of what a fit never saw, every third block of speeds in turn or a whole recording."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_model import Reals
from rotorrig.identify.extended_model import ExtendedProblem, Recording
from rotorrig.identify.least_squares import inverse_information_root
from rotorrig.identify.verdict.part_fits import PartFits
from rotorrig.identify.verdict.predictive_density import block_deviances
from rotorrig.identify.verdict.settings import VERDICT

Complex = NDArray[np.complex128]
Folds = Sequence[tuple[list[Recording], list[Recording]]]  # what is shown and what is hidden


@dataclass(frozen=True, slots=True, kw_only=True)
class Prediction:
    """Prediction error of 1X on rows the fit did not see."""

    error: float  # m, root mean square of |measured - model|
    floor: float  # m, the same of what the noise alone would be
    expected: float  # m, of noise and the model's own error
    sigmas: float  # root mean square of the error in standard deviations of a component
    #: (block,) -2 log predictive density, all orders, of neighbouring rows together: predictive_density.py
    blocks: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))
    folds: tuple["Fold", ...] = ()  # of which it was put together; none of a whole recording

    @property
    def over_floor(self) -> float:
        """The error as a multiple of the noise floor."""
        return self.error / self.floor

    @property
    def over_expected(self) -> float:
        """The error as a multiple of what a right model has."""
        return self.error / self.expected

    @property
    def excess(self) -> float:
        """By how much the mean square error is more than a right model's [m^2]; 0 where it is not."""
        return max(self.error**2 - self.expected**2, 0.0)

    def is_better_than(self, other: "Prediction") -> bool:
        """Say whether it predicts the same data better than `other`, by more than the standard error of that.

        At all orders, as -2 log predictive density; blocks of neighbouring rows count as independent. Less than one is
        none: of what changes nothing, rounding decides the sign.
        """
        lower = other.blocks - self.blocks
        return float(lower.sum()) > max(float(lower.std(ddof=1)) * math.sqrt(len(lower)), VERDICT.gained)


@dataclass(frozen=True, slots=True, kw_only=True)
class Fold:
    """One fit of a cross-validation, to the rows it was shown, and what it makes of those hidden from it."""

    shown: float  # chi2 of its rows, priors included
    errors: NDArray[np.float64]  # see `errors`
    blocks: NDArray[np.float64]  # (block,) see `block_deviances`; 0 where nothing was hidden


class Unseen:
    """Data hidden from a fit, which models of the same recordings are to predict."""

    def __init__(self, problem: ExtendedProblem, p: Reals, *, holdout: Recording | None = None) -> None:
        """Hide `holdout`, or blocks of the problem's own recordings; `p` is the fit of the base."""
        self.on = "the recording no fit saw" if holdout else "blocks of speeds in turn"
        self._holdout = problem.on([holdout]).expecting_error(p).recordings if holdout else None
        self._parts = None if holdout else folds_of(problem.recordings)

    def measure(self, problem: ExtendedProblem, p: Reals, *, fits: PartFits | None = None) -> Prediction:
        """Return how well a model predicts it; `p` is its fit to all rows, `fits` those begun there, if known."""
        if self._holdout:
            return measure_prediction(problem, p, self._holdout)
        known = fits if fits and fits.are_of(problem, p) else None
        return cross_validate(problem, p, parts=self._parts, fits=known)


def cross_validate(
    problem: ExtendedProblem, p: Reals, *, parts: Folds | None = None, fits: PartFits | None = None
) -> Prediction:
    """Return how well the model, fitted to all blocks but every third, predicts those, in turn.

    `p` is its fit to all rows. Several models of the same recordings share the `parts`, see `folds_of`; `fits` are
    those begun at `p`, where they are known.
    """
    fits = fits or PartFits(problem, p)
    folds = []
    for shown, hidden in parts or folds_of(problem.recordings):
        fit = fits.fit(shown)
        of_hidden, vectors = problem.on(hidden), fit.problem.model.predict(fit.p)
        blocks = block_deviances(of_hidden, vectors, fits.spread(of_hidden, fit))
        folds.append(Fold(shown=fit.chi2, errors=errors(of_hidden, vectors), blocks=blocks))
    return pool_folds(folds)


def measure_prediction(problem: ExtendedProblem, p: Reals, recordings: Sequence[Recording]) -> Prediction:
    """Return how well the model predicts other recordings; `p` is its fit to those of the problem."""
    unseen, free = problem.on(recordings), problem.parameters.free
    vectors = unseen.model.predict(p)
    spread = unseen.jacobian(p, free) @ inverse_information_root(problem.jacobian(p, free))
    whole = Fold(shown=np.nan, errors=errors(unseen, vectors), blocks=block_deviances(unseen, vectors, spread))
    return replace(pool_folds([whole]), folds=())


def errors(problem: ExtendedProblem, vectors: Sequence[Mapping[int, Complex]]) -> NDArray[np.float64]:
    """Return sums over the usable 1X vectors: |error|^2, 2 sigma^2, the model's own, |error|^2 in sigmas, their number.

    `vectors` are the model's, order -> (row + 1, probe) [m] of every recording.
    """
    total = np.zeros(5)
    for recording, model in zip(problem.recordings, vectors, strict=True):
        measured = recording.measured[1]
        usable = measured.usable[:-1]
        off = np.where(usable, model[1][:-1] - measured.z[:-1], 0)
        variance = np.where(usable, measured.sigma[:-1] ** 2, 0)
        white = measured.sigmas(np.where(measured.usable, model[1] - measured.z, 0))[:-1]
        own = 0.0 if measured.error is None else np.sum(np.abs(measured.error[:-1][usable]) ** 2)
        total += [np.sum(np.abs(off) ** 2), 2 * variance.sum(), own, np.sum(white**2) / 2, usable.sum()]
    return total


def pool_folds(folds: Sequence[Fold]) -> Prediction:
    """Return the prediction over all parts."""
    square, noise, own, white, count = np.sum([fold.errors for fold in folds], axis=0)
    count = max(count, 1)
    return Prediction(
        error=float(np.sqrt(square / count)),
        floor=float(np.sqrt(noise / count)),
        expected=float(np.sqrt((noise + own) / count)),
        sigmas=float(np.sqrt(white / count)),
        blocks=np.sum([fold.blocks for fold in folds], axis=0),
        folds=tuple(folds),
    )


def folds_of(recordings: Sequence[Recording]) -> Folds:
    """Return what is shown and what is hidden, in turn every third block of rows, of every recording.

    Not recording by recording: how large a trial mass shows up is known from its own recording alone.
    """
    of_row = [divide(r, VERDICT.folds) for r in recordings]
    folds = []
    for number in range(VERDICT.folds):
        hidden = [fold == number for fold in of_row]
        pairs = list(zip(recordings, hidden, strict=True))
        folds.append(([r.only(~hide) for r, hide in pairs], [r.only(hide) for r, hide in pairs]))
    return folds


def divide(recording: Recording, parts: int) -> NDArray[np.intp]:
    """Return the part (row,) each row is in: blocks of neighbours in speed, which share their noise, in turn.

    The next run begins with the next part, so that no part has one and the same resonance in all runs.
    """
    omega, run = recording.response.omega[recording.rows], recording.response.run[recording.rows]
    part = np.empty(len(run), dtype=np.intp)
    for turn, number in enumerate(np.unique(run)):
        mine = np.flatnonzero(run == number)
        block = max(1, min(VERDICT.block, len(mine) // VERDICT.blocks))
        part[mine[np.argsort(omega[mine], kind="stable")]] = (np.arange(len(mine)) // block + turn) % parts
    return part

"""Cross-validation: prediction of what a fit never saw, speeds in blocks or a whole recording."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.adequacy import ADEQUACY
from rotorrig.identify.base_model import Reals
from rotorrig.identify.extended_model import ExtendedProblem, Recording
from rotorrig.identify.least_squares import LinearModel, Point, take_step
from rotorrig.identify.verdict.settings import VERDICT
from rotorrig.rig import DataError

Complex = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class Prediction:
    """Prediction error of 1X on rows the fit did not see."""

    error: float  # m, root mean square of |measured - model|
    floor: float  # m, the same of what the noise alone would be
    expected: float  # m, of noise and the model's own error
    sigmas: float  # root mean square of the error in standard deviations of a component
    #: (block,) sum of the squared error in standard deviations, all orders, of neighbouring rows together
    blocks: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))

    @property
    def over_floor(self) -> float:
        """The error as a multiple of the noise floor."""
        return self.error / self.floor

    @property
    def over_expected(self) -> float:
        """The error as a multiple of what a right model has."""
        return self.error / self.expected


def cross_validate(problem: ExtendedProblem, p: Reals) -> Prediction:
    """Return how well the model, fitted to one half of the blocks, predicts the other, both ways round.

    `p` is its fit to all rows. Half of them moves that by little, so the derivatives there serve both halves; it is
    only where the model is wrong that a second step is needed. Under a force law, whose derivatives take longest, one
    has to do.
    """
    exact = problem.taken_for_exact()
    J, r = exact.jacobian(p), exact.residual(p)
    steps = 1 if problem.model.moving(p).laws else VERDICT.refit_steps
    sums, blocks = [], []
    for shown, hidden in _halves(problem.recordings):
        of_shown = problem.on(shown)
        mask = _usable_mask(of_shown)
        fit = _refit(of_shown, p, of_shown.less_error(mask * r), of_shown.less_error(mask[:, None] * J), steps=steps)
        of_hidden, vectors = problem.on(hidden), of_shown.model.predict(fit)
        sums.append(errors(of_hidden, vectors))
        blocks.append(block_errors(of_hidden, vectors))
    return _pool_errors(sums, blocks)


def _refit(problem: ExtendedProblem, p: Reals, r: Reals, J: Reals, *, steps: int) -> Reals:
    """Return the fit of `problem` from `p`, its residual `r` and its Jacobian `J` there, in `steps` or fewer."""
    free = np.setdiff1d(np.arange(len(p)), list(problem.parameters.frozen))
    bounds = tuple(bound[free] for bound in problem.bounds)

    def full(part: Reals) -> Reals:
        whole = p.copy()
        whole[free] = part
        return whole

    def evaluate(part: Reals) -> Point:
        try:
            with np.errstate(over="ignore", invalid="ignore"):  # of a step that goes too far, and is taken back
                reached = problem.residual(full(part))
        except DataError:  # a step too far, to where there is no motion
            reached = np.full(len(r), np.inf)
        return Point(part, reached, lambda: problem.jacobian(full(part))[:, free])

    enough = max(VERDICT.accurate, VERDICT.nearly * float(r @ r))
    for step in range(1, steps + 1):
        model = LinearModel(J[:, free], r, p[free], bounds)
        promise = model.promise(model.best(0.0))
        taken = take_step(evaluate, model) if promise > enough else None
        if taken is None:
            break
        p, r = full(taken.point.p), taken.point.r
        if step == steps or (promise < VERDICT.close * enough and promise - (model.cost - float(r @ r)) < enough):
            break
        J = problem.jacobian(p)
    return p


def _usable_mask(problem: ExtendedProblem) -> Reals:
    """Return 1 for every element of the residual that is usable, and every prior, 0 for the others."""
    usable = [np.repeat(m.usable, 2, axis=1).ravel() for r in problem.recordings for m in r.measured.values()]
    return np.concatenate([*usable, np.ones(len(problem.parameters.priors))]).astype(float)


def measure_prediction(problem: ExtendedProblem, p: Reals) -> Prediction:
    """Return how well the model at `p` predicts the recordings of `problem`, nothing fitted."""
    vectors = problem.model.predict(p)
    return _pool_errors([errors(problem, vectors)], [block_errors(problem, vectors)])


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


def block_errors(problem: ExtendedProblem, vectors: Sequence[Mapping[int, Complex]]) -> NDArray[np.float64]:
    """Return sums (block,) of |error|^2 in sigmas at all orders, of a few neighbouring rows each.

    `vectors` are the model's, as of `errors`.
    """
    blocks = []
    for recording, model in zip(problem.recordings, vectors, strict=True):
        rows = np.zeros(len(recording.rows))
        for order, measured in recording.measured.items():
            off = np.where(measured.usable, model[order] - measured.z, 0)
            rows += np.sum(measured.sigmas(off)[:-1] ** 2, axis=1)
        together = max(1, min(ADEQUACY.stretch, len(rows) // VERDICT.fewest_blocks))
        blocks.append(np.add.reduceat(rows, np.arange(0, len(rows), together)))
    return np.concatenate(blocks)


def _pool_errors(sums: Sequence[NDArray[np.float64]], blocks: Sequence[NDArray[np.float64]]) -> Prediction:
    """Return the prediction over all parts of `errors` and `block_errors`."""
    square, noise, own, white, count = np.sum(sums, axis=0)
    count = max(count, 1)
    return Prediction(
        error=float(np.sqrt(square / count)),
        floor=float(np.sqrt(noise / count)),
        expected=float(np.sqrt((noise + own) / count)),
        sigmas=float(np.sqrt(white / count)),
        blocks=np.concatenate(blocks),
    )


def _halves(recordings: Sequence[Recording]) -> list[tuple[list[Recording], list[Recording]]]:
    """Return what is shown and what is hidden, both ways round: every other block of rows, of every recording.

    Not recording by recording: how large a trial mass shows up is known from its own recording alone.
    """
    odd = [(np.arange(len(r.rows)) // _block(len(r.rows))) % 2 == 1 for r in recordings]
    first = [r.only(keep) for r, keep in zip(recordings, odd, strict=True)]
    second = [r.only(~keep) for r, keep in zip(recordings, odd, strict=True)]
    return [(first, second), (second, first)]


def _block(rows: int) -> int:
    return max(1, min(VERDICT.block, rows // VERDICT.blocks))

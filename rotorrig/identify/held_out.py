"""Prediction of what a fit never saw: speeds in blocks, or a whole recording."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.extended import ExtendedProblem
from rotorrig.identify.parameters import Reals
from rotorrig.identify.recording import Recording

BLOCK = 24  # rows that are left out together, at most: neighbours share their noise
BLOCKS = 6  # that a recording is divided into at least
_ACCURATE = 0.3  # of chi2
_STEPS = 8
_CURVED_STEPS = 1  # under a force law, from the fit of all rows: each takes seconds


@dataclass(frozen=True, slots=True, kw_only=True)
class Prediction:
    """Of 1X on held-out rows."""

    error: float  # m, root mean square of |measured - model|
    floor: float  # m, the same of what the noise alone would be
    sigmas: float  # root mean square of the error in standard deviations of a component

    @property
    def over_floor(self) -> float:
        """The error as a multiple of the noise floor."""
        return self.error / self.floor


def held_out(problem: ExtendedProblem, p: Reals) -> Prediction:
    """Return how well the model, fitted to one half of the blocks from `p`, predicts the other, both ways round."""
    parts = []
    for shown, hidden in _halves(problem.recordings):
        fit = problem.on(shown).solve(p, tolerance=_ACCURATE, max_steps=_CURVED_STEPS if problem.curved else _STEPS)
        parts.append(errors(problem.on(hidden), fit.p))
    return summed(parts)


def predicted(problem: ExtendedProblem, p: Reals) -> Prediction:
    """Return how well the model at `p` predicts the recordings of `problem`, nothing fitted."""
    return summed([errors(problem, p)])


def errors(problem: ExtendedProblem, p: Reals) -> NDArray[np.float64]:
    """Return sums over the usable 1X vectors: |error|^2, 2 sigma^2, |error|^2 in sigmas, and their number."""
    total = np.zeros(4)
    for recording, found in zip(problem.recordings, problem.predict(p), strict=True):
        measured = recording.measured[1]
        usable = measured.usable[:-1]
        off = np.where(usable, found[1][:-1] - measured.z[:-1], 0)
        variance = np.where(usable, measured.sigma[:-1] ** 2, 0)
        white = measured.sigmas(np.where(measured.usable, found[1] - measured.z, 0))[:-1]
        total += [np.sum(np.abs(off) ** 2), 2 * variance.sum(), np.sum(white**2) / 2, usable.sum()]
    return total


def summed(parts: Sequence[NDArray[np.float64]]) -> Prediction:
    """Return the prediction over all parts of `errors`."""
    square, noise, white, count = np.sum(parts, axis=0)
    count = max(count, 1)
    return Prediction(
        error=float(np.sqrt(square / count)), floor=float(np.sqrt(noise / count)), sigmas=float(np.sqrt(white / count))
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
    return max(1, min(BLOCK, rows // BLOCKS))

"""Agreement of disjoint parts of the data: whether one and the same rotor moves in all of them.

A cause that is not there may take up a misfit, and leave it to the bearings and the unbalance to take up the rest,
differently at other speeds, in another run and at another plane; and it may be of another size there. So the model is
fitted to parts that share no row or no probe, and the difference of what they say of the base and of the causes is held
against its covariance. No law is known to the last digit: of a cause that explains much, a small error of its law may
split the parts as well, by `SELECTION.model_error` of its vectors. That is what the distance is allowed beforehand (as
the noncentrality of its chi squared: Kay, Fundamentals of Statistical Signal Processing II (1998), ch. 2.2.3).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import ncx2

from rotorrig.identify.base_model import Reals
from rotorrig.identify.causes import SELECTION
from rotorrig.identify.extended_model import ExtendedProblem, Recording
from rotorrig.identify.least_squares import inverse_information_root, squared_distance
from rotorrig.identify.verdict.cross_validation import divide
from rotorrig.identify.verdict.part_fits import PartFit, PartFits
from rotorrig.identify.verdict.settings import VERDICT

Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True)
class Agreement:
    """The parts of the data that agree least."""

    p: float  # that parameters of one rotor differ as much, the number of divisions paid for
    between: str  # "runs", "planes of probes", "speeds below and above the peak" or "every other block of speeds"


def measure_agreement(
    problem: ExtendedProblem, p: Reals, *, explained: float = 0.0, fits: PartFits | None = None
) -> Agreement:
    """Return how well coefficients, unbalance and causes agree between parts of the data; `p` is the fit to all of it.

    `explained` is by how much the causes lower chi2, `fits` are those begun at `p`, where they are known.

    Both parts know the same priors, so their difference scatters less than the sum of their covariances: the
    probability is too large rather than too small.
    """
    fits = fits or PartFits(problem, p)
    each = []
    allowed = SELECTION.model_error**2 * max(explained, 0.0)
    for between, masks in _divisions(problem.recordings):
        (one, of_one), (other, of_other) = (
            _select_compared(fits.fit([r.only(mask) for r, mask in zip(problem.recordings, part, strict=True)]))
            for part in (masks, [~mask for mask in masks])
        )
        off = one - other
        distance = squared_distance(off, np.hstack([of_one, of_other]))
        each.append((float(ncx2.sf(distance, len(off), allowed)), between))
    least, between = min(each)
    return Agreement(p=float(-np.expm1(len(each) * np.log1p(-min(least, 1 - 1e-16)))), between=between)


def _select_compared(fit: PartFit) -> tuple[Reals, Reals]:
    """Return the parameters of a fit that are compared and a root of their covariance, scaled up where it is bad.

    Those of the base, and of the causes where they are of the first order: one step takes the others nowhere near.
    """
    names = fit.problem.parameters
    free = names.free
    worse = max(1.0, fit.chi2 / max(fit.problem.size - len(free), 1))
    root = np.sqrt(worse) * inverse_information_root(fit.jacobian[:, free])
    causes = [part for effect, part in zip(names.effects, names.theta, strict=True) if not effect.is_nuisance]
    sizes = [] if fit.problem.curved else [np.arange(part.start, part.stop) for part in causes]
    which = np.intersect1d(np.concatenate([np.r_[names.base.sought, names.base.unbalance], *sizes]), free)
    own = np.searchsorted(free, which)
    return fit.p[which], root[own]


def _divisions(recordings: Sequence[Recording]) -> Iterator[tuple[str, list[Mask]]]:
    """Yield, in words and as masks (row, probe) per recording, what of the data makes one part."""
    yield "every other block of speeds", [_every_probe(r, divide(r, 2) == 0) for r in recordings]
    runs = [r.response.run[r.rows] for r in recordings]
    if all(len(np.unique(run)) > 1 for run in runs):
        yield "runs", [_every_probe(r, run == run[0]) for r, run in zip(recordings, runs, strict=True)]
    if len(recordings) > 1:
        yield "recordings", [_every_probe(r, np.full(len(r.rows), r is recordings[0])) for r in recordings]
    peak = _find_speed_of_peak(recordings[0])
    slower = [r.response.omega[r.rows] < peak for r in recordings]
    if all(VERDICT.fewest_rows <= below.sum() <= len(below) - VERDICT.fewest_rows for below in slower):
        yield "speeds below and above the peak", [_every_probe(r, b) for r, b in zip(recordings, slower, strict=True)]
    response = recordings[0].response
    positions = np.array([response.rig.probe(name).position for name in response.probes])
    if np.ptp(positions) > 0:
        first = positions == positions[0]
        yield "planes of probes", [np.repeat(first[None], len(r.rows), axis=0) for r in recordings]


def _every_probe(recording: Recording, keep: Mask) -> Mask:
    return np.repeat(keep[:, None], len(recording.response.probes), axis=1)


def _find_speed_of_peak(recording: Recording) -> float:
    """Return the speed of the largest 1X motion [rad/s]."""
    measured = recording.measured[1]
    motion = np.where(measured.usable, np.abs(measured.z - measured.z[-1:]), 0.0)[:-1]
    return float(recording.response.omega[recording.rows][motion.sum(axis=1).argmax()])

"""Standard deviation of an unknown where the law is not quite the truth's: from how parts of the data disagree.

A misfit that is alike over many rows moves an estimate further than noise of its size would. What every stretch of a
recording says of the unknown by itself is therefore held against the others: the sandwich of White, Econometrica 50
(1982) 1; over clusters Liang, Zeger, Biometrika 73 (1986) 13.
"""

from collections.abc import Iterator

import numpy as np

from rotorrig.identify.discovery.settings import DISCOVERY
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.identify.least_squares import Solution


def robust_sigma(problem: ExtendedProblem, fit: Solution, index: int) -> float:
    """Return one standard deviation of the unknown `index` of a fit at its minimum, in units of the unknown.

    No less than that by the covariance of the noise. Raises LinAlgError where the motion is beyond bounds.
    """
    J, r = problem.jacobian(fit.p), problem.residual(fit.p)
    free = np.flatnonzero(np.linalg.norm(J, axis=0) > 0)
    if index not in free:
        return float(fit.sigma[index])
    size = np.linalg.norm(J[:, free], axis=0)
    Q, R = np.linalg.qr(J[:, free] / size)
    unit = (free == index).astype(float)
    pull = Q @ np.linalg.solve(R.T, unit) / size[unit.argmax()]  # d unknown / d residual, but for the sign
    stretches = list(_stretches(problem))
    data = sum((pull[part] @ r[part]) ** 2 for part in stretches) * len(stretches) / max(len(stretches) - 1, 1)
    known = sum(part.size for part in stretches)
    return float(max(np.sqrt(data + pull[known:] @ pull[known:]), fit.sigma[index]))


def _stretches(problem: ExtendedProblem) -> Iterator[np.ndarray]:
    """Yield the residuals of neighbouring rows, all probes together; those of the priors are in none."""
    first = 0
    for recording in problem.recordings:
        for measured in recording.measured.values():
            rows = np.arange(first, first + measured.whiten[..., 0].size).reshape(len(measured.z), -1)
            yield from (part.ravel() for part in np.array_split(rows, DISCOVERY.stretches) if part.size)
            first += rows.size

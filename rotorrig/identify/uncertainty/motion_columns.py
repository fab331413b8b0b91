"""Motion at 1X by a fitted model, and what one standard deviation of its parameters changes of it."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_model import Reals
from rotorrig.identify.extended_model import ExtendedProblem

Complex = NDArray[np.complex128]

DEAD = 1e-12  # of the largest variance: rounding


def covariance_root(covariance: Reals) -> Reals:
    """Return columns (parameter, column) whose outer products sum to a covariance; 0 for what was held."""
    free = np.flatnonzero(np.diag(covariance) > 0)
    scale = np.sqrt(np.diag(covariance)[free])
    size, directions = np.linalg.eigh(covariance[np.ix_(free, free)] / np.outer(scale, scale))
    kept = size > DEAD * size[-1]
    root = np.zeros((len(covariance), int(kept.sum())))
    root[free] = scale[:, None] * directions[:, kept] * np.sqrt(size[kept])
    return root


def motion_with_columns(problem: ExtendedProblem, p: Reals, root: Reals) -> list[tuple[Complex, Complex]]:
    """Return the motion (row, probe) [m] of every recording at `p`, without runout and hum, and its columns.

    Columns are (row, probe, column) m, for the columns of `root`, (parameter, column).
    """
    metres = problem.on([recording.in_metres() for recording in problem.recordings])
    names, still = metres.parameters, p.copy()
    moves = np.ones(len(p), dtype=bool)
    for part in (names.base.runout, names.hums):
        still[part], moves[part] = 0.0, False
    figures = metres.jacobian(still)
    found, first = [], 0
    for recording, predicted in zip(metres.recordings, metres.model.predict(still, orders=(1,)), strict=True):
        z = predicted[1]
        mine = figures[first : first + 2 * z.size].reshape(*z.shape, 2, len(p))
        columns = (mine[..., 0, moves] + 1j * mine[..., 1, moves]) @ root[moves]
        found.append((z[:-1], np.asarray(columns[:-1], complex)))
        first += sum(2 * m.usable.size for m in recording.measured.values())
    return found

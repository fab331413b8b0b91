"""Whether an effect that has been fitted would rather be elsewhere: a look from its best fit at its other beginnings.

A crack left of the disk and one right of it bend the rotor nearly alike, and either may be where a fit ends. From one
of them the other is promised by the residual there, less all of it that the unknowns could follow.
"""

import numpy as np

from rotorrig.identify.base_model.parameters import Reals
from rotorrig.identify.extended import ExtendedProblem
from rotorrig.identify.solving import Polished
from rotorrig.rig.errors import DataError

_BETTER = 2.0  # of chi2


def elsewhere(problem: ExtendedProblem, fit: Polished) -> Reals | None:
    """Return where to begin anew, one unknown of the last effect moved to that of a beginning; None: nowhere better.

    `fit` is that of `problem`, its Jacobian included.
    """
    effect, part = problem.effects[-1], problem.parameters.theta[-1]
    length = np.linalg.norm(fit.jacobian, axis=0)
    basis = np.linalg.qr(fit.jacobian[:, length > 0] / length[length > 0])[0]
    best, lowest = None, fit.chi2 - _BETTER
    for i, q in enumerate(effect.parameters, start=part.start):
        for value in sorted({begun[q.name] / q.size for begun in effect.beginnings if q.name in begun}):
            moved = fit.p.copy()
            moved[i] = value
            try:
                r = problem.residual(moved)
            except DataError:
                continue  # no motion that is bounded: nowhere to begin
            left = float(r @ r - np.sum((basis.T @ r) ** 2))
            if left < lowest:
                best, lowest = moved, left
    return best

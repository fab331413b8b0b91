"""Local search of `profile="modern"`: a trust region about the best point, and a model of all the values known.

Every point the search has evaluated, by whom and for what, takes part in the model, so a descent among known points
begins with slopes and curvatures it did not pay for. Measured in two dimensions with 48 points known, in calls to the
confirmed minimum: 20 on the banana function from anywhere, 12 in a basin of Rastrigin's function, 10 in one of the
chapter's f2; 50 to 60, 12 and 12 with the start alone. Rosenbrock's function of 5 and 10 parameters takes 120 and 260.
Ripples finer than the radius are seen through, noise ends a descent where it hides the slope, a kink at the minimum
costs 30 to 40 calls. A wall of failing calls is no slope: a descent may end at its edge.
"""

from collections.abc import Callable
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.engine import End
from rotorrig.identify.chea.modern.settings import MODERN, DescentSettings
from rotorrig.identify.chea.modern.taylor_model import TaylorModel, fit
from rotorrig.identify.chea.session import Evaluations, Record
from rotorrig.identify.chea.steps import minimize_on_box

Array = NDArray[np.float64]

#: Asked once per step with the best point (dim,), its value, the model's minimum (dim,) and the value foreseen there.
StopIf = Callable[[Array, float, Array, float], bool]

HUGE = 1e100  # beyond that no polynomial is fitted without overflow
FLOAT = 4 * np.finfo(np.float64).eps  # a gain below that, of the value, is rounding


def descend(
    record: Record,
    start: Array,
    value: float,
    *,
    radius: float = 0.1,
    tolerance: float = 1e-6,
    max_calls: int | None = None,
    stop_if: StopIf | None = None,
    settings: DescentSettings = MODERN.descent,
) -> Evaluations[End]:
    """Descend from `start` (dim,), where the function is `value`, to a minimum of the unit cube.

    `radius` is how far the model is trusted at first, `tolerance` the length of the last step. A descent ends in a
    "minimum"; "abandoned" because `stop_if` said so; "stuck" where no step of `tolerance` leads down although the model
    sees one, as in a minimum with a kink or under noise, or after `max_calls` (200 per parameter and 200); with "no
    value" at a start that has none. Never leaves the cube, and evaluates one batch of up to dim points at first, then
    mostly single points.
    """
    if not np.isfinite(value):
        return End(u=start, fun=value, kind="no value", hessian=np.zeros((len(start), len(start))))
    descent = _Descent(record, start, value, radius, settings)
    most = settings.calls * (len(start) + 1) if max_calls is None else max_calls
    kind = yield from descent.run(tolerance, most, stop_if)
    return End(u=descent.u, fun=descent.fun, kind=kind, hessian=descent.hessian)


class _Descent:
    """The best point so far and the radius within which the model about it is trusted."""

    def __init__(self, record: Record, u: Array, fun: float, radius: float, settings: DescentSettings) -> None:
        self.u = u
        self.fun = fun
        self.hessian = np.zeros((len(u), len(u)))
        self._record = record
        self._radius = radius
        self._settings = settings
        self._calls = 0
        self._unconfirmed = 0  # attempts since the last move

    def run(
        self, tolerance: float, max_calls: int, stop_if: StopIf | None
    ) -> Evaluations[Literal["minimum", "stuck", "abandoned"]]:
        """Explore, step or confirm, whichever the model calls for, until one of the ends of `descend`."""
        while self._calls < max_calls and self._radius >= tolerance:
            model = self._model()
            doubtful = self._doubtful_points(model)
            if len(doubtful):
                yield from self._evaluate(doubtful)
                continue
            self.hessian = model.hessian(np.zeros(len(self.u))) / self._radius**2
            if stop_if and stop_if(self.u, self.fun, *self._outlook(model)):
                return "abandoned"
            x = self._step(model, 1.0)
            foreseen = model.fun - model.value(x)
            if np.abs(x).max() * self._radius >= tolerance and foreseen > FLOAT * abs(self.fun):
                yield from self._try(x, foreseen)
            elif self._radius > self._settings.certified:
                self._radius = max(0.1 * self._radius, self._settings.certified)
            elif self._unconfirmed == self._settings.attempts or (
                yield from self._is_confirmed(model, self._settings.narrow * tolerance)
            ):
                return "minimum"
        return "stuck"

    def _model(self) -> TaylorModel:
        """Fit the nearest points."""
        points, dim = self._record.points, len(self.u)
        near = self._record.nearest(self.u, max(self._settings.points, (dim + 1) * (dim + 2)))
        values = _without_cliffs(self._record.values[near], self._settings.cliff)
        return fit(
            points[near],
            values,
            centre=self.u,
            radius=self._radius,
            hessian=self.hessian,
            settings=self._settings.taylor,
        )

    def _doubtful_points(self, model: TaylorModel) -> Array:
        """Return points (n, dim) at the radius along which the slope is in doubt, downhill if that is known."""
        variances, axes = np.linalg.eigh(model.doubt)
        points = []
        for axis in axes.T[variances > self._settings.poised**2]:
            step = -self._radius * axis if axis @ model.slope > 0 else self._radius * axis
            ahead, behind = np.clip(self.u + step, 0.0, 1.0), np.clip(self.u - step, 0.0, 1.0)
            has_room = np.linalg.norm(ahead - self.u) >= 0.5 * np.linalg.norm(behind - self.u)
            points.append(ahead if has_room else behind)
        return np.array(points).reshape(-1, len(self.u))

    def _evaluate(self, points: Array) -> Evaluations[float]:
        """Evaluate points (n, dim), move to the best of them if it is lower, and return its value."""
        values = yield points
        self._calls += len(points)
        best = int(values.argmin())
        if values[best] < self.fun:
            self.u, self.fun = points[best], float(values[best])
            self._unconfirmed = 0
        return float(values[best])

    def _try(self, x: Array, foreseen: float) -> Evaluations[None]:
        """Take a step x (dim,) radii long that should gain `foreseen`; trust the model by what was gained."""
        before = self.fun
        value = yield from self._evaluate(np.clip(self.u + self._radius * x, 0.0, 1.0)[None])
        gained = (before - value) / foreseen
        length = float(np.abs(x).max())  # in radii
        if gained > self._settings.foreseen:
            self._radius *= max(3 * length, 0.2) if length < 0.5 else 2.0
        elif gained > self._settings.poor:
            self._radius *= max(length, 0.2)
        else:
            self._radius *= max(0.5 * length, 0.1)
        self._radius = min(self._radius, self._settings.widest)

    def _is_confirmed(self, model: TaylorModel, distance: float) -> Evaluations[bool]:
        """Return whether the function rises as foreseen along the direction of least curvature.

        There a small error of the slope leads far. In a round valley the certified points are enough.
        """
        free = np.flatnonzero((self.u > 0) & (self.u < 1))
        curvatures, axes = np.linalg.eigh(self.hessian[free[:, None], free])
        if not len(free) or curvatures[0] > self._settings.round * curvatures[-1]:
            return True
        x = np.zeros(len(self.u))
        x[free] = distance / self._radius * axes[:, 0]
        x = -x if x @ model.slope > 0 else x
        there = np.clip(self.u + self._radius * x, 0.0, 1.0)
        x = (there - self.u) / self._radius
        self._unconfirmed += 1
        value = yield from self._evaluate(there[None])
        self._radius = distance
        return bool(abs(value - model.value(x)) <= self._settings.sure * abs(curvatures[0]) * distance**2)

    def _outlook(self, model: TaylorModel) -> tuple[Array, float]:
        """Return the least point (dim,) of the model in a wider box, and the value there."""
        x = self._step(model, self._settings.outlook)
        return self.u + self._radius * x, model.value(x)

    def _step(self, model: TaylorModel, radii: float) -> Array:
        """Return x (dim,), the least of the model within so many radii and the cube, by sequential quadratics."""
        low = np.maximum(-self.u / self._radius, -radii)
        high = np.minimum((1.0 - self.u) / self._radius, radii)
        x, lowest, stride = np.zeros(len(self.u)), model.fun, radii
        for _ in range(self._settings.quadratics):
            gradient, hessian = model.gradient(x), model.hessian(x)
            s = minimize_on_box(gradient, hessian, np.maximum(low - x, -stride), np.minimum(high - x, stride))
            value, length = model.value(x + s), np.abs(s).max()
            if value < lowest:
                x, lowest = x + s, value
            else:
                stride = 0.25 * length
            if length <= 0.05 * np.abs(x).max():
                break
        return x


def _without_cliffs(values: Array, cliff: float) -> Array:
    """Return values (n,) fit for a polynomial: failed ones as high as the highest other, and none immensely high.

    Immense is `cliff` times as far above the lowest as the lower quarter reaches, or beyond HUGE.
    """
    finite = values[np.isfinite(values)]
    lowest, quarter = finite.min(), np.partition(finite, len(finite) // 4)[len(finite) // 4]
    ceiling = min(finite.max(), lowest + cliff * (quarter - lowest), HUGE) if quarter > lowest else finite.max()
    return np.clip(values, -HUGE, min(ceiling, HUGE))

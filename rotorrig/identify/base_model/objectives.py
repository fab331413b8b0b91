"""Objectives of a search: the chapter's f1, f2 and f3 on amplitudes, or the whitened complex residual.

Each is a vector of residuals with its Jacobian over the unit cube of `Steady`. The unbalance, in which the response is
linear, is solved for at every point (variable projection: Golub and Pereyra 1973, with Kaufman's Jacobian 1975).
"""

from collections.abc import Callable
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_model.settings import BASE_MODEL
from rotorrig.identify.base_model.steady_forward import Steady
from rotorrig.identify.base_model.unknowns import Space
from rotorrig.identify.measurement import Measurement, trial_unbalance
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig import ConfigError, DataError

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]
ObjectiveName = Literal["residual", "f1", "f2", "f3"]
Vector = Callable[[Real], tuple[Real, Real]]  # a point of the unit cube -> residuals (figure,) and their Jacobian

_MICROMETRE = 1e-6
_LN10 = np.log(10.0)


class Amplitudes:
    """Eq. (14) to (16): measured amplitudes against predicted ones, of one unbalance of unknown phase.

    Where the measurement had its slow-roll vector subtracted, so has the prediction: at 500 rpm a good part of the
    "slow roll" is unbalance response, and comparing with an uncompensated prediction puts k wrong by 12 % to 84 % on
    data without any noise.
    """

    def __init__(self, steady: Steady, amplitude: Real, *, slow_roll: bool = False) -> None:
        """`amplitude` (speed, probe) m, NaN where left out; with `slow_roll` the last speed of `steady` is that one's.

        Raises ConfigError unless one plane is sought: amplitudes of several are not those of their sum. Raises
        DataError if there are fewer amplitudes than unknowns.
        """
        planes = steady.space.planes
        if len(planes) != 1:
            raise ConfigError(
                f"unbalance is sought on {', '.join(planes)}, want one disk or plane for an objective on amplitudes"
            )
        self.steady = steady
        self.dim = steady.dim + 1  # of `differences` and `log_ratios`
        self._amplitude = amplitude
        self._slow_roll = slow_roll
        self._used = np.flatnonzero(np.isfinite(amplitude))
        self._measured = amplitude.ravel()[self._used]
        if self.figures < self.dim:
            raise DataError(f"{self.figures} amplitudes stand out of the noise, want at least {self.dim}")
        bounds = steady.space.amounts[0]
        self._lowest = float(np.log(bounds.low))
        self._range = float(np.log(bounds.high)) - self._lowest

    @classmethod
    def of(cls, response: OrderTrackedResponse, measured: Measurement, space: Space) -> "Amplitudes":
        """Take the runs without a trial mass. Raises DataError if there is none, ConfigError as above."""
        bare = np.array([not response.runs[i].trial_unbalance for i in response.run[measured.rows]])
        chosen = thin_rows(np.flatnonzero(bare), BASE_MODEL.amplitude_rows)
        if len(chosen) == 0:
            raise DataError(f"{response.source.source}: every run carries a trial mass, want one without")
        amplitude = np.abs(measured.z[chosen] - np.nan_to_num(measured.z[-1]))
        weak = amplitude < BASE_MODEL.faint * np.sqrt(2) * measured.sigma[chosen]  # its logarithm would be noise
        amplitude[weak | ~measured.usable[chosen]] = np.nan
        compensated = bool(np.isfinite(response.slow_omega))
        omega = response.omega[measured.rows[chosen]]
        if compensated:
            omega = np.append(omega, response.slow_omega)
        steady = Steady.of(response.rig, omega, space, planes=space.planes, probes=response.probes)
        return cls(steady, amplitude, slow_roll=compensated)

    @property
    def figures(self) -> int:
        """How many amplitudes are compared."""
        return len(self._measured)

    def cost(self, theta: Real, *, objective: str) -> Real:
        """Return f1 [um^2], f2 or f3 [um], (candidate,), of the coefficients and the amount in SI, (candidate, 5).

        All bearings sought share kxx, kyy, cxx and cyy.
        """
        receptance = self.steady.receptance
        return receptance.misfit(self._amplitude, *theta.T, objective=objective, slow_roll=self._slow_roll)

    def shape(self, u: Real) -> tuple[Real, Real]:
        """Return the log ratios at `u` (dim - 1,) with the amount at its best within bounds, to base 10, and d/du."""
        ratio, by = self._log_ratios(u)
        amount = -ratio.mean()
        within = np.clip(amount, self._lowest, self._lowest + self._range)
        if within == amount:
            by = by - by.mean(axis=0)
        return (ratio + within) / _LN10, by / _LN10

    def amount(self, u: Real) -> float:
        """Return that amount as a coordinate of the unit cube."""
        return float(np.clip((-self._log_ratios(u)[0].mean() - self._lowest) / self._range, 0.0, 1.0))

    def least_cost(self, u: Real, *, objective: ObjectiveName) -> tuple[Real, Real]:
        """Return f1 [um^2], f2 or f3 [um] of candidates (candidate, dim - 1), and the amount that suits each best.

        Both (candidate,), the amount as a coordinate of the unit cube; no derivatives are taken. The amount enters as a
        factor: least squares give it for f1, a median for f2, a weighted median for f3.
        """
        log_ratio = np.log(np.abs(self._compared(self.steady.responses(u)[:, 0])) / self._measured)
        measured = self._measured / _MICROMETRE
        predicted = np.exp(log_ratio) * measured  # for 1 kg m
        if objective == "f1":
            amount = np.log(predicted @ measured / (predicted**2).sum(axis=1))
        elif objective == "f2":
            amount = -np.median(log_ratio, axis=1)
        else:
            amount = -_weighted_median(log_ratio, predicted)
        amount = np.clip(amount, self._lowest, self._lowest + self._range)
        if objective == "f2":
            cost = np.abs(log_ratio + amount[:, None]).sum(axis=1) / _LN10
        else:
            off = predicted * np.exp(amount)[:, None] - measured
            cost = (off**2 if objective == "f1" else np.abs(off)).sum(axis=1)
        return cost, (amount - self._lowest) / self._range

    def values(self, v: Real, *, objective: ObjectiveName) -> Real:
        """Return f1 [um^2], f2 or f3 [um], (candidate,), at points (candidate, dim), the amount last."""
        log_ratio = np.log(np.abs(self._compared(self.steady.responses(v[:, :-1])[:, 0])) / self._measured)
        log_ratio += self._lowest + v[:, -1:] * self._range
        if objective == "f2":
            return np.abs(log_ratio).sum(axis=1) / _LN10
        off = np.expm1(log_ratio) * self._measured / _MICROMETRE
        return (off**2 if objective == "f1" else np.abs(off)).sum(axis=1)

    def size(self, objective: ObjectiveName) -> float:
        """Return the objective of a prediction of nothing, f1 [um^2] or f3 [um]; for f2 of one e times too large."""
        measured = self._measured / _MICROMETRE
        return {"f1": float(measured @ measured), "f2": len(measured) / _LN10, "f3": float(measured.sum())}[objective]

    def vector(self, objective: ObjectiveName) -> Vector:
        """Return what "f1" sums the squares of, "f2" or "f3" the absolute values."""
        return self.log_ratios if objective == "f2" else self.differences

    def log_ratios(self, v: Real) -> tuple[Real, Real]:
        """Return log10 of predicted over measured at `v` (dim,), the amount last, and d/dv: f2 is their sum."""
        ratio, by = self._log_ratios(v[:-1])
        ratio = ratio + self._lowest + v[-1] * self._range
        return ratio / _LN10, self._with_amount(by) / _LN10

    def differences(self, v: Real) -> tuple[Real, Real]:
        """Return predicted less measured [um] at `v` (dim,), the amount last, and d/dv: f1 and f3 are their sums."""
        ratio, by = self._log_ratios(v[:-1])
        predicted = self._measured / _MICROMETRE * np.exp(ratio + self._lowest + v[-1] * self._range)
        return predicted - self._measured / _MICROMETRE, predicted[:, None] * self._with_amount(by)

    def theta(self, v: Real) -> tuple[float, ...]:
        """Return the unknowns and the amount at `v` (dim,), in SI."""
        return tuple(map(float, self.places(v)))

    def places(self, v: Real) -> Real:
        """Return likewise, (..., unknown), those of points (..., dim)."""
        amount = np.exp(self._lowest + v[..., -1:] * self._range)
        return np.concatenate([self.steady.values(v[..., :-1]), amount], axis=-1)

    def _log_ratios(self, u: Real) -> tuple[Real, Real]:
        """Return ln of predicted, for 1 kg m, over measured, (figure,), and d/du."""
        z, by_u = self.steady(u)
        z, by_u = self._compared(z[0]), self._compared(by_u[:, 0])
        return np.log(np.abs(z) / self._measured), (by_u / z).real.T

    def _compared(self, z: Complex) -> Complex:
        """Return what is compared, (..., figure), of responses (..., speed, probe) or their derivatives."""
        if self._slow_roll:
            z = z[..., :-1, :] - z[..., -1:, :]
        return z.reshape(*z.shape[:-2], -1)[..., self._used]

    def _with_amount(self, by: Real) -> Real:
        return np.column_stack([by, np.full(len(by), self._range)])


class ComplexResidual:
    """1X vectors against predicted ones, whitened by their covariance; unbalance and runout are solved for.

    The amounts have no bounds here, and the runout no prior.
    """

    def __init__(self, steady: Steady, z: Complex, whiten: Real, *, known: Complex | None = None) -> None:
        """`z` (speed, probe) m and `whiten` (speed, 2 probe, 2 probe) as in `Measurement`, 0 for what is left out.

        `known` (plane, speed) kg m is the unbalance that is there besides what is sought; the planes of `steady` are
        those sought and then those of the trial masses.
        """
        self.steady = steady
        self._known = known
        self._whiten = whiten
        runout = whiten.reshape(-1, whiten.shape[-1])  # whitened constants, one column per probe and part
        self._runout = np.linalg.qr(runout)[0]
        self._measured = self._cleared(z[None])[:, 0]

    @classmethod
    def of(cls, response: OrderTrackedResponse, measured: Measurement, space: Space) -> "ComplexResidual":
        """Take all runs, the slow roll as one more row."""
        chosen = thin_rows(np.arange(len(measured.rows)), BASE_MODEL.vector_rows)
        rows = np.append(chosen, len(measured.rows))
        trials = trial_unbalance(response, measured.rows)
        planes = tuple(dict.fromkeys((*space.planes, *trials)))
        nothing = np.zeros(len(measured.z))
        omega = np.append(response.omega[measured.rows[chosen]], np.nan_to_num(response.slow_roll_omega))
        usable = measured.usable[rows]
        return cls(
            Steady.of(response.rig, omega, space, planes=planes, probes=response.probes),
            np.where(usable, measured.z[rows], 0),
            measured.whiten[rows] * np.repeat(usable, 2, axis=1)[:, None],
            known=np.array([trials.get(plane, nothing)[rows] for plane in planes]) if trials else None,
        )

    @property
    def size(self) -> float:
        """Sum of squares of what is measured, whitened and without a constant."""
        return float(self._measured @ self._measured)

    def __call__(self, u: Real) -> tuple[Real, Real]:
        """Return the residual at `u` (dim,) in standard deviations, (figure,), and d/du."""
        _, off, by_u = self._solved(u)
        return off, by_u

    def values(self, u: Real) -> Real:
        """Return the sums of squares (candidate,) at points (candidate, dim)."""
        return np.array([float(r @ r) for _, r, _ in map(self._solved, u)])

    def theta(self, u: Real) -> tuple[float, ...]:
        """Return the unknowns and the amounts at `u`, in SI."""
        return (*map(float, self.steady.values(u)), *map(float, np.abs(self.amounts(u))))

    def amounts(self, u: Real) -> Complex:
        """Return the unbalance at its best at `u`, (plane sought,) kg m."""
        return self._solved(u)[0]

    def _solved(self, u: Real) -> tuple[Complex, Real, Real]:
        """Return the best amounts, the residual with them, and its derivatives."""
        z, by_u = self.steady(u)
        n, dim = len(self.steady.space.planes), len(by_u)
        whole = np.concatenate([z[None], by_u])  # (1 + dim, plane, speed, probe)
        columns = whole[:, :n].reshape(-1, *z.shape[1:])
        per_part = self._cleared(np.concatenate([columns, 1j * columns])).reshape(-1, 2, 1 + dim, n)
        columns, change = per_part[:, :, 0].reshape(-1, 2 * n), per_part[:, :, 1:]
        off, by = -self._measured, np.zeros(())
        if self._known is not None:
            trials = self._cleared((whole * self._known[..., None]).sum(axis=1))
            off, by = off + trials[:, 0], trials[:, 1:]
        normal = columns.T @ columns
        normal.flat[:: 2 * n + 1] += BASE_MODEL.planes_apart * normal.diagonal().sum()
        inverse = np.linalg.inv(normal)
        x = -inverse @ (columns.T @ off)
        by = by + np.einsum("fpdk,pk->fd", change, x.reshape(2, n))
        return x[:n] + 1j * x[n:], off + columns @ x, by - columns @ (inverse @ (columns.T @ by))

    def _cleared(self, z: Complex) -> Real:
        """Return vectors (n, speed, probe) whitened and without what a constant explains, (figure, n)."""
        n, speeds, probes = z.shape
        pairs = np.empty((speeds, probes, 2, n))
        pairs[:, :, 0] = z.real.transpose(1, 2, 0)
        pairs[:, :, 1] = z.imag.transpose(1, 2, 0)
        white = (self._whiten @ pairs.reshape(speeds, 2 * probes, n)).reshape(-1, n)
        return white - self._runout @ (self._runout.T @ white)


def _weighted_median(values: Real, weights: Real) -> Real:
    """Return the median of each row, (row,), of values (row, figure) that count as much as their weights."""
    order = values.argsort(axis=1)
    below = np.cumsum(np.take_along_axis(weights, order, axis=1), axis=1)
    middle = (below < below[:, -1:] / 2).sum(axis=1, keepdims=True)
    return np.take_along_axis(values, np.take_along_axis(order, middle, axis=1), axis=1)[:, 0]


def thin_rows(rows: NDArray[np.intp], most: int) -> NDArray[np.intp]:
    """Return `most` of the rows at most, evenly spaced.

    >>> thin_rows(np.arange(100), 4).tolist()
    [0, 33, 66, 99]
    """
    return rows[np.unique(np.linspace(0, len(rows) - 1, most).astype(np.intp))] if len(rows) else rows

"""Refine a candidate by whitened complex least squares, and say how well the data determine it."""

import copy
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_model.forward import Forward, UnitResponse
from rotorrig.identify.base_model.parameters import Parameters, Reals
from rotorrig.identify.base_model.settings import BASE_MODEL
from rotorrig.identify.least_squares import LEAST_SQUARES, NONE_FIXED, Solution, solve
from rotorrig.identify.measurement import Measurement, trial_unbalance
from rotorrig.processing import OrderTrackedResponse

Complex = NDArray[np.complex128]


class Problem:
    """The least-squares problem of one band of one response."""

    def __init__(self, response: OrderTrackedResponse, measured: Measurement) -> None:
        """Set up the forward model for the rows measured. Raises ConfigError if the rig has no [identify] table."""
        self.parameters = Parameters(response.rig, response.probes)
        self.measured = measured
        self._known = trial_unbalance(response, measured.rows)
        space = self.parameters.space
        self._planes = tuple(dict.fromkeys((*space.planes, *self._known)))
        self._forward = Forward(
            response,
            measured.rows,
            groups=space.groups,
            others=self.parameters.others,
            planes=self._planes,
        )
        self._last: tuple[bytes, UnitResponse] | None = None
        self.swept = self._forward.swept

    def of(self, z: Complex) -> "Problem":
        """Return the same problem of other vectors (row + 1, probe) [m], their covariance that of those measured."""
        other = copy.copy(self)
        other.measured = replace(self.measured, z=z)
        return other

    def start(self, values: Reals) -> Reals:
        """Return a full vector from the unknowns in SI: unbalance and runout by linear least squares."""
        space = self.parameters.space
        p = np.zeros(len(self.parameters))
        p[self.parameters.sought] = np.clip(space.to_working(values), *space.working_bounds.T)
        return self.solve_linear(p, np.arange(len(p)))

    def refine(self, values: Reals, *, max_steps: int = BASE_MODEL.most_steps) -> Solution:
        """Refine from the unknowns in SI: first as if the nameplate and the probes were exact, then with all free.

        Far from the minimum a nuisance would take what the unknowns have not reached yet, and find back only slowly.
        """
        names = self.parameters
        nuisances = [i for part in (names.nameplate, names.gain, names.angle) for i in range(part.start, part.stop)]
        near = self.solve(self.start(values), fixed=dict.fromkeys(nuisances, 0.0), tolerance=BASE_MODEL.near)
        return self.solve(near.p, max_steps=max_steps)

    @property
    def bounds(self) -> tuple[Reals, Reals]:
        """Lower and upper bounds of the parameters."""
        return self.parameters.bounds

    @property
    def size(self) -> int:
        """Number of real figures measured, and of priors."""
        return self.measured.size + len(self.parameters.priors)

    def solve(
        self,
        start: Reals,
        *,
        fixed: Mapping[int, float] = NONE_FIXED,
        tolerance: float = LEAST_SQUARES.tolerance,
        max_steps: int = BASE_MODEL.most_steps,
    ) -> Solution:
        """Refine by least squares within the bounds, the parameters in `fixed` held: least_squares.solve."""
        # damped: a search may end far off, where full steps of a wrong model run to the bounds
        return solve(self, start, fixed=fixed, tolerance=tolerance, max_steps=max_steps, damped=True)

    def at_bound(self, p: Reals, i: int) -> bool:
        """Say whether unknown number `i` ended within a per cent of its bound."""
        return bool(np.abs(self.parameters.space.working_bounds[i] - p[i]).min() < BASE_MODEL.at_bound)

    def predict(self, p: Reals) -> Complex:
        """Return 1X vectors (row + 1, probe) [m] as they should have been measured, the slow roll last."""
        runout = p[self.parameters.runout]
        return self._seen(p, *self._motion(p, self._unit(p))) + runout[0::2] + 1j * runout[1::2]

    def residual(self, p: Reals) -> Reals:
        """Return whitened residuals, model less measured, then the priors' [sigma]."""
        return np.concatenate([self._whitened(self.predict(p) - self.measured.z), self.parameters.prior_residual(p)])

    def jacobian(self, p: Reals, free: NDArray[np.intp] | None = None) -> Reals:
        """Return d residual / d p, (figure + prior, parameter), or its columns `free` alone."""
        names = self.parameters
        free = np.arange(len(p)) if free is None else free
        along, across = self._motion(p, self._unit(p))
        gain, cos, sin = self._probes(p)
        each = np.eye(len(gain))
        by_gain = (cos * along + sin * across)[..., None] * each
        by_angle = (gain * (cos * across - sin * along))[..., None] * each
        structural = np.zeros((*along.shape, names.structural.stop), dtype=complex)
        if len(moving := free[free < names.structural.stop]):
            by = names.structure_derivatives(p)
            changes = self._forward.derivatives(names.structure(p), [by[i] for i in moving])
            structural[..., moving] = np.moveaxis(self._seen(p, *self._motion(p, changes)), 0, -1)
        nonlinear = self._whitened(np.concatenate([structural, by_gain, by_angle], axis=-1))
        data = np.concatenate([nonlinear, self._linear_columns(p)], axis=1)
        return np.concatenate([data, names.prior_jacobian()])[:, free]

    def _linear_columns(self, p: Reals) -> Reals:
        """Return d data residual / d (unbalance, runout)."""
        unit = self._unit(p)
        count = len(self.parameters.space.planes)
        gain, cos, sin = (part[:, None] for part in self._probes(p))
        forced = gain * (cos * unit.along[..., :count] + sin * unit.across[..., :count])
        each = np.broadcast_to(np.eye(len(gain), dtype=complex), (*forced.shape[:-1], len(gain)))
        return self._whitened(np.concatenate([_re_im(forced), _re_im(each)], axis=-1))

    def solve_linear(self, p: Reals, free: NDArray[np.intp]) -> Reals:
        """Return `p` with the linear parameters among `free` at their best by linear least squares."""
        names = self.parameters
        linear = np.arange(names.linear.start, names.linear.stop)
        chosen = linear[np.isin(linear, free)]
        columns = np.concatenate([self._linear_columns(p), names.prior_jacobian()[:, linear]])
        best = p.copy()
        best[chosen] -= np.linalg.lstsq(columns[:, chosen - linear[0]], self.residual(p), rcond=None)[0]
        return best

    def _motion(self, p: Reals, unit: UnitResponse) -> tuple[Complex, Complex]:
        """Return the motion along and across the nominal probe axes, (..., row + 1, probe), of what unit responses are.

        It is due to the unbalance in `p` and the known trial masses.
        """
        sought = self.parameters.amounts(p)
        amounts = np.stack(
            [sought.get(plane, 0) + self._known.get(plane, np.zeros(len(self.measured.z))) for plane in self._planes],
            axis=-1,
        )
        return tuple(np.einsum("...rpl,rl->...rp", z, amounts) for z in (unit.along, unit.across))

    def _seen(self, p: Reals, along: Complex, across: Complex) -> Complex:
        """Return what the probes make of a motion, gain and angle errors included."""
        gain, cos, sin = self._probes(p)
        return gain * (cos * along + sin * across)

    def _unit(self, p: Reals) -> UnitResponse:
        """Return the unit responses, those of the last candidate at once."""
        key = p[self.parameters.structural].tobytes()
        if self._last is None or self._last[0] != key:
            self._last = key, self._forward(self.parameters.structure(p))
        return self._last[1]

    def _probes(self, p: Reals) -> tuple[Reals, Reals, Reals]:
        """Return gain, and cosine and sine of the angle error, per probe."""
        angle = p[self.parameters.angle]
        return 1 + p[self.parameters.gain], np.cos(angle), np.sin(angle)

    def _whitened(self, change: Complex) -> Reals:
        """Return changes of the vectors, (row + 1, probe) or (row + 1, probe, column), in sigmas, (figure, ...)."""
        sigmas = self.measured.sigmas(change)
        return sigmas.reshape(-1, *sigmas.shape[2:])


def _re_im(z: Complex) -> Complex:
    """Return columns by Re u, Im u of columns by u, (..., 2 column)."""
    return np.stack([z, 1j * z], axis=-1).reshape(*z.shape[:-1], -1)

"""The prediction of a whole response: 1X vectors as the recording would show them, for one set of parameters.

The speed was moving and each row is a window of turns, so both are in the model (sims.rotor.sweep), from what the
recording knows: the keyphasor's pulse times. Where a table came without times, the steady response stands in.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_model.structure import StructuralModel, Structure
from rotorrig.processing import OrderTrackedResponse
from rotorrig.sims.rotor.steady import columns, steady_derivatives
from rotorrig.sims.rotor.swept import Timeline, swept_columns, swept_derivatives, tracked_rows

Complex = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class UnitResponse:
    """Response to 1 kg m on each plane, m per kg m; the last row is the slow roll."""

    along: Complex  # (..., row + 1, probe, plane) along every probe's axis
    across: Complex  # the same at right angles to it, +90 degrees


class Forward:
    """Predicts the rows of one response; made once, asked for every candidate."""

    def __init__(
        self,
        response: OrderTrackedResponse,
        rows: NDArray[np.intp],
        *,
        groups: Sequence[Sequence[str]],
        others: Sequence[str],
        planes: Sequence[str],
    ) -> None:
        """Reduce the rotor and lay out the time line of `rows` of the response, for unbalance on `planes`.

        The bearings in `groups` get the coefficients of a `Structure`, group by group, `others` its factors.
        """
        self._planes = planes
        self._rotor = StructuralModel(response.rig, response.probes, groups=groups, others=others)
        self._omega = response.omega[rows]
        slow = response.slow_roll_omega
        self._slow = np.array([slow if np.isfinite(slow) else 0.0])
        self.swept = len(response.keyphasor_t) > 3 and bool(np.isfinite(response.t[rows]).all())
        if self.swept:
            self._tracked = tracked_rows(
                Timeline(response.keyphasor_t),
                t=response.t[rows],
                revolutions=response.revolutions[rows],
                window=response.window,
            )

    def __call__(self, values: Structure) -> UnitResponse:
        """Return the response to unit unbalance on every plane."""
        model, planes = self._rotor(values), self._planes
        if self.swept:
            moving = swept_columns(model, self._tracked, unbalance=planes)
        else:
            moving = columns(model, self._omega, unbalance=planes)
        return _split(np.concatenate([moving, columns(model, self._slow, unbalance=planes)]))

    def derivatives(self, values: Structure, by: Sequence[Structure]) -> UnitResponse:
        """Return the derivatives of the response along every one of `by`, (direction, row + 1, probe, plane)."""
        model = self._rotor(values)
        directions = [self._rotor.direction(model, values, change) for change in by]
        if self.swept:
            moving = swept_derivatives(model, self._tracked, unbalance=self._planes, directions=directions)
        else:
            moving = steady_derivatives(model, self._omega, unbalance=self._planes, directions=directions)
        slow = steady_derivatives(model, self._slow, unbalance=self._planes, directions=directions)
        return _split(np.concatenate([moving.by, slow.by], axis=1))


def _split(z: Complex) -> UnitResponse:
    """Part the probes, axis -2, into those of the response and those at right angles to them."""
    n = z.shape[-2] // 2
    return UnitResponse(along=z[..., :n, :], across=z[..., n:, :])

"""The prediction of a whole response: 1X vectors as the recording would show them, for one set of parameters.

The speed was moving and each row is a window of turns, so both are in the model (sims.rotor.sweep), from what the
recording knows: the keyphasor's pulse times. Where a table came without times, the steady response stands in.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.description import RigConfig
from rotorrig.sims.rotor.assembly import RotorModel, assemble, scaled, with_bearing
from rotorrig.sims.rotor.directions import (
    Direction,
    along_bearing,
    along_density,
    along_disk_mass,
    along_modulus,
    steady_derivatives,
)
from rotorrig.sims.rotor.harmonic import columns
from rotorrig.sims.rotor.reduction import reduce
from rotorrig.sims.rotor.sweep import swept_columns, swept_derivatives
from rotorrig.sims.rotor.timeline import Timeline
from rotorrig.sims.rotor.tracking import tracked_rows

Complex = NDArray[np.complex128]

_MODES = 6  # beside the static shapes: 3e-10 of the peak from the full model on the RK4, twice as fast as ten


@dataclass(frozen=True, slots=True, kw_only=True)
class Structure:
    """The structural parameters a prediction depends on nonlinearly, or their derivatives by one parameter of a fit."""

    K: NDArray[np.float64]  # (group, 2, 2) N/m of the bearings sought
    C: NDArray[np.float64]  # (group, 2, 2) N s/m
    youngs_modulus: float = 1.0  # factor on the nameplate
    density: float = 1.0  # factor on the nameplate, of the shaft
    disk_mass: float = 1.0  # factor on the nameplate, all disks alike
    others: tuple[float, ...] = ()  # factors on the stiffness of the bearings not identified: x, y, x, y ...


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
        self._groups = groups
        self._others = others
        self._planes = planes
        self._model = reduce(assemble(_with_cross_probes(response.rig, response.probes)), modes=_MODES)
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
        model, planes = self._changed(values), self._planes
        if self.swept:
            moving = swept_columns(model, self._tracked, unbalance=planes)
        else:
            moving = columns(model, self._omega, unbalance=planes)
        return _split(np.concatenate([moving, columns(model, self._slow, unbalance=planes)]))

    def derivatives(self, values: Structure, by: Sequence[Structure]) -> UnitResponse:
        """Return the derivatives of the response along every one of `by`, (direction, row + 1, probe, plane)."""
        model = self._changed(values)
        directions = [self._direction(model, values, change) for change in by]
        if self.swept:
            moving = swept_derivatives(model, self._tracked, unbalance=self._planes, directions=directions)
        else:
            moving = steady_derivatives(model, self._omega, unbalance=self._planes, directions=directions)
        slow = steady_derivatives(model, self._slow, unbalance=self._planes, directions=directions)
        return _split(np.concatenate([moving.by, slow.by], axis=1))

    def _changed(self, values: Structure) -> RotorModel:
        model = self._model
        for names, K, C in zip(self._groups, values.K, values.C, strict=True):
            model = with_bearing(model, names, K, C)
        for name, K in self._other_stiffness(values):
            model = with_bearing(model, name, K, self._model.bearing(name).C)
        return scaled(model, youngs_modulus=values.youngs_modulus, density=values.density, disk_mass=values.disk_mass)

    def _direction(self, model: RotorModel, values: Structure, change: Structure) -> Direction:
        """Return the derivative of the matrices of `model`, which has those `values`."""
        parts = [along_bearing(model, name, K=K) for name, K in self._other_stiffness(change) if K.any()]
        for names, K, C in zip(self._groups, change.K, change.C, strict=True):
            if K.any() or C.any():
                parts.append(along_bearing(model, names, K=K, C=C))
        for along, ratio in (
            (along_modulus, change.youngs_modulus / values.youngs_modulus),
            (along_density, change.density / values.density),
            (along_disk_mass, change.disk_mass / values.disk_mass),
        ):
            if ratio:
                parts.append(Direction._make(ratio * A for A in along(model)))
        return Direction._make(sum(matrices) for matrices in zip(*parts, strict=True))

    def _other_stiffness(self, values: Structure) -> Iterator[tuple[str, NDArray[np.float64]]]:
        """Yield the names of the bearings not sought and their stiffness times their factors, a row each."""
        for name, xy in zip(self._others, np.reshape(values.others, (-1, 2)), strict=True):
            yield name, xy[:, None] * self._model.bearing(name).K


def _split(z: Complex) -> UnitResponse:
    """Part the probes, axis -2, into those of the response and those at right angles to them."""
    n = z.shape[-2] // 2
    return UnitResponse(along=z[..., :n, :], across=z[..., n:, :])


def _with_cross_probes(rig: RigConfig, names: tuple[str, ...]) -> RigConfig:
    """Return the rig with its probes in the response's order, then each once more, turned by +90 degrees."""
    probes = tuple(rig.probe(name) for name in names)
    across = tuple(p.model_copy(update={"name": f"{p.name}+90", "angle": p.angle + np.pi / 2}) for p in probes)
    return rig.model_copy(update={"probes": probes + across})

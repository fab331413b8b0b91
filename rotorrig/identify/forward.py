"""The prediction of a whole response: 1X vectors as the recording would show them, for one set of parameters.

The speed was moving and each row is a window of turns, so both are in the model (sims.rotor.sweep), from what the
recording knows: the keyphasor's pulse times. Where a table came without times, the steady response stands in.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.description import RigConfig
from rotorrig.sims.rotor.assembly import RotorModel, assemble, scaled, with_bearing
from rotorrig.sims.rotor.harmonic import probe_response
from rotorrig.sims.rotor.reduction import reduce
from rotorrig.sims.rotor.sweep import Timeline, swept_response

Complex = NDArray[np.complex128]

_MODES = 6  # beside the static shapes: 3e-10 of the peak from the full model on the RK4, twice as fast as ten


@dataclass(frozen=True, slots=True, kw_only=True)
class Structure:
    """The structural parameters a prediction depends on nonlinearly."""

    kxx: float
    kyy: float
    cxx: float
    cyy: float
    youngs_modulus: float = 1.0  # factor on the nameplate
    disk_mass: float = 1.0  # factor on the nameplate, all disks alike
    others: tuple[float, ...] = ()  # factors on the stiffness of the bearings not identified: x, y, x, y ...


@dataclass(frozen=True, slots=True, kw_only=True)
class UnitResponse:
    """Response to 1 kg m on each disk: along every probe's axis and at right angles to it, +90 degrees."""

    along: dict[str, Complex]  # disk -> (row + 1, probe) m per kg m; the last row is the slow roll
    across: dict[str, Complex]


class Forward:
    """Predicts the rows of one response; made once, asked for every candidate."""

    def __init__(
        self, response: OrderTrackedResponse, rows: NDArray[np.intp], *, disks: tuple[str, ...], others: tuple[str, ...]
    ) -> None:
        """Reduce the rotor and lay out the time line of `rows` of the response, for unbalance on `disks`."""
        self._response = response
        self._rows = rows
        self._disks = disks
        self._others = others
        self._names = response.rig.identify.bearings if response.rig.identify else ()
        self._model = reduce(assemble(_with_cross_probes(response.rig, response.probes)), modes=_MODES)
        self.swept = len(response.keyphasor_t) > 3 and bool(np.isfinite(response.t[rows]).all())
        self._timeline = Timeline(response.keyphasor_t) if self.swept else None

    def __call__(self, values: Structure) -> UnitResponse:
        """Return the response to unit unbalance on every disk."""
        model = self._changed(values)
        columns = {disk: self._one(model, disk) for disk in self._disks}
        n = len(self._response.probes)
        return UnitResponse(
            along={disk: z[:, :n] for disk, z in columns.items()},
            across={disk: z[:, n:] for disk, z in columns.items()},
        )

    def _changed(self, values: Structure) -> RotorModel:
        K = np.diag([values.kxx, values.kyy])
        C = np.diag([values.cxx, values.cyy])
        model = with_bearing(self._model, self._names, K, C)
        factors = np.reshape(values.others, (len(self._others), 2))
        for name, xy in zip(self._others, factors, strict=True):
            bearing = self._model.bearing(name)
            model = with_bearing(model, name, xy[:, None] * bearing.K, bearing.C)
        return scaled(model, youngs_modulus=values.youngs_modulus, disk_mass=values.disk_mass)

    def _one(self, model: RotorModel, disk: str) -> Complex:
        response, rows = self._response, self._rows
        unit = {disk: 1.0 + 0.0j}
        slow = np.array([response.slow_roll_omega if np.isfinite(response.slow_roll_omega) else 0.0])
        at_slow_roll = probe_response(model, slow, unbalance=unit)
        if self._timeline is None:
            moving = probe_response(model, response.omega[rows], unbalance=unit)
        else:
            moving = swept_response(
                model,
                self._timeline,
                t=response.t[rows],
                revolutions=response.revolutions[rows],
                window=response.window,
                unbalance=unit,
            )
        return np.concatenate([moving, at_slow_roll])


def _with_cross_probes(rig: RigConfig, names: tuple[str, ...]) -> RigConfig:
    """Return the rig with its probes in the response's order, then each once more, turned by +90 degrees."""
    probes = tuple(rig.probe(name) for name in names)
    across = tuple(p.model_copy(update={"name": f"{p.name}+90", "angle": p.angle + np.pi / 2}) for p in probes)
    return rig.model_copy(update={"probes": probes + across})

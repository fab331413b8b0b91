"""The rotor of a fit: reduced once, and changed for every candidate's structural parameters."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_model.settings import BASE_MODEL
from rotorrig.rig.config import Plane, RigConfig
from rotorrig.sims.rotor.model import (
    Direction,
    RotorModel,
    along_bearing,
    along_density,
    along_disk_mass,
    along_modulus,
    assemble,
    reduce,
    scale_properties,
    with_bearing,
)

NOWHERE: Mapping[str, float] = MappingProxyType({})


@dataclass(frozen=True, slots=True, kw_only=True)
class Structure:
    """The structural parameters a prediction depends on nonlinearly, or their derivatives by one parameter of a fit."""

    K: NDArray[np.float64]  # (group, 2, 2) N/m of the bearings sought
    C: NDArray[np.float64]  # (group, 2, 2) N s/m
    youngs_modulus: float = 1.0  # factor on the nameplate
    density: float = 1.0  # factor on the nameplate, of the shaft
    disk_mass: float = 1.0  # factor on the nameplate, all disks alike
    others: tuple[float, ...] = ()  # factors on the stiffness of the bearings not identified: x, y, x, y ...


class StructuralModel:
    """The reduced rotor of one rig, seen along every probe and at right angles to it."""

    def __init__(
        self,
        rig: RigConfig,
        probes: tuple[str, ...],
        *,
        groups: Sequence[Sequence[str]],
        others: Sequence[str],
        places: Mapping[str, float] = NOWHERE,
    ) -> None:
        """Reduce the rotor of `rig`; `places` [m] are planes it gets beside its own.

        The bearings in `groups` get the coefficients of a `Structure`, group by group, `others` its factors.
        """
        self._groups = groups
        self._others = others
        self.nominal = reduce(assemble(_with_cross_probes(with_places(rig, places), probes)), modes=BASE_MODEL.modes)

    def __call__(self, values: Structure) -> RotorModel:
        """Return the model of those values."""
        model = self.nominal
        for names, K, C in zip(self._groups, values.K, values.C, strict=True):
            model = with_bearing(model, names, K, C)
        for name, K in self._other_stiffness(values):
            model = with_bearing(model, name, K, self.nominal.bearing(name).C)
        return scale_properties(
            model, youngs_modulus=values.youngs_modulus, density=values.density, disk_mass=values.disk_mass
        )

    def direction(self, model: RotorModel, values: Structure, change: Structure) -> Direction:
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
            yield name, xy[:, None] * self.nominal.bearing(name).K


def with_places(rig: RigConfig, places: Mapping[str, float]) -> RigConfig:
    """Return the rig with planes at those places [m] beside its own, those beyond an end at that end."""
    if not places:
        return rig
    inside = {name: min(max(z, 0.0), rig.shaft.length) for name, z in places.items()}
    more = tuple(Plane.model_construct(name=name, position=z) for name, z in inside.items())  # SI, no unit to read
    return rig.model_copy(update={"planes": (*rig.planes, *more)})


def _with_cross_probes(rig: RigConfig, names: tuple[str, ...]) -> RigConfig:
    """Return the rig with its probes in the response's order, then each once more, turned by +90 degrees."""
    probes = tuple(rig.probe(name) for name in names)
    across = tuple(p.model_copy(update={"name": f"{p.name}+90", "angle": p.angle + np.pi / 2}) for p in probes)
    return rig.model_copy(update={"probes": probes + across})

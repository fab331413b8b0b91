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
    along_diameter,
    along_disk_mass,
    along_hub,
    along_modulus,
    along_position,
    along_tilt,
    assemble,
    condense_spans,
    geometry_of,
    position_range,
    reduce,
    scale_properties,
    with_bearing,
    with_geometry,
    with_tilt,
)

ACROSS = "+90"  # in the name of the probe at right angles to another
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
    # differences from the nameplate, of a model that takes them; none: as the nameplate says
    positions: tuple[float, ...] = ()  # m, of StructuralModel.movable
    hubs: tuple[float, ...] = ()  # share of the shaft's flexibility that each disk's hub takes away
    tilts: tuple[float, ...] = ()  # N m/rad more than stated, of every bearing
    diameter: float = 0.0  # relative, of the shaft


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
        adjustable: bool = False,
    ) -> None:
        """Reduce the rotor of `rig`; `places` [m] are planes it gets beside its own.

        The bearings in `groups` get the coefficients of a `Structure`, group by group, `others` its factors. Only an
        `adjustable` model takes positions, hubs and diameter, and answers well under other tilt stiffnesses.
        """
        self._groups = groups
        self._others = others
        whole = _with_cross_probes(with_places(rig, places), probes)
        if adjustable:
            full = assemble(whole, max_element=BASE_MODEL.element, hubs=True)
            self.nominal = condense_spans(full, modes=BASE_MODEL.span_modes)
        else:
            self.nominal = reduce(assemble(whole), modes=BASE_MODEL.modes)
        self.hubs = tuple(disk.name for disk in rig.disks)
        self.tilts = tuple(bearing.name for bearing in rig.bearings)
        self.movable = (
            *(f"disk {name}" for name in self.hubs),
            *(f"bearing {name}" for name in self.tilts),
            *(f"probe {name}" for name in probes),
        )

    def position_range(self, part: str) -> float:
        """Return how far [m] either way one of the `movable` parts may be off. Raises ValueError unless adjustable."""
        return position_range(geometry_of(self.nominal), part)

    def __call__(self, values: Structure) -> RotorModel:
        """Return the model of those values."""
        model = self._with_nameplate(values)
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
        parts += [_times(value, along_tilt(model, name)) for name, value in _given(self.tilts, change.tilts)]
        parts += [_times(value, along_hub(model, name)) for name, value in _given(self.hubs, change.hubs)]
        parts += [
            _times(value, along_position(model, part))
            for name, value in _given(self.movable, change.positions)
            for part in _with_across(name)
        ]
        if change.diameter:
            parts.append(_times(change.diameter, along_diameter(model)))
        for along, ratio in (
            (along_modulus, change.youngs_modulus / values.youngs_modulus),
            (along_density, change.density / values.density),
            (along_disk_mass, change.disk_mass / values.disk_mass),
        ):
            if ratio:
                parts.append(_times(ratio, along(model)))
        return Direction._make(sum(matrices) for matrices in zip(*parts, strict=True))

    def _with_nameplate(self, values: Structure) -> RotorModel:
        """Return the nominal model off the nameplate by what `values` say."""
        model = self.nominal
        moved = {part: v for name, v in _given(self.movable, values.positions) for part in _with_across(name)}
        hubs = dict(_given(self.hubs, values.hubs))
        if moved or hubs or values.diameter:
            model = with_geometry(model, positions=moved, hubs=hubs, diameter=values.diameter)
        more = {name: model.tilt(name).stiffness + value for name, value in _given(self.tilts, values.tilts)}
        return with_tilt(model, more) if more else model

    def _other_stiffness(self, values: Structure) -> Iterator[tuple[str, NDArray[np.float64]]]:
        """Yield the names of the bearings not sought and their stiffness times their factors, a row each."""
        for name, xy in zip(self._others, np.reshape(values.others, (-1, 2)), strict=True):
            yield name, xy[:, None] * self.nominal.bearing(name).K


def _given(names: Sequence[str], values: Sequence[float]) -> list[tuple[str, float]]:
    """Return those of the values that are not zero, by name; no values at all are zeros. Raises ValueError."""
    if not values:
        return []
    return [(name, value) for name, value in zip(names, values, strict=True) if value]


def _times(factor: float, direction: Direction) -> Direction:
    return Direction._make(factor * A for A in direction)


def _with_across(part: str) -> tuple[str, ...]:
    """Return the part and, of a probe, the one across it, which stands where it does."""
    return (part, part + ACROSS) if part.startswith("probe ") else (part,)


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
    across = tuple(p.model_copy(update={"name": p.name + ACROSS, "angle": p.angle + np.pi / 2}) for p in probes)
    return rig.model_copy(update={"probes": probes + across})

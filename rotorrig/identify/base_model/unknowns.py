"""Unknowns of an identification: those of a rig's [identify] table, their bounds, and the scale each is searched on.

Direct stiffness and damping, unbalance, modulus and density are ratios: a step means a factor, and they are searched
on a logarithmic scale (chapter 8.2, eq. 21, and the side constraints below it). In linear coordinates a hundredth of
the box would hold nine tenths of the decades. Cross coefficients may have either sign and are searched linearly.

Working coordinates are logarithms, and parts of the larger bound where the scale is linear: of the order of one both.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotorrig.identify.base_model.settings import BASE_MODEL
from rotorrig.rig import ConfigError
from rotorrig.rig.config import Identify, RigConfig

Real = NDArray[np.float64]
Scale = Literal["log", "linear"]

UNITS = {"k": "N/m", "c": "N s/m"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Unknown:
    """One unknown: its name among the estimates, SI unit, bounds and what the nameplate says."""

    name: str  # "kxx", "spring kxy", "E", "density", "u", "u disk 2"
    unit: str
    low: float
    high: float
    nameplate: float  # NaN: it does not say
    scale: Scale
    axes: str = ""  # "xx", "xy".. of a coefficient


@dataclass(frozen=True, kw_only=True)
class Space:
    """The unknowns of one rig, in order: the coefficients group by group, then modulus and density if sought."""

    groups: tuple[tuple[str, ...], ...]  # names of the bearings that share their coefficients
    coefficients: tuple[str, ...]  # "kxx", "kyy".. sought of every group
    also: tuple[str, ...]  # "E", "density": of the shaft, where sought
    planes: tuple[str, ...]  # disks and planes whose unbalance is sought
    unknowns: tuple[Unknown, ...]  # what the response depends on nonlinearly, len(self)
    amounts: tuple[Unknown, ...]  # the unbalance of each plane [kg m]
    phases: tuple[str, ...]  # names of its phase, which has no bounds

    @classmethod
    def of(cls, rig: RigConfig) -> "Space":
        """Return the space of a rig's [identify] table. Raises ConfigError if there is none."""
        sought = rig.identify
        if sought is None:
            raise ConfigError(f"{rig.name}: the config has no [identify] section, want bearings and a disk to identify")
        coefficients = [
            _coefficient(rig, sought, group, name) for group in sought.bearings for name in sought.coefficient_names
        ]
        return cls(
            groups=sought.bearings,
            coefficients=sought.coefficient_names,
            also=tuple(_SHAFT[key][0] for key in sought.also),
            planes=sought.unbalance,
            unknowns=(*coefficients, *(_of_the_shaft(rig, key) for key in sought.also)),
            amounts=tuple(_amount(rig, sought, plane) for plane in sought.unbalance),
            phases=tuple(sought.unbalance_of(plane, "phase") for plane in sought.unbalance),
        )

    def __len__(self) -> int:
        """Return the number of unknowns, amounts of unbalance not counted."""
        return len(self.unknowns)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the unknowns."""
        return tuple(unknown.name for unknown in self.unknowns)

    @cached_property
    def bounds(self) -> Real:
        """Lower and upper bounds of the unknowns, (unknown, 2) in SI."""
        return np.array([(unknown.low, unknown.high) for unknown in self.unknowns])

    @cached_property
    def working_bounds(self) -> Real:
        """The same in working coordinates."""
        return self.to_working(self.bounds.T).T

    @cached_property
    def nameplate(self) -> Real:
        """Nameplate values, (unknown,) in SI, moved into the bounds: a start."""
        return np.clip([unknown.nameplate for unknown in self.unknowns], *self.bounds.T)

    def to_working(self, values: ArrayLike) -> Real:
        """Return working coordinates of SI values, (..., unknown) both."""
        values = np.asarray(values, dtype=float)
        return np.where(self._log, np.log(np.where(self._log, values, 1.0)), values / self._largest)

    def from_working(self, working: ArrayLike) -> Real:
        """Return SI values of working coordinates, (..., unknown) both."""
        working = np.asarray(working, dtype=float)
        return np.where(self._log, np.exp(np.where(self._log, working, 0.0)), working * self._largest)

    def slopes(self, values: ArrayLike) -> Real:
        """Return d value / d working coordinate at SI values, (..., unknown) both."""
        return np.where(self._log, np.asarray(values, dtype=float), self._largest)

    def references(self, values: ArrayLike) -> Real:
        """Return what a change is large or small against, (..., unknown) SI: the value itself on a logarithmic scale.

        A cross coefficient, which may be zero, is held against the direct ones of its bearing, their geometric mean.
        """
        values = np.asarray(values, dtype=float)
        references = np.where(self._log, values, 0.0)
        for i in np.flatnonzero(~self._log):
            group, place = divmod(int(i), len(self.coefficients))
            kind = self.coefficients[place][0]
            xx, yy = (
                group * len(self.coefficients) + self.coefficients.index(f"{kind}{axes}") for axes in ("xx", "yy")
            )
            references[..., i] = np.sqrt(values[..., xx] * values[..., yy])
        return references

    def matrices(self, values: ArrayLike) -> tuple[Real, Real]:
        """Return K [N/m] and C [N s/m] of SI values (..., unknown), (..., group, 2, 2) each.

        They are linear in the values, so `matrices(np.eye(len(space)))` are their derivatives.
        """
        values = np.asarray(values, dtype=float)
        K, C = np.zeros((2, *values.shape[:-1], len(self.groups), 2, 2))
        sets = values[..., : len(self.groups) * len(self.coefficients)]
        sets = sets.reshape(*values.shape[:-1], len(self.groups), len(self.coefficients))
        for i, name in enumerate(self.coefficients):
            matrix = K if name[0] == "k" else C
            matrix[..., "xy".index(name[1]), "xy".index(name[2])] = sets[..., i]
        return K, C

    def shaft_factor(self, name: str, values: ArrayLike) -> Real:
        """Return the factor on the shaft's "E" or "density" in SI values (..., unknown); 1 where it is not sought."""
        values = np.asarray(values, dtype=float)
        if name not in self.also:
            return np.ones(values.shape[:-1])
        i = len(self) - len(self.also) + self.also.index(name)
        return values[..., i] / self.unknowns[i].nameplate

    @cached_property
    def _log(self) -> NDArray[np.bool_]:
        return np.array([unknown.scale == "log" for unknown in self.unknowns])

    @cached_property
    def _largest(self) -> Real:
        return np.abs(self.bounds).max(axis=1)


#: key in the config and field of the shaft -> name among the estimates, unit
_SHAFT = {"youngs_modulus": ("E", "Pa"), "density": ("density", "kg/m^3")}


def _coefficient(rig: RigConfig, sought: Identify, group: tuple[str, ...], name: str) -> Unknown:
    direct = name[1] == name[2]
    if name[0] == "k":
        low, high = sought.k_bounds if direct else sought.kxy_bounds
    else:
        low, high = sought.c_bounds if direct else sought.cxy_bounds
    return Unknown(
        name=sought.coefficient_of(group, name),
        unit=UNITS[name[0]],
        low=low,
        high=high,
        nameplate=rig.bearing(group[0]).constant(name),
        scale="log" if direct else "linear",
        axes=name[1:],
    )


def _of_the_shaft(rig: RigConfig, key: str) -> Unknown:
    name, unit = _SHAFT[key]
    nameplate = getattr(rig.shaft, key)
    return Unknown(
        name=name,
        unit=unit,
        low=nameplate / BASE_MODEL.free_range,
        high=nameplate * BASE_MODEL.free_range,
        nameplate=nameplate,
        scale="log",
    )


def _amount(rig: RigConfig, sought: Identify, plane: str) -> Unknown:
    low, high = sought.u_bounds
    expected = {disk.name: disk.unbalance for disk in rig.disks}.get(plane)
    return Unknown(
        name=sought.unbalance_of(plane, "u"),
        unit="kg m",
        low=low,
        high=high,
        nameplate=expected.amount if expected else float("nan"),
        scale="log",
    )

"""The nameplate of a rig: a TOML file checked into a frozen, hashed `RigConfig` in SI units.

Every stage is given one. What it cannot say exactly (E, masses, angles) is a prior, not a truth: see identify.
Axes: z along the shaft from the coupling, x and y across it, angles from +x towards +y.
"""

import itertools
import json
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, PrivateAttr, model_validator

from rotorrig.rig.config.devices import Daq, Keyphasor, Limits, Motor, PowerCut
from rotorrig.rig.config.extension import Extension
from rotorrig.rig.config.nameplate import (
    COEFFICIENTS,
    MOST,
    SHORTEST,
    Bearing,
    CrossDamping,
    CrossStiffness,
    Damping,
    Disk,
    Name,
    Part,
    Plane,
    Probe,
    Shaft,
    Speed,
    Stiffness,
    Text,
    UnbalanceAmount,
)
from rotorrig.rig.config.prior import LATER_PRIORS, Prior
from rotorrig.rig.config.sweep_plans import Plan, TrialMassRuns
from rotorrig.rig.config.toml_file import parse_toml, read_toml
from rotorrig.rig.config.trial_mass import read_trial_mass
from rotorrig.rig.config.validation import validate_table
from rotorrig.rig.errors import ConfigError
from rotorrig.rig.provenance import short_hash

HUB_WIDTH = 2.5  # shaft diameters, where a disk does not state it
TILT = 0.01  # of E I / diameter: 100 N m/rad on a 10 mm steel shaft, as a small ball bearing; grows as bearings do
SAMPLES_PER_PULSE = 5  # of the keyphasor: two on either level and one to spare


def _as_groups(value: object) -> object:
    """Return `["a", "b"]`, bearings that share one set, as the one group it is."""
    flat = isinstance(value, Sequence) and not isinstance(value, str) and all(isinstance(v, str) for v in value)
    return [value] if flat and value else value


def _as_list(value: object) -> object:
    return [value] if isinstance(value, str) else value


def _symmetric(key: str) -> Callable[[dict[str, Any]], tuple[float, float]]:
    """Return a default for cross coefficients: either sign, as large as the largest direct one of `key`."""
    return lambda given: (-given[key][1], given[key][1])


class Identify(Part):
    """Unknowns of `rotor identify`: stiffness and damping of bearings, unbalance, and shaft properties.

    Bearings in one group share a set of coefficients: `["a", "b"]` is one group, `[["a"], ["b"]]` are two.
    """

    bearings: Annotated[
        tuple[Annotated[tuple[str, ...], Field(min_length=1, max_length=MOST)], ...],
        BeforeValidator(_as_groups),
        Field(min_length=1, max_length=MOST),
    ]  # to identify; one group shares its coefficients
    coefficients: Literal["direct", "all"] = "direct"  # kxx kyy cxx cyy, or with the four cross coefficients
    # disks or planes
    unbalance: Annotated[tuple[str, ...], BeforeValidator(_as_list), Field(min_length=1, max_length=MOST)]
    also: tuple[Literal["youngs_modulus", "density"], ...] = ()  # of the shaft: identified, without a prior
    k_bounds: tuple[Stiffness, Stiffness] = (1e2, 1e6)  # of kxx and kyy
    c_bounds: tuple[Damping, Damping] = (1.0, 1e3)  # of cxx and cyy
    # of kxy and kyx; default: either sign, up to the upper bound of the direct ones
    kxy_bounds: tuple[CrossStiffness, CrossStiffness] = Field(default_factory=_symmetric("k_bounds"))
    # of cxy and cyx; default: likewise
    cxy_bounds: tuple[CrossDamping, CrossDamping] = Field(default_factory=_symmetric("c_bounds"))
    u_bounds: tuple[UnbalanceAmount, UnbalanceAmount] = (1e-7, 1e-3)  # of the global search
    bands: dict[Name, tuple[Speed, Speed]] = Field(default_factory=dict)  # speed ranges to fit besides the whole sweep
    # global search: by residuals and derivatives, or by the objective's value alone, "seed" as the chapter did
    search: Literal["vector", "modern", "seed"] = "vector"

    @property
    def coefficient_names(self) -> tuple[str, ...]:
        """The coefficients sought of every group."""
        return COEFFICIENTS if self.coefficients == "all" else ("kxx", "kyy", "cxx", "cyy")

    def coefficient_of(self, group: tuple[str, ...], name: str) -> str:
        """Return what `name` of a group is called among the estimates: "kxx", or "left A+left B kxx" of several."""
        return name if len(self.bearings) == 1 else f"{'+'.join(group)} {name}"

    def unbalance_of(self, plane: str, name: str) -> str:
        """Return what "u" or "phase" of a plane is called among the estimates: "u", or "u disk 2" of several."""
        return name if len(self.unbalance) == 1 else f"{name} {plane}"

    @model_validator(mode="after")
    def _bounds_rise(self) -> Self:
        for name in ("k_bounds", "c_bounds", "kxy_bounds", "cxy_bounds", "u_bounds"):
            low, high = getattr(self, name)
            if not low < high:
                raise ValueError(f"{name}: got {low:g} to {high:g} (SI), want the lower bound first")
            if low <= 0 and name not in ("kxy_bounds", "cxy_bounds"):
                raise ValueError(f"{name}: the lower bound is zero, want more: they are searched by their logarithm")
        for name, (low, high) in self.bands.items():
            if not low < high:
                raise ValueError(f"bands.{name}: want the lower speed first")
        return self

    @model_validator(mode="after")
    def _each_once(self) -> Self:
        for key, names in (
            ("bearings", [name for group in self.bearings for name in group]),
            ("unbalance", self.unbalance),
            ("also", self.also),
        ):
            for name in names:
                if names.count(name) > 1:
                    raise ValueError(f"{key}: '{name}' stands there twice, want it once")
        return self


class RigConfig(Part):
    """The rig as its nameplate tells it, in SI units; `load` makes one from a TOML file."""

    name: Name  # for reports
    notes: Text = ""  # for people
    shaft: Shaft  # geometry, material, damping
    disks: tuple[Disk, ...] = Field(min_length=1, max_length=MOST)  # on the shaft
    planes: tuple[Plane, ...] = Field((), max_length=MOST)  # more places for unbalance or forces
    bearings: tuple[Bearing, ...] = Field(min_length=1, max_length=MOST)  # at least two, some distance apart
    probes: tuple[Probe, ...] = Field(min_length=1, max_length=MOST)  # proximity probes
    keyphasor: Keyphasor | None = None  # needed for a sweep and for tracking
    motor: Motor | None = None  # needed for a sweep
    daq: Daq | None = None  # needed for a sweep
    limits: Limits | None = None  # interlocks that stop a sweep
    #: the last resort, where it is wired
    power_cut: PowerCut | None = Field(None, exclude_if=lambda table: table is None)
    rotation: Literal["x-to-y", "y-to-x"] = "x-to-y"  # sense of rotation
    gravity: Literal["-x", "-y", "none"] = "-y"  # direction of gravity
    # `default` runs unless `--plan` names another
    plans: dict[Name, Plan] = Field(default_factory=dict, max_length=MOST)
    identify: Identify | None = None  # unknowns to identify
    prior: Prior = Prior()  # uncertainty of the nameplate
    effects: tuple[Extension, ...] = Field((), max_length=MOST)  # causes that extend the model beyond the nameplate
    _text: str = PrivateAttr(default="")

    @property
    def text(self) -> str:
        """The TOML it was read from, comments and all; empty for one made in code."""
        return self._text

    @property
    def hash(self) -> str:
        """First 16 hex digits of the sha256 of the checked values: layout and comments do not count."""
        return self._hash(exclude=set() if self.effects else {"effects"})

    @property
    def turned_over(self) -> Self:
        """The same rig with its rotor turning the other way."""
        return self.model_copy(update={"rotation": "y-to-x" if self.rotation == "x-to-y" else "x-to-y"})

    @property
    def nameplate_hash(self) -> str:
        """The hash without the effects: the same for a rig and the same rig with an extended model."""
        return self._hash(exclude={"effects"})

    def _hash(self, *, exclude: set[str]) -> str:
        table = self.model_dump(mode="json", exclude=exclude)
        if self.identify and self.identify.search == "vector":
            del table["identify"]["search"]  # the usual one: a config that does not name it keeps its hash
        for key in LATER_PRIORS:  # likewise
            if getattr(self.prior, key) == Prior.model_fields[key].default:
                del table["prior"][key]
        return short_hash(json.dumps(table, sort_keys=True).encode())

    def disk(self, name: str) -> Disk:
        """Return the disk of that name."""
        return next(d for d in self.disks if d.name == name)

    def bearing(self, name: str) -> Bearing:
        """Return the bearing of that name."""
        return next(b for b in self.bearings if b.name == name)

    def probe(self, name: str) -> Probe:
        """Return the probe of that name."""
        return next(p for p in self.probes if p.name == name)

    def hub_width(self, disk: str) -> float:
        """Return how much of the shaft [m] the hub of that disk may stiffen."""
        found = self.disk(disk)
        return found.hub_width or HUB_WIDTH * self.shaft.tube_at(found.position).diameter

    def tilt_prior(self, bearing: str) -> float:
        """Return the standard deviation of the tilt stiffness [N m/rad] of that bearing."""
        tube = self.shaft.tube_at(self.bearing(bearing).position)
        second_moment = math.pi / 64 * (tube.diameter**4 - tube.inner_diameter**4)
        return self.prior.tilt or TILT * tube.youngs_modulus * second_moment / tube.diameter

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        named = {
            kind: [part.name for part in getattr(self, kind)] for kind in ("disks", "planes", "bearings", "probes")
        }
        for kind, names in (named | {"effects": [effect.label for effect in self.effects]}).items():
            for name in names:
                if names.count(name) > 1:
                    raise ValueError(f"{kind}: two are named '{name}', want different names")
        for plane in self.planes:
            if plane.name in (d.name for d in self.disks):
                raise ValueError(f"planes: '{plane.name}' is a disk too, want another name; a disk is a plane already")
        self._all_on_the_shaft()
        self._bearings_span()
        self._channels_differ()
        self._pulses_are_sampled()
        self._identify_names_exist()
        self._limits_name_probes()
        self._trial_masses_fit()
        if self.motor and self.limits and self.limits.overspeed > self.motor.max_speed:
            raise ValueError("limits.overspeed: is above motor.max_speed, want it at or below")
        return self

    def _all_on_the_shaft(self) -> None:
        for kind in ("disks", "planes", "bearings", "probes"):
            for i, part in enumerate(getattr(self, kind)):
                if part.position > self.shaft.length + SHORTEST:
                    raise ValueError(
                        f"{kind}[{i}].position: '{part.name}' is at {part.position * 1e3:g} mm, "
                        f"want it on the shaft, 0 to {self.shaft.length * 1e3:g} mm"
                    )

    def _bearings_span(self) -> None:
        places = [b.position for b in self.bearings]
        if max(places) - min(places) <= SHORTEST:
            raise ValueError(f"bearings: all are at {places[0] * 1e3:g} mm, want at least two with a span between them")

    def _channels_differ(self) -> None:
        owners = [(p.channel, f"probe '{p.name}'") for p in self.probes]
        if self.keyphasor:
            owners.append((self.keyphasor.channel, "the keyphasor"))
        for (a, first), (b, second) in itertools.combinations(owners, 2):
            if a == b:
                raise ValueError(f"channel {a}: used by {first} and {second}, want one each")

    def _pulses_are_sampled(self) -> None:
        if not (self.keyphasor and self.motor and self.daq):
            return
        rate = self.keyphasor.pulses_per_revolution * self.motor.max_speed / math.tau
        if rate * SAMPLES_PER_PULSE > self.daq.sample_rate:
            raise ValueError(
                f"keyphasor.pulses_per_revolution: {self.keyphasor.pulses_per_revolution} make {rate:.0f} pulses a "
                f"second at motor.max_speed, want at most daq.sample_rate / {SAMPLES_PER_PULSE} = "
                f"{self.daq.sample_rate / SAMPLES_PER_PULSE:.0f}"
            )

    def _identify_names_exist(self) -> None:
        if not self.identify:
            return
        known = {b.name: b for b in self.bearings}
        for name in itertools.chain(*self.identify.bearings):
            if name not in known:
                raise ValueError(f"identify.bearings: no bearing '{name}', want one of {sorted(known)}")
            if known[name].rigid or known[name].over_speed:
                kind = "rigid" if known[name].rigid else "given over speed"
                raise ValueError(f"identify.bearings: '{name}' is {kind}, want a bearing of constant coefficients")
        for name in self.identify.unbalance:
            if name not in self.unbalance_planes:
                planes = list(self.unbalance_planes)
                raise ValueError(f"identify.unbalance: no {self._place} '{name}', want one of {planes}")

    def _limits_name_probes(self) -> None:
        names = [probe.name for probe in self.probes]
        for table, name in self.limits.named_probes() if self.limits else ():
            if name not in names:
                raise ValueError(f"{table}: no probe '{name}', want one of {names}")

    def _trial_masses_fit(self) -> None:
        for name, plan in self.plans.items():
            if not isinstance(plan, TrialMassRuns):
                continue
            others = sorted(n for n, other in self.plans.items() if not isinstance(other, TrialMassRuns))
            if plan.plan not in others:
                raise ValueError(f"plans.{name}.plan: got '{plan.plan}', want another plan of the config: {others}")
            try:
                for mass in plan.masses:
                    read_trial_mass(mass, planes=self.unbalance_planes)
            except ConfigError as error:
                raise ValueError(f"plans.{name}.masses: {error}") from error

    @property
    def unbalance_planes(self) -> tuple[str, ...]:
        """Names of the places an unbalance or a trial mass may sit at: the disks, then the massless planes."""
        return (*(disk.name for disk in self.disks), *(plane.name for plane in self.planes))

    @property
    def _place(self) -> str:
        return "disk or plane" if self.planes else "disk"


def load(path: Path) -> RigConfig:
    """Read and check a config file. Raises ConfigError naming file, key, what was got and what is wanted."""
    table, text = read_toml(path, want="a rig config")
    return _rig(table, text, where=str(path))


def parse(text: str, *, where: str) -> RigConfig:
    """Check a config's text; `where` names it in errors. Raises ConfigError."""
    return _rig(parse_toml(text, where=where), text, where=where)


def _rig(table: dict[str, Any], text: str, *, where: str) -> RigConfig:
    units = table.pop("units", None)
    if units not in (None, "SI"):
        raise ConfigError(
            f"{where}: units: got {units!r}, want 'SI' for bare numbers in SI, or none and text with units"
        )
    rig = validate_table(RigConfig, table, where=where, context={"si": units == "SI"})
    rig._text = text
    return rig


def from_si(table: dict[str, Any], *, text: str = "", where: str = "embedded config") -> RigConfig:
    """Rebuild a config from `RigConfig.model_dump()`, as our own files carry it. Raises ConfigError."""
    rig = validate_table(RigConfig, table, where=where, context={"si": True})
    rig._text = text
    return rig

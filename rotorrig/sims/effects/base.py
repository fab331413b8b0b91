"""Interface of an effect: one way in which a real rig departs from its nameplate's model, with its unknowns.

To add one, drop a file into this folder. It holds a class derived from `Effect` and `effects(rig)`, which returns one
object for every place on the rig where it could act; a file without `effects` is a helper. (One whose places nobody can
list has `from_config(rig, name, where)` instead.) The class overrides those of these methods
that it needs, and `acts_on` says which:

- `change_matrices`: the model with other stiffness, damping or mass, or with further coordinates (a pedestal);
- `loads`: forces that do not depend on the motion, each of one order of rotation, from the start or from some time on;
- `force_laws`: nonlinear forces at a place, by its motion;
- `change_readings`: the vectors that the probes read of a motion, and what they add to it;
- `words`: the cause with its size, in a sentence for the report.

All unknowns are real, in SI; a phasor is a pair named "... re" and "... im". At zero amplitude, where every unknown has
its `at_zero`, an effect changes nothing. Angles are from the keyphasor mark in the sense of rotation.

Figures of an unknown are those of an RK4. Where they go with how stiff a rig is, how far it moves and how fast it
turns, as a gap does and a probe's runout does not, the unknown is `of_rig`: rig_scale.py.
"""

import importlib
import itertools
import math
import pkgutil
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.rig_scale import RigScale
from rotorrig.sims.rotor.model import Direction, Load, RotorModel
from rotorrig.sims.rotor.nonlinear import ForceLaw

Complex = NDArray[np.complex128]
Theta = Mapping[str, float]
Target = Literal["matrices", "loads", "force laws", "probes"]  # what an effect may act on

TARGETS: Mapping[str, Target] = MappingProxyType(  # method of Effect -> what it acts on
    {"change_matrices": "matrices", "loads": "loads", "force_laws": "force laws", "change_readings": "probes"}
)

EVERY = (1, 2, 3)  # the orders that a change of matrices or of a probe may show in, where there is something to change


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """One unknown of an effect, SI.

    Where several parameters of an effect have starts, each of one goes with each of the others.
    """

    name: str  # "bow re"; pairs "re", "im" are one phasor
    unit: str  # SI, "" for a ratio
    low: float  # beyond these it is no longer plausible
    high: float
    size: float  # typical of an RK4 rotor kit: the unit a fit counts in
    at_zero: float = 0.0  # its value at zero amplitude of the effect
    starts: tuple[float, ...] = ()  # where a fit may begin; empty: at zero amplitude
    prior: float = math.inf  # one standard deviation, of a nuisance of the base; infinite: of a candidate cause
    order: int = 0  # the one order of the vectors it changes; 0: all those of its effect
    grid_searched: bool = False  # no fit moves it: a grid search finds its value, and it stays at `at_zero`
    spread: float = 0.0  # of a grid-searched one: one standard deviation, as far as the grid could tell
    of_rig: bool = False  # its figures are an RK4's: on a rig of another scale they are others

    def rescale(self, scale: RigScale) -> "Parameter":
        """Return it as it is typical of a rig of that scale."""
        if not self.of_rig:
            return self
        by = scale.ratio(self.unit)
        low, high, size, at_zero = (by * value for value in (self.low, self.high, self.size, self.at_zero))
        starts = tuple(by * start for start in self.starts)
        return replace(self, low=low, high=high, size=size, at_zero=at_zero, starts=starts)


@dataclass(frozen=True, slots=True, kw_only=True)
class ReadingContext:
    """Context of the readings that an effect on the probes may change: the rows of one order, the slow roll last."""

    probes: tuple[str, ...]
    angle: NDArray[np.float64]  # (probe,) rad, of the nameplate
    position: NDArray[np.float64]  # (probe,) m
    order: int
    recording: int = 0  # number of it
    omega: NDArray[np.float64]  # (row + 1,) rad/s; 0: no slow roll; below zero: of a shaft that turns backwards
    t: NDArray[np.float64]  # (row,) s; NaN: unknown
    revolutions: NDArray[np.float64]  # (row,) turns of a row's window
    window: str
    keyphasor_t: NDArray[np.float64]  # (pulse,) s; empty: unknown
    #: Hz of the mains -> (time,) s, and by how much their phase is ahead of 2 pi f t then [rad]
    strays: Mapping[float, tuple[NDArray[np.float64], NDArray[np.float64]]] = field(default_factory=dict)
    shares: Mapping[float, Complex] = field(default_factory=dict)  # Hz -> (probe,) of each in the hum; else all alike
    slow_roll: Complex = field(default_factory=lambda: np.zeros(0, complex))  # (probe,) m, measured; empty: was not
    leaks: dict[float, Complex] = field(default_factory=dict, repr=False, compare=False)  # line_hum.leak, by Hz, once


@dataclass(frozen=True, kw_only=True)
class Effect:
    """One effect at one place; without `parameters` it does nothing. Frozen, and cheap to make."""

    name: ClassVar[str]  # the file's
    title: ClassVar[str]  # "residual shaft bow"
    orders: ClassVar[tuple[int, ...]] = (1,)  # of the vectors it may change
    linear: ClassVar[bool] = False  # what it adds to a fixed rotor is linear in the parameters, but grid-searched ones
    linear_in: ClassVar[str] = ""  # of one with starts: the unknown it is linear in while that is small, if any
    scales_base: ClassVar[bool] = True  # its matrices are by what the base's are by: a share of a bearing, say
    law_error: ClassVar[float] = 0.05  # share of what it does that its law is off by, 1 sigma (known_error.py); 0: none
    as_nuisance: ClassVar[bool] = False  # every fit has it as a nuisance too: then it is larger than the prior expects
    after_hum: ClassVar[bool] = False  # changes what was recorded, hum included: a filter, not where a probe looks
    acts_on: ClassVar[frozenset[Target]] = frozenset()  # by the methods that its class overrides
    where: str = ""  # "plane 1", "probe 2y", "at 381 mm"; empty where there is one place only
    parameters: tuple[Parameter, ...] = ()
    places: Mapping[str, float] = field(default_factory=dict)  # planes it needs in the model: name -> m
    recording: int | None = None  # where it acts alone; None: in all
    grid: tuple[tuple[float, ...], ...] = ()  # stretches of values of its grid-searched unknown, ascending
    initial_guesses: tuple[Theta, ...] = ()  # values of some unknowns, of zero amplitude: a fit moves on from there

    def __init_subclass__(cls, **kwargs: Any) -> None:
        """Set what the effects of a class act on."""
        super().__init_subclass__(**kwargs)
        cls.acts_on = frozenset(of for name, of in TARGETS.items() if getattr(cls, name) is not getattr(Effect, name))

    @property
    def label(self) -> str:
        """Name and place: "runout, plane 2"."""
        return f"{self.name}, {self.where}" if self.where else self.name

    @property
    def at_zero(self) -> dict[str, float]:
        """Parameters at zero amplitude, where it vanishes."""
        return {p.name: p.at_zero for p in self.parameters}

    @property
    def needs_starts(self) -> bool:
        """True where the first order vanishes at zero amplitude: a fit begins at the starts of its parameters."""
        return any(p.starts for p in self.parameters)

    @property
    def starts(self) -> tuple[Theta, ...]:
        """Every combination of the starts of its parameters."""
        values = itertools.product(*(p.starts or (p.at_zero,) for p in self.parameters))
        return tuple(dict(zip(self.at_zero, each, strict=True)) for each in values)

    @property
    def is_nuisance(self) -> bool:
        """True for a nuisance of the base: every unknown of it has a prior."""
        return all(math.isfinite(p.prior) for p in self.parameters)

    def within(self, orders: Collection[float]) -> Self:
        """Return the effect without the parameters that vectors of these orders cannot show."""
        return replace(self, parameters=tuple(p for p in self.parameters if not p.order or p.order in orders))

    def at_initial_guesses(self) -> tuple[Self, ...]:
        """Return the effect at each of its initial guesses, of zero amplitude there; itself where it has none."""
        moved = (
            tuple(replace(p, at_zero=values.get(p.name, p.at_zero)) for p in self.parameters)
            for values in self.initial_guesses or ({},)
        )
        return tuple(replace(self, parameters=parameters) for parameters in moved)

    def rescale(self, scale: RigScale) -> Self:
        """Return the effect with unknowns as they are typical of a rig of that scale."""
        return replace(self, parameters=tuple(p.rescale(scale) for p in self.parameters))

    def fix_grid_searched(self, theta: Theta) -> Self:
        """Return the effect with its grid-searched unknown fixed at its value in `theta`."""
        parameters = (replace(p, at_zero=theta[p.name]) if p.grid_searched else p for p in self.parameters)
        return replace(self, parameters=tuple(parameters))

    def relocate(self, theta: Theta) -> tuple["Effect", Theta]:
        """Return the same effect from the place of its kind that is nearest to where `theta` has it."""
        return self, theta

    def is_plausible(self, theta: Theta) -> bool:
        """Return whether a rotor can have it, where the ranges of its unknowns alone do not tell."""
        return True

    def at_other_moments(self, theta: Theta) -> tuple[Theta, ...]:
        """Return what came on once at other moments too, at each of which part of it may have come on."""
        return ()

    def change_matrices(self, model: RotorModel, theta: Theta) -> RotorModel:
        """Return the model with other matrices, coordinates or bearings."""
        return model

    def change_along_shaft(self, along: Direction, model: RotorModel, theta: Theta) -> Direction:
        """Return the derivative `along` of the bare shaft's matrices, with that of what the effect makes of them.

        Asked of nuisances, which are in every model; of others the matrices are differenced.
        """
        return along

    def loads(self, model: RotorModel, theta: Theta) -> tuple[Load, ...]:
        """Return forces on `model`, as `change_matrices` returned it."""
        return ()

    def force_laws(self, model: RotorModel, theta: Theta) -> tuple[ForceLaw, ...]:
        """Return nonlinear forces on `model`: as many at zero amplitude, where they are zero."""
        return ()

    def change_readings(self, z: Complex, context: ReadingContext, theta: Theta) -> Complex:
        """Return the vectors z (row + 1, probe) [m] of one order as the probes read them, the slow roll last."""
        return z

    def words(self, theta: Theta) -> str:
        """Say the cause with its size: "the shaft is bowed by 18 um at 110 deg"; the default lists its figures."""
        return f"{self.title}{' ' + self.where if self.where else ''}: {describe_parameters(self.parameters, theta)}"


def catalogue(rig: RigConfig) -> tuple[Effect, ...]:
    """Return every effect of every file in this folder at every place of `rig` it could act at."""
    return tuple(effect for effects in _functions("effects") for effect in effects(rig))


def find(rig: RigConfig, label: str) -> Effect:
    """Return the effect of that label, of the catalogue or found. Raises ValueError naming those there are."""
    known = catalogue(rig)
    name, _, where = label.partition(", ")
    for effect in (*known, *(e for make in _functions("from_config") if (e := make(rig, name, where)))):
        if effect.label == label:
            return effect
    raise ValueError(f"effect '{label}': there is none, want one of {', '.join(e.label for e in known)}")


def phasor(theta: Theta, name: str) -> complex:
    """Return the phasor of the pair "name re", "name im"; zero of a pair that was left out."""
    return complex(theta.get(f"{name} re", 0.0), theta.get(f"{name} im", 0.0))


def pair(
    name: str, unit: str, *, most: float, size: float, order: int = 0, of_rig: bool = False
) -> tuple[Parameter, Parameter]:
    """Return the two parameters of a phasor, either no larger than `most`."""
    re, im = (
        Parameter(name=f"{name} {part}", unit=unit, low=-most, high=most, size=size, order=order, of_rig=of_rig)
        for part in ("re", "im")
    )
    return re, im


def polar(theta: Theta, name: str) -> tuple[float, float]:
    """Return magnitude and angle [deg, 0 to 360] of the pair "name re", "name im"."""
    z = phasor(theta, name)
    return abs(z), math.degrees(np.angle(z)) % 360


def magnitudes(parameters: tuple[Parameter, ...], theta: Theta) -> Iterator[tuple[str, float, str]]:
    """Yield name, value and unit of every unknown, phasors as magnitude and angle ("bow angle", 0 to 2 pi rad)."""
    for p in parameters:
        stem = p.name.removesuffix(" re")
        if stem != p.name:
            z = phasor(theta, stem)
            yield stem, abs(z), p.unit
            yield f"{stem} angle", float(np.angle(z)) % math.tau, "rad"
        elif not p.name.endswith(" im"):
            yield p.name, theta[p.name], p.unit


def describe_parameters(parameters: tuple[Parameter, ...], theta: Theta) -> str:
    """Describe the unknowns: "bow 1.8e-05 m, bow angle 110 deg"."""
    return ", ".join(
        f"{name} {np.degrees(value):.0f} deg" if unit == "rad" else f"{name} {value:.3g} {unit}".rstrip()
        for name, value, unit in magnitudes(parameters, theta)
    )


def _functions(name: str) -> Iterator[Callable[..., Any]]:
    """Yield the function of that name of every file in the folder that has it."""
    for file in sorted(m.name for m in pkgutil.iter_modules([str(Path(__file__).parent)])):
        module = importlib.import_module(f"{__package__}.{file}")
        if hasattr(module, name):
            yield getattr(module, name)

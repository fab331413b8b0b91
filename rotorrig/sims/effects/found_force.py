"""A force that is none of the effects in this folder, at any place of the shaft, by laws of found_laws.py.

It is not in the catalogue. A diagnosis makes one where nothing known explains the measurement (identify/discovery); a
config carries it by the names of its laws, as `where = "stiffness + damping"`, and its "place" [m] among its unknowns.
Source: Markert, Platz, Seidler, Model based fault identification in rotor systems by least squares fitting, Int. J.
Rotating Machinery 7 (2001) 311-321.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import EVERY, Effect, Parameter, Theta, phasor
from rotorrig.sims.effects.found_laws import (
    CROSSED,
    DAMPING,
    FREQUENCY,
    LAWS,
    PLUS,
    GivenForce,
    Law,
    LinearForce,
    NonlinearForce,
    ResonantForce,
    check_laws,
)
from rotorrig.sims.effects.places import bearing_groups, group_stiffness, reference_speed
from rotorrig.sims.effects.shaft_motion import forward, position_rows
from rotorrig.sims.rotor.model import Added, Load, RotorModel, with_added, with_coordinates
from rotorrig.sims.rotor.nonlinear import ForceLaw

_TUNING = (
    Parameter(name=FREQUENCY, unit="rad/s", low=1.0, high=1e4, size=5.0, at_zero=200.0),
    Parameter(name=DAMPING, unit="", low=1e-3, high=1.0, size=0.02, at_zero=0.05),
)
Kind = TypeVar("Kind", bound=Law)

NAME = "found_force"
WIDEST = 1000.0  # typical sizes: nobody knows how large a force may be that nobody knows
UNKNOWN_STIFFNESS = 1e5  # N/m, for typical sizes on a rig without an elastic bearing


@dataclass(frozen=True, kw_only=True)
class FoundForce(Effect):
    """The forces of its `laws` at one "place" [m]."""

    name = NAME
    title = "a force at a place of the shaft"
    orders = EVERY
    laws: tuple[str, ...]
    length: float  # m, of the shaft

    def tune(self, frequency: float, ratio: float) -> "FoundForce":
        """Return the same with what resonates beginning at that frequency [rad/s] and damping ratio."""
        begin = {FREQUENCY: frequency, DAMPING: ratio}
        moved = (replace(q, at_zero=begin.get(q.name, q.at_zero)) for q in self.parameters)
        return replace(self, parameters=tuple(moved))

    def place(self, theta: Theta) -> float:
        """Return where it is [m]; a fit that goes past an end of the shaft comes back from it."""
        past_end = theta["place"] % (2 * self.length)
        return min(past_end, 2 * self.length - past_end)

    def relocate(self, theta: Theta) -> tuple[Effect, Theta]:
        """Return it with its place on the shaft, where a fit had gone past an end."""
        return self, {**theta, "place": self.place(theta)}

    def words(self, theta: Theta) -> str:
        """Say where it is and how it goes with speed and motion."""
        told = " and ".join(LAWS[name].words(theta) for name in self.laws)
        return f"at {1e3 * self.place(theta):.0f} mm from the coupling acts {told}"

    def _rows(self, model: RotorModel, theta: Theta, law: Law) -> NDArray[np.float64]:
        z = self.place(theta)
        return slope_rows(model, z) if law.tilts else position_rows(model, z)

    def _each(self, kind: type[Kind]) -> Iterator[Kind]:
        """Yield its laws of one kind."""
        yield from (law for name in self.laws if isinstance(law := LAWS[name], kind))


class _Given(FoundForce):
    """One with laws that do not depend on the motion."""

    def loads(self, model: RotorModel, theta: Theta) -> tuple[Load, ...]:
        """Return its given forces."""
        loads = []
        for law in self._each(GivenForce):
            pattern = forward(self._rows(model, theta, law), model.rotation)
            pattern = pattern.conj() if law.backward else pattern
            loads.append(Load(pattern=phasor(theta, law.name) * pattern, law=law.law))
        return tuple(loads)


class _Linear(FoundForce):
    """One with laws that are linear in the motion."""

    def change_matrices(self, model: RotorModel, theta: Theta) -> RotorModel:
        """Return the model with them."""
        for law in self._each(LinearForce):
            rows = self._rows(model, theta, law)
            for name, pattern in zip(law.unknowns, law.patterns, strict=True):
                sense = model.rotation if pattern == CROSSED else 1
                added = sense * theta[name] * (rows.T @ np.array(pattern) @ rows)
                model = with_added(model, Added(**{law.matrix: added}))
        return model


class _Resonant(FoundForce):
    """One with a law that resonates."""

    def change_matrices(self, model: RotorModel, theta: Theta) -> RotorModel:
        """Return the model with it, and two coordinates u of u'' + 2 zeta w u' + w^2 u = w^2 x; the force is a u."""
        model = super().change_matrices(model, theta)
        for law in self._each(ResonantForce):
            omega, ratio = theta[FREQUENCY], theta[DAMPING]
            model = with_coordinates(model, 2)
            own, rows = model.appended[-2:], self._rows(model, theta, law)
            unit = own.T @ own
            amounts = np.diag([theta[name] for name in law.unknowns])
            K = omega**2 * (unit - own.T @ rows) - rows.T @ amounts @ own
            model = with_added(model, Added(M=unit, C=2 * ratio * omega * unit, K=K))
        return model


class _Nonlinear(FoundForce):
    """One with laws that are not."""

    def force_laws(self, model: RotorModel, theta: Theta) -> tuple[ForceLaw, ...]:
        """Return them."""
        return tuple(
            ForceLaw(
                rows=self._rows(model, theta, law),
                force=law.force,
                constants=np.array([theta[name] for name in law.unknowns]),
            )
            for law in self._each(NonlinearForce)
        )


@cache
def _class_of(laws: frozenset[type[Law]]) -> type[FoundForce]:
    """Return the class of an effect with those kinds of law, so that it acts on no more than it has to."""
    kinds = tuple(kind for law, kind in _KINDS.items() if law in laws)
    return kinds[0] if len(kinds) == 1 else dataclass(frozen=True, kw_only=True)(type("_Several", kinds, {}))


_KINDS: Mapping[type[Law], type[FoundForce]] = {
    GivenForce: _Given,
    ResonantForce: _Resonant,
    LinearForce: _Linear,
    NonlinearForce: _Nonlinear,
}


def found_force(rig: RigConfig, laws: Iterable[str], place: float = 0.0) -> FoundForce:
    """Return the force of these laws, beginning at `place` [m]. Raises ValueError naming the laws there are."""
    names = tuple(laws)
    check_laws(NAME, names, LAWS)
    length = rig.shaft.length
    parameters = [Parameter(name="place", unit="m", low=-length, high=2 * length, size=0.005, at_zero=place)]
    stiffness = next((group_stiffness(rig, group) for group in bearing_groups(rig).values()), UNKNOWN_STIFFNESS)
    for name in names:
        size = LAWS[name].typical(stiffness, reference_speed(rig))
        gives_way = isinstance(LAWS[name], ResonantForce)  # and only ever with the force
        low = 0.0 if gives_way else -WIDEST * size
        parameters += [
            Parameter(name=unknown, unit=LAWS[name].unit, low=low, high=WIDEST * size, size=size)
            for unknown in LAWS[name].unknowns
        ]
        if gives_way:
            parameters += _TUNING
    kind = _class_of(frozenset(type(LAWS[name]) for name in names))
    return kind(where=PLUS.join(names), laws=names, length=length, parameters=tuple(parameters))


def from_config(rig: RigConfig, name: str, where: str) -> FoundForce | None:
    """Return the force of the laws in `where` if `name` is that of this file. Raises ValueError as `found_force`."""
    return found_force(rig, where.split(PLUS)) if name == NAME else None


def slope_rows(model: RotorModel, z: float) -> NDArray[np.float64]:
    """Return the rows that read the slopes x' and y' of the shaft at z [m], (2, dof)."""
    return CubicSpline(model.z, model.centreline, axis=1)(z, 1)

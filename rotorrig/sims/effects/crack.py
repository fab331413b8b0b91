"""A transverse crack that opens and closes once per turn as the bending of the turning shaft does.

While its mouth is stretched the shaft gives way there like a hinge across the mouth, by so much per bending moment;
while it is pressed the shaft is whole. Under the weight alone it is open half of every turn: the shaft is softer on the
average, and kinks in step once, twice and three times per turn. Near the critical speed the vibration bends it more
than the weight does and may hold it open or shut; that part acts as a force law. Source: Gasch, J. Sound Vib. 160
(1993) 313-332; Mayes, Davies, J. Vib. Acoust. 106 (1984) 139-145.

Against integration in time within 4 % of what it does: the curvature is read off the centre line, shear and all, and
what 2X and 3X do to the opening is left out.
"""

from dataclasses import dataclass, field
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import EVERY, Effect, Parameter, Theta
from rotorrig.sims.effects.places import bending_stiffness, free_places, span, tube_at
from rotorrig.sims.effects.shaft_motion import at_rest, curvature_rows
from rotorrig.sims.rotor.model import Added, Load, RotorModel, assemble, with_added
from rotorrig.sims.rotor.modes import weight
from rotorrig.sims.rotor.nonlinear import ForceLaw

Reals = NDArray[np.float64]

MOUTHS = 8  # angles about the shaft at which it is looked for first: within 22 degrees of any
OPEN = 0.25  # of a compliance, on the average of a turn: open for half of it, and across the mouth alone
#: order -> kink along the moment and across it, in the sense of rotation, as phasors of cos^2 and cos sin while cos < 0
BREATHING = MappingProxyType(
    {
        1: (-4 / (3 * np.pi), 2j / (3 * np.pi)),
        2: (1 / 4, -1j / 4),
        3: (-4 / (15 * np.pi), 2j / (5 * np.pi)),
    }
)
LEAST = 0.1  # of the largest moment of the weight: where it is less, nothing can be said by it
#: diameters of whole shaft that give way as much, at most: of one through half the shaft they are of the order of two
#: (Dimarogonas, Papadopoulos, J. Sound Vib. 91 (1983) 583-593)
DEEPEST = 5.0
RIGID = 1e-9  # of the shaft's greatest stiffness: less is rounding, and bends it not at all


class _Hinge(NamedTuple):
    """The cracked section in a model."""

    rows: Reals  # (2, dof) N m, read the bending moments of an uncracked shaft
    own: float  # N m per rad: by how much they err where the shaft has a kink there


@dataclass(frozen=True, kw_only=True)
class Crack(Effect):
    """By what part an open crack lets the rotor sag more, "softness", its angle "mouth" [rad] and its "place" [m].

    A crack elsewhere that is as soft does nearly the same, so that softness is known well where the place is not.
    """

    name = "crack"
    title = "breathing crack"
    law_error = 0.1
    orders = EVERY
    rig: RigConfig = field(repr=False, compare=False)
    sag: CubicSpline = field(repr=False, compare=False)  # m, of the nameplate's rotor, (2,) at a place
    work: float  # N m, of its weight on its sag
    least: float  # N m, a moment that counts

    def is_plausible(self, theta: Theta) -> bool:
        """Return whether it gives way no more than a crack through most of the shaft."""
        tube = tube_at(self.rig, self._place(theta))
        return self.compliance(theta) * bending_stiffness(tube) <= DEEPEST * tube.diameter

    def change_matrices(self, model: RotorModel, theta: Theta) -> RotorModel:
        """Return the model as soft as it is on the average of a turn under the weight."""
        compliance = self.compliance(theta)
        if not compliance:
            return model
        hinge = self._hinge(model, theta)
        lost = OPEN * compliance / _reading(hinge, compliance)
        return with_added(model, Added(K=-lost * hinge.rows.T @ hinge.rows))

    def loads(self, model: RotorModel, theta: Theta) -> tuple[Load, ...]:
        """Return the pairs of moments on either side of it that make it breathe under the weight."""
        hinge = self._hinge(model, theta)
        moment = self._at_rest(model, hinge, theta)
        aside = model.rotation * np.array([-moment[1], moment[0]])
        angle = theta["mouth"] - model.rotation * np.arctan2(moment[1], moment[0])
        compliance = self.compliance(theta)
        compliance /= _reading(hinge, compliance)  # the softness of `change_matrices` yields to it too
        return tuple(
            Load(
                pattern=compliance * np.exp(1j * n * angle) * (down * moment + side * aside) @ hinge.rows,
                law="constant",
                order=n,
            )
            for n, (down, side) in BREATHING.items()
        )

    def force_laws(self, model: RotorModel, theta: Theta) -> tuple[ForceLaw, ...]:
        """Return the force law that the vibration adds to that, and to the softness of `change_matrices`."""
        hinge = self._hinge(model, theta)
        compliance, mouth = self.compliance(theta), theta["mouth"]
        reading = _reading(hinge, compliance)
        constants = [compliance / reading, reading, np.cos(mouth), np.sin(mouth), model.rotation]
        return (
            ForceLaw(
                rows=hinge.rows,
                force=breathing,
                constants=np.array([*constants, *self._at_rest(model, hinge, theta), 1.0, 0.0]),
                static=hinge.rows @ at_rest(model, self.rig.gravity),
                overtones=False,
            ),
        )

    def compliance(self, theta: Theta) -> float:
        """Return by how much the open mouth kinks per bending moment, rad/(N m)."""
        return theta["softness"] / self.softness_of(1.0, self._place(theta))

    def softness_of(self, compliance: float, place: float) -> float:
        """Return the softness of a crack of that compliance: its work under the weight's moment, by Castigliano.

        Where the weight hardly bends the shaft, as under `least`.
        """
        moment = max(_moment(self.rig, self.sag, place), self.least)
        return compliance * moment**2 / self.work

    def words(self, theta: Theta) -> str:
        """Say where it is, which way it looks and how far it gives way."""
        angle = np.degrees(theta["mouth"]) % 360
        return (
            f"a crack {1e3 * self._place(theta):.0f} mm from the coupling, its mouth at {angle:.0f} deg from the "
            f"keyphasor mark, lets the shaft kink by {1e6 * self.compliance(theta):.1f} urad per N m while it is open, "
            f"and the rotor sag by {100 * theta['softness']:.2g} % more"
        )

    def _place(self, theta: Theta) -> float:
        left, right = span(self.rig)
        return min(max(theta["place"], left), right)

    def _hinge(self, model: RotorModel, theta: Theta) -> _Hinge:
        place = self._place(theta)
        rows = bending_stiffness(tube_at(self.rig, place)) * curvature_rows(model, place)
        stiffness, shapes = np.linalg.eigh(model.shaft.K)
        bent = stiffness > RIGID * stiffness[-1]
        moments = rows @ shapes[:, bent]
        return _Hinge(rows=rows, own=float(moments[0] ** 2 @ (1 / stiffness[bent])))

    def _at_rest(self, model: RotorModel, hinge: _Hinge, theta: Theta) -> Reals:
        """Return the moments (2,) [N m] under the weight, of a model after `change_matrices`."""
        moments: Reals = hinge.rows @ at_rest(model, self.rig.gravity) / _reading(hinge, self.compliance(theta))
        return moments


def _moment(rig: RigConfig, sag: CubicSpline, place: float) -> float:
    """Return the size of the bending moment of a shaft that hangs so, N m."""
    return bending_stiffness(tube_at(rig, place)) * float(np.linalg.norm(sag(place, 2)))


def _reading(hinge: _Hinge, compliance: float) -> float:
    """Return the ratio of the moment that the rows read to the true one, with the average kink there."""
    return 1 + OPEN * compliance * hinge.own


@njit(cache=True)
def breathing(x: float, y: float, vx: float, vy: float, constants: Reals) -> tuple[float, float]:
    """Return the kink [rad] under moments that read x, y [N m] less that of the weight alone, both less the average.

    The constants: compliance over reading, reading, cosine and sine of the mouth's angle, rotation, moments of the
    weight, cosine and sine of the shaft's angle.
    """
    p = constants
    c, s = p[2] * p[-2] - p[3] * p[-1], p[4] * (p[3] * p[-2] + p[2] * p[-1])
    x, y = x / p[1], y / p[1]
    kink = p[0] * (min(c * x + s * y, 0.0) - min(c * p[5] + s * p[6], 0.0))
    average = OPEN * p[0]
    return kink * c - average * (x - p[5]), kink * s - average * (y - p[6])


def effects(rig: RigConfig) -> tuple[Crack, ...]:
    """Return the one crack there may be, wherever it is between the bearings; none where gravity bends nothing."""
    if rig.gravity == "none":
        return ()
    left, right = span(rig)
    places = [z for z in free_places(rig).values() if left < z < right]
    unknown = (
        Parameter(name="softness", unit="", low=0.0, high=0.2, size=0.005),
        Parameter(name="mouth", unit="rad", low=-2 * np.pi, high=4 * np.pi, size=0.1),
        Parameter(name="place", unit="m", low=left, high=right, size=0.005, at_zero=(left + right) / 2),
    )
    initial_guesses = tuple({"place": z, "mouth": 2 * np.pi * k / MOUTHS} for z in places for k in range(MOUTHS))
    model = assemble(rig)
    rest = at_rest(model, rig.gravity)
    sag = CubicSpline(model.z, model.centreline @ rest, axis=1)
    crack = Crack(
        rig=rig,
        sag=sag,
        work=float(weight(model, rig.gravity) @ rest),
        least=LEAST * max(_moment(rig, sag, z) for z in places),
        parameters=unknown,
        initial_guesses=initial_guesses,
    )
    return (crack,)

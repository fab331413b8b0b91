"""A transverse crack that opens and closes once per turn as the bending of the turning shaft does.

While its mouth is stretched the shaft gives way there like a hinge across the mouth, by so much per bending moment;
while it is pressed the shaft is whole. Under the weight alone it is open half of every turn: the shaft is softer on the
average, and kinks in step once, twice and three times per turn. Near the critical speed the vibration bends it more
than the weight does and may hold it open or shut; that part acts as a force law. Source: Gasch, J. Sound Vib. 160
(1993) 313-332; Mayes, Davies, J. Vib. Acoust. 106 (1984) 139-145.

Against integration in time within 4 % of what it does: the curvature is read off the centre line, shear and all, and
what 2X and 3X do to the opening is left out.
"""

from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rotorrig.rig.description import RigConfig
from rotorrig.sims.effects.base import EVERY, Effect, Parameter, Theta
from rotorrig.sims.effects.places import bending_stiffness, free_places, span, tube_at
from rotorrig.sims.effects.shaft_motion import at_rest, curvature_rows
from rotorrig.sims.rotor.assembly import Added, RotorModel, with_added
from rotorrig.sims.rotor.force_law import ForceLaw
from rotorrig.sims.rotor.loads import Load

Reals = NDArray[np.float64]

MOUTHS = 8  # angles about the shaft that a fit may begin at: within 22 degrees of any
OPEN = 0.25  # of a compliance, on the average of a turn: open for half of it, and across the mouth alone
#: order -> kink along the moment and across it, in the sense of rotation, as phasors of cos^2 and cos sin while cos < 0
BREATHING = MappingProxyType(
    {
        1: (-4 / (3 * np.pi), 2j / (3 * np.pi)),
        2: (1 / 4, -1j / 4),
        3: (-4 / (15 * np.pi), 2j / (5 * np.pi)),
    }
)
RIGID = 1e-9  # of the shaft's greatest stiffness: less is rounding, and bends it not at all


class _Hinge(NamedTuple):
    """The cracked section in a model."""

    rows: Reals  # (2, dof) N m, read the bending moments of an uncracked shaft
    own: float  # N m per rad: by how much they err where the shaft has a kink there


@dataclass(frozen=True, kw_only=True)
class Crack(Effect):
    """The "compliance" [rad/(N m)] of the open mouth, and where it is from where a scan looks for it.

    It looks "turn" [rad] past `mouth` and is "shift" [m] past `position`.
    """

    name = "crack"
    title = "breathing crack"
    orders = EVERY
    position: float  # m from the coupling
    mouth: float  # rad from the keyphasor mark, in the sense of rotation
    bending_stiffness: float  # N m^2 there
    ends: tuple[float, float]  # m, between which it may be
    gravity: str

    def changed(self, model: RotorModel, theta: Theta) -> RotorModel:
        """Return the model as soft as it is on the average of a turn under the weight."""
        if not theta["compliance"]:
            return model
        hinge = self._hinge(model, theta)
        lost = OPEN * theta["compliance"] / _reading(hinge, theta)
        return with_added(model, Added(K=-lost * hinge.rows.T @ hinge.rows))

    def loads(self, model: RotorModel, theta: Theta) -> tuple[Load, ...]:
        """Return the pairs of moments on either side of it that make it breathe under the weight."""
        hinge = self._hinge(model, theta)
        moment = self._at_rest(model, hinge, theta)
        aside = model.rotation * np.array([-moment[1], moment[0]])
        angle = self.mouth + theta["turn"] - model.rotation * np.arctan2(moment[1], moment[0])
        compliance = theta["compliance"] / _reading(hinge, theta)  # the softness of `changed` yields to it too
        return tuple(
            Load(
                pattern=compliance * np.exp(1j * n * angle) * (down * moment + side * aside) @ hinge.rows,
                law="constant",
                order=n,
            )
            for n, (down, side) in BREATHING.items()
        )

    def laws(self, model: RotorModel, theta: Theta) -> tuple[ForceLaw, ...]:
        """Return what the vibration adds to that, and to the softness of `changed`."""
        hinge = self._hinge(model, theta)
        mouth = self.mouth + theta["turn"]
        reading = _reading(hinge, theta)
        constants = [theta["compliance"] / reading, reading, np.cos(mouth), np.sin(mouth), model.rotation]
        return (
            ForceLaw(
                rows=hinge.rows,
                force=breathing,
                constants=np.array([*constants, *self._at_rest(model, hinge, theta), 1.0, 0.0]),
                static=hinge.rows @ at_rest(model, self.gravity),
                overtones=False,
            ),
        )

    def words(self, theta: Theta) -> str:
        """Say where it is, which way it looks and how far it gives way."""
        angle = np.degrees(self.mouth + theta["turn"]) % 360
        return (
            f"a crack {1e3 * self._place(theta):.0f} mm from the coupling, its mouth at {angle:.0f} deg from the "
            f"keyphasor mark, lets the shaft kink by {1e6 * theta['compliance']:.1f} urad per N m while it is open"
        )

    def _place(self, theta: Theta) -> float:
        left, right = self.ends
        return min(max(self.position + theta["shift"], left), right)

    def _hinge(self, model: RotorModel, theta: Theta) -> _Hinge:
        rows = self.bending_stiffness * curvature_rows(model, self._place(theta))
        stiffness, shapes = np.linalg.eigh(model.shaft.K)
        bent = stiffness > RIGID * stiffness[-1]
        moments = rows @ shapes[:, bent]
        return _Hinge(rows=rows, own=float(moments[0] ** 2 @ (1 / stiffness[bent])))

    def _at_rest(self, model: RotorModel, hinge: _Hinge, theta: Theta) -> Reals:
        """Return the moments (2,) [N m] under the weight, of a `changed` model."""
        moments: Reals = hinge.rows @ at_rest(model, self.gravity) / _reading(hinge, theta)
        return moments


def _reading(hinge: _Hinge, theta: Theta) -> float:
    """Return what the rows read of a moment that the kink is the average one of."""
    return 1 + OPEN * theta["compliance"] * hinge.own


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
    """Return one for every angle at every place of a scan between the bearings; none where gravity bends nothing."""
    if rig.gravity == "none":
        return ()
    left, right = span(rig)
    unknown = (
        Parameter(name="compliance", unit="rad/(N m)", low=0.0, high=2e-4, size=1e-5),
        Parameter(name="turn", unit="rad", low=-0.5, high=0.5, size=0.1),
        Parameter(name="shift", unit="m", low=-0.02, high=0.02, size=0.005),
    )
    return tuple(
        Crack(
            where=f"{where}, mouth at {360 * k / MOUTHS:.0f} deg",
            position=z,
            mouth=2 * np.pi * k / MOUTHS,
            bending_stiffness=bending_stiffness(tube_at(rig, z)),
            ends=(left, right),
            gravity=rig.gravity,
            parameters=unknown,
        )
        for where, z in free_places(rig).items()
        if left < z < right
        for k in range(MOUTHS)
    )

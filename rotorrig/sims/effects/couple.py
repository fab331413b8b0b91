"""Couple unbalance: a disk that sits askew on its shaft.

Its axis of inertia leans by tau, which turns with the shaft: a moment Omega^2 (It - Ip) tau that swaps sign where the
disk is thick rather than thin. Source: Genta, Dynamics of Rotating Systems (2005), section 4.4.
"""

from dataclasses import dataclass

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import Effect, Theta, pair, phasor, polar
from rotorrig.sims.effects.places import disks
from rotorrig.sims.effects.shaft_motion import forward
from rotorrig.sims.rotor.model import Load, RotorModel

ROUND = 1e-3  # relative difference of the inertias below which a skew has no moment


@dataclass(frozen=True, kw_only=True)
class Couple(Effect):
    """The phasor "skew" [rad]: the slope of the disk's axis towards +x at theta = 0."""

    name = "couple"
    title = "couple unbalance of a skew disk"
    linear = True
    disk: str

    def loads(self, model: RotorModel, theta: Theta) -> tuple[Load, ...]:
        """Return its moment."""
        disk = model.disk(self.disk)
        pattern = (disk.transverse - disk.polar) * phasor(theta, "skew") * forward(disk.rows[2:], model.rotation)
        return (Load(pattern=pattern, law="unbalance"),)

    def words(self, theta: Theta) -> str:
        """Say how far it leans, and where to."""
        size, angle = polar(theta, "skew")
        return f"{self.disk} sits askew by {1e3 * size:.2f} mrad, {angle:.0f} deg from the keyphasor mark"


def effects(rig: RigConfig) -> tuple[Couple, ...]:
    """Return one for every disk that is not as a ball is."""
    unknown = pair("skew", "rad", most=10e-3, size=1e-3)
    return tuple(
        Couple(where=where, disk=disk.name, parameters=unknown)
        for where, disk in disks(rig).items()
        if abs(disk.transverse_inertia - disk.polar_inertia) > ROUND * disk.polar_inertia
    )

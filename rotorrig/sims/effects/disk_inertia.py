"""A disk whose moments of inertia are not the nameplate's.

A mode in which the disk only shifts does not show it. Source: eq. (5) of the chapter on which the rotor model rests.
"""

from dataclasses import dataclass, replace

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import EVERY, Effect, Parameter, Theta
from rotorrig.sims.effects.places import disks
from rotorrig.sims.rotor.model import Added, RotorModel, disk_gyroscopic, disk_mass, with_added


@dataclass(frozen=True, kw_only=True)
class DiskInertia(Effect):
    """By how much of themselves the "polar" and "transverse" inertia are larger."""

    name = "disk_inertia"
    title = "disk inertia"
    law_error = 0.0
    orders = EVERY
    disk: str

    def change_matrices(self, model: RotorModel, theta: Theta) -> RotorModel:
        """Return the model with them."""
        disk = model.disk(self.disk)
        more = replace(
            disk, mass=0.0, polar=theta["polar"] * disk.polar, transverse=theta["transverse"] * disk.transverse
        )
        return with_added(model, Added(M=disk_mass(more), G=model.rotation * disk_gyroscopic(more)))

    def words(self, theta: Theta) -> str:
        """Say both, in percent."""
        return (
            f"the inertias of {self.disk} differ from the nameplate's: polar {100 * theta['polar']:+.1f} %, "
            f"transverse {100 * theta['transverse']:+.1f} %"
        )


def effects(rig: RigConfig) -> tuple[DiskInertia, ...]:
    """Return one for every disk that has inertia."""
    unknown = tuple(Parameter(name=name, unit="", low=-0.3, high=0.3, size=0.05) for name in ("polar", "transverse"))
    return tuple(
        DiskInertia(where=where, disk=disk.name, parameters=unknown)
        for where, disk in disks(rig).items()
        if disk.polar_inertia or disk.transverse_inertia
    )

"""Faults of the simulated rig, written from the physics of each fault alone: one file each, found by name."""

from rotorrig.sims.plant.faults.base import check, check_faults, deviated, fault, forces, misread, restructured

__all__ = [
    "check",
    "check_faults",
    "deviated",
    "fault",
    "forces",
    "misread",
    "restructured",
]

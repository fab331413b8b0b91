"""Faults of the simulated rig, written from the physics of each fault alone: one file each, found by name."""

from rotorrig.sims.plant.faults.base import (
    apply_deviations,
    apply_sensors,
    apply_structure,
    check_fault,
    check_faults,
    collect_forces,
    load_fault,
)

__all__ = [
    "apply_deviations",
    "apply_sensors",
    "apply_structure",
    "check_fault",
    "check_faults",
    "collect_forces",
    "load_fault",
]

"""Modes of the rotor: whirl speeds, critical speeds, Campbell diagram, stability, static sag."""

from rotorrig.sims.rotor.modes.campbell import campbell, stability_onset
from rotorrig.sims.rotor.modes.modes import (
    Mode,
    critical_modes,
    critical_speeds,
    reduce_if_large,
    static_sag,
    static_solution,
    weight,
    whirl_modes,
)
from rotorrig.sims.rotor.modes.statics import bearing_loads, shaft_mass

__all__ = [
    "Mode",
    "bearing_loads",
    "campbell",
    "critical_modes",
    "critical_speeds",
    "reduce_if_large",
    "shaft_mass",
    "stability_onset",
    "static_sag",
    "static_solution",
    "weight",
    "whirl_modes",
]

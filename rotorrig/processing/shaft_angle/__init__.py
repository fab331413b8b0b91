"""Shaft angle over time from keyphasor pulses: edges, missed and extra pulses, uneven teeth, a Kalman smoother."""

from rotorrig.processing.shaft_angle.read_keyphasor import read_keyphasor
from rotorrig.processing.shaft_angle.shaft_angle import TURN, Flaw, ShaftAngle, fit_shaft_angle

__all__ = [
    "TURN",
    "Flaw",
    "ShaftAngle",
    "fit_shaft_angle",
    "read_keyphasor",
]

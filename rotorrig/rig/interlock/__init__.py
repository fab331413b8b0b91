"""Interlock: limits that stop the rotor whatever the plan says, with or without a [limits] table.

One file for each thing that is watched; `Interlock` looks at every block of samples and every reading of the drive.
docs/sweeps.md lists what is watched, from which source, with which delay, and what of API 670 is not.
"""

from rotorrig.rig.interlock.interlock import Interlock
from rotorrig.rig.interlock.overspeed import overspeed_limit
from rotorrig.rig.interlock.vibration import VibrationLimits

__all__ = ["Interlock", "VibrationLimits", "overspeed_limit"]

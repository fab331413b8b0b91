"""Modbus drive profiles by name: each is a file in rig/motor/profiles, found without importing a driver.

The config's name is the file's, with dashes: "vfd-ed" is `vfd_ed.py`. Dropping a file in is all it takes.
"""

import importlib
import pkgutil
from pathlib import Path
from typing import Protocol, cast

_FOLDER = Path(__file__).parents[1] / "motor" / "profiles"
_PACKAGE = "rotorrig.rig.motor.profiles"


class DriveProfile(Protocol):
    """The part of a profile that a config and its plans depend on; registers are the driver's business."""

    @property
    def highest_frequency(self) -> float:
        """Highest output frequency [Hz] it can be asked for."""
        ...

    @property
    def ramp_by_hand(self) -> bool:
        """True if its ramp is set at the drive and cannot be written over Modbus."""
        ...

    @property
    def keeps_ramp(self) -> bool:
        """True if it keeps the ramp it has while it turns, so that a plan can have but one."""
        ...


def profile_names() -> tuple[str, ...]:
    """Return the names of all profiles, as a config has them."""
    return tuple(sorted(module.name.replace("_", "-") for module in pkgutil.iter_modules([str(_FOLDER)])))


def load_profile(name: str) -> DriveProfile:
    """Return the profile of that name."""
    module = importlib.import_module(f"{_PACKAGE}.{name.replace('-', '_')}")
    return cast(DriveProfile, module.PROFILE)

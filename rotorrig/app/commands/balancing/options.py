"""Options of balancing, from text with units to SI: speeds, masses, radii, holes."""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from rotorrig.balancing import Holes
from rotorrig.rig import ConfigError
from rotorrig.rig.config import read_quantity

NEAR = 0.01  # relative: rows that count as at a speed


@dataclass(frozen=True, slots=True, kw_only=True)
class HoleOptions:
    """What is at hand to mount, as it was written."""

    holes: int | None = None  # per plane
    masses: str | None = None  # "1 g, 2 g, 5 g"
    radius: str | None = None  # "30 mm", or "disk 1: 30 mm, disk 2: 25 mm"
    first: str = "0 deg"  # angle of hole 1 from the mark
    most: int = 2  # holes filled per plane


def read_bands(text: str | None) -> tuple[tuple[float, float], ...]:
    """Return bands [rad/s] of "1500 rpm, 1800 to 2400 rpm". Raises ConfigError.

    >>> read_bands("100 to 200 rad/s")
    ((100.0, 200.0),)
    """
    bands = []
    for part in _parts(text):
        low, to, high = part.partition(" to ")
        if to:
            unit = high.strip().partition(" ")[2]
            low = low if any(letter.isalpha() for letter in low) else f"{low} {unit}"
            band = read_quantity(low, "speed", where="--speeds"), read_quantity(high, "speed", where="--speeds")
        else:
            speed = read_quantity(part, "speed", where="--speeds")
            band = speed * (1 - NEAR), speed * (1 + NEAR)
        if not 0 < band[0] < band[1]:
            raise ConfigError(f"--speeds: got '{part}', want speeds that rise, such as '1800 to 2400 rpm'")
        bands.append(band)
    return tuple(bands)


def read_planes(text: str | None, *, known: Collection[str]) -> tuple[str, ...]:
    """Return the planes of "disk 1, disk 2". Raises ConfigError for one that the config has not."""
    planes = tuple(dict.fromkeys(_parts(text)))
    for plane in planes:
        if plane not in known:
            raise ConfigError(f"--planes: the config has no disk or plane '{plane}', want some of {list(known)}")
    return planes


def read_radii(text: str | None, *, known: Sequence[str]) -> dict[str, float]:
    """Return plane -> radius [m], of "30 mm" for all or "disk 1: 30 mm, disk 2: 25 mm". Raises ConfigError."""
    radii: dict[str, float] = {}
    for part in _parts(text):
        plane, colon, radius = part.rpartition(":")
        if colon and plane.strip() not in known:
            raise ConfigError(
                f"--radius: the config has no disk or plane '{plane.strip()}', want some of {list(known)}"
            )
        value = read_quantity(radius.strip(), "length", where="--radius")
        if not value > 0:
            raise ConfigError(f"--radius: got '{part}', want a length above zero")
        radii |= {plane.strip(): value} if colon else dict.fromkeys(known, value)
    return radii


def read_holes(options: HoleOptions, planes: Sequence[str], radii: dict[str, float]) -> dict[str, Holes] | None:
    """Return the holes of every plane; None if no holes were given. Raises ConfigError if something is missing."""
    if options.holes is None and options.masses is None:
        return None
    if options.holes is None or options.masses is None:
        raise ConfigError("--holes and --masses: got one, want both or neither")
    if options.holes < 1:
        raise ConfigError(f"--holes: got {options.holes}, want at least 1")
    missing = [plane for plane in planes if plane not in radii]
    if missing:
        raise ConfigError(f"--radius: missing for '{missing[0]}', want the radius of its holes, such as '30 mm'")
    masses = tuple(sorted({read_quantity(part, "mass", where="--masses") for part in _parts(options.masses)}))
    if not masses or masses[0] <= 0:
        raise ConfigError(f"--masses: got '{options.masses}', want masses above zero, such as '1 g, 2 g, 5 g'")
    first = read_quantity(options.first, "angle", where="--first-hole") % math.tau
    return {
        plane: Holes(count=options.holes, masses=masses, radius=radii[plane], first=first, most=options.most)
        for plane in planes
    }


def _parts(text: str | None) -> list[str]:
    return [part.strip() for part in (text or "").split(",") if part.strip()]

"""Differences from the nameplate, one at a time: the model after a small one, and its direction."""

from collections.abc import Callable

from rotorrig.sims.rotor.model.assembly import RotorModel, with_geometry, with_tilt
from rotorrig.sims.rotor.model.derivatives import Direction, along_diameter, along_hub, along_position, along_tilt

HUB = 0.2  # so that it may be less

#: name -> the model after a share p of what is typical of a difference, and the derivative by that share
CHANGES: dict[str, tuple[Callable[[RotorModel, float], RotorModel], Callable[[RotorModel], Direction]]] = {
    "disk position": (
        lambda model, p: with_geometry(model, positions={"disk disk": 1e-3 * p}),
        lambda model: times(1e-3, along_position(model, "disk disk")),
    ),
    "bearing position": (
        lambda model, p: with_geometry(model, positions={"bearing left B": 1e-3 * p}),
        lambda model: times(1e-3, along_position(model, "bearing left B")),
    ),
    "probe position": (
        lambda model, p: with_geometry(model, positions={"probe 2x": 1e-3 * p}),
        lambda model: times(1e-3, along_position(model, "probe 2x")),
    ),
    "diameter": (
        lambda model, p: with_geometry(model, diameter=0.01 * p),
        lambda model: times(0.01, along_diameter(model)),
    ),
    "hub": (
        lambda model, p: with_geometry(model, hubs={"disk": HUB + 0.1 * p}),
        lambda model: times(0.1, along_hub(model, "disk")),
    ),
    "tilt": (
        lambda model, p: with_tilt(model, {"left A": 100.0 + 10.0 * p}),
        lambda model: times(10.0, along_tilt(model, "left A")),
    ),
}


def times(factor: float, direction: Direction) -> Direction:
    return Direction._make(factor * A for A in direction)

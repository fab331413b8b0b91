"""A probe that does not sit at the angle the nameplate says, or a bracket turned as a whole.

The reading at a + delta is made of the readings of the plane's probes, x and y first; so one probe alone cannot be
asked. A turned bracket turns the axes of every anisotropy with it. Source: geometry, x cos a + y sin a.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import Probe, RigConfig
from rotorrig.sims.effects.base import EVERY, Complex, Effect, Parameter, ReadingContext, Theta
from rotorrig.sims.effects.places import probe_planes

ASKEW = 0.1  # of a right angle's sine that two probes must have between them to tell x from y


@dataclass(frozen=True, kw_only=True)
class ProbeAngle(Effect):
    """Rotation of the probes `turned` about the shaft [rad], "turn", from +x towards +y."""

    name = "probe_angle"
    title = "probe turned about the shaft"
    law_error = 0.0
    orders = EVERY
    as_nuisance = True
    plane: tuple[str, ...]  # the probes that tell x and y there
    turned: tuple[str, ...]

    def change_readings(self, z: Complex, context: ReadingContext, theta: Theta) -> Complex:
        """Return the vectors with these probes' read at their other angle."""
        if not theta["turn"]:
            return z
        at = [context.probes.index(name) for name in self.plane if name in context.probes]
        moved = [i for i in at if context.probes[i] in self.turned]
        xy = z[:, at] @ np.linalg.pinv(_axes(context.angle[at]))
        result = z.copy()
        result[:, moved] = xy @ _axes(context.angle[moved] + theta["turn"])
        return result

    def words(self, theta: Theta) -> str:
        """Say how far, and where to."""
        who = " and ".join(self.turned)
        verb = "sits" if len(self.turned) == 1 else "sit"
        return f"{who} {verb} {np.degrees(theta['turn']):+.1f} deg from the nameplate's angle, from x towards y"


def effects(rig: RigConfig) -> tuple[ProbeAngle, ...]:
    """Return one for every probe that has another across from it, and one for every plane of such as a whole."""
    angles = []
    most = np.radians(20.0)
    unknown = (Parameter(name="turn", unit="rad", low=-most, high=most, size=0.08),)
    for name, probes in probe_planes(rig).items():
        if not tells_x_from_y(probes):
            continue
        plane = tuple(p.name for p in probes)
        angles += [ProbeAngle(where=f"probe {p}", plane=plane, turned=(p,), parameters=unknown) for p in plane]
        angles.append(ProbeAngle(where=name, plane=plane, turned=plane, parameters=unknown))
    return tuple(angles)


def tells_x_from_y(probes: tuple[Probe, ...]) -> bool:
    """Return whether the probes of one plane look from different enough angles."""
    return bool(
        np.linalg.svd(_axes(np.array([p.angle for p in probes])), compute_uv=False)[-1] > ASKEW and len(probes) > 1
    )


def _axes(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return what takes x, y to the readings at these angles, (2, probe)."""
    return np.stack([np.cos(angle), np.sin(angle)])

"""Effects that are nuisances of every fit, with priors: part of the base model, never reported as causes.

One is the keyphasor's mark seen from its other side, in a recording with the rotor turning backwards. The pulse of a
forward run comes from one edge of the notch, that of a run the other way round from the other. How far apart these are
no config says, so such a run tells no angle from the mark that a forward one gave.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from rotorrig.identify.extended_model.settings import EXTENDED_MODEL
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.sims.effects import (
    EVERY,
    Complex,
    Effect,
    InternalDamping,
    Parameter,
    ReadingContext,
    Theta,
    catalogue,
)


@dataclass(frozen=True, kw_only=True)
class MarkEdge(Effect):
    """The angle "width" [rad] from the edge that pulses forwards to the one that pulses backwards."""

    name = "mark_edge"
    title = "width of the keyphasor's mark"
    orders = EVERY
    after_hum = True

    @classmethod
    def of_recording(cls, number: int) -> Self:
        """Return the nuisance of that recording."""
        width = Parameter(name="width", unit="rad", low=-np.pi, high=np.pi, size=0.1, prior=EXTENDED_MODEL.mark_width)
        return cls(where=f"recording {number + 1}", recording=number, parameters=(width,))

    def change_readings(self, z: Complex, view: ReadingContext, theta: Theta) -> Complex:
        """Return the vectors by an angle that is zero at the other edge."""
        return z * np.exp(1j * view.order * theta["width"])


def nuisance_effects(recordings: Sequence[Recording]) -> list[Effect]:
    """Return them: viscous damping inside the shaft, and the other edge of the mark where a rotor turned backwards."""
    rig = recordings[0].response.rig
    damping: list[Effect] = [
        replace(effect, parameters=(replace(effect.parameters[0], prior=rig.prior.rotating_damping),))
        for effect in catalogue(rig)
        if isinstance(effect, InternalDamping)
    ]
    return [*damping, *(MarkEdge.of_recording(r.number) for r in recordings if r.backward)]

"""Effects that are nuisances of every fit, with priors: part of the base model, never reported as causes."""

from collections.abc import Sequence
from dataclasses import replace

from rotorrig.identify.extended_model.keyphasor_edge import MarkEdge
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.sims.effects import Effect, InternalDamping, catalogue


def nuisance_effects(recordings: Sequence[Recording]) -> list[Effect]:
    """Return them: internal damping of the shaft, and the other edge of the mark where a rotor turned backwards."""
    rig = recordings[0].response.rig
    damping: list[Effect] = [
        replace(effect, parameters=tuple(replace(q, prior=rig.prior.rotating_damping) for q in effect.parameters))
        for effect in catalogue(rig)
        if isinstance(effect, InternalDamping)
    ]
    return [*damping, *(MarkEdge.of_recording(r.number) for r in recordings if r.backward)]

"""The model's own error where its shape is known: dampings that change over speed, a mark that moves with the shaft.

What they are to begin with: measurement/model_error.py.
"""

import numpy as np

from rotorrig.identify.base_model import Reals
from rotorrig.identify.extended_model.jacobian import vectors_by
from rotorrig.identify.extended_model.model import Complex, ExtendedModel
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.measurement import changed_vectors, mark_vectors
from rotorrig.sims.effects import position_rows

DRIVEN_END = 0.0  # m, where the mark is


def known_error(model: ExtendedModel, p: Reals) -> list[Complex]:
    """Return vectors (row + 1, probe, column) m of every recording at `p`, one standard deviation each."""
    slopes = vectors_by(model, p, model.parameters.base.dampings)
    ends = position_rows(model.rotor(p), DRIVEN_END)
    found = []
    for recording, own, z in zip(model.recordings, slopes, model.predict(p, orders=(1,)), strict=True):
        moved = mark_vectors(z[1], model.motion_at(recording, p, ends), radius=recording.rig.prior.mark_radius)
        found.append(np.concatenate([_by_damping(recording, own), moved], axis=-1))
    return found


def _by_damping(recording: Recording, slopes: Complex) -> Complex:
    """Return those of dampings that change over speed; the slow roll has none that counts."""
    share = recording.rig.prior.damping_over_speed
    if not share or not slopes.shape[-1]:
        return slopes[..., :0]
    first = recording.measured[1]
    omega = recording.response.omega[first.rows]
    changed = changed_vectors(slopes[:-1], omega, first.sigma[:-1], share=share)
    return np.concatenate([changed, np.zeros_like(changed[:1])])

"""The model's own error where its shape is known: dampings that change over speed, a mark that moves with the shaft.

What they are to begin with: measurement/model_error.py. Under a force law comes that of the law: a wall creeps back, a
spring levels off, friction is another when warm. So what the law does to the motion at 1X may be another, as smooth
over speed as the rest, by a share of `EXTENDED_MODEL.law_error`.
"""

from dataclasses import replace

import numpy as np

from rotorrig.identify.base_model import Reals
from rotorrig.identify.extended_model.jacobian import vectors_by
from rotorrig.identify.extended_model.model import Complex, ExtendedModel
from rotorrig.identify.extended_model.settings import EXTENDED_MODEL
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.measurement import changed_vectors, error_vectors, mark_vectors
from rotorrig.sims.effects import position_rows

DRIVEN_END = 0.0  # m, where the mark is


def known_error(model: ExtendedModel, p: Reals, *, of_laws: bool = True) -> list[Complex]:
    """Return vectors (row + 1, probe, column) m of every recording at `p`, one standard deviation each.

    Without `of_laws` a force law is taken for exact.
    """
    slopes = vectors_by(model, p, model.parameters.base.dampings)
    ends = position_rows(model.rotor(p), DRIVEN_END)
    found = []
    for recording, own, z in zip(model.recordings, slopes, model.predict(p, orders=(1,)), strict=True):
        moved = mark_vectors(z[1], model.motion_at(recording, p, ends), radius=recording.rig.prior.mark_radius)
        by_laws = [_by_laws(model, recording, p)] if of_laws else []
        found.append(np.concatenate([_by_damping(recording, own), moved, *by_laws], axis=-1))
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


def _by_laws(model: ExtendedModel, recording: Recording, p: Reals) -> Complex:
    """Return those of force laws, by what they do to the motion at 1X."""
    moving, first = model.moving(p), recording.measured[1]
    if not moving.laws:
        return np.zeros((*first.z.shape, 0), complex)
    motion = model.motions(recording, p, moving, orders=(1,))[1]
    bare = model.motion_of(recording, p, replace(moving, laws=()), order=1)
    by_laws = model.probes.linear(p, motion - bare)[:-1]
    omega, run = recording.response.omega[first.rows], recording.response.run[first.rows]
    own = error_vectors(by_laws, omega, run, share=EXTENDED_MODEL.law_error, repeatability=0.0)
    return np.concatenate([own, np.zeros_like(own[:1])])

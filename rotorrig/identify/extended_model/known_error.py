"""The model's own error where its shape is known: dampings that change over speed, a mark that moves with the shaft.

What an effect does above 1X, a coupling or an uneven shaft at 2X, is known no better than the motion at 1X: by the same
share, and by the same dampings, which there count where that order meets the critical speed.

What they are to begin with: measurement/model_error.py. Under a force law comes that of the law: a wall creeps back, a
spring levels off, friction is another when warm. So what the law does to the motion at 1X may be another, as smooth
over speed as the rest, by a share of `EXTENDED_MODEL.law_error`.
"""

from dataclasses import replace

import numpy as np

from rotorrig.identify.base_model import Reals
from rotorrig.identify.extended_model.excited_rotor import Moving
from rotorrig.identify.extended_model.jacobian import vectors_by
from rotorrig.identify.extended_model.model import Complex, ExtendedModel
from rotorrig.identify.extended_model.settings import EXTENDED_MODEL
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.measurement import changed_vectors, error_vectors, mark_vectors
from rotorrig.sims.effects import position_rows

DRIVEN_END = 0.0  # m, where the mark is


def known_error(model: ExtendedModel, p: Reals, *, of_laws: bool = True) -> list[dict[int, Complex]]:
    """Return vectors of every recording at `p`, order -> (row + 1, probe, column) m, one standard deviation each.

    Without `of_laws` a force law is taken for exact.
    """
    slopes = vectors_by(model, p, model.parameters.base.dampings)
    ends = position_rows(model.rotor(p), DRIVEN_END)
    found = []
    above = above_first(model, p)
    for n, (recording, own, z) in enumerate(zip(model.recordings, slopes, model.predict(p, orders=(1,)), strict=True)):
        moved = mark_vectors(z[1], model.motion_at(recording, p, ends), radius=recording.rig.prior.mark_radius)
        by_laws = [_by_laws(model, recording, p)] if of_laws else []
        found.append({1: np.concatenate([_by_damping(recording, own), moved, *by_laws], axis=-1), **above[n]})
    return found


def above_first(model: ExtendedModel, p: Reals) -> list[dict[int, Complex]]:
    """Return the same above 1X, of what the rotor itself does there; nothing under a force law, or where nothing is."""
    moving = model.moving(p)
    if moving.laws:
        return [{} for _ in model.recordings]
    h, changed = EXTENDED_MODEL.step, []
    for i in model.parameters.base.dampings:
        other = p.copy()
        other[i] += h
        changed.append(model.moving(other))
    found: list[dict[int, Complex]] = []
    for recording in model.recordings:
        found.append({})
        for order in (order for order in recording.orders if order > 1 and moving.loads(recording, order)):
            z, *others = (_seen(model, recording, p, each, order) for each in (moving, *changed))
            slopes = np.stack([(other - z) / h for other in others], axis=-1) if others else z[..., None][..., :0]
            found[-1][order] = _own(recording, z, slopes, order)
    return found


def _seen(model: ExtendedModel, recording: Recording, p: Reals, moving: Moving, order: int) -> Complex:
    """Return what the probes see of a rotor's motion above 1X, (row + 1, probe)."""
    motion = recording.columns(moving.model, moving.loads(recording, order), order=order).sum(axis=-1)
    return model.probes.linear(p, motion)


def _own(recording: Recording, z: Complex, slopes: Complex, order: int) -> Complex:
    """Return those of an order by a share of its motion and by dampings that change over speed."""
    prior, measured = recording.rig.prior, recording.measured[order]
    omega, run = recording.response.omega[measured.rows], recording.response.run[measured.rows]
    by = {"share": prior.model_error, "repeatability": prior.repeatability}
    own = error_vectors(z[:-1] - z[-1], omega, run, **by) if any(by.values()) else slopes[:-1, :, :0]
    return np.concatenate([np.concatenate([own, np.zeros_like(own[:1])]), _by_damping(recording, slopes, order)], -1)


def _by_damping(recording: Recording, slopes: Complex, order: int = 1) -> Complex:
    """Return those of dampings that change over speed; the slow roll has none that counts."""
    share = recording.rig.prior.damping_over_speed
    if not share or not slopes.shape[-1]:
        return slopes[..., :0]
    measured = recording.measured[order]
    omega = recording.response.omega[measured.rows]
    changed = changed_vectors(slopes[:-1], omega, measured.sigma[:-1], share=share)
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

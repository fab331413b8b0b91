"""The model's own error where its shape is known: dampings that change over speed, a mark that moves with the shaft.

What an effect does above 1X, a coupling or an uneven shaft at 2X, is known no better than the motion at 1X: by the same
share, and by the same dampings, which there count where that order meets the critical speed.

What they are to begin with: measurement/model_error.py. To that comes what the law of an effect may be off by: a wall
creeps back, friction is another when warm, the bushes of a coupling stiffen, a flat does not go all along. So what an
effect does to a vector may be another, as smooth over speed as the rest, by a share that its class states as
`law_error`: a tenth of contacts, a twentieth of other mechanisms, nothing of what is so by definition, as a probe's
angle is. Of force laws that is told at 1X alone, of probes at all orders, of others above 1X alone: at 1X, where the
base has all its freedom too, a bow whose law may be off at every probe predicts unseen data no better than none.

What came on at a moment, as a step of unbalance, may have taken its time: half of it, one standard deviation, came on
at any of the moments around that the effect states.
"""

from dataclasses import replace

import numpy as np

from rotorrig.identify.base_model import Reals
from rotorrig.identify.extended_model.excited_rotor import Moving
from rotorrig.identify.extended_model.jacobian import on_probes_alone, vectors_by
from rotorrig.identify.extended_model.model import Complex, ExtendedModel
from rotorrig.identify.extended_model.settings import EXTENDED_MODEL
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.measurement import changed_vectors, error_vectors, mark_vectors
from rotorrig.sims.effects import position_rows

DRIVEN_END = 0.0  # m, where the mark is


def known_error(model: ExtendedModel, p: Reals, *, of_laws: bool = True) -> list[dict[int, Complex]]:
    """Return vectors of every recording at `p`, order -> (row + 1, probe, column) m, one standard deviation each.

    Without `of_laws` the laws of effects are taken for exact.
    """
    slopes = vectors_by(model, p, model.parameters.base.dampings)
    ends = position_rows(model.rotor(p), DRIVEN_END)
    found = []
    by_effects = error_of_effects(model, p, of_laws=of_laws)
    for n, (recording, own, z) in enumerate(zip(model.recordings, slopes, model.predict(p, orders=(1,)), strict=True)):
        moved = mark_vectors(z[1], model.motion_at(recording, p, ends), radius=recording.rig.prior.mark_radius)
        by_laws = [_by_laws(model, recording, p)] if of_laws else []
        first = np.concatenate([_by_damping(recording, own), moved, *by_laws], axis=-1)
        found.append(_join({1: first}, by_effects[n]))
    return found


def error_of_effects(model: ExtendedModel, p: Reals, *, of_laws: bool = True) -> list[dict[int, Complex]]:
    """Return the same of effects alone, by their laws and above 1X; nothing under a force law, or where nothing is."""
    moving = model.moving(p)
    if moving.laws:
        return [{} for _ in model.recordings]
    above = _above_first(model, p, moving)
    if not of_laws:
        return above
    return [_join(*each) for each in zip(above, _by_effects(model, p), _by_moments(model, p), strict=True)]


def _above_first(model: ExtendedModel, p: Reals, moving: Moving) -> list[dict[int, Complex]]:
    """Return those above 1X, of what the rotor itself does there."""
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


def _by_effects(model: ExtendedModel, p: Reals) -> list[dict[int, Complex]]:
    """Return those of every effect above 1X, at 1X of probes, by what it does beyond what it does to the slow roll."""
    found: list[dict[int, Complex]] = [{} for _ in model.recordings]
    inexact = [i for i, effect in enumerate(model.effects) if effect.law_error and not effect.is_nuisance]
    predicted = model.predict(p) if inexact else []
    for i in inexact:
        effect, without = model.effects[i], p.copy()
        without[model.parameters.theta[i]] = [q.at_zero / q.size for q in effect.parameters]
        for n, (z, other) in enumerate(zip(predicted, model.predict(without), strict=True)):
            lowest = 1 if on_probes_alone(effect) else 2
            changes = {order: z[order] - other[order] for order in z if order >= lowest}
            own = {
                order: _in_share(model.recordings[n], order, change[:-1] - change[-1], share=effect.law_error)
                for order, change in changes.items()
                if (change != change[-1]).any()
            }
            found[n] = _join(found[n], own)
    return found


def _by_moments(model: ExtendedModel, p: Reals) -> list[dict[int, Complex]]:
    """Return those at 1X of effects that came on once, by what half of each at another moment changes."""
    found: list[dict[int, Complex]] = [{} for _ in model.recordings]
    for i, effect in enumerate(model.effects):
        others = effect.at_other_moments(model.parameters.of_effect(p, i))
        predicted = model.predict(p, orders=(1,)) if others else []
        for theta in others:
            other = p.copy()
            other[model.parameters.theta[i]] = [theta[q.name] / q.size for q in effect.parameters]
            pairs = zip(predicted, model.predict(other, orders=(1,)), strict=True)
            halves = [{1: (after[1] - z[1])[..., None] / 2} for z, after in pairs]
            found = [_join(*each) for each in zip(found, halves, strict=True)]
    return found


def _join(*parts: dict[int, Complex]) -> dict[int, Complex]:
    """Return the columns of all parts, order by order."""
    orders = dict.fromkeys(order for part in parts for order in part)
    return {n: np.concatenate([part[n] for part in parts if n in part], axis=-1) for n in orders}


def _in_share(
    recording: Recording, order: int, motion: Complex, *, share: float, repeatability: float = 0.0
) -> Complex:
    """Return those of a motion (row, probe) [m] known to a share, (row + 1, probe, column); none of the slow roll."""
    rows = recording.measured[order].rows
    omega, run = recording.response.omega[rows], recording.response.run[rows]
    own = error_vectors(motion, omega, run, share=share, repeatability=repeatability)
    return np.concatenate([own, np.zeros_like(own[:1])])


def _seen(model: ExtendedModel, recording: Recording, p: Reals, moving: Moving, order: int) -> Complex:
    """Return what the probes see of a rotor's motion above 1X, (row + 1, probe)."""
    motion = recording.columns(moving.model, moving.loads(recording, order), order=order).sum(axis=-1)
    return model.probes.linear(p, motion)


def _own(recording: Recording, z: Complex, slopes: Complex, order: int) -> Complex:
    """Return those of an order by a share of its motion and by dampings that change over speed."""
    prior = recording.rig.prior
    by = {"share": prior.model_error, "repeatability": prior.repeatability}
    own = _in_share(recording, order, z[:-1] - z[-1], **by) if any(by.values()) else slopes[..., :0]
    return np.concatenate([own, _by_damping(recording, slopes, order)], axis=-1)


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
    share = max(effect.law_error for effect in model.effects if "force laws" in effect.acts_on)
    return _in_share(recording, 1, model.probes.linear(p, motion - bare)[:-1], share=share)

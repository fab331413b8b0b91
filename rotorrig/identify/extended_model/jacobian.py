"""The derivatives of an extended model's vectors by its unknowns, column by column."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_model import Reals
from rotorrig.identify.extended_model.excited_rotor import Moving, halved_amounts
from rotorrig.identify.extended_model.force_law_jacobian import LawColumns, under_laws
from rotorrig.identify.extended_model.model import ExtendedModel
from rotorrig.identify.extended_model.settings import EXTENDED_MODEL
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.measurement import Measurement
from rotorrig.sims.effects import Effect
from rotorrig.sims.rotor.model import Load

Complex = NDArray[np.complex128]
Index = NDArray[np.intp]

Changes = dict[int, list[dict[int, Complex]]]  # unknown -> per recording: order -> (row + 1, probe)


def columns(model: ExtendedModel, p: Reals, free: Index) -> Reals:
    """Return d whitened vectors / d p of the columns `free`, (figure, column): recordings, orders, rows, probes."""
    moving = model.moving(p)
    by_difference = [int(i) for i in free if _differenced(model, p, moving, int(i))]
    differences = _differences(model, p, by_difference)
    lawful = LawColumns(model, p, moving, free) if moving.laws else None
    stated = model.predict(p) if model.amplitudes_alone else None
    parts = []
    for n, recording in enumerate(model.recordings):
        found = _exact(model, recording, p, free, moving, lawful)
        for order, measured in recording.measured.items():
            d = found[order]
            for i, change in differences.items():
                if order in change[n]:
                    d[..., np.searchsorted(free, i)] = change[n][order]
            if stated is not None:
                d = measured.off_derivatives(d, stated[n][order])
            parts.append(_whiten_columns(measured, d))
    return np.concatenate(parts)


def vectors_by(model: ExtendedModel, p: Reals, which: Index) -> list[Complex]:
    """Return d vectors / d p of 1X by unknowns that are not differenced, (row + 1, probe, column) m per recording."""
    moving = model.moving(p)
    lawful = LawColumns(model, p, moving, which) if moving.laws else None
    return [_exact(model, recording, p, which, moving, lawful)[1] for recording in model.recordings]


def _whiten_columns(measured: Measurement, d: Complex) -> Reals:
    """Return columns (row + 1, probe, column) in sigmas, (figure, column); most are zero above 1X, and stay so."""
    moving = np.flatnonzero(d.any(axis=(0, 1)))
    white = np.zeros((2 * measured.usable.size, d.shape[-1]))
    if len(moving):
        white[:, moving] = measured.sigmas(d[..., moving]).reshape(len(white), len(moving))
    return white


def on_probes_alone(effect: Effect) -> bool:
    """Say whether an effect leaves the motion as it is."""
    return effect.acts_on <= {"probes"}


def by_matrices(effect: Effect) -> bool:
    """Say whether an effect changes matrices, and has nothing beside them but loads that are linear in its unknowns.

    It then has exact derivatives.
    """
    return effect.acts_on == {"matrices"} or (effect.acts_on == {"matrices", "loads"} and effect.linear)


def _differenced(model: ExtendedModel, p: Reals, moving: Moving, i: int) -> bool:
    """Say whether column `i` is taken as a difference of the whole prediction."""
    names = model.parameters
    if i < names.own.start:
        return False
    effect = next(e for e, part in zip(model.effects, names.theta, strict=True) if part.start <= i < part.stop)
    if on_probes_alone(effect):
        return False
    if moving.laws:
        return not under_laws(model, p, effect, i)
    if by_matrices(effect):
        return model.resized(p, i)
    return not effect.linear or "probes" in effect.acts_on


def _differences(model: ExtendedModel, p: Reals, which: list[int]) -> Changes:
    """Return (prediction(p + h e_i) - prediction(p)) / h for every i, one-sided, within the bounds."""
    if not which:
        return {}
    low, high = model.parameters.bounds
    at = model.predict(p)
    found = {}
    for i in which:
        h = EXTENDED_MODEL.step
        if p[i] + h > high[i] and p[i] - h >= low[i]:
            h = -h
        moved = p.copy()
        moved[i] += h
        there = model.predict(moved)
        found[i] = [{n: (b[n] - a[n]) / h for n in b} for a, b in zip(at, there, strict=True)]
    return found


def _exact(
    model: ExtendedModel,
    recording: Recording,
    p: Reals,
    free: Index,
    moving: Moving,
    lawful: LawColumns | None,
) -> dict[int, Complex]:
    """Return every column that is no difference, order -> (row + 1, probe, column)."""
    rows, probes = len(recording.rows) + 1, len(recording.response.probes)
    found = {order: np.zeros((rows, probes, len(free)), complex) for order in recording.orders}
    for order in recording.orders:
        if lawful is not None and order == 1:
            marched = tuple(n for n in recording.orders if n <= EXTENDED_MODEL.highest_law_order)
            motion = lawful.fill(recording, found, orders=marched)
        elif order > 1 and model.linear_at(order) and not model.units.exact:
            motion = model.motion_of(recording, p, moving, order=order)
            _by_loads(model, recording, p, free, moving, order, found[order])
        else:
            motion = _by_rotor(model, recording, p, free, moving, order, found[order])
            if lawful is not None:
                lawful.fill_above(recording, found[order], order=order)
        if lawful is not None and order > 1:
            motion = model.motions(recording, p, moving)[order]
        _by_probes(model, p, motion, free, found[order])
        _by_runout(model, free, order, found[order])
        if order == 1:
            first, first_changes = model.probes.of_motion(p, motion, order=1), found[1].copy()
        found[order] += model.probes.bent_changes(p, first, first_changes, order)
        _by_curvature(model, first, free, order, found[order])
        if any("probes" in effect.acts_on for effect in model.effects):
            z = model.probes.of_motion(p, motion, order=order) + model.probes.bent(p, first, order)
            _through_effects(model, recording, p, z, free, order, found[order])
        _by_hum(model, recording, p, free, order, found[order])
    return found


def _by_rotor(
    model: ExtendedModel,
    recording: Recording,
    p: Reals,
    free: Index,
    moving: Moving,
    order: int,
    found: Complex,
) -> Complex:
    """Fill in the columns by structure, unbalance and linear effects; return the motion, (row + 1, 2 probe)."""
    base, planes = model.parameters.base, list(moving.planes) if order == 1 else []
    loads = [*planes, *moving.loads(recording, order)]
    rows = len(recording.rows) + 1
    amounts = np.ones((rows, len(loads)), complex)
    if order == 1:
        amounts[:, : len(planes)] = model.amounts(recording, p, halved=moving.halved)
    if not loads:
        motion = np.zeros((rows, len(moving.model.probes)), complex)
    counts = order == 1 or model.units.exact  # else at 2X and 3X only amounts do
    structural = _structural(model, p, free) if counts else free[:0]
    if loads and len(structural):
        directions = model.directions(p, moving.model, structural)
        unit, by = recording.derivatives(moving.model, loads, directions, order=order)
        for k, i in enumerate(structural):
            d = np.einsum("rpl,rl->rp", by[k], amounts)
            found[..., np.searchsorted(free, i)] += model.probes.linear(p, d)
        _by_moved_loads(model, recording, p, free, moving, order, found)
    elif loads:
        unit = recording.columns(moving.model, loads, order=order)
    if loads:
        motion = np.einsum("rpl,rl->rp", unit, amounts)
    if order == 1:
        sought = base.space.planes
        for i in free[(free >= base.unbalance.start) & (free < base.unbalance.stop)]:
            plane, part = divmod(int(i) - base.unbalance.start, 2)
            k = model.planes.index(sought[plane])
            column = unit[..., 2 * k + part] if moving.halved else unit[..., k] * (1j if part else 1)
            found[..., np.searchsorted(free, i)] = model.probes.linear(p, column)
        if model.parameters.keyphasor in free:
            turned = np.stack([1j * trial for trial in model.trials(recording, p).values()], axis=-1)
            turned = halved_amounts(turned) if moving.halved else turned
            d = np.einsum("rpl,rl->rp", unit[..., : len(planes)], turned)
            found[..., np.searchsorted(free, model.parameters.keyphasor)] = model.probes.linear(p, d)
    _by_loads(model, recording, p, free, moving, order, found)
    return motion


def _by_moved_loads(
    model: ExtendedModel, recording: Recording, p: Reals, free: Index, moving: Moving, order: int, found: Complex
) -> None:
    """Add what the base's structure makes of the loads of effects: a bow's are by the shaft's stiffness and spans."""
    now, step = moving.loads(recording, order), EXTENDED_MODEL.structure_step
    changed: list[tuple[int, Load]] = []
    for i in np.intersect1d(free, model.parameters.base.of_shaft) if now else ():
        moved = p.copy()
        moved[i] += step
        changed += [
            (int(i), replace(load, pattern=(there.pattern - load.pattern) / step))
            for load, there in zip(now, model.moving(moved).loads(recording, order), strict=True)
            if not np.array_equal(there.pattern, load.pattern)
        ]
    if not changed:
        return
    z = recording.columns(moving.model, [load for _, load in changed], order=order)
    for k, (i, _) in enumerate(changed):
        found[..., np.searchsorted(free, i)] += model.probes.linear(p, z[..., k])


def _structural(model: ExtendedModel, p: Reals, free: Index) -> Index:
    """Return the unknowns that change matrices: of the base, and of effects."""
    names = model.parameters
    own = [
        i
        for effect, part in zip(model.effects, names.theta, strict=True)
        if by_matrices(effect)
        for i in range(part.start, part.stop)
        if i in free and not model.resized(p, i)
    ]
    return free[(free < names.base.structural.stop) | np.isin(free, own)]


def _by_loads(
    model: ExtendedModel, recording: Recording, p: Reals, free: Index, moving: Moving, order: int, found: Complex
) -> None:
    """Fill in the columns by the loads of linear effects; those of effects on the probes too are differences."""
    names = model.parameters
    mine = [
        i
        for effect, part in zip(model.effects, names.theta, strict=True)
        if effect.linear and "probes" not in effect.acts_on
        for i in range(part.start, part.stop)
        if i in free
    ]
    if not mine:
        return
    units = model.units.of(recording, p, moving.model, order)
    for i in mine:
        found[..., np.searchsorted(free, i)] += model.probes.linear(p, units[..., i - names.own.start])


def _by_probes(model: ExtendedModel, p: Reals, motion: Complex, free: Index, found: Complex) -> None:
    """Fill in the columns by gain and angle error."""
    base = model.parameters.base
    gain, cos, sin = model.probes.figures(p)
    n = len(gain)
    along, across = motion[:, :n], motion[:, n:]
    for part, d in (
        (base.gain, cos * along + sin * across),
        (base.angle, gain * (cos * across - sin * along)),
    ):
        for i in free[(free >= part.start) & (free < part.stop)]:
            k = int(i) - part.start
            found[:, k, np.searchsorted(free, i)] = d[:, k]


def _by_runout(model: ExtendedModel, free: Index, order: int, found: Complex) -> None:
    part = model.parameters.runouts[order]
    for i in free[(free >= part.start) & (free < part.stop)]:
        probe, imaginary = divmod(int(i) - part.start, 2)
        found[:, probe, np.searchsorted(free, i)] = 1j if imaginary else 1.0


def _by_hum(model: ExtendedModel, recording: Recording, p: Reals, free: Index, order: int, found: Complex) -> None:
    """Fill in the columns by the amounts of hum, in which the effects behind it are linear but for a constant."""
    none = np.zeros(found.shape[:2], complex)
    names, leaks = model.parameters, recording.hum[order]
    for i in free[(free >= names.hums.start) & (free < names.hums.stop)]:
        line, imaginary = divmod(int(i) - names.hums.start, 2)
        number, frequency = names.hum_lines[line]
        if number == recording.number and frequency in leaks:
            hum = leaks[frequency] * (1j if imaginary else 1)
            after, before = (model.probes.change_recorded(recording, p, z, order=order) for z in (hum, none))
            found[..., np.searchsorted(free, i)] = after - before


def _by_curvature(model: ExtendedModel, first: Complex, free: Index, order: int, found: Complex) -> None:
    part, curves = model.parameters.curves, model.parameters.probe_curves
    bent = curves.columns(first, order)
    for i in free[(free >= part.start) & (free < part.stop)]:
        found[:, curves.probe[i - part.start], np.searchsorted(free, i)] = bent[:, i - part.start]


def _through_effects(
    model: ExtendedModel, recording: Recording, p: Reals, z: Complex, free: Index, order: int, found: Complex
) -> None:
    """Take columns of what the probes read through the effects behind them; fill in those by these effects."""
    names = model.parameters
    before = model.probes.through_effects(recording, p, z, order=order)
    for k in range(found.shape[-1]):
        if found[..., k].any():  # what an effect does there is linear in the vectors, but for a constant
            found[..., k] = model.probes.through_effects(recording, p, z + found[..., k], order=order) - before
    for effect, part in zip(model.effects, names.theta, strict=True):
        if not on_probes_alone(effect) or effect.recording not in (None, recording.number):
            continue
        for i in free[(free >= part.start) & (free < part.stop)]:
            moved = p.copy()
            moved[i] += EXTENDED_MODEL.step
            there = model.probes.through_effects(recording, moved, z, order=order)
            found[..., np.searchsorted(free, i)] = (there - before) / EXTENDED_MODEL.step

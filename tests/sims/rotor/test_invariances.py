"""What must hold for every rotor, on random ones: turned axes, mirror image, keyphasor, linearity, mesh, reciprocity,
energy. Tolerances are rounding: near a resonance an error of Z comes out as large as its condition number makes it.
"""

import math
from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy import linalg

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.rotor.model.assembly import RotorModel, assemble, hysteretic, matrices, with_bearing
from rotorrig.sims.rotor.steady.harmonic_response import dynamic_stiffness, probe_response, steady_response
from tests.sims.rotor.random_rotors import PLACES, number, rotors, size, turned

OMEGA = np.array([40.0, 130.0, 410.0, 900.0])
ROUNDINGS = 3  # for each of Z's rows: theorem 9.4, of Gaussian elimination
few = settings(max_examples=20)
ANGLES = number(-math.pi, math.pi)


def coarse(rig: RigConfig) -> RotorModel:
    return assemble(rig, max_element=rig.shaft.length / PLACES)


def unbalances(rig: RigConfig) -> dict[str, complex]:
    """One for every disk, all different."""
    return {disk.name: 1e-5 * (i + 1) * np.exp(2j * i) for i, disk in enumerate(rig.disks)}


def scaled_by(amounts: dict[str, complex], factor: complex) -> dict[str, complex]:
    return {name: factor * amount for name, amount in amounts.items()}


def changed_probes(rig: RigConfig, angle_of) -> RigConfig:
    return rig.model_copy(update={"probes": tuple(p.model_copy(update={"angle": angle_of(p)}) for p in rig.probes)})


def with_bearings(model: RotorModel, change) -> RotorModel:
    """Return the model with every bearing's matrices put through `change`."""
    for b in model.bearings:
        model = with_bearing(model, b.name, change(b.K), change(b.C))
    return model


def reversed_(rig: RigConfig) -> RigConfig:
    return rig.model_copy(update={"rotation": "y-to-x" if rig.rotation == "x-to-y" else "x-to-y"})


def assert_same(got: NDArray[np.complex128], want: NDArray[np.complex128], *, within: float | NDArray) -> None:
    """Neither may differ by more than `within` [m], a number or one for every speed and probe."""
    assert np.all(np.abs(got - want) <= within)


def rounding(model: RotorModel, q: NDArray[np.complex128], *, order: float = 1.0) -> NDArray[np.float64]:
    """Return how far rounding may take every coordinate of the response q at OMEGA, (speed, dof) m.

    |dq| <= 3 n eps |Z^-1| E |q|, n the rows of Z, E the magnitudes that it is made of before they cancel: Higham,
    Accuracy and Stability of Numerical Algorithms (2002), theorems 7.4 and 9.4, for a Z that elimination does not make
    grow. A bearing's are all as its largest, as turned axes mix them.
    """
    M, C, G, K = (np.abs(A) for A in matrices(replace(model, bearings=())))
    speed = np.abs(OMEGA)[:, None, None]
    E = K + np.abs(hysteretic(model)) + np.abs(order) * speed * (C + speed * G) + (order * speed) ** 2 * M
    for b in model.bearings:
        size = np.abs(b.K).max() + np.abs(order) * speed * np.abs(b.C).max()
        E = E + size * (np.abs(b.rows).T @ np.ones((2, 2)) @ np.abs(b.rows))
    inverse = np.abs(np.linalg.inv(dynamic_stiffness(model, OMEGA, order=order)))
    return ROUNDINGS * len(M) * np.finfo(float).eps * (inverse @ E @ np.abs(q)[..., None])[..., 0]


def seen_rounding(model: RotorModel, unbalance: dict[str, complex]) -> NDArray[np.float64]:
    """Return how far rounding may take what the probes see of the response, (speed, probe) m."""
    return rounding(model, steady_response(model, OMEGA, unbalance=unbalance)) @ np.abs(model.probes.T)


@few
@given(rotors(), ANGLES)
def test_turning_bearings_probes_and_unbalance_together_changes_nothing(rig, angle):
    want = probe_response(coarse(rig), OMEGA, unbalance=unbalances(rig))
    sense = 1 if rig.rotation == "x-to-y" else -1  # an unbalance's angle counts in the sense of rotation
    model = with_bearings(coarse(changed_probes(rig, lambda p: p.angle + angle)), lambda A: turned(A, angle))
    got = probe_response(model, OMEGA, unbalance=scaled_by(unbalances(rig), np.exp(1j * sense * angle)))
    assert_same(got, want, within=seen_rounding(coarse(rig), unbalances(rig)))


@few
@given(rotors())
def test_the_mirror_image_turning_backwards_answers_alike(rig):
    want = probe_response(coarse(rig), OMEGA, unbalance=unbalances(rig))
    mirror = np.diag([1.0, -1.0])
    mirrored = with_bearings(coarse(reversed_(changed_probes(rig, lambda p: -p.angle))), lambda A: mirror @ A @ mirror)
    got = probe_response(mirrored, OMEGA, unbalance=unbalances(rig))
    assert_same(got, want, within=seen_rounding(coarse(rig), unbalances(rig)))


@few
@given(rotors(), ANGLES)
def test_moving_the_keyphasor_mark_back_adds_the_angle_to_every_phase(rig, angle):
    """It passes later: theta is smaller by the angle, and every heavy spot that much further from the mark."""
    model, amounts = coarse(rig), unbalances(rig)
    further = {name: amount * np.exp(1j * angle) for name, amount in amounts.items()}
    z, moved = (probe_response(model, OMEGA, unbalance=u) for u in (amounts, further))
    theta = 1.234
    later, before = (moved * np.exp(1j * (theta - angle))).real, (z * np.exp(1j * theta)).real
    assert_same(later, before, within=seen_rounding(model, amounts))


@few
@given(rotors(), size(1e-3, 1e3))
def test_the_response_is_proportional_to_the_unbalance(rig, factor):
    model, amounts = coarse(rig), unbalances(rig)
    want = factor * probe_response(model, OMEGA, unbalance=amounts)
    got = probe_response(model, OMEGA, unbalance=scaled_by(amounts, factor))
    assert_same(got, want, within=factor * seen_rounding(model, amounts))


@few
@given(rotors())
def test_the_unbalances_of_several_disks_add(rig):
    model, amounts = coarse(rig), unbalances(rig)
    alone = [{name: amount} for name, amount in amounts.items()]
    got = np.sum([probe_response(model, OMEGA, unbalance=one) for one in alone], axis=0)
    within = np.sum([seen_rounding(model, one) for one in alone], axis=0)
    assert_same(got, probe_response(model, OMEGA, unbalance=amounts), within=within)


@few
@given(rotors(), number(0.03, 0.97))
def test_a_node_more_changes_nothing_at_rest(rig, where):
    """The element's shape functions are exact for static loads at its ends."""
    table = rig.model_dump() | {"planes": [{"name": "node", "position": where * rig.shaft.length}]}
    split = coarse(RigConfig.model_validate(table, context={"si": True}))
    force = {rig.disks[0].name: (1.0, 0.3j)}
    want = probe_response(coarse(rig), 0.0, force=force, order=0.0)
    lost = np.finfo(float).eps * np.linalg.cond(matrices(split, 0.0).K)  # seen: 3 % of this, at most
    got = probe_response(split, 0.0, force=force, order=0.0)
    assert_same(got, want, within=min(max(1e-6, 0.1 * lost), 1e-5) * np.abs(want).max())


@few
@given(rotors())
def test_splitting_every_element_lowers_natural_frequencies_if_anything(rig):
    """Rayleigh and Ritz: a finer mesh holds every motion of a coarser one, so undamped frequencies can only fall."""
    coarser, finer = (undamped(assemble(rig, max_element=rig.shaft.length / pieces)) for pieces in (PLACES, 2 * PLACES))
    assert np.all(finer <= coarser * (1 + 1e-6))
    assert np.all(finer >= coarser * 0.99)


def undamped(model: RotorModel) -> NDArray[np.float64]:
    """Return the lowest natural frequencies at rest without damping and circulating stiffness, rad/s."""
    M, _, _, K = matrices(model)
    periods = linalg.eigh(M, (K + K.T) / 2, eigvals_only=True, subset_by_index=[model.dof - 6, model.dof - 1])
    return periods[::-1] ** -0.5  # of M against K, so that rounding is a part of the lowest and not of the highest


@few
@given(rotors(), st.sampled_from([1.0, -1.0, 2.0]))
def test_receptances_are_reciprocal_for_the_reversed_rotation_and_transposed_bearings(rig, order):
    """H_ij(Omega, K, C) = H_ji(-Omega, K^T, C^T): the gyroscopic matrix is skew, all else of the shaft symmetric."""
    model, back = coarse(rig), with_bearings(coarse(reversed_(rig)), np.transpose)
    ends = np.zeros((model.dof, 2))
    ends[0, 0] = ends[-3, 1] = 1  # x of the first node, y of the last
    got, within = receptances(model, ends, order)
    other, within_other = receptances(back, ends, order)
    assert_same(got, np.swapaxes(other, 1, 2), within=within + np.swapaxes(within_other, 1, 2))


def receptances(
    model: RotorModel, ends: NDArray[np.float64], order: float
) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
    """Return those between some coordinates at OMEGA and how far rounding may take them, (speed, to, from) m/N."""
    Z = dynamic_stiffness(model, OMEGA, order=order)
    q = np.linalg.solve(Z, np.broadcast_to(ends, (len(OMEGA), *ends.shape)))
    within = np.stack([rounding(model, q[..., i], order=order) for i in range(ends.shape[1])], axis=-1)
    return ends.T @ q, ends.T @ within


@few
@given(rotors())
def test_the_work_of_the_unbalance_is_what_bearings_and_shaft_take(rig):
    """Mean power: in, Re (j Omega q)^H F / 2; taken, Re (j Omega q)^H (K + j Omega C) q / 2 by the bearings, and the
    shaft's own losses. Circulating cross stiffness may give power; gyroscopic forces do no work."""
    model = coarse(rig)
    q = steady_response(model, OMEGA, unbalance=unbalances(rig))
    bare = replace(model, bearings=())
    C = matrices(bare).C
    for speed, motion in zip(OMEGA, q, strict=True):
        velocity = 1j * speed * motion
        force = dynamic_stiffness(model, speed)[0] @ motion
        given_power = _mean(velocity, force)
        taken = _mean(velocity, C @ velocity) + _mean(velocity, 1j * hysteretic(model) @ motion)
        scale = abs(taken)
        for bearing in model.bearings:
            journal = bearing.rows @ motion
            share = _mean(1j * speed * journal, (bearing.K + 1j * speed * bearing.C) @ journal)
            taken += share
            scale += abs(share)
        assert abs(given_power - taken) <= 1e-6 * scale


def _mean(velocity: NDArray[np.complex128], force: NDArray[np.complex128]) -> float:
    return float(np.vdot(velocity, force).real / 2)

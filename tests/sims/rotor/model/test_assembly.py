"""The assembled model: mesh, invariances, and changes without a new assembly."""

import math

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.rotor.model.assembly import assemble, matrices, scale_properties, with_bearing
from rotorrig.sims.rotor.steady.harmonic_response import dynamic_stiffness, probe_response

OMEGA = np.linspace(50, 380, 12)


def changed(rig: RigConfig, part: str, **update: object) -> RigConfig:
    """Return the rig with every disk, bearing or probe updated; a callable value is given the part."""
    parts = tuple(
        p.model_copy(update={k: v(p) if callable(v) else v for k, v in update.items()}) for p in getattr(rig, part)
    )
    return rig.model_copy(update={part: parts})


@pytest.fixture(scope="module")
def skewed(rk4) -> RigConfig:
    """The RK4 with cross coefficients and oblique probes, so that every sign matters."""
    rig = changed(rk4, "bearings", kxy=3e3, kyx=-1e3, cxy=2.0, cyx=1.0)
    return changed(rig, "probes", angle=lambda p: p.angle + 0.3)


def test_every_part_and_both_ends_have_a_node(rk4, full):
    wanted = {0.0, 0.56, *(p.position for p in (*rk4.bearings, *rk4.disks, *rk4.probes))}
    assert all(np.abs(full.z - place).min() < 1e-12 for place in wanted)
    assert np.diff(full.z).max() <= 0.02 + 1e-12


def test_parts_at_the_same_place_share_a_node(rk4):
    near = changed(rk4, "probes", position=lambda p: 0.2805 + 1e-9)
    assert np.diff(assemble(near).z).min() > 1e-3


def test_a_span_of_whole_elements_is_not_divided_further(rk4):
    between = (z := assemble(rk4).z)[(z > 0.2805 - 1e-9) & (z < 0.3805 + 1e-9)]
    np.testing.assert_allclose(between, 0.2805 + 0.02 * np.arange(6))


def test_the_matrices_hold_the_whole_mass(rk4, full):
    shift = np.zeros(full.dof)
    shift[0::4] = 1
    shaft = 7801 * np.pi / 4 * 0.01**2 * 0.56
    assert shift @ matrices(full).M @ shift == pytest.approx(shaft + 0.809)
    assert full.weight[0] @ shift == pytest.approx(shaft)


def test_turning_bearings_probes_and_unbalance_by_90_degrees_changes_nothing(skewed):
    def turn(rig):
        rig = changed(
            rig,
            "bearings",
            **{
                f"{k}{to}": lambda b, k=k, of=of, sign=sign: sign * getattr(b, k + of)
                for k in "kc"
                for to, of, sign in (("xx", "yy", 1), ("yy", "xx", 1), ("xy", "yx", -1), ("yx", "xy", -1))
            },
        )
        return changed(rig, "probes", angle=lambda p: p.angle + math.pi / 2)

    before = probe_response(assemble(skewed), OMEGA, unbalance={"disk": 1e-5})
    after = probe_response(assemble(turn(skewed)), OMEGA, unbalance={"disk": 1e-5j})
    np.testing.assert_allclose(after, before, rtol=1e-9)


def test_the_mirror_image_turning_backwards_answers_alike(skewed):
    mirrored = changed(skewed, "bearings", kxy=-3e3, kyx=1e3, cxy=-2.0, cyx=-1.0)
    mirrored = changed(mirrored, "probes", angle=lambda p: -p.angle).model_copy(update={"rotation": "y-to-x"})
    unbalance = {"disk": 1e-5 * np.exp(0.5j)}  # in the sense of rotation, so the same number
    want = probe_response(assemble(skewed), OMEGA, unbalance=unbalance)
    np.testing.assert_allclose(probe_response(assemble(mirrored), OMEGA, unbalance=unbalance), want, rtol=1e-9)


def test_twice_the_unbalance_is_twice_the_response(full):
    once = probe_response(full, OMEGA, unbalance={"disk": 1e-5j})
    np.testing.assert_allclose(probe_response(full, OMEGA, unbalance={"disk": 2e-5j}), 2 * once, rtol=1e-12)


@pytest.mark.parametrize(("element", "worst"), [("timoshenko", 1e-5), ("lumped", 2e-2)])
def test_splitting_every_element_hardly_changes_the_response(rk4, full, element, worst):
    coarse, fine = (
        probe_response(assemble(rk4, element=element, max_element=size), OMEGA, unbalance={"disk": 1e-5})
        for size in (0.02, 0.01)
    )
    assert 0 < np.abs(fine - coarse).max() < worst * np.abs(fine).max()


def test_receptances_are_reciprocal_when_the_rotation_is_reversed_and_only_then(rk4):
    forward, backward = (
        np.linalg.inv(dynamic_stiffness(assemble(rk4.model_copy(update={"rotation": sense})), 300.0)[0])
        for sense in ("x-to-y", "y-to-x")
    )
    np.testing.assert_allclose(forward, backward.T, atol=1e-9 * np.abs(forward).max())
    assert np.abs(forward - forward.T).max() > 1e-4 * np.abs(forward).max()


def test_with_bearing_is_the_assembly_of_the_changed_config(rk4, full):
    other = changed(rk4, "bearings", kxx=5e4, kyy=6e4, kxy=1e3, cxx=3.0, cyy=4.0)
    got = with_bearing(full, ("left A", "left B", "spring"), [[5e4, 1e3], [0, 6e4]], [[3.0, 0], [0, 4.0]])
    for mine, theirs in zip(matrices(got), matrices(assemble(other)), strict=True):
        np.testing.assert_array_equal(mine, theirs)


def test_scaling_is_the_assembly_of_the_scaled_config(rk4, full):
    shaft = rk4.shaft.model_copy(update={"youngs_modulus": 1.03 * 208.11e9, "density": 1.1 * 7801})
    other = rk4.model_copy(update={"shaft": shaft})
    for key in ("mass", "polar_inertia", "transverse_inertia"):
        other = changed(other, "disks", **{key: lambda d, key=key: 0.98 * getattr(d, key)})
    got, want = scale_properties(full, youngs_modulus=1.03, density=1.1, disk_mass=0.98), assemble(other)
    for mine, theirs in zip(matrices(got), matrices(want), strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(got.weight, want.weight, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda rig, model: assemble(rig, element="solid"), "element is 'solid', want 'timoshenko' or 'lumped'"),
        (lambda rig, model: assemble(rig, max_element=0.0), "max_element is 0 m"),
        (lambda rig, model: with_bearing(model, "sprung", np.eye(2), np.eye(2)), r"no bearing 'sprung', want one of"),
        (lambda rig, model: with_bearing(model, "spring", 1.0, np.eye(2)), r"K has shape \(\), want \(2, 2\)"),
        (lambda rig, model: probe_response(model, 1.0, unbalance={"disc": 1.0}), r"no disk 'disc', want one of"),
    ],
)
def test_a_wrong_argument_is_named(rk4, full, call, message):
    with pytest.raises(ValueError, match=message):
        call(rk4, full)

"""A rotor that turns backwards: solved at a negative speed, and seen in a mirror."""

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.effects.base import find
from rotorrig.sims.rotor.model.assembly import Added, RotorModel, assemble, with_added, with_bearing, with_geometry
from rotorrig.sims.rotor.model.derivatives import along_bearing, along_position
from rotorrig.sims.rotor.model.loads import Load, unbalance_loads
from rotorrig.sims.rotor.model.reversal import reverse_direction, reverse_load, reverse_rotor
from rotorrig.sims.rotor.steady.derivatives import steady_derivatives
from rotorrig.sims.rotor.steady.harmonic_response import load_columns

OMEGA = np.array([60.0, 180.0, 233.0, 260.0, 390.0])  # rad/s, through the first critical speeds
U = 9e-6 * np.exp(0.7j)  # kg m
K, C = np.array([[33e3, 4e3], [4e3, 37e3]]), np.array([[14.0, 3.0], [3.0, 18.0]])  # fixed to the ground: symmetric


def turning(rig: RigConfig, *effects: tuple[str, dict[str, float]]) -> RotorModel:
    model = with_bearing(assemble(rig), "spring", K, C)
    for label, theta in effects:
        model = find(rig, label).change_matrices(model, theta)
    return model


def unbalanced(model: RotorModel, phasor: complex = U) -> Load:
    (unit,) = unbalance_loads(model, ["disk"])
    return Load(phasor * unit.pattern, "unbalance")


def backwards(model: RotorModel, load: Load, order: int = 1) -> NDArray[np.complex128]:
    """What is measured, x = Re(z e^{j n |theta|})."""
    return load_columns(reverse_rotor(model), OMEGA, [reverse_load(load)])[..., 0]


@pytest.mark.parametrize(
    "effects",
    [
        (),
        (("internal_damping", {"beta": 4e-5}),),
        (("pedestal, x", {"lightness": 0.2, "omega": 200.0, "damping ratio": 0.03}),),
        (("shaft_asymmetry", {"asymmetry re": 0.03, "asymmetry im": 0.02}),),
    ],
    ids=["bare", "internal damping", "pedestal", "asymmetric shaft"],
)
def test_it_is_the_solution_at_the_negative_speed(rig_config: RigConfig, effects: tuple) -> None:
    """x = Re(Q e^{j theta}) with theta = -|theta|, so what is measured is conj(Q)."""
    model = turning(rig_config, *effects)
    direct = load_columns(model, -OMEGA, [unbalanced(model)])[..., 0]
    np.testing.assert_allclose(backwards(model, unbalanced(model)), direct.conj(), rtol=1e-9)


def test_in_a_mirror_it_turns_forwards(rig_config: RigConfig) -> None:
    """y to -y: springs aslant lean the other way, and all that follows the sense of rotation is as it was."""
    mirrored = np.diag([1, -1])
    model = turning(rig_config, ("internal_damping", {"beta": 4e-5}), ("skew_stiffness", {"k": 2e3}))
    seen = with_bearing(assemble(rig_config), "spring", mirrored @ K @ mirrored, mirrored @ C @ mirrored)
    for label, theta in (("internal_damping", {"beta": 4e-5}), ("skew_stiffness", {"k": 2e3})):
        seen = find(rig_config, label).change_matrices(seen, theta)
    forwards = load_columns(seen, OMEGA, [unbalanced(seen, np.conj(U))])[..., 0]
    along_y = np.array([np.sin(probe.angle) for probe in rig_config.probes])
    sign = np.where(np.abs(along_y) > 0.5, -1, 1)  # the probes stand along x or y
    np.testing.assert_allclose(backwards(model, unbalanced(model)), sign * forwards, rtol=1e-9)


def test_skew_stiffness_drives_forward_whirl_either_way_round(rig_config: RigConfig) -> None:
    """The rig of the other sense of rotation in its config: the effect says itself which way it pushes."""
    other = rig_config.model_copy(update={"rotation": "y-to-x"})
    model, way_back = (turning(rig, ("skew_stiffness", {"k": 3e3})) for rig in (rig_config, other))
    want = load_columns(way_back, OMEGA, [unbalanced(way_back, np.conj(U))])[..., 0]
    np.testing.assert_allclose(backwards(model, unbalanced(model)), want, rtol=1e-9)


def test_turned_back_twice_it_is_itself(rig_config: RigConfig) -> None:
    model = turning(rig_config, ("shaft_asymmetry", {"asymmetry re": 0.03, "asymmetry im": 0.02}))
    load = unbalanced(model)
    again = load_columns(reverse_rotor(reverse_rotor(model)), OMEGA, [reverse_load(reverse_load(load))])
    np.testing.assert_array_equal(again, load_columns(model, OMEGA, [load]))


def test_its_derivatives_are_those_of_the_reversed_rotor(rig_config: RigConfig) -> None:
    model = turning(rig_config, ("internal_damping", {"beta": 4e-5}))
    skew = np.array([[0.0, 1.0], [-1.0, 0.0]])
    direction = along_bearing(model, "spring", K=skew + np.eye(2))
    load = reverse_load(unbalanced(model))
    found = steady_derivatives(reverse_rotor(model), OMEGA, loads=[load], directions=[reverse_direction(direction)])
    step = 1.0  # N/m
    moved = with_added(model, Added(K=step * direction.K))
    before = load_columns(reverse_rotor(model), OMEGA, [load])
    after = load_columns(reverse_rotor(moved), OMEGA, [load])
    np.testing.assert_allclose(found.by[0], (after - before) / step, rtol=2e-3, atol=1e-13)


def test_so_are_those_by_the_position_of_a_disk_and_of_a_probe(rig_config: RigConfig) -> None:
    model = turning(rig_config, ("internal_damping", {"beta": 4e-5}))
    load, step = reverse_load(unbalanced(model)), 2e-6  # m
    for part in ("disk disk", "probe 1x"):
        direction = reverse_direction(along_position(model, part))
        found = steady_derivatives(reverse_rotor(model), OMEGA, loads=[load], directions=[direction])
        after, before = (
            load_columns(reverse_rotor(with_geometry(model, positions={part: p})), OMEGA, [load]) for p in (step, -step)
        )
        want = (after - before) / (2 * step)
        # a probe at a node: the shear of the elements on either side differs by the inertia of half of both
        np.testing.assert_allclose(found.by[0], want, atol=(5e-5 if "probe" in part else 1e-5) * np.abs(want).max())

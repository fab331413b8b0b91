"""What is added to the matrices and coordinates, where the same rotor can be had in another way."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.sims.rotor.model.assembly import (
    Added,
    matrices,
    speed_stiffness,
    with_added,
    with_bearing,
    with_coordinates,
)
from rotorrig.sims.rotor.model.derivatives import Direction
from rotorrig.sims.rotor.model.loads import bow_force
from rotorrig.sims.rotor.model.reduction import reduce
from rotorrig.sims.rotor.modes.campbell import stability_onset
from rotorrig.sims.rotor.modes.modes import critical_speeds, whirl_modes
from rotorrig.sims.rotor.steady.derivatives import steady_derivatives
from rotorrig.sims.rotor.steady.harmonic_response import dynamic_stiffness, probe_response
from rotorrig.sims.rotor.steady.receptance import condense
from rotorrig.sims.rotor.swept.swept_response import swept_columns, swept_derivatives
from rotorrig.sims.rotor.swept.tracking_windows import tracked_rows
from tests.sims.rotor.collocation import RPM, Ramp

OMEGA = np.linspace(50, 380, 12)
U = {"disk": 1e-5}


def at_spring(model, value) -> np.ndarray:
    """Return a (2, 2) matrix at the spring bearing, (dof, dof)."""
    rows = model.bearing("spring").rows
    return rows.T @ np.asarray(value) @ rows


def on_pedestal(model, *, mass: float, stiffness: float):
    """Return the model with the spring bearing on a mass of its own."""
    larger = with_coordinates(model, 2)
    bearings = tuple(replace(b, rows=b.rows - larger.appended) if b.name == "spring" else b for b in larger.bearings)
    unit = larger.appended.T @ larger.appended
    return with_added(replace(larger, bearings=bearings), Added(M=mass * unit, K=stiffness * unit))


def test_stiffness_and_damping_added_at_a_bearing_are_that_bearings(small):
    k, c = np.array([[5e3, 800.0], [-200.0, 9e3]]), np.array([[3.0, 0.5], [0.1, 2.0]])
    spring = small.bearing("spring")
    want = with_bearing(small, "spring", spring.K + k, spring.C + c)
    got = with_added(with_added(small, Added(K=at_spring(small, k))), Added(C=at_spring(small, c)))
    np.testing.assert_allclose(
        probe_response(got, OMEGA, unbalance=U), probe_response(want, OMEGA, unbalance=U), rtol=1e-9
    )
    assert critical_speeds(got, up_to=400) == pytest.approx(critical_speeds(want, up_to=400), rel=1e-9)


@pytest.mark.parametrize("order", [1, -1, 2])
def test_every_part_enters_the_dynamic_stiffness_at_its_power_of_the_speed(small, rng, order):
    omega, (M, C, G, K, H, S, loss) = 120.0, rng.normal(size=(7, small.dof, small.dof))
    added = with_added(small, Added(M, C, G, K + 1j * loss, H, S))
    got = dynamic_stiffness(added, omega, order=order)[0] - dynamic_stiffness(small, omega, order=order)[0]
    w = order * omega
    want = K + 1j * np.sign(order) * loss + omega * H + omega**2 * S - w**2 * M + 1j * w * (C + omega * G)
    np.testing.assert_allclose(got, want, atol=1e-4)


def test_an_added_loss_factor_of_the_shaft_is_structural_damping(small):
    want = replace(small, structural_damping=0.02)
    got = with_added(small, Added(K=0.02j * small.shaft.K))
    for order in (1, -1):
        np.testing.assert_allclose(
            probe_response(got, OMEGA, unbalance=U, order=order),
            probe_response(want, OMEGA, unbalance=U, order=order),
            rtol=1e-9,
        )
    a, b = ([mode.eigenvalue for mode in whirl_modes(model, 200.0)] for model in (got, want))
    np.testing.assert_allclose(a, b, rtol=1e-9)


def test_internal_damping_is_a_cross_coupling_that_grows_with_speed_and_ends_in_whirl(small):
    """c_i (u' - Omega J u) at the spring of a symmetric rotor, c_e outside: unstable beyond w (1 + c_e / c_i).

    Friswell et al. (2010), section 7.3; w, the forward mode, by its own frequency at the onset.
    """
    c_i, c_e = 8.0, 4.0
    model = with_bearing(small, "spring", np.eye(2) * 34e3, np.eye(2) * c_e)
    for name in ("left A", "left B"):
        model = with_bearing(model, name, np.eye(2) * model.bearing(name).K[0, 0], np.zeros((2, 2)))
    J = np.array([[0, -1.0], [1, 0]])
    whirling = with_added(model, Added(C=at_spring(model, c_i * np.eye(2)), H=at_spring(model, -c_i * J)))
    onset = stability_onset(whirling, up_to=500)
    assert stability_onset(model, up_to=500) is None
    assert onset.omega == pytest.approx(onset.frequency * (1 + c_e / c_i), rel=1e-4)


def test_a_very_stiff_pedestal_is_none(small):
    got = on_pedestal(small, mass=1.0, stiffness=1e13)
    np.testing.assert_allclose(
        probe_response(got, OMEGA, unbalance=U), probe_response(small, OMEGA, unbalance=U), rtol=1e-6
    )


def test_a_pedestal_without_mass_is_a_softer_bearing(small):
    undamped, k, kp = np.zeros((2, 2)), 34e3, 80e3
    model = with_bearing(small, "spring", np.eye(2) * k, undamped)
    want = with_bearing(small, "spring", np.eye(2) * k * kp / (k + kp), undamped)
    got = on_pedestal(model, mass=1e-9, stiffness=kp)
    np.testing.assert_allclose(
        probe_response(got, OMEGA, unbalance=U), probe_response(want, OMEGA, unbalance=U), rtol=1e-6
    )


def test_a_bow_of_a_shaft_on_a_pedestal_still_loads_no_bearing(small):
    model = on_pedestal(small, mass=0.5, stiffness=2e5)
    q = np.linalg.solve(matrices(model).K.astype(complex), bow_force(model, "disk"))
    np.testing.assert_allclose(np.abs(model.appended @ q), 0, atol=1e-7)
    assert model.disk("disk").rows[0] @ q == pytest.approx(1, rel=1e-6)


def test_a_reduced_model_keeps_what_was_added(full):
    model = on_pedestal(full, mass=1.5, stiffness=1e5)
    k = np.array([[0, 4.0], [-4.0, 0]])
    model = with_added(model, Added(K=at_spring(model, 50 * k), H=at_spring(model, k), S=at_spring(model, 1e-2 * k)))
    want, got = (probe_response(m, OMEGA, unbalance=U) for m in (model, reduce(model)))
    assert np.abs(got - want).max() < 1e-6 * np.abs(want).max()


def test_receptances_keep_it_too(small):
    k = np.array([[0, 4.0], [-4.0, 0]])
    model = with_added(small, Added(C=at_spring(small, np.eye(2)), H=at_spring(small, k), S=at_spring(small, 1e-2 * k)))
    model = with_bearing(model, "left A", np.eye(2) * 2e6, np.zeros((2, 2)))
    got = condense(model, OMEGA, bearings=["left A"], disk="disk").response(2e6, 2e6, 0.0, 0.0, 1e-5)
    want = probe_response(model, OMEGA, unbalance=U)
    np.testing.assert_allclose(got, want, atol=1e-9 * np.abs(want).max())


@pytest.mark.parametrize(("order", "start"), [(1, 1800), (2, 900)])
def test_derivatives_along_added_matrices_are_the_limit_of_differences(small, order, start):
    """Swept and steady, along all seven at once."""
    k = np.array([[1.0, 0.4], [-0.3, 0.7]])
    unit = at_spring(small, k)
    rest = {"H": 10 * unit, "S": 0.05 * unit, "T": (200 - 90j) * unit}
    direction = Direction(M=0.1 * unit, C=5 * unit, G=0.02 * unit, K=1e3 * unit, **rest)

    def changed(p: float):
        return with_added(small, Added(*(p * A for A in direction[:7])))

    ramp = Ramp(start * RPM, 60 * RPM, 16.0)
    rows = tracked_rows(ramp.timeline, t=ramp.rows, revolutions=8, window="hann")
    step = 1e-4
    model, asked = changed(1.0), {"unbalance": ["disk"], "order": order}
    got = swept_derivatives(model, rows, directions=[direction], **asked).by[0]
    up, down = (swept_columns(changed(1 + p), rows, **asked) for p in (step, -step))
    want = (up - down) / (2 * step)
    assert np.abs(got - want).max() < 1e-4 * np.abs(want).max()
    got = steady_derivatives(model, OMEGA, directions=[direction], **asked).by[0, ..., 0]
    up, down = (probe_response(changed(1 + p), OMEGA, unbalance={"disk": 1}, order=order) for p in (step, -step))
    want = (up - down) / (2 * step)
    assert np.abs(got - want).max() < 1e-5 * np.abs(want).max()


def test_another_shape_is_refused(small):
    with pytest.raises(ValueError, match=r"added K has shape \(2, 2\), want \(dof, dof\)"):
        with_added(small, Added(K=np.eye(2)))


def test_nothing_added_is_nothing(small):
    got = with_added(small, Added())
    np.testing.assert_array_equal(matrices(got).K, matrices(small).K)
    assert not np.any(speed_stiffness(got))

"""The condensed response is that of the whole model, candidate by candidate; its derivatives those of eq. (11).

Derivatives are checked by complex step on the real form of eq. (11), of size 2 dof, whose matrices take a complex
increment of any coefficient: exact to rounding, and it shares nothing with the code under test.
"""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.rig.config.description import from_si
from rotorrig.rig.errors import ConfigError, DataError
from rotorrig.sims.rotor.model.assembly import assemble, matrices, with_bearing
from rotorrig.sims.rotor.model.disk import unbalance_direction
from rotorrig.sims.rotor.steady.harmonic_response import probe_response
from rotorrig.sims.rotor.steady.receptance import condense, condense_groups

OMEGA = np.linspace(50, 380, 60)  # through the critical speed
STEP = 1e-200


def directly(model, bearings, k, c, u):
    return probe_response(with_bearing(model, bearings, np.diag(k), np.diag(c)), OMEGA, unbalance={"disk": u})


@pytest.fixture
def population():
    rng = np.random.default_rng(5)
    k, c = 10 ** rng.uniform(2, 7, (2, 40)), 10 ** rng.uniform(0, 3, (2, 40))
    return k, c, 1e-5 * np.exp(2j * np.pi * rng.uniform(size=40))


@pytest.mark.parametrize("bearings", [["spring"], ["left A", "spring"], ["left A", "left B", "spring"]])
def test_a_population_is_answered_as_one_by_one(small, population, bearings):
    k, c, u = population
    got = condense(small, OMEGA, bearings=bearings, disk="disk").response(*k, *c, u)
    assert got.shape == (40, 60, 4)
    for i in range(40):
        want = directly(small, bearings, k[:, i], c[:, i], u[i])
        assert np.abs(got[i] - want).max() < 1e-9 * np.abs(want).max()


def test_the_whole_model_may_be_condensed_too(full):
    got = condense(full, OMEGA, bearings=["spring"], disk="disk").response(33.9e3, 34.6e3, 15.0, 15.0, 15e-6)
    want = probe_response(full, OMEGA, unbalance={"disk": 15e-6})
    assert got.shape == (60, 4)
    assert np.abs(got - want).max() < 1e-9 * np.abs(want).max()


def test_a_fine_mesh_is_condensed_by_its_band(rk4):
    model = assemble(rk4, max_element=0.005)
    got = condense(model, OMEGA[::10], bearings=["spring"], disk="disk").response(33.9e3, 34.6e3, 15.0, 15.0, 15e-6)
    want = probe_response(model, OMEGA[::10], unbalance={"disk": 15e-6})
    assert np.abs(got - want).max() < 1e-9 * np.abs(want).max()


def test_what_is_not_condensed_may_be_damped_and_change_with_speed(rk4):
    table = {"speed": ["0 rpm", "3600 rpm"], "value": ["1e6 N/m", "3e6 N/m"]}
    data = rk4.model_dump(exclude_unset=True, exclude_none=True)
    data["shaft"] |= {"structural_damping": 0.01}
    data["bearings"] = [b for b in data["bearings"] if b["name"] != "left A"]
    rig = from_si(data)
    changing = type(rk4.bearings[0]).model_validate({"name": "left A", "position": "65 mm", "kxx": table, "kyy": table})
    model = assemble(rig.model_copy(update={"bearings": (changing, *rig.bearings)}))
    for i in range(2):
        k, c = [3e4, 5e4][i], [10.0, 20.0][i]
        got = condense(model, OMEGA, bearings=["spring"], disk="disk").response(k, k, c, c, 1e-5)
        want = directly(model, ["spring"], [k, k], [c, c], 1e-5)
        assert np.abs(got - want).max() < 1e-9 * np.abs(want).max()


def test_any_argument_may_be_the_one_that_varies(small):
    receptance = condense(small, OMEGA, bearings=["spring"], disk="disk")
    one = receptance.response(3e4, 4e4, 10.0, 20.0, 1e-5)
    amounts = receptance.response(3e4, 4e4, 10.0, 20.0, np.array([1e-5, 2e-5]))
    np.testing.assert_allclose(amounts, [one, 2 * one])
    grid = receptance.response(np.array([[3e4], [5e4]]), 4e4, 10.0, 20.0, np.array([1e-5, 2e-5, 3e-5]))
    assert grid.shape == (2, 3, 60, 4)
    np.testing.assert_allclose(grid[0, 2], 3 * one)


def test_answers_do_not_wear_out(small):
    receptance = condense(small, OMEGA, bearings=["left A", "spring"], disk="disk")
    first = receptance.response(3e4, 4e4, 10.0, 20.0, 1e-5)
    receptance.response(np.array([1e2, 1e6]), 1e3, 1.0, 2.0, 1e-6)
    np.testing.assert_array_equal(receptance.response(3e4, 4e4, 10.0, 20.0, 1e-5), first)


OBJECTIVES = {  # the chapter's eq. (14) to (16), um for f1 and f3
    "f1": lambda a, b: np.nansum(((a - b) * 1e6) ** 2, axis=(-2, -1)),
    "f2": lambda a, b: np.nansum(np.abs(np.log10(a) - np.log10(b)), axis=(-2, -1)),
    "f3": lambda a, b: np.nansum(np.abs(a - b) * 1e6, axis=(-2, -1)),
}


@pytest.mark.parametrize("slow_roll", [False, True])
@pytest.mark.parametrize("objective", ["f1", "f2", "f3"])
def test_the_misfit_is_the_objective_of_the_amplitudes(small, population, objective, slow_roll):
    k, c, u = population
    receptance = condense(small, OMEGA, bearings=["left A", "spring"], disk="disk")
    z = receptance.response(*k, *c, u)
    predicted = np.abs(z[:, :-1] - z[:, -1:]) if slow_roll else np.abs(z)
    measured = predicted[0] * np.random.default_rng(1).uniform(0.8, 1.2, predicted[0].shape)
    measured[3, 1] = measured[7] = np.nan  # not usable
    got = receptance.misfit(measured, *k, *c, u, objective=objective, slow_roll=slow_roll)
    np.testing.assert_allclose(got, OBJECTIVES[objective](measured, predicted), rtol=1e-12)


def test_a_misfit_of_the_truth_is_nothing_and_of_no_motion_is_infinite(small):
    receptance = condense(small, OMEGA, bearings=["spring"], disk="disk")
    measured = np.abs(receptance.response(3e4, 4e4, 10.0, 20.0, 1e-5))
    got = receptance.misfit(measured, 3e4, 4e4, 10.0, 20.0, [1e-5, 1e-4, 0.0], objective="f2")
    assert got[0] < 1e-12
    assert got[1] == pytest.approx(measured.size)  # a decade off everywhere
    assert np.isinf(got[2])


@pytest.fixture(scope="module")
def two_disks():
    """A hollow shaft with two disks, three bearings and a forward force at a probe."""
    names = ("a", "b", "c")
    disk = {"mass": 0.8, "polar_inertia": 6e-4, "transverse_inertia": 4e-4}
    return assemble(
        from_si(
            {
                "name": "two disks",
                "shaft": {
                    "length": 0.6,
                    "diameter": 0.012,
                    "inner_diameter": 0.004,
                    "density": 7800.0,
                    "youngs_modulus": 2e11,
                },
                "disks": [{"name": "1", "position": 0.2, **disk}, {"name": "2", "position": 0.4, **disk}],
                "bearings": [
                    {"name": n, "position": z, "kxx": 1e5, "kyy": 1e5, "cxx": 20.0, "cyy": 20.0}
                    for n, z in zip(names, (0.0, 0.1, 0.6), strict=True)
                ],
                "probes": [
                    {"name": f"{i}", "position": 0.3, "angle": angle, "channel": i}
                    for i, angle in enumerate([0.2, 1.9])
                ],
            }
        ),
        max_element=0.1,
    )


@pytest.fixture(scope="module")
def grouped(two_disks):
    """Bearings "a" and "c" alike, "b" on its own; loads: unbalance on either disk, a force at the first probe."""
    unbalance = np.column_stack([unbalance_direction(two_disks.disk(n), 1) for n in "12"])
    forces = np.concatenate(
        [
            OMEGA[:, None, None] ** 2 * unbalance,
            np.broadcast_to(two_disks.probes[0][:, None], (len(OMEGA), two_disks.dof, 1)),
        ],
        axis=2,
    )
    return condense_groups(two_disks, OMEGA, groups=[["a", "c"], ["b"]], forces=forces), forces


@pytest.fixture
def candidate():
    rng = np.random.default_rng(8)
    K = np.array([[[3e4, -2e3], [4e3, 5e4]], [[8e4, 1e3], [-3e3, 2e4]]])
    C = np.array([[[30.0, 4.0], [-3.0, 50.0]], [[10.0, 1.0], [2.0, 60.0]]])
    return K, C, rng.normal(size=3) * [1e-5, 1e-5, 1] + 1j * rng.normal(size=3) * [1e-5, 1e-5, 1]


def real_form(model, forces, K, C, u):
    """Return the probes' z by eq. (11) with the signs put right: (q_C, q_S), q = q_C cos + q_S sin; z = q_C - j q_S.

    All arithmetic is analytic in K, C and (Re u, Im u) = u, so that a complex step passes through both halves: they
    are returned apart, (2, speed, probe).
    """
    bare = with_bearing(model, ["a", "b", "c"], np.zeros((2, 2)), np.zeros((2, 2)))
    M, D, G, S = (A.astype(complex) for A in matrices(bare))
    for name, g in (("a", 0), ("c", 0), ("b", 1)):
        rows = model.bearing(name).rows
        S, D = S + rows.T @ K[g] @ rows, D + rows.T @ C[g] @ rows
    halves = []
    for omega, force in zip(OMEGA, forces, strict=True):
        stiff, damped = S - omega**2 * M, omega * (D + omega * G)
        load_c = force.real @ u[0] - force.imag @ u[1]
        load_s = -(force.real @ u[1] + force.imag @ u[0])
        q = np.linalg.solve(np.block([[stiff, damped], [-damped, stiff]]), np.concatenate([load_c, load_s]))
        halves.append(model.probes @ q.reshape(2, -1).T)
    cosine, sine = np.moveaxis(np.array(halves), 2, 0)
    return np.stack([cosine, -sine])


def by_complex_step(model, forces, K, C, u):
    re, im = real_form(model, forces, K, C, u).imag / STEP
    return re + 1j * im


def test_eight_coefficients_of_two_groups_and_three_loads_answer_as_the_real_form(two_disks, grouped, candidate):
    receptance, forces = grouped
    K, C, u = candidate
    got = receptance.general_response(K, C, u)
    re, im = real_form(two_disks, forces, K, C, np.array([u.real, u.imag])).real
    assert np.abs(got - (re + 1j * im)).max() < 1e-10 * np.abs(got).max()


@pytest.mark.parametrize("group", [0, 1])
@pytest.mark.parametrize(("i", "j"), [(0, 0), (0, 1), (1, 0), (1, 1)])
def test_derivatives_by_bearing_coefficients_are_those_of_a_complex_step(two_disks, grouped, candidate, group, i, j):
    receptance, forces = grouped
    K, C, u = candidate
    got = receptance.response_and_derivatives(K, C, u)
    np.testing.assert_allclose(got.z, receptance.general_response(K, C, u), rtol=1e-12)
    step = np.zeros_like(K, dtype=complex)
    step[group, i, j] = 1j * STEP
    u = np.array([u.real, u.imag])
    for have, want in (
        (got.by_stiffness, by_complex_step(two_disks, forces, K + step, C, u)),
        (got.by_damping, by_complex_step(two_disks, forces, K, C + step, u)),
    ):
        assert np.abs(have[group, i, j] - want).max() < 1e-9 * np.abs(want).max()


@pytest.mark.parametrize("load", [0, 1, 2])
def test_derivatives_by_amounts_are_those_of_a_complex_step(two_disks, grouped, candidate, load):
    receptance, forces = grouped
    K, C, u = candidate
    got = receptance.response_and_derivatives(K, C, u).by_amount[load]
    for part, factor in ((0, 1), (1, 1j)):
        step = np.zeros((2, 3), dtype=complex)
        step[part, load] = 1j * STEP
        want = by_complex_step(two_disks, forces, K, C, np.array([u.real, u.imag]) + step)
        assert np.abs(factor * got - want).max() < 1e-9 * np.abs(want).max()


def test_general_candidates_broadcast(grouped, candidate):
    receptance, _ = grouped
    K, C, u = candidate
    got = receptance.general_response(np.array([K, 2 * K, 3 * K])[:, None], C, np.array([u, 2 * u]))
    assert got.shape == (3, 2, 60, 2)
    np.testing.assert_allclose(got[1, 1], 2 * receptance.general_response(2 * K, C, u), rtol=1e-12)


@pytest.mark.parametrize(
    ("names", "disk", "message"),
    [
        (["sprung"], "disk", "no bearing 'sprung'"),
        (["spring"], "disc", "no disk 'disc'"),
        ([], "disk", "bearings is empty"),
        (["spring", "spring"], "disk", "each of them once"),
    ],
)
def test_an_unknown_name_is_said(small, names, disk, message):
    with pytest.raises(ValueError, match=message):
        condense(small, OMEGA, bearings=names, disk=disk)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"kxx": np.nan}, "candidate 0: bearing spring: coefficients are .*nan.*, want finite ones"),
        ({"cyy": np.inf}, "want finite ones"),
        ({"kyy": [3e4, -3e4]}, "candidate 1: bearing spring: kxx, kyy, cxx, cyy .* want zero or more"),
        ({"u": [1e-5, 1e-5, complex(0, np.nan)]}, "candidate 2: amounts"),
    ],
)
def test_what_cannot_be_a_bearing_or_unbalance_is_said(small, changed, message):
    receptance = condense(small, OMEGA, bearings=["spring"], disk="disk")
    values = {"kxx": 3e4, "kyy": 3e4, "cxx": 10.0, "cyy": 10.0, "u": 1e-5} | changed
    with pytest.raises(ValueError, match=message):
        receptance.response(**values)
    with pytest.raises(ValueError, match=message):
        receptance.misfit(np.ones((60, 4)), **values, objective="f2")


def test_a_resonance_without_damping_on_one_of_the_speeds_is_said():
    """A shaft whose bearings have no stiffness left is free: its first natural frequency is 0 rpm."""
    rig = from_si(
        {
            "name": "free",
            "shaft": {"length": 1.0, "diameter": 0.01, "density": 7800.0, "youngs_modulus": 2e11},
            "disks": [{"name": "d", "position": 0.5, "mass": 1.0, "polar_inertia": 1e-3, "transverse_inertia": 1e-3}],
            "bearings": [{"name": n, "position": z, "kxx": 1.0, "kyy": 1.0} for n, z in (("a", 0.0), ("b", 1.0))],
            "probes": [{"name": "x", "position": 0.5, "angle": 0.0, "channel": 0}],
        }
    )
    receptance = condense(assemble(rig), [0.0, 100.0], bearings=["a", "b"], disk="d")
    with pytest.raises(DataError, match=r"candidate 1: an undamped resonance .* 0 to 954\.93 rpm"):
        receptance.response([1.0, 0.0], 1.0, 0.0, 0.0, 1.0)
    assert np.isfinite(receptance.response(1.0, 1.0, 0.0, 0.0, 1.0)).all()


def test_a_rotor_that_no_bearing_can_hold_is_said(two_disks):
    """A shaft without stiffness at rest, held at one place."""
    limp = replace(two_disks, shaft=two_disks.shaft._replace(K=np.zeros_like(two_disks.shaft.K)))
    with pytest.raises(DataError, match="at 0 rpm the bearings do not hold the rotor"):
        condense(limp, 0.0, bearings=["a"], disk="1")


def test_a_bearing_that_changes_with_speed_is_no_unknown(rk4):
    table = {"speed": ["0 rpm", "3600 rpm"], "value": ["1e4 N/m", "3e4 N/m"]}
    spring = type(rk4.bearings[0]).model_validate({"name": "spring", "position": "481 mm", "kxx": table, "kyy": table})
    model = assemble(rk4.model_copy(update={"bearings": (*rk4.bearings[:2], spring)}))
    with pytest.raises(ConfigError, match="bearing 'spring': its coefficients depend on speed"):
        condense(model, OMEGA, bearings=["spring"], disk="disk")


def test_shapes_that_do_not_fit_are_said(two_disks, grouped, candidate):
    receptance, _ = grouped
    K, C, u = candidate
    with pytest.raises(ValueError, match=r"K has shape \(2, 2\), want \(\.\.\., 2, 2, 2\)"):
        receptance.general_response(K[0], C, u)
    with pytest.raises(ValueError, match=r"forces have shape \(60, 3\)"):
        condense_groups(two_disks, OMEGA, groups=[["a"]], forces=np.ones((60, 3)))
    with pytest.raises(ValueError, match="want one"):
        receptance.response_and_derivatives(np.array([K, K]), C, u)
    with pytest.raises(ValueError, match=r"measured has shape \(3, 2\), want \(speed, probe\) = \(60, 2\)"):
        receptance.misfit(np.ones((3, 2)), 1.0, 1.0, 1.0, 1.0, 1.0, objective="f1")
    with pytest.raises(ValueError, match="objective is 'f4'"):
        receptance.misfit(np.ones((60, 2)), 1.0, 1.0, 1.0, 1.0, 1.0, objective="f4")

"""The condensed response is that of the whole model, candidate by candidate."""

import numpy as np
import pytest

from rotorrig.sims.rotor.assembly import with_bearing
from rotorrig.sims.rotor.harmonic import probe_response
from rotorrig.sims.rotor.receptance import condense

OMEGA = np.linspace(50, 380, 60)  # through the critical speed


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


@pytest.mark.parametrize(
    ("names", "disk", "message"),
    [
        (["sprung"], "disk", "no bearing 'sprung'"),
        (["spring"], "disc", "no disk 'disc'"),
        ([], "disk", "bearings is empty"),
    ],
)
def test_an_unknown_name_is_said(small, names, disk, message):
    with pytest.raises(ValueError, match=message):
        condense(small, OMEGA, bearings=names, disk=disk)

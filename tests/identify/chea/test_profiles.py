"""The two searches by name."""

import re

import numpy as np
import pytest

from rotorrig.identify.chea import MODERN, SEED, chea
from rotorrig.identify.chea.profiles import begin

SETTINGS = {"seed": SEED, "modern": MODERN}


@pytest.mark.parametrize("profile", SETTINGS)
def test_a_profile_comes_with_its_own_settings(profile: str) -> None:
    own, given = (begin(profile, settings, 2, np.random.default_rng(0)) for settings in (None, SETTINGS[profile]))
    assert own[0].dim == 2
    assert next(own[1]).tolist() == next(given[1]).tolist()


@pytest.mark.parametrize("profile", SETTINGS)
def test_a_first_batch_lies_in_the_unit_cube(profile: str) -> None:
    for dim in (1, 2, 12):
        points = next(begin(profile, None, dim, np.random.default_rng(0))[1])
        assert points.shape[1] == dim
        assert ((points >= 0) & (points <= 1)).all()


def test_modern_is_what_one_gets() -> None:
    def fun(x: np.ndarray) -> float:
        return float((x**2).sum())

    usual, named = chea(fun, [(-1, 1)] * 2, rng=0), chea(fun, [(-1, 1)] * 2, rng=0, profile="modern")
    assert usual.history.tolist() == named.history.tolist()


def rastrigin(x: np.ndarray) -> np.ndarray:
    return 20 + (x**2 - 10 * np.cos(2 * np.pi * x)).sum(axis=1)


@pytest.mark.parametrize(("profile", "local"), [("seed", "model"), ("modern", "sqp")])
def test_either_profile_searches_with_the_local_search_of_the_other(profile: str, local: str) -> None:
    given = chea(rastrigin, [(-4, 6)] * 2, rng=0, profile=profile, local=local, vectorized=True)
    assert given.x == pytest.approx([0, 0], abs=1e-3)
    own = chea(rastrigin, [(-4, 6)] * 2, rng=0, profile=profile, vectorized=True)
    assert given.history.tolist() != own.history.tolist()
    cut = chea(rastrigin, [(-4, 6)] * 2, rng=0, profile=profile, local=local, vectorized=True, max_nfev=400)
    assert chea(rastrigin, resume=cut.state, vectorized=True).history.tolist() == given.history.tolist()


def test_the_profiles_own_local_search_named_is_the_usual_search() -> None:
    usual, named = (chea(rastrigin, [(-4, 6)] * 2, rng=0, local=local, vectorized=True) for local in (None, "model"))
    assert usual.history.tolist() == named.history.tolist()


def test_another_local_search_is_refused() -> None:
    with pytest.raises(ValueError, match="local is 'powell', expected one of 'model', 'sqp'"):
        chea(sum, [(0, 1)], local="powell")


def test_another_name_is_refused() -> None:
    with pytest.raises(ValueError, match="profile is 'Seed', expected one of 'modern', 'seed'"):
        chea(sum, [(0, 1)], profile="Seed")


@pytest.mark.parametrize("profile", SETTINGS)
def test_settings_of_something_else_are_refused(profile: str) -> None:
    words = re.escape("settings is a dict, expected a rotorrig.identify.chea.")
    with pytest.raises(ValueError, match=words + rf".* for profile='{profile}'"):
        chea(sum, [(0, 1)], profile=profile, settings={"population": 9})

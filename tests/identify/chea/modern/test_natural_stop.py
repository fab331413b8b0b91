"""When a search has seen enough."""

import numpy as np

from rotorrig.identify.chea.modern.natural_stop import NaturalStop


def stop(*, descents: int, patience: float = 2.0, idle: int = 1000) -> NaturalStop:
    return NaturalStop(patience=patience, idle=idle, per_minimum=4, most=12, descents=descents)


def test_three_descents_to_one_minimum_are_enough() -> None:
    for descents, enough in ((2, False), (3, True)):
        state = stop(descents=descents)
        state.note_minimum(lower=True, ties=1, nfev=60)
        assert state.is_reached(1, 70) is enough


def test_more_minima_ask_for_more_descents_up_to_a_limit() -> None:
    assert stop(descents=6).too_few(2)
    assert not stop(descents=7).too_few(2)
    assert stop(descents=11).too_few(50)
    assert not stop(descents=12).too_few(50)


def test_several_minima_are_looked_beyond_in_proportion_to_the_calls_until_the_last_find() -> None:
    state = stop(descents=12)
    state.note_minimum(lower=True, ties=1, nfev=100)
    assert not state.is_reached(4, 249)
    assert state.is_reached(4, 250)  # 100 + 2 (1 - 1/4) 100


def test_minima_that_share_the_best_value_shorten_the_wait() -> None:
    state = stop(descents=12)
    state.note_minimum(lower=True, ties=3, nfev=100)
    assert state.is_reached(4, 150)


def test_a_lower_minimum_and_one_more_as_low_are_finds_and_others_are_none() -> None:
    state = stop(descents=12)
    for nfev, lower, ties, last in (
        (100, True, 1, 100),
        (200, False, 1, 100),
        (300, False, 2, 300),
        (400, True, 1, 400),
    ):
        state.note_minimum(lower=lower, ties=ties, nfev=nfev)
        assert state.last_find == last


def test_the_wait_has_a_limit() -> None:
    state = stop(descents=12, idle=300)
    state.note_minimum(lower=True, ties=1, nfev=5000)
    assert state.is_reached(9, 5300)


def test_nothing_found_is_no_error() -> None:
    assert stop(descents=3).is_reached(0, 50)
    assert np.isfinite(stop(descents=0).last_find)

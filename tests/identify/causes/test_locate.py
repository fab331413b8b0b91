"""The location that a grid search finds, against promises whose best place and width are known."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from rotorrig.identify.causes.locate import best_place
from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.effects.base import Effect, find

TRUE, SIGMA = 63.21, 0.02


def with_grid(rig: RigConfig, *stretches: tuple[float, ...]) -> Effect:
    return type(step := find(rig, "unbalance_step"))(plane="disk", parameters=step.parameters, grid=stretches)


def time_of(effect: Effect) -> tuple[float, float]:
    time = effect.parameters[-1]
    return time.at_zero, time.spread


def promising(lam: Callable[[float], float], asked: list[float]) -> Callable[[Sequence[Effect]], list[float]]:
    def promise(tries: Sequence[Effect]) -> list[float]:
        times = [time_of(effect)[0] for effect in tries]
        asked.extend(times)
        return [lam(t) for t in times]

    return promise


def test_a_sharp_best_is_found_from_a_coarse_look_with_its_width(rig: RigConfig) -> None:
    """Far off the promise falls slowly, as a moment's does; within sigmas of the best as a parabola."""
    asked: list[float] = []
    lam = promising(lambda t: 1e6 - 100 * min(((t - TRUE) / SIGMA) ** 2 / 100, abs(t - TRUE) / SIGMA), asked)
    found, spread = time_of(best_place(with_grid(rig, tuple(np.linspace(0, 150, 16))), lam))
    assert found == pytest.approx(TRUE, abs=SIGMA)
    assert spread == pytest.approx(SIGMA, rel=0.1)
    assert len(asked) < 60


def test_a_look_is_no_closer_than_the_data_can_tell(rig: RigConfig) -> None:
    asked: list[float] = []
    best_place(with_grid(rig, tuple(np.linspace(0, 150, 16))), promising(lambda t: 3 - ((t - TRUE) / 40) ** 2, asked))
    assert len(asked) == 16


def test_a_place_of_its_own_is_taken_as_it_is(rig: RigConfig) -> None:
    lam = promising(lambda t: 50.0 if t == 500.0 else 1.0 / (1 + abs(t - 20)), asked := [])
    found = best_place(with_grid(rig, (10.0, 20.0, 30.0), (500.0,), (900.0, 1000.0)), lam)
    assert time_of(found) == (500.0, 0.0)
    assert len(asked) == 6


def test_the_best_at_an_end_of_a_stretch_stays_within_it(rig: RigConfig) -> None:
    lam = promising(lambda t: 100.0 * t, [])
    found, _ = time_of(best_place(with_grid(rig, (0.0, 1.0, 2.0), (1.5, 1.6)), lam))
    assert found == 2.0

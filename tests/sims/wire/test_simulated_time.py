import asyncio
import time
from typing import Any

from rotorrig.rig.clock import WallClock
from rotorrig.sims.wire.simulated_time import pass_time


class Board:
    """Takes samples; once, after `before` of them, it does so only after `seconds`."""

    def __init__(self, *, before: int = 0, seconds: float = 0.0) -> None:
        self.taken = 0
        self._before, self._seconds = before, seconds

    async def room(self) -> None:
        if self._seconds and self.taken >= self._before:
            seconds, self._seconds = self._seconds, 0.0
            await asyncio.sleep(seconds)

    def measure(self, counts: Any) -> None:
        self.taken += len(counts)


def run(plant: Any, board: Board, *, seconds: float, rate: float, real_time: bool = False, awake: bool = True) -> float:
    """Return the wall time for which time was let pass."""

    async def job() -> float:
        began = time.monotonic()
        passing = pass_time(plant, board, rate=rate, awake=lambda: awake, clock=WallClock(), real_time=real_time)
        try:
            await asyncio.wait_for(passing, seconds)
        except TimeoutError:
            return time.monotonic() - began
        raise AssertionError("time ended")

    return asyncio.run(job())


def test_time_passes_at_the_rate_and_every_sample_is_handed_on(plant: Any) -> None:
    board = Board()
    elapsed = run(plant, board, seconds=0.5, rate=5.0)
    assert 0.5 * 5.0 * 0.5 < plant.t <= 5.0 * elapsed + 0.2
    assert board.taken == plant.scans


def test_a_wait_for_the_reader_is_not_caught_up(plant: Any) -> None:
    elapsed = run(plant, Board(before=100, seconds=0.3), seconds=0.4, rate=10.0)
    assert plant.t <= 10.0 * (elapsed - 0.3) + 0.5


def test_a_delay_is_caught_up_in_real_time(plant: Any) -> None:
    run(plant, Board(before=100, seconds=0.3), seconds=0.5, rate=1.0, real_time=True)
    assert plant.t >= 0.4


def test_no_time_passes_while_nobody_is_awake(plant: Any) -> None:
    run(plant, Board(), seconds=0.1, rate=20.0, awake=False)
    assert plant.t == 0.0

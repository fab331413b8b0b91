"""Clock of a simulated bench: simulated time over wall time.

Time is asked of the plant in short steps with turns of the event loop in between, so that a Modbus request, which
takes about a dozen turns over the emulated cable, waits for a few steps (0.6 ms of computing each) and not for frames.
"""

import asyncio
from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig import Clock
from rotorrig.sims.wire.plant_port import Plant

DEFAULT_RATE = 20.0  # simulated over wall time: a sweep of 3 minutes takes 10 s, a command acts within 0.2 s of it
STEP = 0.01  # s of simulated time per call of the plant; shorter ones cost speed, 14 % at 5 ms
_TURNS = 4  # of the event loop per step; with one a request takes twice as long, 13 ms instead of 7 on a busy machine
_IDLE = 0.01  # s of wall time between looks at a rotor at rest
_SLACK = 0.02  # s of wall time that may be caught up: the loop's timer is no finer than 1 ms, a step at 20x is 0.5 ms


class Sampler(Protocol):
    """Taker of the samples: the DAQ board."""

    async def room(self) -> None:
        """Return when there is room for samples; a board that rather loses some returns at once."""
        ...

    def measure(self, counts: NDArray[np.int32]) -> None:
        """Take samples (sample, channel)."""
        ...


async def pass_time(
    plant: Plant,
    board: Sampler,
    *,
    rate: float,
    awake: Callable[[], bool],
    clock: Clock,
    real_time: bool,
    on_step: Callable[[], None] = lambda: None,
) -> None:
    """Move `plant` on at `rate` times wall time and hand its samples to `board`, until cancelled.

    `passed` is called after every step of at most `STEP` seconds.

    Time stands still while `awake()` is false (rotor at rest, nobody looking: nothing to compute) and while the board
    has no room. Neither is caught up afterwards, so that the rotor never runs away from who commands it; nor is the
    delay when the machine is slower than `rate`. With `real_time` everything but rest is caught up, as the clock of
    a real board cannot be held.
    """
    due = clock.now()
    while True:
        await board.room()
        if not awake():
            await asyncio.sleep(_IDLE)
            due = clock.now()
            continue
        board.measure(plant.advance(plant.t + STEP))
        on_step()
        now = clock.now()
        due = (due if real_time else max(due, now - _SLACK)) + STEP / rate
        for _ in range(_TURNS - 1):
            await asyncio.sleep(0)
        await asyncio.sleep(max(0.0, due - now))

"""A rotor simple enough to know by heart, and an event loop in a thread to run emulators against blocking clients."""

import asyncio
import threading
from collections.abc import Callable, Coroutine, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.rig.config.devices import ModbusRtu
from rotorrig.sims.wire import emulation
from tests.manual_clock import ManualClock


class ToyPlant:
    """Speed follows the command exactly; coasting loses 10 rad/s per second.

    Scan n (from time zero) reads (n mod 1000, -n mod 1000 as a negative number, speed in 0.1 rad/s).
    """

    sample_rate = 1000.0
    channels = 3
    volts_per_count = (0.001, 0.002, 0.5)
    full_scale_counts = 32768

    def __init__(self) -> None:
        self.scans = 0
        self.speed = 0.0
        self.commands: list[tuple[float, float, bool]] = []
        self._target, self._slope = 0.0, 10.0

    @property
    def t(self) -> float:
        return self.scans / self.sample_rate

    def command(self, setpoint: float, ramp: float, powered: bool) -> None:
        self.commands.append((setpoint, ramp, powered))
        self._target, self._slope = (setpoint, ramp) if powered else (0.0, 10.0)

    def advance(self, t: float) -> NDArray[np.int32]:
        n = np.arange(self.scans, round(t * self.sample_rate))
        step = self._slope * len(n) / self.sample_rate
        self.speed += float(np.clip(self._target - self.speed, -step, step))
        self.scans += len(n)
        counts = np.stack([n % 1000, -(n % 1000), np.full_like(n, round(10 * self.speed))], axis=1)
        return counts.astype(np.int32)


@pytest.fixture
def plant() -> ToyPlant:
    return ToyPlant()


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@contextmanager
def in_background(job: Callable[[asyncio.Event], Coroutine[Any, Any, None]]) -> Iterator[None]:
    """Run `job` in an event loop of its own thread; set the event it was given, and wait, at the end of the block."""
    end = asyncio.Event()
    loop = asyncio.new_event_loop()
    failure: list[BaseException] = []

    def work() -> None:
        try:
            loop.run_until_complete(job(end))
        except BaseException as error:
            failure.append(error)
        finally:
            loop.close()

    thread = threading.Thread(target=work)
    thread.start()
    try:
        yield
    finally:
        if thread.is_alive():
            loop.call_soon_threadsafe(end.set)
        thread.join(10.0)
        assert not thread.is_alive(), "the emulator did not end"
    if failure:
        raise failure[0]


Emulating = Callable[..., AbstractContextManager[tuple[str, str]]]


@pytest.fixture
def emulating(plant: ToyPlant) -> Emulating:
    """Both emulators in front of the toy plant: `with emulating(rate=20.0) as (motor_port, daq_port)`."""
    motor = ModbusRtu.model_validate(
        {"driver": "modbus-rtu", "port": "unused", "address": 100, "rpm_per_hz": 60.0, "max_speed": "4200 rpm"}
    )

    @contextmanager
    def start(*, rate: float) -> Iterator[tuple[str, str]]:
        ports: list[str] = []
        ready = threading.Event()

        async def job(end: asyncio.Event) -> None:
            async with emulation.emulate(
                motor, plant, serial="T1", rate=rate, keyphasor=None, report=lambda said: None
            ) as running:
                ports.extend(str(place["port"]) for place in (running.motor, running.daq))
                ready.set()
                await end.wait()

        with in_background(job):
            assert ready.wait(5.0), "the emulators did not start"
            yield ports[0], ports[1]

    return start


@pytest.fixture
def background() -> Callable[..., AbstractContextManager[None]]:
    return in_background


@pytest.fixture
def children() -> Callable[[int], set[int]]:
    """Ids of the living processes a process has started."""

    def of(parent: int) -> set[int]:
        found = set()
        for stat in Path("/proc").glob("[0-9]*/stat"):
            with suppress(OSError):  # gone meanwhile
                state, started_by = stat.read_text().rpartition(")")[2].split()[:2]
                if int(started_by) == parent and state != "Z":
                    found.add(int(stat.parent.name))
        return found

    return of

"""Emulation of motor controller and DAQ in front of one plant, in one event loop and one simulated time."""

import asyncio
import tempfile
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from rotorrig.rig import WallClock
from rotorrig.rig.config import Motor
from rotorrig.sims.wire import probe_daq
from rotorrig.sims.wire.background import run_jobs
from rotorrig.sims.wire.cables import Cable
from rotorrig.sims.wire.drive import Drive
from rotorrig.sims.wire.fault_player import Player, Report, Targets
from rotorrig.sims.wire.inputs import Inputs
from rotorrig.sims.wire.motors import Place, controllers
from rotorrig.sims.wire.plant_port import Plant
from rotorrig.sims.wire.simulated_time import pass_time

_STANDSTILL = 1e-3  # rad/s: below it the rotor counts as at rest
_TICK = 0.02  # s of wall time between looks at ramp and watchdog
_REPORT_EVERY = 1.0  # s of simulated time while the rotor turns


@dataclass(frozen=True, slots=True, kw_only=True)
class Emulation:
    """Running emulators: where a client finds the two, what plays faults on them, and the plant behind them."""

    motor: Place
    daq: Place
    player: Player
    plant: Plant

    def moment(self) -> dict[str, Any]:
        """Return the simulated time [s], this machine's monotonic clock [s] and the rotor's true speed [rad/s]."""
        return {"t": round(self.plant.t, 6), "wall": time.monotonic(), "speed": self.plant.speed}


@asynccontextmanager
async def emulate(
    motor: Motor,
    plant: Plant,
    *,
    serial: str,
    rate: float,
    keyphasor: int | None,
    report: Report,
    wire: IO[bytes] | None = None,
) -> AsyncIterator[Emulation]:
    """Run the controller of `motor` and a DAQ in front of `plant` for the length of the block.

    Up to `rate` 1 the DAQ is a real board: paced by its own clock, it loses samples when nobody reads. Above, time
    waits for the reader, nothing is lost, and `rate` is a ceiling. `keyphasor` is its channel. `report` is told when a
    fault begins or ends (see `Player`), when the rotor begins to turn, each second while it does, and when it is at
    rest (see `Emulation.moment`). What the DAQ's client is sent is written to `wire`, too. Raises ConfigError if the
    controller cannot turn the rotor so fast.
    """
    real_time, clock = rate <= 1.0, WallClock()
    board = probe_daq.Firmware(plant, serial=serial, waits=not real_time)
    inputs = Inputs(board, keyphasor=keyphasor)
    with (
        tempfile.TemporaryDirectory(prefix="rotorrig-ports-") as ports,
        Cable(name=Path(ports) / "daq", tap=wire) as cable,
    ):
        serving = controllers.serve_controller(motor, plant, clock=clock, rate=rate, name=Path(ports) / "motor")
        async with serving as controller:
            drive = controller.drive
            targets = Targets(
                motor=controller.link, daq=cable, drive=drive, inputs=inputs, disguise=controller.disguise
            )
            player = Player(targets, plant=plant, report=report)
            emulation = Emulation(motor=controller.place, daq={"port": cable.port}, player=player, plant=plant)

            def awake() -> bool:
                return board.streaming or drive.active or plant.speed > _STANDSTILL

            passing = pass_time(
                plant, inputs, rate=rate, awake=awake, clock=clock, real_time=real_time, on_step=player.look
            )
            async with run_jobs(
                _tick(drive), probe_daq.serve(board, cable), passing, player.run(), _watch(emulation, report)
            ):
                yield emulation


async def _tick(drive: Drive) -> None:
    while True:
        drive.tick()
        await asyncio.sleep(_TICK)


async def _watch(emulation: Emulation, report: Report) -> None:
    """Report the rotor's true speed."""
    turned, reported = False, 0.0  # rotor, s of simulated time
    while True:
        turns = emulation.plant.speed > _STANDSTILL
        if turns != turned:
            report(emulation.moment() | {"event": "turns" if turns else "rests"})
        elif turns and emulation.plant.t - reported > _REPORT_EVERY:
            report(emulation.moment())
        else:
            await asyncio.sleep(_TICK)
            continue
        turned, reported = turns, emulation.plant.t

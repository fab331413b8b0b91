"""An emulated inverter behind a real wire, a pty or a TCP port, in front of the toy plant: for blocking clients."""

import asyncio
import threading
import time
from collections.abc import Iterator
from contextlib import AsyncExitStack, contextmanager
from dataclasses import dataclass
from typing import Any, Literal

from rotorrig.rig.clock import WallClock
from rotorrig.rig.config.devices import ModbusRtu, ModbusTcp
from rotorrig.rig.config.drive_profiles import load_profile
from rotorrig.sims.wire.cables.pty_bridge import PtyBridge
from rotorrig.sims.wire.motors import modbus_motor
from rotorrig.sims.wire.motors.inverters import commission_drive
from rotorrig.sims.wire.motors.modbus_motor import Disguise, Registers
from tests.sims.wire.conftest import ToyPlant, in_background

Wire = Literal["rtu", "tcp"]
RATE = 20.0  # simulated over wall time
RAMP = "300 rpm/s"  # the one set at a drive that cannot be told


@dataclass(frozen=True)
class Served:
    """A running emulator."""

    table: ModbusRtu | ModbusTcp  # what a client is told
    registers: Registers
    plant: ToyPlant
    disguise: Disguise


@contextmanager
def served(profile: str, *, wire: Wire = "rtu", address: int = 1, **more: Any) -> Iterator[Served]:
    """Serve a drive of 70 Hz that turns 60 rpm per Hz, with time passing; `more` are keys of [motor]."""
    said = {"profile": profile, "address": address, "max_speed": "4200 rpm", **more}
    said |= {"ramp": RAMP} if load_profile(profile).ramp_by_hand else {}
    plant, found, ready = ToyPlant(), [], threading.Event()

    async def run(end: asyncio.Event) -> None:
        disguise = Disguise()
        async with AsyncExitStack() as stack, asyncio.TaskGroup() as group:
            jobs = []
            if wire == "rtu":
                cable = stack.enter_context(PtyBridge())
                table: ModbusRtu | ModbusTcp = ModbusRtu.model_validate(
                    {"driver": "modbus-rtu", "port": cable.client_port, **said}
                )
                registers = commission_drive(table, plant, WallClock())
                serving = modbus_motor.serve_rtu(registers, port=cable.device_port, address=address, disguise=disguise)
                await stack.enter_async_context(serving)
                jobs.append(group.create_task(cable.run()))
            else:
                table = ModbusTcp.model_validate({"driver": "modbus-tcp", "host": "127.0.0.1", **said})
                registers = commission_drive(table, plant, WallClock())
                serving_tcp = modbus_motor.serve_tcp(registers, address=address, disguise=disguise)
                table = table.model_copy(update={"tcp_port": await stack.enter_async_context(serving_tcp)})
            jobs.append(group.create_task(_pass_time(registers, plant)))
            found.append(Served(table, registers, plant, disguise))
            ready.set()
            await end.wait()
            for job in jobs:
                job.cancel()

    with in_background(run):
        assert ready.wait(5.0), "the emulator did not start"
        yield found[0]


async def _pass_time(registers: Registers, plant: ToyPlant) -> None:
    began = time.monotonic()
    while True:
        plant.advance(RATE * (time.monotonic() - began))
        registers.drive.tick()
        await asyncio.sleep(0.002)

"""Emulated controller and its wire for a config's `[motor]`: one per table of rig/config/devices.py.

The libraries a wire needs are imported when it is wanted.
"""

from collections.abc import AsyncIterator
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import assert_never

from rotorrig.rig import Clock
from rotorrig.rig.config import CanOpen, LineController, ModbusRtu, ModbusTcp, Motor
from rotorrig.sims.wire.background import run_jobs
from rotorrig.sims.wire.cables import HOST, PtyBridge, TcpBridge
from rotorrig.sims.wire.drive import Drive
from rotorrig.sims.wire.fault_player import Disguise, Link
from rotorrig.sims.wire.plant_port import Plant

Place = dict[str, str | int]  # keys of [motor] or [daq], and where they are found
_BITS_PER_CHARACTER = 6.0  # of a CAN frame per character of its text in slcan: 5 with eight bytes of data, 8 with none


@dataclass(frozen=True, slots=True, kw_only=True)
class Controller:
    """A served controller: the drive behind it, the link to it and where a client finds that."""

    drive: Drive
    link: Link
    place: Place
    disguise: Disguise | None = None  # of one that has an address to answer from


def serve_controller(
    table: Motor, plant: Plant, *, clock: Clock, rate: float, name: Path
) -> AbstractAsyncContextManager[Controller]:
    """Serve the controller that `table` names for the length of the block, in front of `plant`.

    `name` is the path its serial port is found under, if it has one. The wire's bit rate belongs to simulated time, so
    it is `rate` times what the table says. Raises ConfigError if such a controller cannot turn the rotor so fast.
    """
    match table:
        case ModbusRtu():
            return _modbus_rtu(table, plant, clock, PtyBridge(baudrate=table.baudrate * rate, name=name))
        case ModbusTcp():
            return _modbus_tcp(table, plant, clock)
        case LineController():
            return _line(table, plant, clock, PtyBridge(baudrate=table.baudrate * rate, name=name))
        case CanOpen():
            adapter = PtyBridge(baudrate=table.bitrate * rate, bits_per_byte=_BITS_PER_CHARACTER, name=name)
            return _canopen(table, plant, clock, adapter)
        case _:
            assert_never(table)


@asynccontextmanager
async def _modbus_rtu(table: ModbusRtu, plant: Plant, clock: Clock, bridge: PtyBridge) -> AsyncIterator[Controller]:
    from rotorrig.sims.wire.motors import modbus_motor
    from rotorrig.sims.wire.motors.inverters import commission_drive

    with bridge:
        registers, disguise = commission_drive(table, plant, clock), modbus_motor.Disguise()
        server = modbus_motor.serve_rtu(registers, port=bridge.device_port, address=table.address, disguise=disguise)
        async with server, run_jobs(bridge.run()):
            place: Place = {"port": bridge.client_port}
            yield Controller(drive=registers.drive, link=bridge.cable, place=place, disguise=disguise)


@asynccontextmanager
async def _modbus_tcp(table: ModbusTcp, plant: Plant, clock: Clock) -> AsyncIterator[Controller]:
    from rotorrig.sims.wire.motors import modbus_motor
    from rotorrig.sims.wire.motors.inverters import commission_drive

    registers, disguise = commission_drive(table, plant, clock), modbus_motor.Disguise()
    async with modbus_motor.serve_tcp(registers, address=table.address, disguise=disguise) as port:
        with TcpBridge(port) as bridge:
            async with run_jobs(bridge.run()):
                place: Place = {"host": HOST, "tcp_port": bridge.client_port}
                yield Controller(drive=registers.drive, link=bridge, place=place, disguise=disguise)


@asynccontextmanager
async def _line(table: LineController, plant: Plant, clock: Clock, bridge: PtyBridge) -> AsyncIterator[Controller]:
    from rotorrig.sims.wire.motors import line_motor

    with bridge:
        device = line_motor.LineDevice(plant, max_speed=table.max_speed, clock=clock)
        async with line_motor.serve(device, port=bridge.device_port), run_jobs(bridge.run()):
            yield Controller(drive=device.drive, link=bridge.cable, place={"port": bridge.client_port})


@asynccontextmanager
async def _canopen(table: CanOpen, plant: Plant, clock: Clock, adapter: PtyBridge) -> AsyncIterator[Controller]:
    from rotorrig.sims.wire.motors import can_motor
    from rotorrig.sims.wire.motors.cia402 import Cia402

    with adapter:
        device = Cia402(plant, max_speed=table.max_speed, rpm_per_unit=table.rpm_per_unit, clock=clock)
        server = can_motor.serve_slcan(device, port=adapter.device_port, node=table.node, bitrate=table.bitrate)
        async with server, run_jobs(adapter.run()):
            place: Place = {"interface": "slcan", "channel": adapter.client_port}
            yield Controller(drive=device.drive, link=adapter.cable, place=place)

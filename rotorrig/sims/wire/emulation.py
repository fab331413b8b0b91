"""Both emulators in front of one plant, in one event loop: no threads, no locks, one simulated time."""

import asyncio
from collections.abc import Callable

from rotorrig.rig.clock import WallClock
from rotorrig.rig.description import Motor
from rotorrig.rig.units import RPM
from rotorrig.sims.wire import modbus_motor, probe_daq
from rotorrig.sims.wire.plant_port import Plant
from rotorrig.sims.wire.powerflex400 import PowerFlex400
from rotorrig.sims.wire.pty_bridge import Pty, PtyBridge
from rotorrig.sims.wire.simulated_time import pass_time

_STANDSTILL = 1e-3  # rad/s: below it the rotor counts as at rest
_TICK = 0.02  # s of wall time between looks at ramp and watchdog


async def emulate(
    motor: Motor,
    plant: Plant,
    *,
    serial: str,
    rate: float,
    announce: Callable[[str, str], None],
    end: asyncio.Event,
) -> None:
    """Run drive and DAQ in front of `plant` until `end` is set; `announce` gets the motor's and the DAQ's port.

    Up to `rate` 1 the DAQ is a real board: paced by its own clock, it loses samples when nobody reads. Above, time
    waits for the reader, nothing is lost, and `rate` is a ceiling.
    """
    real_time = rate <= 1.0
    clock = WallClock()
    hertz = motor.max_speed * RPM / motor.rpm_per_hz
    drive = PowerFlex400(plant, rpm_per_hz=motor.rpm_per_hz, max_frequency=hertz, clock=clock)
    board = probe_daq.Firmware(plant, serial=serial, waits=not real_time)

    def awake() -> bool:
        return board.streaming or drive.active or plant.speed > _STANDSTILL

    # the cable's baud rate belongs to simulated time as well
    with PtyBridge(baudrate=motor.baudrate * rate) as cable, Pty() as daq_pty:
        serving = modbus_motor.serving(drive, port=cable.device_port, address=motor.address)
        async with serving, asyncio.TaskGroup() as group:
            tasks = [
                group.create_task(job)
                for job in (
                    cable.run(),
                    _tick(drive),
                    probe_daq.serve(board, daq_pty),
                    pass_time(plant, board, rate=rate, awake=awake, clock=clock, real_time=real_time),
                )
            ]
            announce(cable.client_port, daq_pty.port)
            await end.wait()
            for task in tasks:
                task.cancel()


async def _tick(drive: PowerFlex400) -> None:
    while True:
        drive.tick()
        await asyncio.sleep(_TICK)

"""A peer bench: one drive, one DAQ board and the rotor between them, in a process of their own.

    python -m tests.peers.bench CONTROLLER FOLDER [--seed N] [--rate HZ] [--rolling RPM]

It prints the ports, as keys of `[motor]` and `[daq]`. Its standard input takes faults, one JSON object a line:
{"switch": "link closed", "seconds": 4}; without `seconds` a fault stays. FOLDER gets `journal.jsonl`, with events and
the true speed, and `wire`, what reached the DAQ's client. The bench lives until its standard input ends.
"""

import argparse
import asyncio
import json
import logging
import math
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from tests.peers.cables import PtyCable, TcpCable
from tests.peers.can_drive import TRIPPED, CanDrive
from tests.peers.daq_board import DaqBoard
from tests.peers.drives import FAMILIES
from tests.peers.inverter import Inverter
from tests.peers.journal import Journal
from tests.peers.line_controller import TRIP_FAULT, LineController
from tests.peers.registers import ModbusDrive
from tests.peers.rotor import Rotor

CONTROLLERS = (*(f"{family}-{wire}" for family in FAMILIES for wire in ("rtu", "tcp")), "canopen", "line")
TICK = 0.02  # s
TRUTH = 0.05  # s between lines of the true speed
POWER_CYCLE = 1.5  # s for which a drive that restarts is off
OVER_CURRENT = 12  # a fault code that several families have

Undo = Callable[[], None]


class Bench:
    """Drive, board and rotor."""

    def __init__(self, controller: str, folder: Path, *, seed: int, rate: float) -> None:
        """Prepare everything but the motor's port, which `open` makes."""
        self.controller, self.folder, self.seed = controller, folder, seed
        self.journal = Journal(folder / "journal.jsonl")
        self.rotor = Rotor()
        self.inverter = Inverter(self.journal, seed=seed)
        self.inverter.shaft = lambda: self.rotor.rpm
        self.board = DaqBoard(port=folder / "daq", wire=folder / "wire", rate=rate, seed=seed, journal=self.journal)
        self.drive: ModbusDrive | CanDrive | LineController
        self.cable: PtyCable | TcpCable

    async def open(self) -> dict[str, Any]:
        """Make the motor's port; return where it is."""
        if self.controller == "canopen":
            self.drive = CanDrive(self.inverter, self.journal)
            connect = self.drive.connect
        elif self.controller == "line":
            self.drive = LineController(self.inverter)
            connect = self.drive.connect
        else:
            family, _, wire = self.controller.rpartition("-")
            self.drive = ModbusDrive(FAMILIES[family](self.inverter), self.inverter, self.journal)
            connect = await (self.drive.listen_tcp() if wire == "tcp" else self.drive.listen_rtu())
            if wire == "tcp":
                self.cable = TcpCable(connect, seed=self.seed)
                await self.cable.open()
                return {"host": "127.0.0.1", "tcp_port": self.cable.port, "address": self.drive.map.address}
        self.cable = PtyCable(connect, path=self.folder / "motor", seed=self.seed)
        if isinstance(self.drive, ModbusDrive):
            return {"port": str(self.cable.path), "address": self.drive.map.address}
        return {"channel" if self.controller == "canopen" else "port": str(self.cable.path)}

    async def turn(self, *, rolling: float) -> None:
        """Turn the rotor in real time; until the first sample, somebody else keeps it at `rolling` rpm."""
        began = last = time.monotonic()
        done, told = 0, 0.0
        while True:
            await asyncio.sleep(TICK)
            now = time.monotonic()
            scans = int((now - began) * self.board.rate) - done
            done += scans
            before_trip = self.inverter.fault
            output = self.inverter.advance(now - last)
            if rolling and not self.board.scans:
                output = rolling
            angle = self.rotor.angle
            first, end = self.rotor.advance(now - last, output=output)
            steps = np.arange(scans) / self.board.rate
            speeds = first + (end - first) * steps / max(now - last, 1e-9)
            self.board.sample(angle + (first + speeds) / 2 * steps, speeds * 30 / math.pi)
            if self.inverter.fault and not before_trip and isinstance(self.drive, CanDrive):
                self.drive.emergency()
            if now - told >= TRUTH:
                told = now
                self.journal.truth(rpm=self.rotor.rpm, on=self.inverter.on, sent=self.board.scans)
            last = now

    def switch(self, name: str, value: Any = None) -> Undo:
        """Switch a fault on; return what switches it off."""
        self.journal.event("fault", switch=name)
        act = SWITCHES[name]
        undo = act(self) if value is None else act(self, value)

        def off() -> None:
            undo()
            self.journal.event("fault ends", switch=name)

        return off

    def cycle_power(self) -> Undo:
        """Cut the drive's power for a moment: the output is off, the link silent, settings are lost."""
        self.inverter.switch_off()
        self.inverter.fault = 0
        self.cable.faults.silent = True

        def on_again() -> None:
            self.cable.faults.silent = False
            self.inverter.switch_off()
            self.inverter.heard()
            if isinstance(self.drive, ModbusDrive):
                self.drive.values.update(self.drive.map.initial)
                self.drive.map.power_up()
            else:
                self.drive.power_up()
            self.journal.event("drive is back")

        asyncio.get_running_loop().call_later(POWER_CYCLE, on_again)
        return lambda: None

    def trip(self) -> Undo:
        """Trip the drive."""
        codes = {CanDrive: TRIPPED, LineController: TRIP_FAULT}
        self.inverter.trip(codes.get(type(self.drive), OVER_CURRENT))
        return lambda: None

    def busy(self, value: tuple[float, int] = (0.7, 2)) -> Undo:
        """Answer bursts of requests with a transient refusal; the line protocol has none."""
        if isinstance(self.drive, LineController):
            return lambda: None
        drive = self.drive
        drive.busy(every=value[0], times=value[1])
        return lambda: drive.busy(every=0.0, times=0)

    def unplug(self, cable: PtyCable | TcpCable) -> Undo:
        """Pull a plug."""
        cable.unplug()
        return cable.plug

    def restart_board(self) -> Undo:
        """Let the DAQ board begin again."""
        self.board.restart()
        return lambda: None


def _set(thing: str, name: str, default: Any) -> Callable[..., Undo]:
    """Return what sets one switch of a part of the bench."""

    def act(bench: Bench, value: Any = default) -> Undo:
        part = {"link": bench.cable.faults if thing == "link" else None, "daq": bench.board.switches}.get(
            thing, bench.inverter.switches
        )
        before = getattr(part, name)
        setattr(part, name, value)
        return lambda: setattr(part, name, before)

    return act


SWITCHES: dict[str, Callable[..., Undo]] = {
    "link closed": lambda bench: bench.unplug(bench.cable),
    "link silent": _set("link", "silent", True),
    "link delayed": _set("link", "delay", 0.15),
    "link loses frames": _set("link", "lost", 0.1),
    "link garbled": _set("link", "garbled", 0.1),
    "busy": Bench.busy,
    "ignores stop": _set("drive", "ignores_stop", True),
    "only coast": _set("drive", "only_coast", True),
    "deaf": _set("drive", "deaf", True),
    "reports 0": _set("drive", "reports_zero", True),
    "stale speed": _set("drive", "stale", True),
    "no watchdog": _set("drive", "no_watchdog", True),
    "runs at": _set("drive", "runs_at", 3500.0),
    "speed factor": _set("drive", "speed_factor", 2.0),
    "turns backward": _set("drive", "backward", True),
    "drive trips": Bench.trip,
    "drive restarts": Bench.cycle_power,
    "DAQ silent": _set("daq", "silent", True),
    "DAQ unplugged": lambda bench: bench.unplug(bench.board.cable),
    "DAQ loses frames": _set("daq", "lost", 0.05),
    "DAQ late": _set("daq", "late", 4.5),
    "DAQ restarts": Bench.restart_board,
    "keyphasor dead": _set("daq", "keyphasor", "dead"),
    "keyphasor noisy": _set("daq", "keyphasor", "noisy"),
    "probe at 0 V": _set("daq", "probe", 0.0),
    "probe at -19.9 V": _set("daq", "probe", -19.9),
}


async def serve(bench: Bench, rolling: float) -> None:
    """Serve until the standard input ends."""
    motor = await bench.open()
    turning = asyncio.ensure_future(bench.turn(rolling=rolling))
    print(json.dumps({"motor": motor, "daq": {"port": str(bench.board.cable.path)}}), flush=True)
    loop = asyncio.get_running_loop()
    commands = asyncio.StreamReader()
    await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(commands), sys.stdin)
    while line := await commands.readline():
        asked = json.loads(line)
        undo = bench.switch(asked["switch"], asked.get("value"))
        if seconds := asked.get("seconds"):
            loop.call_later(seconds, undo)
    turning.cancel()
    bench.board.close()
    bench.journal.close()


def main() -> None:
    """Run a bench."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("controller", choices=CONTROLLERS)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rate", type=float, default=5000.0, help="samples per second and channel")
    parser.add_argument("--rolling", type=float, default=0.0, help="rpm at which the rotor turns already")
    options = parser.parse_args()
    logging.disable(logging.ERROR)  # of pymodbus and canopen: what the client sends them is its own affair

    async def run() -> None:
        await serve(Bench(options.controller, options.folder, seed=options.seed, rate=options.rate), options.rolling)

    asyncio.run(run())


if __name__ == "__main__":
    main()

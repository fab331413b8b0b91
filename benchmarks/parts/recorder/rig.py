"""The rig of the recorder's benchmark: a drive and a DAQ of 8 channels at 50 kS/s behind serial ports, in real time.

`python -m benchmarks.parts.recorder.rig CONFIG.toml SIGNAL.npz [--loud SHORTEST LONGEST]`

The samples were computed before (parts/recorder/signal.py) and go round: a loop at rest, one at speed, one at speed
with more vibration than the limit allows; after a stop obeyed at speed come once those of a rotor that slows down.
With `--loud` the third begins so many seconds after the rotor has come to speed. Lines of JSON on standard output:
where the ports are; when a stream began and what it lost; how long after the last byte of the first loud frame the
drive obeyed a stop; from which scan on the rotor slowed down. Ends with its standard input. Times are CLOCK_MONOTONIC.
"""

import argparse
import asyncio
import json
import os
import random
import struct
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rotorrig.rig import WallClock
from rotorrig.rig.config import RigConfig, load
from rotorrig.sims.wire.cables.pty_bridge import Pty
from rotorrig.sims.wire.drive import Drive
from rotorrig.sims.wire.motors import controllers
from rotorrig.sims.wire.probe_daq import frame, int24

SPEED = 3000 * np.pi / 30  # rad/s
FRAME_SCANS = 1000  # 20 ms
FIFO_SECONDS = 1.0  # of samples the board keeps for a reader that is late, as an emulated one does
MISSED_SECONDS = 5.0  # without a stop: the trip was missed
_DATA, _INFO, _STOPPED = 0x02, 0x01, 0x03


class Rotor:
    """A shaft without mass behind the drive: it follows the ramp; a stop, which in the samples takes time, at once."""

    def __init__(self) -> None:
        self.stopped = asyncio.Event()  # a stop was obeyed
        self._from, self._to, self._slope, self._since = 0.0, 0.0, 1.0, 0.0

    @property
    def t(self) -> float:
        """Seconds of the machine's clock."""
        return time.monotonic()

    @property
    def speed(self) -> float:
        """Speed [rad/s]."""
        way = self._to - self._from
        return self._from + np.sign(way) * min(abs(way), self._slope * (self.t - self._since))

    def command(self, setpoint: float, ramp: float, powered: bool) -> None:
        """Take the drive's command."""
        self._from, self._to, self._slope, self._since = float(self.speed), setpoint, ramp, self.t
        if not powered:
            self._from = self._to = 0.0
        if self._to == 0.0:
            self.stopped.set()


@dataclass(frozen=True, slots=True)
class Loops:
    """The samples as they go over the wire, each loop long enough to cut a frame beginning anywhere."""

    scans: dict[str, int]
    wire: dict[str, bytes]
    channels: int

    @classmethod
    def read(cls, path: Path) -> "Loops":
        """Return the loops of a file of recorder_signal."""
        with np.load(path) as file:
            loops = {name: file[name] for name in file.files}
        wire = {name: int24(np.concatenate([loop, loop[:FRAME_SCANS]])) for name, loop in loops.items()}
        return cls({name: len(loop) for name, loop in loops.items()}, wire, loops["rest"].shape[1])

    def cut(self, name: str, first: int) -> bytes:
        """Return the counts of the frame that begins at scan `first`."""
        size, at = 3 * self.channels, first % self.scans[name]
        return self.wire[name][at * size : (at + FRAME_SCANS) * size]


class Board:
    """The DAQ: answers on its port and streams, paced by the machine's clock."""

    def __init__(self, rig: RigConfig, loops: Loops, rotor: Rotor, drive: Drive, loud: tuple[float, float] | None):
        assert rig.daq
        self._rate, self._loops, self._rotor, self._drive, self._loud = rig.daq.sample_rate, loops, rotor, drive, loud
        self._began: float | None = None  # when scan 0 was taken; None: not streaming
        self._frames = self._sent = self._lost = 0
        self._loud_from = float("inf")  # from when on it vibrates too much
        self._loud_seen: float | None = None  # when the first loud frame was on the wire
        self._told = False  # what came of this stream's trip
        self._at_speed = False
        self._stopped_at: int | None = None  # scan from which on the rotor slows down
        self._sending = asyncio.Lock()  # one frame after the other

    async def listen(self, pty: Pty) -> None:
        """Obey what comes in on the port."""
        line = b""
        while True:
            *lines, line = (line + await pty.read()).split(b"\n")
            for word in lines:
                await self._obey(word, pty)

    async def stream(self, pty: Pty) -> None:
        """Send frames when they are due, and tell what came of the loud ones."""
        while True:
            if self._began is None:
                await asyncio.sleep(0.005)
                continue
            due = self._began + (self._frames + 1) * FRAME_SCANS / self._rate
            await asyncio.sleep(max(0.0, due - time.monotonic()))
            if self._began is not None:
                await self._send(pty, late=time.monotonic() - due > FIFO_SECONDS)
                self._follow_trip()

    async def _obey(self, word: bytes, pty: Pty) -> None:
        if word == b"ID?":
            await self._put(pty, frame(_INFO, json.dumps(self._info()).encode()))
        elif word == b"START":
            self._drive.fault = 0  # the operator has seen to the last one
            self._frames = self._sent = self._lost = 0
            self._loud_from, self._loud_seen, self._told = float("inf"), None, False
            self._at_speed, self._stopped_at = False, None
            self._began = time.monotonic()
            say(start=self._began)
        elif word == b"STOP":
            if self._began is not None:
                say(sent=self._sent * FRAME_SCANS, lost=self._lost * FRAME_SCANS)
            self._began = None
            await self._put(pty, frame(_STOPPED, struct.pack("<Q", self._frames * FRAME_SCANS)))

    async def _send(self, pty: Pty, *, late: bool) -> None:
        now, first = time.monotonic(), self._frames * FRAME_SCANS
        self._frames += 1
        if late:
            self._lost += 1
            return
        name, begin = self._choose_loop(now, first)
        head = struct.pack("<IQHB", self._sent, first, FRAME_SCANS, self._loops.channels)
        self._sent += 1
        await self._put(pty, frame(_DATA, head + self._loops.cut(name, first - begin)))
        if name == "loud" and self._loud_seen is None and not self._told:
            self._loud_seen = time.monotonic()
        if name == "running" and self._loud and self._loud_from == float("inf"):
            self._rotor.stopped.clear()
            self._loud_from = now + random.uniform(*self._loud)

    def _choose_loop(self, now: float, first: int) -> tuple[str, int]:
        """Return the loop that the frame from scan `first` on is cut from, and the scan at which it began."""
        if self._rotor.speed >= 0.99 * SPEED:
            self._at_speed = True
            return "loud" if now >= self._loud_from else "running", 0
        if self._at_speed and self._stopped_at is None:
            self._stopped_at = first
            say(stopping=first)
        if self._stopped_at is not None and first - self._stopped_at < self._loops.scans["stopping"]:
            return "stopping", self._stopped_at
        return "rest", 0

    async def _put(self, pty: Pty, data: bytes) -> None:
        async with self._sending:
            await pty.write(data)

    def _follow_trip(self) -> None:
        if self._loud_seen is not None and time.monotonic() - self._loud_seen > MISSED_SECONDS:
            say(trip_s=None)
            self._loud_seen, self._told = None, True

    async def tell_trips(self) -> None:
        """Tell how long after the first loud frame a stop was obeyed."""
        while True:
            await self._rotor.stopped.wait()
            now = time.monotonic()
            self._rotor.stopped.clear()
            if self._loud_seen is not None:
                say(trip_s=now - self._loud_seen)
                self._loud_seen, self._told = None, True

    def _info(self) -> dict[str, object]:
        return {
            "protocol": 1,
            "model": "recorder benchmark",
            "serial": "1",
            "sample_rate_hz": self._rate,
            "channels": self._loops.channels,
            "volts_per_count": [24.0 / 32768] * self._loops.channels,
            "full_scale_counts": 32768,
        }


def say(**values: object) -> None:
    """Print a line of JSON."""
    os.write(1, json.dumps(values).encode() + b"\n")


async def _run(rig: RigConfig, loops: Loops, loud: tuple[float, float] | None) -> None:
    assert rig.motor
    rotor, end = Rotor(), asyncio.Event()
    asyncio.get_running_loop().add_reader(0, lambda: end.set() if not os.read(0, 4096) else None)
    with tempfile.TemporaryDirectory(prefix="recorder-rig-") as folder, Pty() as pty:
        serving = controllers.serve_controller(
            rig.motor, rotor, clock=WallClock(), rate=1.0, name=Path(folder) / "motor"
        )
        async with serving as controller:
            board = Board(rig, loops, rotor, controller.drive, loud)
            jobs = [
                asyncio.create_task(job)
                for job in (board.listen(pty), board.stream(pty), board.tell_trips(), _tick(controller.drive))
            ]
            say(motor=controller.place, daq={"port": pty.port})
            await asyncio.wait([*jobs, asyncio.create_task(end.wait())], return_when=asyncio.FIRST_COMPLETED)
            for job in jobs:
                job.cancel()


async def _tick(drive: Drive) -> None:
    while True:
        drive.tick()
        await asyncio.sleep(0.02)


def main() -> None:
    """Run the rig until its standard input ends."""
    parser = argparse.ArgumentParser(description="The rig of the recorder's benchmark.")
    parser.add_argument("config", type=Path)
    parser.add_argument("signal", type=Path)
    parser.add_argument("--loud", type=float, nargs=2, help="s at speed before it vibrates too much")
    given = parser.parse_args()
    asyncio.run(_run(load(given.config), Loops.read(given.signal), tuple(given.loud) if given.loud else None))


if __name__ == "__main__":
    main()

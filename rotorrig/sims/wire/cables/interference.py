"""Interference on a cable: messages lost, damaged, late or doubled by the faults acting on it."""

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from rotorrig.sims.wire.fault_script import Corrupt, Delay, Drop, Duplicate, OfMessages

Deliver = Callable[[bytes], Awaitable[None]]
Toward = Literal["to-device", "from-device"]
_UNDER_WAY = 1000  # messages that may be late at once: a second of a stream at its fastest


@dataclass(slots=True, eq=False)
class _Acting:
    fault: OfMessages
    rng: np.random.Generator
    hits: int = 0

    def hit(self, toward: Toward) -> bool:
        """Return whether it hits the next message, and count the hit."""
        fault = self.fault
        if fault.direction not in ("both", toward) or self.hits == fault.count:
            return False
        struck = fault.share == 1.0 or bool(self.rng.random() < fault.share)
        self.hits += struck
        return struck


class Interference:
    """The faults that act on the messages of one link, both ways."""

    def __init__(self) -> None:
        self._silent = False
        self._acting: list[_Acting] = []

    def begin(self, fault: OfMessages, rng: np.random.Generator) -> None:
        """Let `fault` act; `rng` draws which messages and which of their bits."""
        self._acting.append(_Acting(fault, rng))

    def end(self, fault: OfMessages) -> int:
        """Let `fault` act no more; return how many messages it has hit."""
        (ended,) = (a for a in self._acting if a.fault is fault)
        self._acting.remove(ended)
        return ended.hits

    def is_spent(self, fault: OfMessages) -> bool:
        """Return whether `fault` has hit as many messages as it may."""
        return any(a.fault is fault and a.hits == fault.count for a in self._acting)

    def silence(self, silent: bool) -> None:
        """Let nothing through, or everything again."""
        self._silent = silent

    def disturb(self, message: bytes, toward: Toward) -> tuple[list[bytes], float]:
        """Return what arrives of a message, and the delay [s]."""
        arriving, late = [] if self._silent else [message], 0.0
        for acting in self._acting:
            if not acting.hit(toward):
                continue
            match acting.fault:
                case Drop(bytes=count):
                    arriving = [short for m in arriving if (short := _shorten(m, count, acting.rng))]
                case Corrupt(bits=count):
                    arriving = [_flip_bits(m, count, acting.rng) for m in arriving]
                case Duplicate():
                    arriving = [m for m in arriving for _ in range(2)]
                case Delay(by=seconds):
                    late += seconds
        return arriving, late


def _shorten(message: bytes, count: int | None, rng: np.random.Generator) -> bytes:
    if count is None or count >= len(message):
        return b""
    return np.delete(np.frombuffer(message, np.uint8), rng.choice(len(message), count, replace=False)).tobytes()


def _flip_bits(message: bytes, count: int, rng: np.random.Generator) -> bytes:
    bits = np.unpackbits(np.frombuffer(message, np.uint8))
    bits[rng.choice(len(bits), min(count, len(bits)), replace=False)] ^= 1
    return np.packbits(bits).tobytes()


class Lane:
    """One direction of a link: messages are put in, and delivered in their order as interference lets them through.

    What is to be late is delivered while `run` runs; all else at once, without a turn of the event loop.
    """

    def __init__(self, interference: Interference, toward: Toward, deliver: Deliver) -> None:
        self._interference, self._toward, self._deliver = interference, toward, deliver
        self._late: asyncio.Queue[tuple[float, bytes]] = asyncio.Queue(_UNDER_WAY)
        self._waiting = 0  # messages that are late and not yet delivered

    async def put(self, message: bytes) -> None:
        """Send a message; return when it is delivered, or at once if it is to be late."""
        arriving, late = self._interference.disturb(message, self._toward)
        if not late and not self._waiting:
            for piece in arriving:
                await self._deliver(piece)
            return
        due = asyncio.get_running_loop().time() + late
        for piece in arriving:
            self._waiting += 1
            await self._late.put((due, piece))
        if not late:
            await self._late.join()

    async def run(self) -> None:
        """Deliver what is late, until cancelled."""
        while True:
            due, message = await self._late.get()
            await asyncio.sleep(due - asyncio.get_running_loop().time())
            await self._deliver(message)
            self._waiting -= 1
            self._late.task_done()

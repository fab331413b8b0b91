"""Inputs of the DAQ, between the rig's sensors and the board: cables that can come off."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.sims.wire.probe_daq import Firmware


class Inputs:
    """A simulated_time.Sampler in front of the board; `keyphasor` is the channel of the pulse, None: there is none."""

    def __init__(self, board: Firmware, *, keyphasor: int | None) -> None:
        self._board, self._keyphasor = board, keyphasor
        self._keyphasor_lost = False

    async def room(self) -> None:
        """Return when the board has room for samples."""
        await self._board.room()

    def measure(self, counts: NDArray[np.int32]) -> None:
        """Hand samples (sample, channel) on to the board."""
        if self._keyphasor_lost and self._keyphasor is not None:
            counts = counts.copy()
            counts[:, self._keyphasor] = 0  # an input without a cable
        self._board.measure(counts)

    def lose_keyphasor(self, lost: bool) -> None:
        """Pull the keyphasor's cable off, or put it back."""
        self._keyphasor_lost = lost

    def overrun(self, overrun: bool) -> int:
        """Begin or end an overrun of the board; return how many scans it has lost so far."""
        self._board.overrunning = overrun
        return self._board.lost

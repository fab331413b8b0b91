"""Preview of a recording, for viewers that plot numbers over time: speed, and each probe's envelope.

The samples themselves are arrays, which Foxglove and Rerun do not draw over time. So beside them stands, every fifth of
a second, the speed by the keyphasor and between which displacements each probe read since the last one. It is made of
the samples as they are written, and of a cut recording's as it is salvaged; nothing reads it back.
"""

from collections.abc import Iterator
from typing import Any, Self

import numpy as np

from rotorrig.acquisition.files.schemas import MessageType, message_type
from rotorrig.rig import ConfigError
from rotorrig.rig.config import RPM, UM, RigConfig
from rotorrig.rig.probes import Block, DaqInfo, KeyphasorSpeed, ProbeScale

EVERY_NS = 200_000_000  # of the sample clock: 2 % of a recording of 5 channels at 10 kHz, less of a faster one

SPEED = message_type("Speed", {"rpm": "double"})  # median of the last five turns; 0 before a whole one
ENVELOPE = message_type(
    "Envelope",
    {
        "low_um": "double",  # smallest displacement towards the probe since the last message, 0 at its gap voltage
        "high_um": "double",  # largest
    },
)


class Preview:
    """Follows the blocks of a recording."""

    def __init__(self, rig: RigConfig, info: DaqInfo) -> None:
        """Begin. Raises ConfigError if the config names a channel that the DAQ has not."""
        self._scale = ProbeScale.of(rig, info)
        self._keyphasor = KeyphasorSpeed(rig, info) if rig.keyphasor else None
        self._since_ns: int | None = None  # None: nothing has come since the last messages
        self._lows = np.empty(0)
        self._highs = np.empty(0)

    @classmethod
    def of(cls, rig: RigConfig, info: DaqInfo) -> Self | None:
        """Return one, or None where the config does not fit the DAQ: that must not keep samples from being written."""
        try:
            return cls(rig, info)
        except ConfigError:
            return None

    @property
    def topics(self) -> dict[str, MessageType]:
        """Its topics."""
        envelopes = {f"/envelope/{name}": ENVELOPE for name in self._scale.names}
        return {"/speed": SPEED, **envelopes} if self._keyphasor else envelopes

    def take(self, block: Block) -> Iterator[tuple[str, MessageType, dict[str, Any]]]:
        """Take the next block; yield topic, message type and fields of what is due at its time."""
        if not len(block.counts):
            return
        if self._keyphasor:
            self._keyphasor.update(block)
        counts = block.counts[:, self._scale.channels]
        both = np.stack([counts.min(axis=0), counts.max(axis=0)]) * self._scale.gain + self._scale.offset
        if self._since_ns is None:
            self._since_ns, self._lows, self._highs = block.t_ns, both.min(axis=0), both.max(axis=0)
        else:
            self._lows = np.minimum(self._lows, both.min(axis=0))
            self._highs = np.maximum(self._highs, both.max(axis=0))
        if block.t_ns - self._since_ns < EVERY_NS:
            return
        self._since_ns = None
        if self._keyphasor:
            yield "/speed", SPEED, {"rpm": self._keyphasor.steady_speed * RPM}
        for name, low, high in zip(self._scale.names, self._lows.tolist(), self._highs.tolist(), strict=True):
            yield f"/envelope/{name}", ENVELOPE, {"low_um": low * UM, "high_um": high * UM}

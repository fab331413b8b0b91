"""Driver of openDAQ devices: packets of each channel, assembled to scans on the device's clock."""

import time
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import OpenDaq
from rotorrig.rig.errors import ConfigError, LinkLost
from rotorrig.rig.probes.base import Block, DaqCounters, DaqInfo
from rotorrig.rig.probes.opendaq.device import Channel, OpenDaqDevice
from rotorrig.rig.probes.opendaq.scan_assembly import ScanAssembler
from rotorrig.rig.probes.opendaq.tick_index import TickIndex
from rotorrig.rig.probes.requirements import check_requirements
from rotorrig.rig.probes.tally import Tally

POLL_SECONDS = 0.005  # between looks for packets; devices send some every 10 to 50 ms


class OpenDaqDaq:
    """A rig.probes.base.Daq; `channels` is how many of the device's inputs the config needs, counted from its first."""

    def __init__(self, table: OpenDaq, *, channels: int) -> None:
        self._table = table
        self._want_channels = channels
        self._device: OpenDaqDevice | None = None
        self._channels: list[Channel] = []
        self._info: DaqInfo | None = None
        self._readers: list[Any] = []
        self._scans = ScanAssembler(channels)
        self._ticks: TickIndex | None = None
        self._first = 0  # where counting began: the first sample all channels had
        self._tally: Tally | None = None

    @property
    def counters(self) -> DaqCounters:
        """Data received and lost since `start`, up to the last block read."""
        return self._tally.counters if self._tally else DaqCounters()

    def open(self) -> DaqInfo:
        """Connect to the device, set it and ask what it is.

        Raises LinkLost if it does not answer, ConfigError if it is not the DAQ the config describes or the SDK is not
        installed.
        """
        self.close()
        self._device = OpenDaqDevice(self._table, inputs=self._want_channels)
        try:
            self._channels = self._device.channels()
            self._info = _info(self._device, self._channels, self._table)
            check_requirements(
                self._info,
                where=self._table.connection,
                sample_rate=self._table.sample_rate,
                channels=self._want_channels,
            )
        except BaseException:
            self.close()
            raise
        return self._info

    def start(self) -> None:
        """Begin to stream at sample 0: the first that all channels have. Raises LinkLost."""
        self.stop()
        if self._device is None or self._info is None:
            raise LinkLost(f"{self._table.connection}: the DAQ is not open")
        self._scans = ScanAssembler(len(self._channels))
        self._ticks = TickIndex(
            delta=self._channels[0].time.delta, sample_rate=self._info.sample_rate, channels=len(self._channels)
        )
        self._tally = Tally(
            self._info,
            lowest=np.array([c.scale.lowest for c in self._channels], dtype=np.int32),
            highest=np.array([c.scale.highest for c in self._channels], dtype=np.int32),
        )
        self._readers = [self._device.reader(channel) for channel in self._channels]

    def read(self, timeout: float = 1.0) -> Block:
        """Return the next block. Raises LinkLost after `timeout` seconds without one, or if the device is set anew."""
        if not self._readers or self._tally is None:
            raise LinkLost(f"{self._table.connection}: the DAQ is not streaming, want start() first")
        deadline = time.monotonic() + timeout
        while True:
            for number, channel in enumerate(self._channels):
                self._collect(number, channel)
            if scans := self._scans.take():
                return self._make_block(*scans)
            if time.monotonic() > deadline:
                raise LinkLost(f"{self._table.connection}: no samples from the DAQ for {timeout:g} s")
            time.sleep(POLL_SECONDS)

    def stop(self) -> None:
        """End the stream, dropping blocks not yet read; may be called twice."""
        self._readers = []  # a reader that is gone is disconnected

    def close(self) -> None:
        """Let go of the device; may be called twice."""
        self.stop()
        self._channels = []
        self._device = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _collect(self, number: int, channel: Channel) -> None:
        """Take what a channel has sent since the last look. Raises LinkLost if it cannot go on like this."""
        assert self._device is not None
        for packet in self._readers[number].read_all():
            if data := self._device.data_packet(packet):
                values = np.frombuffer(data.raw_data if channel.is_raw else data.data, channel.raw)
                tick = data.domain_packet.offset.int_value
                self._scans.add(number, self._sample_index(number, tick, len(values)), channel.scale.counts(values))
            elif not self._device.is_unchanged(channel):
                raise LinkLost(
                    f"{self._table.connection}: {channel.name} was given another rate or range while it streams; "
                    "want a device that nobody else sets"
                )

    def _sample_index(self, number: int, tick: int, samples: int) -> int:
        assert self._ticks is not None
        try:
            return self._ticks.first(number, tick=tick, samples=samples)
        except LinkLost as error:
            raise LinkLost(f"{self._table.connection}: {error}") from error

    def _make_block(self, first: int, counts: NDArray[np.int32]) -> Block:
        assert self._tally is not None
        if not self._tally.next_sample:
            self._first = first
        return self._tally.block(counts, first_sample=first - self._first)


def _info(device: OpenDaqDevice, channels: list[Channel], table: OpenDaq) -> DaqInfo:
    """Return what the device says of itself. Raises ConfigError if its channels do not run together."""
    if not channels:
        raise ConfigError(f"daq.connection: the device at {table.connection} has no analog inputs")
    for channel in channels:
        if channel.time != channels[0].time:
            raise ConfigError(
                f"daq.connection: {channel.name} samples at {channel.time.sample_rate:.10g} Hz and {channels[0].name} "
                f"at {channels[0].time.sample_rate:.10g} Hz, want one rate for all"
            )
    return DaqInfo(
        model=device.model,
        serial=device.serial,
        sample_rate=channels[0].time.sample_rate,
        channels=len(channels),
        volts_per_count=tuple(c.scale.volts_per_count for c in channels),
        full_scale_counts=min(c.scale.full_scale for c in channels),
        remarks=_remarks(channels),
    )


def _remarks(channels: list[Channel]) -> tuple[str, ...]:
    """Return what was done to which channels, those alike in one sentence."""
    remarks = dict.fromkeys(c.scale.remark for c in channels)
    same = {r: [str(n) for n, c in enumerate(channels) if c.scale.remark == r] for r in remarks}
    return tuple(f"channel{'s'[: len(n) - 1]} {', '.join(n)}: {remark}" for remark, n in same.items())

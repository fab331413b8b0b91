"""Driver of the framed serial DAQ (docs/daq-stream.md): ask, start, read blocks, stop."""

import contextlib
import time
from collections.abc import Iterator
from types import TracebackType
from typing import Self

import serial

from rotorrig.rig.errors import BadFrame, LinkLost
from rotorrig.rig.probes.base import Block, DaqCounters, DaqInfo
from rotorrig.rig.probes.requirements import check_requirements
from rotorrig.rig.probes.stream.frames import ASK, START, STOP, Complaint, Data, Frame, Info, Stopped, decode_info
from rotorrig.rig.probes.stream.port import POLL_SECONDS, FramePort
from rotorrig.rig.probes.stream.sequence import FrameSequence, Place
from rotorrig.rig.probes.tally import Tally
from rotorrig.rig.serial_port import open_serial

ANSWER_SECONDS = 3.0  # for INFO: boards that reset when their port is opened boot in about two
ASK_AGAIN_SECONDS = 0.5
STOP_SECONDS = 1.0  # for STOPPED
WRITE_SECONDS = 1.0


class StreamDaq:
    """A rig.probes.base.Daq; `sample_rate` [Hz] and `channels` are what the config needs of the device."""

    def __init__(self, port: str, *, sample_rate: float, channels: int, baudrate: int = 115200) -> None:
        self.port = port
        self._baudrate = baudrate
        self._want_rate = sample_rate
        self._want_channels = channels
        self._info: DaqInfo | None = None
        self._wire: FramePort | None = None
        self._streaming = False
        self._tally: Tally | None = None
        self._sequence = FrameSequence(sample_rate=sample_rate)
        self._noise_before = (0, 0)  # damaged frames, stray bytes up to the start

    @property
    def counters(self) -> DaqCounters:
        """Data received and lost since `start`, up to the last block read."""
        return self._tally.counters if self._tally else DaqCounters()

    def open(self) -> DaqInfo:
        """Open the port and ask the device what it is.

        Raises LinkLost if the port does not open or no DAQ of protocol 1 answers, ConfigError if it is not the DAQ
        the config describes.
        """
        self.close()
        self._wire = FramePort(self._open_port())
        try:
            self._send(STOP)  # it may still stream to whoever asked before
            self._info = self._ask()
            check_requirements(self._info, where=self.port, sample_rate=self._want_rate, channels=self._want_channels)
        except BaseException:
            self.close()
            raise
        return self._info

    def start(self) -> None:
        """Begin to stream at sample 0. Raises LinkLost."""
        self.stop()
        decoder = self._require_port().decoder
        assert self._info is not None
        self._tally = Tally(self._info)
        self._sequence = FrameSequence(sample_rate=self._info.sample_rate)
        self._noise_before = (decoder.bad_frames, decoder.skipped_bytes)
        self._send(START)
        self._streaming = True

    def read(self, timeout: float = 1.0) -> Block:
        """Return the next block. Raises LinkLost after `timeout` seconds without one, or when the port is gone."""
        if not self._streaming:
            raise LinkLost(f"{self.port}: the DAQ is not streaming, want start() first")
        for frame, heard in self._frames(timeout):
            match frame:
                case Data() if len(frame.counts):
                    if block := self._make_block(frame, heard):
                        return block
                case Complaint():
                    raise LinkLost(f"{self.port}: the DAQ says '{frame.text}'")
                case Stopped() if self._tally and self._tally.next_sample:  # before any sample: of the stream before
                    self._streaming = False
                    raise LinkLost(f"{self.port}: the DAQ stopped by itself after {frame.scans} scans")
        self._count_noise()
        raise LinkLost(f"{self.port}: no samples from the DAQ for {timeout:g} s{self._noise()}")

    def stop(self) -> None:
        """End the stream, dropping blocks not yet read. Raises LinkLost if the device does not confirm."""
        if not self._streaming:
            return
        self._streaming = False
        self._send(STOP)
        if not any(isinstance(frame, Stopped) for frame, _ in self._frames(STOP_SECONDS)):
            raise LinkLost(f"{self.port}: asked the DAQ to stop, no answer in {STOP_SECONDS:g} s{self._noise()}")

    def close(self) -> None:
        """Give the port back, asking a device that still streams to stop."""
        wire, self._wire = self._wire, None
        if wire is None:
            return
        if self._streaming:
            self._streaming = False
            with contextlib.suppress(OSError):  # the wire may be what went wrong
                wire.port.write(STOP)
        wire.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _open_port(self) -> serial.Serial:
        return open_serial(self.port, self._baudrate, of="DAQ", timeout=POLL_SECONDS, write_timeout=WRITE_SECONDS)

    def _ask(self) -> DaqInfo:
        """Ask until the device answers; what a stream of before left on the wire is passed over."""
        complaint = ""
        for _ in range(round(ANSWER_SECONDS / ASK_AGAIN_SECONDS)):
            self._send(ASK)
            for frame, _ in self._frames(ASK_AGAIN_SECONDS):
                if isinstance(frame, Info):
                    return self._decode_info(frame)
                if isinstance(frame, Complaint):
                    complaint = f"; it says '{frame.text}'"
        raise LinkLost(f"{self.port}: asked 'ID?', no DAQ answered in {ANSWER_SECONDS:g} s{complaint}{self._noise()}")

    def _decode_info(self, frame: Info) -> DaqInfo:
        try:
            return decode_info(frame.payload)
        except BadFrame as error:
            raise LinkLost(f"{self.port}: the DAQ's answer cannot be used: {error}") from error

    def _make_block(self, frame: Data, heard: float) -> Block | None:
        """Return a frame as a block, None if it came late or twice; count missing frames."""
        assert self._info is not None and self._tally is not None
        if frame.counts.shape[1] != self._info.channels:
            raise LinkLost(
                f"{self.port}: the DAQ sent {frame.counts.shape[1]} channels, want the {self._info.channels} it named"
            )
        try:
            place, missing_frames = self._sequence.place(frame)
        except LinkLost as error:
            raise LinkLost(f"{self.port}: {error}") from error
        self._count_noise()
        if place is not Place.NEXT:
            self._tally.count(**{"late_frames" if place is Place.LATE else "repeated_frames": 1})
            return None
        self._tally.count(lost_frames=missing_frames)
        return self._tally.block(frame.counts, first_sample=frame.first_scan, overrun=frame.overrun, arrived=heard)

    def _count_noise(self) -> None:
        """Take over what the decoder dropped since the start; it runs ahead by the frames not yet read."""
        decoder = self._require_port().decoder
        assert self._tally is not None
        frames, stray = self._noise_before
        self._noise_before = (decoder.bad_frames, decoder.skipped_bytes)
        self._tally.count(damaged_frames=decoder.bad_frames - frames, stray_bytes=decoder.skipped_bytes - stray)

    def _send(self, line: bytes) -> None:
        try:
            self._require_port().port.write(line)
        except OSError as error:
            raise LinkLost(f"{self.port}: '{line.decode().strip()}' cannot be sent to the DAQ ({error})") from error

    def _frames(self, seconds: float) -> Iterator[tuple[Frame, float]]:
        """Yield what arrives within `seconds`, and when. Raises LinkLost when the port is gone.

        A process that was held up meanwhile has not waited: what the port kept for it is still to come.
        """
        wire, waited = self._require_port(), 0.0
        while waited < seconds:
            began = time.monotonic()
            frame = wire.next_frame(min(POLL_SECONDS, seconds - waited))
            waited += min(time.monotonic() - began, POLL_SECONDS)
            if frame:
                yield frame

    def _require_port(self) -> FramePort:
        if self._wire is None:
            raise LinkLost(f"{self.port}: the DAQ's port is not open")
        return self._wire

    def _noise(self) -> str:
        decoder = self._require_port().decoder
        stray = decoder.skipped_bytes + decoder.pending
        return f" ({stray} bytes came that are no frame; is it another device?)" if stray else ""

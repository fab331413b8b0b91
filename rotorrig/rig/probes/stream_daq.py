"""The framed serial DAQ (docs/daq-stream.md) behind a serial port: owns the port, hands on Blocks.

A thread of its own empties the port, so that a slow Modbus reply or a busy disk elsewhere costs no samples: an
operating system buffers some 20 kB of a serial port, 17 ms of 8 channels at 50 kS/s. The thread runs at most
`BLOCKS_AHEAD` frames ahead of `read`; then the port is left to fill and the device flags what it had to drop.
"""

import contextlib
import queue
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from types import TracebackType
from typing import Self

import serial

from rotorrig.rig.errors import BadFrame, ConfigError, LinkLost
from rotorrig.rig.probes import daq_frames
from rotorrig.rig.probes.base import Block, DaqInfo
from rotorrig.rig.probes.daq_frames import Complaint, Data, Frame, FrameDecoder, Info, Stopped
from rotorrig.rig.serial_port import why_closed

BLOCKS_AHEAD = 50  # frames; a second of 20 ms frames
ANSWER_SECONDS = 3.0  # for INFO: boards that reset when their port is opened boot in about two
ASK_AGAIN_SECONDS = 0.5
STOP_SECONDS = 1.0  # for STOPPED
POLL_SECONDS = 0.05  # of one read of the port
PAUSE_SECONDS = 0.5  # of silence inside a frame after which its rest will not come
WRITE_SECONDS = 1.0
RATE_TOLERANCE = 1e-6  # relative


@dataclass(slots=True)
class StreamCounters:
    """What has arrived since START, and what went wrong on the way; only `blocks` moves on a sound link."""

    blocks: int = 0
    gaps: int = 0  # jumps of the scan index
    lost_scans: int = 0  # in those gaps
    lost_frames: int = 0  # by sequence number
    overruns: int = 0  # frames before which the device says it lost samples
    bad_frames: int = 0  # damaged
    skipped_bytes: int = 0  # part of no frame


class StreamDaq:
    """A rig.probes.base.Daq; `sample_rate` [Hz] and `channels` are what the config needs of the device."""

    def __init__(self, port: str, *, sample_rate: float, channels: int) -> None:
        self.port = port
        self.counters = StreamCounters()
        self._want_rate = sample_rate
        self._want_channels = channels
        self._info: DaqInfo | None = None
        self._reader: _Reader | None = None
        self._streaming = False
        self._next_sequence = 0
        self._next_scan = 0

    def open(self) -> DaqInfo:
        """Open the port and ask the device what it is.

        Raises LinkLost if the port does not open or no DAQ of protocol 1 answers, ConfigError if it is not the DAQ
        the config describes.
        """
        self.close()
        self._reader = _Reader(self._open_port())
        try:
            self._send(daq_frames.STOP)  # it may still stream to whoever asked before
            self._info = self._ask()
            self._check(self._info)
        except BaseException:
            self.close()
            raise
        return self._info

    def start(self) -> None:
        """Begin to stream at sample 0. Raises LinkLost."""
        self.stop()
        self.counters = StreamCounters()
        self._open_reader().reset_counters()
        self._next_sequence = self._next_scan = 0
        self._send(daq_frames.START)
        self._streaming = True

    def read(self, timeout: float = 1.0) -> Block:
        """Return the next block. Raises LinkLost after `timeout` seconds without one, or when the port is gone."""
        if not self._streaming:
            raise LinkLost(f"{self.port}: the DAQ is not streaming, want start() first")
        for frame in self._frames(timeout):
            match frame:
                case Data() if len(frame.counts):
                    return self._block(frame)
                case Complaint():
                    raise LinkLost(f"{self.port}: the DAQ says '{frame.text}'")
                case Stopped():
                    self._streaming = False
                    raise LinkLost(f"{self.port}: the DAQ stopped by itself after {frame.scans} scans")
        raise LinkLost(f"{self.port}: no samples from the DAQ for {timeout:g} s{self._noise()}")

    def stop(self) -> None:
        """End the stream, dropping blocks not yet read. Raises LinkLost if the device does not confirm."""
        if not self._streaming:
            return
        self._streaming = False
        self._send(daq_frames.STOP)
        if not any(isinstance(frame, Stopped) for frame in self._frames(STOP_SECONDS)):
            raise LinkLost(f"{self.port}: asked the DAQ to stop, no answer in {STOP_SECONDS:g} s{self._noise()}")

    def close(self) -> None:
        """Give the port back, asking a device that still streams to stop."""
        reader, self._reader = self._reader, None
        if reader is None:
            return
        if self._streaming:
            self._streaming = False
            with contextlib.suppress(OSError):  # the wire may be what went wrong
                reader.port.write(daq_frames.STOP)
        reader.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _open_port(self) -> serial.Serial:
        try:
            return serial.Serial(self.port, timeout=POLL_SECONDS, write_timeout=WRITE_SECONDS, exclusive=True)
        except (OSError, ValueError) as error:
            raise LinkLost(f"{self.port}: the DAQ's port cannot be opened ({why_closed(self.port)})") from error

    def _ask(self) -> DaqInfo:
        """Ask until the device answers; what a stream of before left on the wire is passed over."""
        complaint = ""
        for _ in range(round(ANSWER_SECONDS / ASK_AGAIN_SECONDS)):
            self._send(daq_frames.ASK)
            for frame in self._frames(ASK_AGAIN_SECONDS):
                if isinstance(frame, Info):
                    return self._understood(frame)
                if isinstance(frame, Complaint):
                    complaint = f"; it says '{frame.text}'"
        raise LinkLost(f"{self.port}: asked 'ID?', no DAQ answered in {ANSWER_SECONDS:g} s{complaint}{self._noise()}")

    def _understood(self, frame: Info) -> DaqInfo:
        try:
            return daq_frames.daq_info(frame.payload)
        except BadFrame as error:
            raise LinkLost(f"{self.port}: the DAQ's answer cannot be used: {error}") from error

    def _check(self, info: DaqInfo) -> None:
        if abs(info.sample_rate - self._want_rate) > RATE_TOLERANCE * self._want_rate:
            raise ConfigError(
                f"daq.sample_rate: got {self._want_rate:.10g} Hz in the config, "
                f"want {info.sample_rate:.10g} Hz as the DAQ '{info.model}' at {self.port} samples"
            )
        if info.channels < self._want_channels:
            raise ConfigError(
                f"channel {self._want_channels - 1}: is named in the config, but the DAQ '{info.model}' at {self.port} "
                f"has {info.channels} channels, want at least {self._want_channels}"
            )

    def _block(self, frame: Data) -> Block:
        """Place a DATA frame in time and count what is missing before it."""
        assert self._info is not None
        if frame.counts.shape[1] != self._info.channels:
            raise LinkLost(
                f"{self.port}: the DAQ sent {frame.counts.shape[1]} channels, want the {self._info.channels} it named"
            )
        missing = frame.first_scan - self._next_scan
        if missing < 0:
            raise LinkLost(
                f"{self.port}: the DAQ went back to scan {frame.first_scan} after {self._next_scan}; has it restarted?"
            )
        self._count(frame, missing)
        self._next_sequence = (frame.sequence + 1) % (1 << 32)
        self._next_scan = frame.first_scan + len(frame.counts)
        return Block(
            counts=frame.counts,
            first_sample=frame.first_scan,
            t_ns=round(frame.first_scan * 1e9 / self._info.sample_rate),
            overrun=frame.overrun,
        )

    def _count(self, frame: Data, missing: int) -> None:
        counters, decoder = self.counters, self._open_reader().decoder
        counters.blocks += 1
        counters.gaps += missing > 0
        counters.lost_scans += missing
        counters.lost_frames += (frame.sequence - self._next_sequence) % (1 << 32)
        counters.overruns += frame.overrun
        counters.bad_frames, counters.skipped_bytes = decoder.bad_frames, decoder.skipped_bytes

    def _send(self, line: bytes) -> None:
        try:
            self._open_reader().port.write(line)
        except OSError as error:
            raise LinkLost(f"{self.port}: '{line.decode().strip()}' cannot be sent to the DAQ ({error})") from error

    def _frames(self, seconds: float) -> Iterator[Frame]:
        """Yield what arrives within `seconds`. Raises LinkLost when the port is gone."""
        reader = self._open_reader()
        deadline = time.monotonic() + seconds
        while (left := deadline - time.monotonic()) > 0 and (frame := reader.next_frame(left)):
            yield frame

    def _open_reader(self) -> "_Reader":
        if self._reader is None:
            raise LinkLost(f"{self.port}: the DAQ's port is not open")
        return self._reader

    def _noise(self) -> str:
        decoder = self._open_reader().decoder
        stray = decoder.skipped_bytes + decoder.pending
        return f" ({stray} bytes came that are no frame; is it another device?)" if stray else ""


class _Reader:
    """The thread that empties the port into a short queue of frames."""

    def __init__(self, port: serial.Serial) -> None:
        self.port = port
        self.decoder = FrameDecoder()
        self._frames: queue.Queue[Frame | None] = queue.Queue(BLOCKS_AHEAD)
        self._error: OSError | None = None
        self._heard = time.monotonic()  # when bytes last came
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"DAQ {port.port}", daemon=True)
        self._thread.start()

    def next_frame(self, timeout: float) -> Frame | None:
        """Return the next frame, None after `timeout` seconds. Raises LinkLost when the port is gone."""
        try:
            frame = self._frames.get(timeout=timeout)
        except queue.Empty:
            frame = None
        if frame is None and self._error:
            raise LinkLost(f"{self.port.port}: the DAQ is gone, was it unplugged? ({self._error})") from self._error
        return frame

    def reset_counters(self) -> None:
        """Begin to count anew."""
        self.decoder.bad_frames = self.decoder.skipped_bytes = 0

    def close(self) -> None:
        """End the thread, then close the port."""
        self._closing.set()
        self._thread.join()
        self.port.close()

    def _run(self) -> None:
        try:
            while not self._closing.is_set():
                for frame in self._arrived():
                    self._put(frame)
        except OSError as error:  # pyserial's own are OSErrors too
            self._error = error
            self._put(None)  # wakes who waits

    def _arrived(self) -> list[Frame]:
        data = self.port.read(self.port.in_waiting or 1)
        if data:
            self._heard = time.monotonic()
            return self.decoder.feed(data)
        if self.decoder.pending and time.monotonic() - self._heard > PAUSE_SECONDS:
            return self.decoder.give_up()
        return []

    def _put(self, frame: Frame | None) -> None:
        while not self._closing.is_set():
            with contextlib.suppress(queue.Full):
                self._frames.put(frame, timeout=POLL_SECONDS)
                return

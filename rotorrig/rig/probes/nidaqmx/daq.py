"""Driver of National Instruments' analog inputs through NI-DAQmx: continuous, buffered, in raw counts.

NI's driver keeps the samples in a buffer of this computer until they are read. It never overwrites any silently: when
that buffer or the device's own memory runs over, the acquisition ends with an error and so does the stream here, as a
lost link; there is no gap to be filled, and none to be overlooked.
"""

import contextlib
import importlib
from types import TracebackType
from typing import Any, NoReturn, Self

import numpy as np

from rotorrig.rig.config import NiDaqmx
from rotorrig.rig.errors import ConfigError, LinkLost
from rotorrig.rig.probes.base import Block, DaqCounters, DaqInfo
from rotorrig.rig.probes.nidaqmx.counts import Linearisation, linearise
from rotorrig.rig.probes.requirements import check_requirements
from rotorrig.rig.probes.tally import Tally

BLOCK_SECONDS = 0.02
BUFFER_SECONDS = 10.0  # of samples NI's driver keeps until they are read

# codes of nidaqmx.error_codes.DAQmxErrors
NO_SAMPLES_YET = -200284
OVERRUNS = {  # which memory ran over
    -200361: "the device's own memory",
    -200010: "the device's own memory",
    -209829: "the device's own memory",
    -200019: "the converter",
    -201319: "the converter",
    -200279: "this computer's buffer",
    -200222: "this computer's buffer",
    -200283: "this computer's buffer",
}
NOT_THERE = {-200220, -201003, -88708}  # invalid device id, device cannot be accessed, resource not found
IN_USE = {-50103, -200587}  # reserved by another task or program


class NiDaqmxDaq:
    """A rig.probes.base.Daq; `channels` is how many inputs the config needs, from ai0 on."""

    def __init__(self, table: NiDaqmx, *, channels: int) -> None:
        self._table = table
        self._want_channels = channels
        self._task: Any = None
        self._reader: Any = None
        self._error: type[Exception] = Exception  # nidaqmx.errors.DaqError, once the package is loaded
        self._scales: list[Linearisation] = []
        self._info: DaqInfo | None = None
        self._tally: Tally | None = None
        self._streaming = False

    @property
    def counters(self) -> DaqCounters:
        """Data received and lost since `start`, up to the last block read."""
        return self._tally.counters if self._tally else DaqCounters()

    def open(self) -> DaqInfo:
        """Reserve the inputs and set them up.

        Raises LinkLost if the device is not there or in use, ConfigError if it cannot be set as the config asks or
        NI-DAQmx is not installed.
        """
        self.close()
        package = load_package()
        self._error = package.errors.DaqError
        try:
            self._task = package.Task()
        except (package.errors.DaqNotFoundError, package.errors.DaqNotSupportedError) as error:
            raise ConfigError(
                f"daq.driver: 'nidaqmx' needs NI-DAQmx, National Instruments' driver, beside the Python package "
                f"({first_sentence(error)}); want it installed from ni.com, or on Linux by `nidaqmx installdriver`"
            ) from error
        try:
            self._set_up(package)
            self._info = self._describe()
            check_requirements(
                self._info,
                where=self._table.device,
                sample_rate=self._table.sample_rate,
                channels=self._want_channels,
            )
        except self._error as error:
            self.close()
            raise _refusal(self._table.device, error) from error
        except BaseException:
            self.close()
            raise
        return self._info

    def start(self) -> None:
        """Begin to stream at sample 0. Raises LinkLost."""
        self.stop()
        if self._task is None or self._info is None:
            raise LinkLost(f"{self._table.device}: the DAQ is not open")
        self._tally = Tally(
            self._info,
            lowest=np.array([s.lowest for s in self._scales]),
            highest=np.array([s.highest for s in self._scales]),
        )
        try:
            self._task.start()
        except self._error as error:
            raise _refusal(self._table.device, error) from error
        self._streaming = True

    def read(self, timeout: float = 1.0) -> Block:
        """Return the next block. Raises LinkLost after `timeout` seconds without one, or when samples were lost."""
        if not self._streaming or self._tally is None or self._info is None:
            raise LinkLost(f"{self._table.device}: the DAQ is not streaming, want start() first")
        n = max(1, round(BLOCK_SECONDS * self._info.sample_rate))
        raw = np.empty((self._info.channels, n), dtype=np.int32)
        try:
            self._reader.read_int32(raw, number_of_samples_per_channel=n, timeout=timeout)
        except self._error as error:
            self._give_up(error, timeout)
        counts = np.stack([scale.counts(row) for scale, row in zip(self._scales, raw, strict=True)], axis=1)
        return self._tally.block(counts, first_sample=self._tally.next_sample)

    def stop(self) -> None:
        """End the stream, dropping samples not yet read; may be called twice."""
        if not self._streaming:
            return
        self._streaming = False
        try:
            self._task.stop()
        except self._error as error:  # the error that ended the acquisition is told again here
            if error_code(error) not in OVERRUNS:
                raise LinkLost(f"{self._table.device}: {first_sentence(error)}") from error

    def close(self) -> None:
        """Give the inputs back; may be called twice."""
        task, self._task, self._reader, self._streaming = self._task, None, None, False
        if task is not None:
            with contextlib.suppress(self._error):  # of a device that is gone
                task.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _set_up(self, package: Any) -> None:
        constants, table = package.constants, self._table
        self._task.ai_channels.add_ai_voltage_chan(
            physical_channels(table.device, self._want_channels),
            terminal_config=constants.TerminalConfiguration[terminal_name(table.terminals)],
            min_val=table.low,
            max_val=table.high,
        )
        buffer = round(BUFFER_SECONDS * table.sample_rate)
        self._task.timing.cfg_samp_clk_timing(
            table.sample_rate, sample_mode=constants.AcquisitionType.CONTINUOUS, samps_per_chan=buffer
        )
        self._task.in_stream.input_buf_size = buffer
        readers = importlib.import_module("nidaqmx.stream_readers")
        self._reader = readers.AnalogUnscaledReader(self._task.in_stream)

    def _describe(self) -> DaqInfo:
        try:
            self._scales = [
                linearise(tuple(c.ai_dev_scaling_coeff), low=c.ai_rng_low, high=c.ai_rng_high)
                for c in self._task.ai_channels
            ]
        except ValueError as error:
            raise ConfigError(f"daq.device: {self._table.device}: {error}") from error
        device, scales = self._task.devices[0], self._scales
        remarks = list(dict.fromkeys(s.remark for s in scales))
        if not device.ai_simultaneous_sampling_supported and len(scales) > 1:
            apart = 1e6 / self._task.timing.ai_conv_rate
            remarks.append(f"the inputs are sampled one after another, {apart:.3g} us apart")
        return DaqInfo(
            model=str(device.product_type),
            serial=f"{device.serial_num:X}",
            sample_rate=float(self._task.timing.samp_clk_rate),
            channels=len(scales),
            volts_per_count=tuple(s.volts_per_count for s in scales),
            full_scale_counts=min(max(-s.lowest, s.highest + 1) for s in scales),
            remarks=tuple(remarks),
        )

    def _give_up(self, error: Exception, timeout: float) -> NoReturn:
        """Raise LinkLost for an error of a read, after counting it."""
        assert self._tally is not None
        code = error_code(error)
        if code in OVERRUNS:
            self._tally.count(overruns=1)
        raise LinkLost(read_failure(self._table.device, error, timeout=timeout)) from error


def load_package() -> Any:
    """Import nidaqmx. Raises ConfigError where it is not installed."""
    try:
        return importlib.import_module("nidaqmx")
    except ImportError as error:
        raise ConfigError(
            f"daq.driver: 'nidaqmx' needs the Python package of that name, which does not load ({error}); "
            "want it installed: pip install 'rotorrig[nidaqmx]'"
        ) from error


def physical_channels(device: str, channels: int) -> str:
    """Return NI's name of inputs 0 to channels - 1.

    >>> physical_channels("Dev1", 5)
    'Dev1/ai0:4'
    >>> physical_channels("cDAQ1Mod1", 1)
    'cDAQ1Mod1/ai0'
    """
    return f"{device}/ai0" + (f":{channels - 1}" if channels > 1 else "")


def terminal_name(terminals: str) -> str:
    """Return the member of nidaqmx.constants.TerminalConfiguration for the config's word.

    >>> terminal_name("pseudo-diff")
    'PSEUDO_DIFF'
    """
    return terminals.upper().replace("-", "_")


def error_code(error: Exception) -> int:
    """Return NI's number of an error, 0 if it has none."""
    return int(getattr(error, "error_code", 0))


def first_sentence(error: Exception) -> str:
    """Return the first sentence of NI's error text, which goes on with properties and codes for pages."""
    lines = str(error).strip().splitlines()
    return lines[0].split(". ")[0].rstrip(".") if lines else type(error).__name__


def read_failure(device: str, error: Exception, *, timeout: float) -> str:
    """Return why a read failed, in one sentence."""
    code = error_code(error)
    if code == NO_SAMPLES_YET:
        return f"{device}: no samples from the DAQ for {timeout:g} s"
    if code in OVERRUNS:
        return (
            f"{device}: {OVERRUNS[code]} ran over and samples were lost, which ended the acquisition ({code}); "
            "want a lower sample rate, fewer channels or a faster bus"
        )
    return f"{device}: the DAQ is gone ({first_sentence(error)}; {code})"


def _refusal(device: str, error: Exception) -> ConfigError | LinkLost:
    """Return what to raise when NI's driver does not set the device up."""
    code = error_code(error)
    if code in NOT_THERE:
        return LinkLost(f"{device}: no such NI device here ({first_sentence(error)}; {code})")
    if code in IN_USE:
        return LinkLost(f"{device}: in use by another program ({code})")
    return ConfigError(f"daq: '{device}' cannot be set up as the config asks ({first_sentence(error)}; {code})")

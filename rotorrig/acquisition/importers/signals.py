"""Import from files that hold each channel by itself (UFF, TDMS, WAV): the config's channels, of one rate."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition.importers.channel_mapping import ChannelMapping
from rotorrig.acquisition.importers.channels import Channel, FileChannel, Format, match_channels
from rotorrig.acquisition.importers.waveforms import Scale, make_recording
from rotorrig.acquisition.recording import RawRecording
from rotorrig.rig import DataError
from rotorrig.rig.config import RigConfig

PIECE = 65536  # samples made a block at a time
SAME_RATE = 1e-6  # relative; a clock's ppm is no other rate


@dataclass(frozen=True, slots=True, kw_only=True)
class Signal:
    """Channel as its file describes it."""

    names: tuple[str, ...]  # any of them names it; the first is shown
    unit: str = ""  # empty: the file does not say
    rate: float = 0.0  # Hz; 0: the file does not say
    start: float = 0.0  # s, of the first sample
    samples: int
    values: Callable[[], NDArray[np.float64]]  # (sample,), read when asked for


def read_signals(
    path: Path,
    rig: RigConfig,
    signals: Sequence[Signal],
    mapping: ChannelMapping | None,
    *,
    form: Format,
    scale: Callable[[Sequence[Channel]], Scale | None] = lambda channels: None,
) -> RawRecording:
    """Return the config's channels among `signals` as the recording of a rig; `scale` gives the DAQ's counts, if known.

    Raises DataError for a channel that is missing or of another rate, length or start, and for a value that cannot be.
    """
    channels = match_channels(path, rig, [FileChannel(s.names, s.unit) for s in signals], mapping, form=form)
    picked = [signals[channel.index] for channel in channels]
    _check_alike(path, channels, picked, form)
    rate, rate_source = _rate(path, picked[0], mapping)
    values = np.stack([_read(path, channel, signal, form) for channel, signal in zip(channels, picked, strict=True)])
    pieces = (values[:, at : at + PIECE].T for at in range(0, values.shape[1], PIECE))
    return make_recording(
        path, rig, channels, pieces, rate=rate, rate_source=rate_source, form=form, scale=scale(channels)
    )


def _check_alike(path: Path, channels: Sequence[Channel], signals: Sequence[Signal], form: Format) -> None:
    """Raise DataError unless all have the rate, start and length of the first."""
    first = signals[0]
    step = 1.0 / first.rate if first.rate else 0.0
    if first.samples < 3:
        raise DataError(f"{path}, {form.channel} '{channels[0].name}': has {first.samples} samples, want waveforms")
    for channel, signal in zip(channels, signals, strict=True):
        for got, want, within, what in (
            (signal.rate, first.rate, SAME_RATE * first.rate, "is sampled at {:.9g} Hz"),
            (signal.samples, first.samples, 0, "has {:g} samples"),
            (signal.start, first.start, step / 2, "begins at {:.9g} s"),
        ):
            if not abs(got - want) <= within:
                raise DataError(
                    f"{path}, {form.channel} '{channel.name}': {what.format(got)}, "
                    f"but '{channels[0].name}' {what.format(want)}; want the same of all"
                )


def _rate(path: Path, signal: Signal, mapping: ChannelMapping | None) -> tuple[float, str]:
    """Return the sample rate [Hz] and where it comes from."""
    asked = mapping.rate if mapping else None
    if not signal.rate and not asked:
        raise DataError(f"{path}: says no sample rate, want one in a mapping, such as rate = '25.6 kHz'")
    if asked and signal.rate and abs(asked - signal.rate) > 1e-3 * signal.rate:
        raise DataError(
            f"{path}: says a sample rate of {signal.rate:.6g} Hz, the mapping {asked:.6g} Hz; want it left out there"
        )
    return (signal.rate, "as the file says") if signal.rate else (asked or 0.0, "as the mapping says")


def _read(path: Path, channel: Channel, signal: Signal, form: Format) -> NDArray[np.float64]:
    values = signal.values()
    if values.shape != (signal.samples,):
        raise DataError(
            f"{path}, {form.channel} '{channel.name}': holds {values.size} values, its heading says {signal.samples}; "
            "is the file cut short?"
        )
    return values

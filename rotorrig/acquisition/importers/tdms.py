"""Import of waveforms from TDMS: LabVIEW's and NI-DAQmx's channels, scaled by their properties.

A channel is named by its name, or by group and name ("Measured/AI0") where two groups have the same. Its unit is the
property `unit_string` (or `NI_UnitDescription`), its rate and start are `wf_increment`, `wf_start_offset` and
`wf_start_time`. Format: NI, TDMS File Format Internal Structure.
"""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import nptdms
import numpy as np
from nptdms.log import log_manager
from numpy.typing import NDArray

from rotorrig.acquisition.importers.channel_mapping import ChannelMapping
from rotorrig.acquisition.importers.channels import Format
from rotorrig.acquisition.importers.signals import Signal, read_signals
from rotorrig.acquisition.importers.tdms_limits import BoundedFile, check_chunks, check_scales, check_segments
from rotorrig.acquisition.recording import RawRecording
from rotorrig.rig import DataError, RigError
from rotorrig.rig.config import RigConfig

FORM = Format(name="TDMS", channel="channel", unnamed="no channel of numbers")
UNIT_PROPERTIES = ("unit_string", "NI_UnitDescription")

log_manager.set_level(logging.ERROR)  # what it warns of, a recording is refused for


def read_tdms(path: Path, rig: RigConfig, mapping: ChannelMapping | None = None) -> RawRecording:
    """Read a TDMS file as the recording of a rig. Raises DataError for one that cannot be used."""
    with _data_errors(path), path.open("rb") as raw:
        check_segments(path, raw)
        with nptdms.TdmsFile.open(BoundedFile(raw, path.stat().st_size)) as file:
            check_chunks(path, file._reader._segments)  # nptdms shows them in no other way
            channels = [channel for group in file.groups() for channel in group.channels()]
            signals = [_signal(path, file, channel) for channel in channels if _holds_numbers(channel)]
            return read_signals(path, rig, signals, mapping, form=FORM)


@contextmanager
def _data_errors(path: Path) -> Iterator[None]:
    """Turn whatever nptdms makes of hostile bytes into a DataError."""
    try:
        yield
    except RigError:
        raise
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror})") from error
    except Exception as error:
        raise DataError(f"{path}: cannot be read as TDMS ({type(error).__name__}: {error!s:.200})") from error


def _holds_numbers(channel: Any) -> bool:
    kind = channel.data_type
    number = kind is not None and kind.nptype is not None and kind.nptype.kind in "iuf"
    return len(channel) > 0 and (number or bool(channel.scaler_data_types))


def _signal(path: Path, file: Any, channel: Any) -> Signal:
    own = channel.properties
    for properties in (own, file[channel.group_name].properties, file.properties):
        check_scales(f"{path}, channel '{channel.name}'", properties)
    step = _number(own, "wf_increment")
    return Signal(
        names=(channel.name, f"{channel.group_name}/{channel.name}"),
        unit=next((str(own[key]).strip() for key in UNIT_PROPERTIES if str(own.get(key, "")).strip()), ""),
        rate=float(f"{1 / step:.12g}") if step else 0.0,
        start=_number(own, "wf_start_offset") + _start_time(own),
        samples=len(channel),
        values=partial(_values, channel),
    )


def _number(properties: Any, key: str) -> float:
    value = properties.get(key, 0.0)
    return float(value) if isinstance(value, int | float) else 0.0


def _start_time(properties: Any) -> float:
    """Return `wf_start_time` in seconds of the Unix epoch, 0 without one."""
    value = properties.get("wf_start_time")
    return float((value - np.datetime64(0, "s")) / np.timedelta64(1, "s")) if isinstance(value, np.datetime64) else 0.0


def _values(channel: Any) -> NDArray[np.float64]:
    with np.errstate(all="ignore"):  # of absurd scales; what comes of them is found among the values
        return np.asarray(channel.read_data(), dtype=np.float64)

"""Export of waveforms as a universal file: a data set 58b, time response in volts, for every channel.

It is named by its channel; its second line is the calibration from volts to metres. A gap in the recording splits it
into data sets, each with its own start: nothing is filled in.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition.exporters.channels import named_channels
from rotorrig.acquisition.exporters.uff58 import GENERAL, TIME, TIME_RESPONSE, Axis, Function, binary_function
from rotorrig.acquisition.recording import RawRecording
from rotorrig.rig import write_whole_file
from rotorrig.rig.config import RigConfig
from rotorrig.rig.probes import channel_volts


def write_uff(path: Path, recording: RawRecording) -> int:
    """Write all waveforms and return the number of data sets. Raises DataError if the file cannot be written."""
    written = 0
    with write_whole_file(path) as file:
        for first, counts in recording.segments():
            for name, channel in named_channels(recording):
                volts = channel_volts(counts, channel=channel, info=recording.daq)
                file.write(binary_function(_function(recording, name, first, volts)))
                written += 1
    return written


def _function(recording: RawRecording, name: str, first: int, volts: NDArray[np.float64]) -> Function:
    rig, source = recording.rig, recording.source
    lines = (
        name,
        _calibration(rig, name),
        f"recording {source.source} {source.source_hash}, config {source.config_hash}",
        f"from sample {first} on, {recording.daq.sample_rate:.9g} Hz",
        rig.name,
    )
    planes = sorted({probe.position for probe in rig.probes})
    return Function(
        kind=TIME_RESPONSE,
        lines=lines,
        name=name,
        node=0 if name == "keyphasor" else 1 + planes.index(rig.probe(name).position),
        direction=0 if name == "keyphasor" else direction(rig, name),
        abscissa=Axis(TIME, "time", "s"),
        ordinate=Axis(GENERAL, "voltage", "V"),
        start=first / recording.daq.sample_rate,
        step=1 / recording.daq.sample_rate,
        values=volts,
    )


def direction(rig: RigConfig, probe: str) -> int:
    """Return 1, -1, 2 or -2 for a probe that sits at +X, -X, +Y or -Y, 0 for one between them."""
    quarter = rig.probe(probe).angle / (np.pi / 2)
    aligned = abs(quarter - round(quarter)) < 1e-6
    return (1, 2, -1, -2)[round(quarter) % 4] if aligned else 0


def _calibration(rig: RigConfig, name: str) -> str:
    if name == "keyphasor":
        return "shaft angle 0 at its pulse"
    probe = rig.probe(name)
    return f"towards the probe [m] = (V - {probe.gap_voltage:g}) / {probe.sensitivity:.6g}"

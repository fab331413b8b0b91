"""Export of waveforms as CSV: time, keyphasor and probes in volts, as `importers.csv` reads them.

Volts, not displacements: they are what was measured. A gap in the recording is a jump in the time column.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from rotorrig.acquisition.exporters.channels import named_channels
from rotorrig.acquisition.recording import RawRecording
from rotorrig.rig import write_whole_file

PIECE = 8192  # rows formatted at a time
DECIMALS = 3  # more than the last digit of a count: rounding is a thousandth of it


def write_csv(path: Path, recording: RawRecording) -> int:
    """Write every scan, one row each, and return their number. Raises DataError if the file cannot be written."""
    channels = named_channels(recording)
    heading = ",".join(["time [s]", *(f"{name} [V]" for name, _ in channels)])
    with write_whole_file(path) as file:
        file.write(f"{heading}\n".encode())
        for text in _rows(recording, [place for _, place in channels]):
            file.write(text.encode())
    return recording.samples


def _rows(recording: RawRecording, places: list[int]) -> Iterator[str]:
    scale = np.array(recording.daq.volts_per_count)[places]
    digits = [max(0, DECIMALS - int(np.floor(np.log10(volts)))) for volts in scale]
    row = ",".join(["%.9f", *(f"%.{n}f" for n in digits)]) + "\n"
    for block in recording.blocks:
        for at in range(0, len(block.counts), PIECE):
            volts = block.counts[at : at + PIECE, places] * scale
            times = (block.first_sample + at + np.arange(len(volts))) / recording.daq.sample_rate
            values = np.column_stack([times, volts])
            yield row * len(values) % tuple(values.ravel().tolist())

"""`rotor import`: waveforms and Bode tables of other programs to run.mcap and response.mcap."""

import math
from pathlib import Path

from rotorrig.acquisition import RawRecording
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig import DataError
from rotorrig.rig.config import RPM, RigConfig, read_toml

#: first bytes -> what the file is, whatever it is called
_BEGINNINGS = {b"TDSm": "tdms", b"RIFF": "wav", b"RF64": "wav", b"BW64": "wav", b"    -1\n": "uff", b"    -1\r": "uff"}
_ENDINGS = {".csv": "csv", ".txt": "csv", ".uff": "uff", ".unv": "uff", ".tdms": "tdms", ".wav": "wav"}


def bring_in(file: Path, *, rig: RigConfig, mapping: Path | None, out: Path, overwrite: bool = False) -> str:
    """Convert `file` to `out` and return a summary. Raises DataError, ConfigError."""
    if mapping is not None and kind_made(mapping) == "response":
        return _vectors(file, mapping, rig, out)
    return _waveforms(file, mapping, rig, out, overwrite=overwrite)


def kind_made(mapping: Path | None) -> str:
    """Return "response" for a mapping with [[vectors]], of a Bode table, else "run". Raises ConfigError."""
    if mapping is None or "channels" in read_toml(mapping, want="a mapping")[0]:
        return "run"
    return "response"


def kind_of(file: Path) -> str:
    """Return "csv", "uff", "tdms" or "wav" by a file's first bytes, else by its suffix."""
    try:
        with file.open("rb") as opened:
            beginning = opened.read(12)
    except OSError as error:
        raise DataError(f"{file}: cannot be read ({error.strerror})") from error
    for first, kind in _BEGINNINGS.items():
        if beginning.startswith(first):
            return kind
    if file.suffix.lower() not in _ENDINGS:
        raise DataError(f"{file}: cannot be imported, want one of {', '.join(_ENDINGS)}")
    return _ENDINGS[file.suffix.lower()]


def _vectors(file: Path, mapping: Path, rig: RigConfig, out: Path) -> str:
    from rotorrig.processing.files import read_table, write_response

    response = read_table(file, mapping, rig)
    write_response(out, response)
    counted = [(len(response.omega), "row"), (len(response.probes), "probe"), (len(response.runs), "run")]
    summary = f"{out}: " + ", ".join(f"{n} {noun}{'s' * (n != 1)}" for n, noun in counted)
    notes = [_describe_times(response), _describe_compensation(response), _describe_phases(response)]
    notes += dict.fromkeys(word for row in response.remarks for word in row)
    return "\n".join([summary, *(f"Note: {note}" for note in notes if note)])


def _describe_times(response: OrderTrackedResponse) -> str:
    if len(response.keyphasor_t) == 0:
        return "no times are known: the model takes the speed of every row as steady"
    return (
        "times were derived from the speeds, and the model follows the moving speed" if response.derived_times else ""
    )


def _describe_compensation(response: OrderTrackedResponse) -> str:
    if not math.isfinite(response.compensation_omega):
        return ""
    rpm = response.compensation_omega * RPM
    return f"the vectors stay compensated, and the model subtracts its own response at {rpm:.0f} rpm likewise"


def _describe_phases(response: OrderTrackedResponse) -> str:
    if not response.amplitudes_alone:
        return ""
    return (
        "the table has amplitudes without phases: rotor identify --objective f1 finds stiffness, damping and the "
        "amount of unbalance by them; its phase, the keyphasor mark, the sense of whirl and what a trial mass changes "
        "are not known"
    )


def _waveforms(file: Path, mapping: Path | None, rig: RigConfig, out: Path, *, overwrite: bool) -> str:
    from rotorrig.acquisition.files import write_recording

    recording = read_waveforms(file, rig, mapping)
    write_recording(out, recording, overwrite=overwrite)
    seconds = recording.samples / recording.daq.sample_rate
    return f"{out}: {seconds:.1f} s, {recording.samples} scans at {recording.daq.sample_rate:g} Hz"


def read_waveforms(file: Path, rig: RigConfig, mapping: Path | None) -> RawRecording:
    """Read a waveform file of another program as a recording of the rig. Raises DataError, ConfigError."""
    from rotorrig.acquisition.importers import load_channels, read_csv, read_tdms, read_uff, read_wav

    read = {"csv": read_csv, "uff": read_uff, "tdms": read_tdms, "wav": read_wav}[kind_of(file)]
    return read(file, rig, load_channels(mapping, rig) if mapping else None)

"""`rotor import`: foreign tables and waveforms into our files."""

from pathlib import Path

from rotorrig.rig.description import RigConfig
from rotorrig.rig.errors import NotBuilt


def bring_in(file: Path, *, rig: RigConfig, mapping: Path | None, out: Path) -> str:
    """Convert `file` to `out` and say what was made. Raises DataError, ConfigError, NotBuilt."""
    if file.suffix.lower() not in (".csv", ".txt"):
        raise NotBuilt(f"{file}: only CSV can be imported yet")
    return _vectors(file, mapping, rig, out) if mapping else _waveforms(file, rig, out)


def _vectors(file: Path, mapping: Path, rig: RigConfig, out: Path) -> str:
    from rotorrig.processing.response_file import write_response
    from rotorrig.processing.vector_table import read_table

    response = read_table(file, mapping, rig)
    write_response(out, response)
    counted = [(len(response.omega), "row"), (len(response.probes), "probe"), (len(response.runs), "run")]
    return f"{out}: " + ", ".join(f"{n} {noun}{'s' * (n != 1)}" for n, noun in counted)


def _waveforms(file: Path, rig: RigConfig, out: Path) -> str:
    from rotorrig.acquisition.importers.csv import read_csv
    from rotorrig.acquisition.mcap_file import write_recording

    recording = read_csv(file, rig)
    write_recording(out, recording)
    seconds = recording.samples / recording.daq.sample_rate
    return f"{out}: {seconds:.1f} s, {recording.samples} scans at {recording.daq.sample_rate:g} Hz"

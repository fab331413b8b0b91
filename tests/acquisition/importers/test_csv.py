from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from rotorrig.acquisition.files.recording_mcap import read_recording, write_recording
from rotorrig.acquisition.importers import csv
from rotorrig.acquisition.importers.channel_mapping import ChannelMapping
from rotorrig.acquisition.importers.csv import read_csv
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import DataError
from rotorrig.rig.provenance import file_hash

HEADING = "time [s], keyphasor [V], 1x [um], 1y [um], 2x [um], 2y [um]"
ROWS = ["0.000, -2.0, 0.0, 10.0, 1.5, -3", "0.001, -2.5, 1.0, 11.0, 1.5, -3", "0.002, -9.75, -1e1, 12.0, 1.5, -3"]


Table = Callable[..., Path]


@pytest.fixture
def table(tmp_path: Path) -> Table:
    def write(*rows: str, heading: str = HEADING, encoding: str = "utf-8") -> Path:
        path = tmp_path / "waves.csv"
        path.write_text("\n".join([heading, *rows]) + "\n", encoding=encoding)
        return path

    return write


def test_volts_and_micrometres_become_counts_in_the_configs_channels(rig: RigConfig, table: Table) -> None:
    path = table(*ROWS)
    recording = read_csv(path, rig)
    counts = np.concatenate([block.counts for block in recording.blocks])
    volts = counts * np.array(recording.daq.volts_per_count)
    assert volts[:, 4] == pytest.approx([-2.0, -2.5, -9.75], abs=1e-6)
    # 200 mV/mil = 7874 V/m about -10 V, towards the probe
    assert (volts[:, 0] + 10.0) / 7874.0 == pytest.approx([0.0, 1e-6, -10e-6], abs=1e-9)
    assert (volts[:, 3] + 10.0) / 7874.0 == pytest.approx([-3e-6] * 3, abs=1e-9)
    assert recording.daq.sample_rate == 1000.0
    assert recording.complete
    assert (recording.source.source, recording.source.source_hash) == (path.name, file_hash(path))


def test_what_was_assumed_is_on_record(rig: RigConfig, table: Table) -> None:
    (note,) = read_csv(table(*ROWS), rig).events
    assert note.kind == "note"
    assert "1x [um]" in note.text
    assert "1x, 1y, 2x, 2y taken as displacement towards the probe from its gap voltage" in note.text


@pytest.mark.parametrize(
    ("time", "unit", "probe", "cell"),
    [("time [ms]", 1000.0, "1x [mm]", "-0.01"), ("time [s]", 1.0, "1x [mil]", "-0.393700787"),
     ("time [us]", 1e6, "1x [V]", "-10.07874"), ("time [s]", 1.0, "1x [mV]", "-10078.74"),
     ("time [s]", 1.0, "1x [µm]", "-10")],
)  # fmt: skip
def test_units_are_those_of_the_heading(
    rig: RigConfig, table: Table, time: str, unit: float, probe: str, cell: str
) -> None:
    rows = [f"{k * unit / 2000}, -2, {cell}, 0, 0, 0" for k in range(4)]
    recording = read_csv(table(*rows, heading=f"{time}, keyphasor [V], {probe}, 1y [um], 2x [um], 2y [um]"), rig)
    assert recording.daq.sample_rate == 2000.0
    volts = recording.blocks[0].counts[:, 0] * recording.daq.volts_per_count[0]
    assert (volts + 10.0) / 7874.0 == pytest.approx([-10e-6] * 4, abs=1e-9)


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_columns_may_stand_in_any_order_among_others(rig: RigConfig, table: Table, delimiter: str) -> None:
    heading = delimiter.join(
        ["2y [um]", "note", "time [s]", '"1y [um]"', "2x [um]", "1x [um]", "keyphasor [V]", "T [K]"]
    )
    rows = [delimiter.join(["1", "ok", f"{k / 100}", "2", "3", "4", "-5", "300"]) for k in range(5)]
    recording = read_csv(table(*rows, heading=heading, encoding="utf-8-sig"), rig)
    volts = recording.blocks[0].counts[0] * np.array(recording.daq.volts_per_count)
    assert (volts[:4] + 10.0) / 7.874e-3 == pytest.approx([4, 2, 3, 1], abs=1e-3)
    assert volts[4] == pytest.approx(-5.0)


def test_times_printed_with_few_digits_are_even(rig: RigConfig, table: Table) -> None:
    rows = [f"{k / 25600:.6f}, -2, 0, 0, 0, 0" for k in range(2561)]  # 39.0625 us printed as 39 or 40
    assert read_csv(table(*rows), rig).daq.sample_rate == pytest.approx(25600.0, rel=1e-5)


def test_a_large_file_is_read_in_pieces(rig: RigConfig, table: Table, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(csv, "PIECE", 7)
    rows = [f"{k / 1000:.3f}, -2, {k}, 0, 0, 0" for k in range(100)]
    recording = read_csv(table(*rows, "", "  "), rig)
    assert [len(block.counts) for block in recording.blocks] == [7] * 14 + [2]
    ((first, counts),) = recording.segments()
    assert first == 0
    volts = counts[:, 0] * recording.daq.volts_per_count[0]
    assert (volts + 10.0) / 7.874e-3 == pytest.approx(np.arange(100), abs=1e-3)
    with pytest.raises(DataError, match=r"row 60, column '1x': got 'x'"):
        read_csv(table(*rows[:58], "0.058, -2, x, 0, 0, 0", *rows[59:]), rig)


def test_an_imported_recording_survives_its_file(rig: RigConfig, table: Table, tmp_path: Path) -> None:
    recording = read_csv(table(*ROWS), rig)
    write_recording(tmp_path / "run.mcap", recording)
    read = read_recording(tmp_path / "run.mcap")
    assert np.array_equal(read.blocks[0].counts, recording.blocks[0].counts)
    assert (read.daq, read.events) == (recording.daq, recording.events)


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        (["0.003, -2, 0, , 0, 0"], r"row 5, column '1y': got an empty cell, want a number"),
        (["0.003, -2, 0, nan, 0, 0"], r"row 5, column '1y': got 'nan'"),
        (["0.003, -2, 0, inf, 0, 0"], r"row 5, column '1y': got 'inf'"),
        (["0.003, -2, 0, 1.5 um, 0, 0"], r"row 5, column '1y': got '1.5 um'"),
        (["0.003, -2, 0"], r"row 5: ends before column '1y'"),
        (["", "0.003, -2, 0, 0, 0, 0"], r"row 5: is blank"),
        (["0.004, -2, 0, 0, 0, 0"], r"row 5, column 'time': is 2 ms after the row before, want 1 ms"),
        (["0.002, -2, 0, 0, 0, 0"], r"row 5, column 'time': is 0 ms after"),
        (["0.003, -2, 1e9, 0, 0, 0"], r"row 5, column '1x': is too large for a signal in \[um\].*unit right"),
        (["0.003, -2, 1e308, 0, 0, 0"], r"row 5, column '1x': is too large"),
    ],
)
def test_a_bad_row_is_named(rig: RigConfig, table: Table, rows: list[str], said: str) -> None:
    with pytest.raises(DataError, match=said):
        read_csv(table(*ROWS, *rows), rig)


def test_a_sample_rate_that_drifts_is_refused(rig: RigConfig, table: Table) -> None:
    t = np.cumsum(np.linspace(0.9e-3, 1.1e-3, 200))  # every step within 10 % of the median
    with pytest.raises(DataError, match=r"row \d+, column 'time': is .* off an even"):
        read_csv(table(*(f"{s:.7f}, -2, 0, 0, 0, 0" for s in t)), rig)


@pytest.mark.parametrize(
    ("heading", "said"),
    [
        (HEADING.replace("2x [um], ", ""), r"row 1: has no column '2x \[unit\]'.*has 'time', 'keyphasor', '1x'"),
        (HEADING.replace("keyphasor [V]", "keyphasor"), r"has no column 'keyphasor \[unit\]'"),
        (HEADING.replace("2x", "1x"), r"two columns are named '1x'"),
        (HEADING.replace("1x [um]", "1x [kg]"), r"column '1x' is in \[kg\], want V or a length such as um"),
        (HEADING.replace("keyphasor [V]", "keyphasor [um]"), r"'keyphasor' is in \[um\], want V or mV"),
        (HEADING.replace("[s]", "[rpm]"), r"'time' is in \[rpm\], want a time such as s or ms"),
        ("0.0, 1.0, 2.0", "no heading of the form 'name"),
    ],
)
def test_a_bad_heading_is_named(rig: RigConfig, table: Table, heading: str, said: str) -> None:
    with pytest.raises(DataError, match=said):
        read_csv(table(*ROWS, heading=heading), rig)


def test_files_that_hold_no_table_are_refused(rig: RigConfig, table: Table, tmp_path: Path) -> None:
    with pytest.raises(DataError, match="has 0 rows"):
        read_csv(table(), rig)
    with pytest.raises(DataError, match="cannot be read"):
        read_csv(tmp_path / "nothing.csv", rig)
    binary = tmp_path / "binary.csv"
    binary.write_bytes(bytes(range(256)))
    with pytest.raises(DataError, match="is not UTF-8 text"):
        read_csv(binary, rig)


def test_a_mapping_names_the_columns_and_their_units(
    rig: RigConfig, table: Table, mapping: Callable[[str], ChannelMapping]
) -> None:
    path = table(*(f"{k},-2,{k},0,0,0" for k in range(4)), heading="t,tach,A [um],B [um],C [um],D [um]")
    text = '[time]\ncolumn = "t"\nunit = "1 ms"\n[[channels]]\nprobe = "keyphasor"\nchannel = "tach"\nunit = "1 V"\n'
    for number, (probe, column) in enumerate(zip(("1x", "1y", "2x", "2y"), "ABCD", strict=True), start=3):
        text += f'[[channels]]\nprobe = "{probe}"\nchannel = {number if probe == "1x" else f"{column!r}"}\n'
    recording = read_csv(path, rig, mapping(text))
    assert recording.daq.sample_rate == 1000.0
    volts = recording.blocks[0].counts[:, 0] * recording.daq.volts_per_count[0]
    assert (volts + 10.0) / 7.874e-3 == pytest.approx(np.arange(4), abs=1e-3)
    by_rate = text.replace('[time]\ncolumn = "t"\nunit = "1 ms"\n', 'rate = "2 kHz"\n')
    assert read_csv(path, rig, mapping(by_rate)).daq.sample_rate == 2000.0
    with pytest.raises(DataError, match=r"column 'time': says 1000 Hz, the mapping 2000 Hz"):
        read_csv(path, rig, mapping('rate = "2 kHz"\n' + text))


def test_a_line_without_an_end_is_refused(rig: RigConfig, tmp_path: Path) -> None:
    path = tmp_path / "long.csv"
    path.write_text("a" * 2**20)
    with pytest.raises(DataError, match="row 1: has more than 1048576 characters"):
        read_csv(path, rig)

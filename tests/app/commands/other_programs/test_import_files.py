"""What a file is, is seen by its contents; what it is called decides only where they do not say."""

from dataclasses import replace
from pathlib import Path

import pytest

from rotorrig.app.commands.other_programs.export_files import write_out
from rotorrig.app.commands.other_programs.import_files import bring_in, kind_of
from rotorrig.processing.files.response_mcap import write_response
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import DataError
from tests.acquisition.importers.foreign_files import fmt, riff, tdms_segment, uff58, waves
from tests.fuzz.corpus import CHANNELS, response

UFF = b"".join(uff58(name, volts) for name, volts in waves().items())
TDMS = tdms_segment([(f"/'g'/'{n}'", v, {"wf_increment": 1e-4, "unit_string": "V"}) for n, v in waves().items()])
WAV = riff((b"fmt ", fmt(1, channels=5, rate=25_600, bits=16)), (b"data", bytes(200)))
CSV = b"time [s],keyphasor [V],1x [V],1y [V],2x [V],2y [V]\n" + b"".join(b"%d,-2,-9,-9,-9,-9\n" % k for k in range(20))


@pytest.mark.parametrize(
    ("name", "data", "kind"),
    [
        ("x.csv", CSV, "csv"),
        ("x.txt", CSV, "csv"),
        ("x.csv", UFF, "uff"),
        ("x.dat", UFF.replace(b"\n", b"\r\n", 1), "uff"),
        ("x", TDMS, "tdms"),
        ("x.bin", WAV, "wav"),
        ("x.uff", b"", "uff"),
        ("X.TDMS", b"", "tdms"),
    ],
)
def test_a_file_is_what_its_first_bytes_say(tmp_path: Path, name: str, data: bytes, kind: str) -> None:
    (tmp_path / name).write_bytes(data)
    assert kind_of(tmp_path / name) == kind


@pytest.mark.parametrize(("data", "samples"), [(CSV, 20), (UFF, 200), (TDMS, 200), (WAV, 20)])
def test_each_becomes_a_recording(rig_config: RigConfig, tmp_path: Path, data: bytes, samples: int) -> None:
    (tmp_path / "x.csv").write_bytes(data)
    mapping = tmp_path / "m.toml" if data == WAV else None
    (tmp_path / "m.toml").write_bytes(CHANNELS)
    said = bring_in(tmp_path / "x.csv", rig=rig_config, mapping=mapping, out=tmp_path / "run.mcap")
    assert f"{samples} scans at " in said


@pytest.mark.parametrize(
    ("name", "data", "said"),
    [
        ("x.tdms", CSV, "is no TDMS file"),
        ("x.wav", CSV, "is no WAV file"),
        ("x.uff", CSV, "is no universal file"),
        ("x.csv", b"\x89MCAP0\r\n" + b"\0" * 99, "is not UTF-8 text, want a CSV file"),
        ("x.xlsx", b"PK\x03\x04", "cannot be imported, want one of .csv"),
        ("x.csv", b"", r"has no column 'time \[unit\]'"),
    ],
)
def test_a_file_of_another_kind_is_refused_in_a_sentence(
    rig_config: RigConfig, tmp_path: Path, name: str, data: bytes, said: str
) -> None:
    (tmp_path / name).write_bytes(data)
    (tmp_path / "m.toml").write_bytes(CHANNELS)
    mapping = tmp_path / "m.toml" if name == "x.wav" else None
    with pytest.raises(DataError, match=said):
        bring_in(tmp_path / name, rig=rig_config, mapping=mapping, out=tmp_path / "run.mcap")
    assert not (tmp_path / "run.mcap").exists()


def test_each_of_our_files_is_exported_as_what_it_holds(rig_config: RigConfig, tmp_path: Path) -> None:
    (tmp_path / "x.csv").write_bytes(CSV)
    bring_in(tmp_path / "x.csv", rig=rig_config, mapping=None, out=tmp_path / "a.mcap")
    write_response(tmp_path / "b.mcap", response(rig_config))
    said = [
        write_out(tmp_path / f"{name}.mcap", tmp_path / f"{name}{suffix}")
        for name in "ab"
        for suffix in (".csv", ".uff")
    ]
    assert [words.partition(": ")[2] for words in said] == [
        "20 rows of volts",
        "5 time responses in volts",
        "3 rows",
        "8 order functions",  # of four probes, and forward and backward of two planes
    ]


def test_a_response_whose_probes_its_config_lacks_is_refused(rig_config: RigConfig, tmp_path: Path) -> None:
    write_response(tmp_path / "strange.mcap", replace(response(rig_config), probes=("1x", "1y", "2x", "9z")))
    with pytest.raises(DataError, match="has a probe '9z' that its config does not know"):
        write_out(tmp_path / "strange.mcap", tmp_path / "strange.uff")

"""`rr.read`: every kind of file by its content."""

from pathlib import Path

import numpy as np
import pytest

import rotorrig as rr
from rotorrig.acquisition import RawRecording
from rotorrig.acquisition.files import write_recording
from rotorrig.balancing import Balance
from rotorrig.balancing.balance_file import write_balance
from rotorrig.identify import Diagnosis, Identification, write_diagnosis, write_identification
from rotorrig.rig.config import RigConfig
from tests.conftest import CONFIGS
from tests.processing.synthetic import chirp, recording_of

RATE = 5_000.0
MAPPING = """
[speed]
column = "rpm"
unit = "1 rpm"
[[vectors]]
probe = "1x"
amplitude = "A"
phase = "P"
unit = "1 um"
amplitude_is = "peak-to-peak"
phase_is = "lag"
phase_unit = "1 deg"
[[runs]]
name = "up"
direction = "up"
[uncertainty]
absolute = "0.1 um"
"""


@pytest.fixture(scope="module")
def run(rig_config: RigConfig, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run-up of 10 s from 600 rpm with 40 rpm/s, 20 um 0-peak on every probe."""
    t = np.arange(int(10 * RATE)) / RATE
    theta = chirp(t, start=20 * np.pi, rate=40 * np.pi / 30, theta_0=-0.3)
    x = np.tile(20e-6 * np.cos(theta)[:, None], 4)
    path = tmp_path_factory.mktemp("read") / "anything.bin"
    write_recording(path, recording_of(rig_config, theta, x, rate=RATE))
    return path


def test_a_recording_is_told_by_its_content_and_stays_in_its_file(run: Path) -> None:
    recording = rr.read(str(run))
    assert isinstance(recording, rr.Recording)
    assert recording.seconds == pytest.approx(10.0, abs=0.01)
    assert "10.0 s, 50000 scans at 5000 Hz" in repr(recording)
    waves = recording.to_xarray(begin=2.0, seconds=0.5).displacement
    assert waves.sizes == {"time": 2500, "probe": 4}
    assert float(np.ptp(waves.sel(probe="1x").values)) == pytest.approx(40e-6, rel=0.02)


def test_a_stretch_beyond_the_recording_is_refused(run: Path) -> None:
    with pytest.raises(rr.DataError, match=r"9.5 to 10.5 s is not all there, want .* within the 10.0 s recorded"):
        rr.read(run).to_xarray(begin=9.5)


def test_a_tracked_recording_has_the_amplitude_that_was_put_in(run: Path) -> None:
    for given in (run, str(run), rr.read(run)):
        response = rr.track(given, orders=[1], every="0.5 s")
        assert np.median(np.abs(response.order(1.0))) == pytest.approx(20e-6, rel=0.01)


def test_results_are_read_with_their_tables(
    identification: Identification, named: Diagnosis, balanced: Balance, tmp_path: Path
) -> None:
    write_identification(tmp_path / "a.json", identification)
    write_diagnosis(tmp_path / "b.json", named)
    write_balance(tmp_path / "c.json", balanced)
    fit, diagnosis, balance = (rr.read(tmp_path / f"{name}.json") for name in "abc")
    assert (
        isinstance(fit, rr.Identification) and isinstance(diagnosis, rr.Diagnosis) and isinstance(balance, rr.Balance)
    )
    first = identification.fits[0].estimates[0]
    row = fit.to_pandas().iloc[0]
    assert (row["name"], row["value"], row["unit"]) == (first.name, first.value, first.unit)
    assert list(diagnosis.to_pandas()["cause"]) == [cause.label for cause in named.causes]
    assert named.sentence in repr(diagnosis) and len(repr(fit)) < 2000
    for result in (fit, diagnosis):
        assert type(rr.read(result.save(tmp_path / "again.json"))) is type(result)


def test_a_config_is_read_as_its_rotor() -> None:
    assert isinstance(rr.read(CONFIGS / "rk4.toml"), rr.Rotor)


def test_a_table_of_another_program_wants_the_config_and_its_mapping(tmp_path: Path) -> None:
    (tmp_path / "v.csv").write_text("rpm,A,P\n1000,10,30\n1100,12,40\n1200,15,50\n")
    (tmp_path / "m.toml").write_text(MAPPING)
    with pytest.raises(rr.DataError, match=r"v.csv: is a file of another kind, .* want config="):
        rr.read(tmp_path / "v.csv")
    response = rr.read(tmp_path / "v.csv", config="rk4", mapping=tmp_path / "m.toml")
    z = response.order(1.0)[0, response.probes.index("1x")]
    assert abs(z) == pytest.approx(5e-6)
    assert -np.degrees(np.angle(z)) == pytest.approx(30.0)


def test_waveforms_of_another_program_become_a_recording(run: Path, tmp_path: Path) -> None:
    from rotorrig.app.commands.other_programs import export_files

    export_files.write_out(run, tmp_path / "w.csv")
    recording = rr.read(tmp_path / "w.csv", config="rk4")
    assert isinstance(recording, RawRecording)
    assert np.median(np.abs(rr.track(recording, orders=[1]).order(1.0))) == pytest.approx(20e-6, rel=0.01)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("gone", None, "is not there"),
        ("empty", b"", "is an empty file"),
        ("page.html", b"<title>x: rotor report</title>", "is a report"),
        ("noise", bytes(range(256)), "is a file of another kind"),
    ],
)
def test_what_cannot_be_read_is_said_in_a_sentence(
    tmp_path: Path, name: str, content: bytes | None, words: str
) -> None:
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(rr.DataError, match=f"{name}: {words}"):
        rr.read(tmp_path / name)


def test_a_folder_is_no_file(tmp_path: Path) -> None:
    with pytest.raises(rr.DataError, match="is a folder, want a file"):
        rr.read(tmp_path)

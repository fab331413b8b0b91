"""`rotor report` with the recording the response was tracked from, and with another."""

import sys
from pathlib import Path

import pytest

from rotorrig.acquisition.files.recording_mcap import write_recording
from rotorrig.acquisition.recording import RawRecording
from rotorrig.app import cli


def rotor(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str]:
    monkeypatch.setattr(sys, "argv", ["rotor", *words])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert isinstance(ended.value.code, int) or ended.value.code is None
    return ended.value.code or 0, " ".join(capsys.readouterr().err.split())


def test_a_run_adds_its_cascade_and_time_bases_and_another_run_is_refused(
    tmp_path: Path, recording: RawRecording, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    write_recording(Path("run.mcap"), recording)
    (block,) = recording.blocks
    shorter = type(block)(counts=block.counts[:50_000], first_sample=0, t_ns=0)
    write_recording(
        Path("other.mcap"),
        RawRecording(
            rig=recording.rig, daq=recording.daq, blocks=(shorter,), events=(), motor=(), source=recording.source,
            complete=True,
        ),
    )  # fmt: skip
    assert rotor(monkeypatch, capsys, "track", "run.mcap", "--out", "response.mcap")[0] == 0
    report = ("report", "response.mcap", "--out", "report.html", "--run")
    code, said = rotor(monkeypatch, capsys, *report, "other.mcap")
    assert (code, "want the run of this very response" in said) == (1, True), said
    assert not Path("report.html").exists()
    assert rotor(monkeypatch, capsys, *report, "run.mcap")[0] == 0
    page = Path("report.html").read_text()
    assert 'data-figure="cascade-3"' in page
    assert "Time base and orbits as recorded" in page

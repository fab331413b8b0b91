"""`rotor investigate` on a simulated rig: it ends with a verdict, and goes on after it was stopped."""

import html
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from rotorrig.app.cli import app
from rotorrig.app.commands import diagnose, investigate
from rotorrig.app.commands.simulate import SimulatedRig
from rotorrig.identify import Verdict
from rotorrig.investigation import Budget, Choice, Ending, read_journal
from rotorrig.processing.files import read_response
from rotorrig.rig import ConfigError, DataError
from rotorrig.rig.config import RPM, RigConfig, load
from rotorrig.sims.plant import FaultSpec, draw, seal


@pytest.fixture
def late(brief_rig: RigConfig, tmp_path: Path) -> Path:
    """A sealed rig whose probes are all late by 1 ms."""
    fault = FaultSpec(name="delay", parameters={"time": 1e-3})
    seal(draw(brief_rig, seed=7, faults=(fault,)), tmp_path / "sealed.json")
    return tmp_path / "sealed.json"


def prepared(rig: RigConfig, folder: Path, hidden: Path | None = None, **more: Any) -> investigate.Setup:
    simulation = SimulatedRig(seed=1, hidden=hidden, rate=5.0) if hidden else None
    known: dict[str, Any] = {"plan": "default", "budget": Budget(runs=2), "simulation": simulation, **more}
    return investigate.prepare(rig, config=Path("brief.toml"), folder=folder, **known)


@pytest.mark.campaign
def test_it_goes_on_after_it_was_stopped_and_ends_with_a_cause_measured_on_an_unseen_run(
    brief_rig: RigConfig, late: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, limits = tmp_path / "found", list[str]()
    with monkeypatch.context() as stopped:

        def interrupt(*_: object, time_limit: str, **__: object) -> None:
            limits.append(time_limit)
            raise KeyboardInterrupt

        stopped.setattr(diagnose, "diagnose_responses", interrupt)
        with pytest.raises(KeyboardInterrupt):
            investigate.investigate(prepared(brief_rig, folder, late))
    assert limits == ["5 min"], "a diagnosis does not hold up an investigation"
    first = (folder / "run-1.mcap").stat().st_mtime_ns
    journal, diagnosis = investigate.investigate(prepared(brief_rig, folder, late))
    assert (folder / "run-1.mcap").stat().st_mtime_ns == first, "what was recorded is not recorded again"
    assert [each.number for each in journal.rounds] == [1, 2]
    assert [each.verdict for each in journal.rounds] == [Verdict.NAMED, Verdict.NAMED]
    assert journal.rounds[1].unseen
    cause = diagnosis.causes[0]
    assert cause.label == "delay"
    assert cause.theta["delay"] == pytest.approx(1e-3, abs=2e-4)
    assert journal.rounds[1].beliefs[0].label == cause.label
    assert diagnosis.gain is not None
    assert diagnosis.gain.heldout_after < diagnosis.gain.heldout_before
    assert read_journal(folder / "investigation.json") == journal
    assert [effect.label for effect in load(folder / "extended.toml").effects] == [cause.label]
    page = (folder / "report.html").read_text()
    assert "How it was found" in page
    assert journal.rounds[1].why in page
    again, _ = investigate.investigate(prepared(brief_rig, folder, late))
    assert again == journal, "it is at its end"


@pytest.mark.campaign
def test_a_run_that_holds_speeds_is_made_and_judged_with_the_one_before(
    brief_rig: RigConfig, late: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    speeds = (900 / RPM, 1500 / RPM)
    asked: list[Choice | Ending] = [
        Choice(plan="default", trial=(), why="first"),
        Choice(plan="default-held", trial=(), why="where they part", speeds=speeds),
        Ending("enough"),
    ]
    monkeypatch.setattr(investigate, "choose", lambda *_, **__: asked.pop(0))
    journal, diagnosis = investigate.investigate(prepared(brief_rig, tmp_path / "found", late))
    assert [each.speeds for each in journal.rounds] == [(), speeds]
    assert read_journal(tmp_path / "found/investigation.json") == journal
    held = read_response(tmp_path / "found/response-2.mcap")
    dwells = {held.runs[i].name for i in held.run}
    assert dwells - {"slow roll"} == {"dwell 900 rpm", "dwell 1500 rpm"}
    assert diagnosis.causes[0].label == "delay"
    assert len(diagnosis.responses) == 2
    assert "plan 'default-held' at 900, 1500 rpm" in html.unescape((tmp_path / "found/report.html").read_text())


def test_a_rig_without_a_proof_test_is_not_left_alone(brief_rig: RigConfig, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"--unattended: no proof test of this rig's protections"):
        prepared(brief_rig, tmp_path / "x", unattended=True)
    assert not (tmp_path / "x").exists()


def test_without_a_terminal_nobody_can_say_that_the_rotor_may_turn(brief_rig: RigConfig, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="no terminal to confirm at that the rotor may be turned"):
        investigate.investigate(prepared(brief_rig, tmp_path / "x"))
    assert not list((tmp_path / "x").glob("run-*")), "and it was not"


def test_a_folder_of_another_rig_is_refused(brief_rig: RigConfig, rig: RigConfig, late: Path, tmp_path: Path) -> None:
    prepared(brief_rig, tmp_path / "x", late)
    with pytest.raises(ConfigError, match=r"rig\.toml: is another config than the one given"):
        prepared(rig, tmp_path / "x", late)


def test_a_folder_with_other_files_is_left_alone(brief_rig: RigConfig, late: Path, tmp_path: Path) -> None:
    (tmp_path / "x").mkdir()
    (tmp_path / "x" / "report.html").write_text("of last year")
    with pytest.raises(DataError, match="x: holds other files, want an empty folder, or one of an investigation"):
        prepared(brief_rig, tmp_path / "x", late)
    assert [path.name for path in (tmp_path / "x").iterdir()] == ["report.html"]


def test_bad_words_end_in_a_sentence(tmp_path: Path) -> None:
    for more, words in (
        (["--budget", "a while"], "--budget: got 'a while', want '6 runs', '30 min' or both"),
        (["--plan", "sprint"], "plan 'sprint': the config has none of that name"),
        (["--out", "/dev/null/x"], "/dev/null/x: cannot be a folder (Not a directory), want another --out"),
    ):
        given = ["investigate", "rk4", "--simulate", "--out", str(tmp_path / "x"), *more]
        result = CliRunner().invoke(app, given)
        assert result.exit_code == 1
        assert words in str(result.exception)

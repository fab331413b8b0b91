"""What `rotor diagnose` makes of a diagnosis: what it prints and writes, and what it refuses."""

import dataclasses
import json
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from rotorrig.app import cli
from rotorrig.app.commands import diagnose as diagnosing
from rotorrig.app.commands.config_model import check_effects
from rotorrig.identify.diagnosis import Diagnosis, Verdict
from rotorrig.identify.identification import NameplateCheck
from rotorrig.identify.result_files import read_diagnosis
from rotorrig.processing.files.response_mcap import write_response
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import load, parse
from rotorrig.rig.config.extended_config import extend
from rotorrig.rig.config.extension import Extension
from rotorrig.rig.errors import ConfigError
from tests.app.conftest import WRONG_CONFIG

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def rotor(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Run:
    """Run the command in an empty folder; return its code, standard output and standard error."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(cli.err, "_width", 400)
    monkeypatch.setattr(cli.out, "_width", 400)

    def run(*words: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["rotor", *words])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        printed = capsys.readouterr()
        return int(ended.value.code or 0), printed.out, printed.err

    return run


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch, named: Diagnosis) -> dict[str, Any]:
    """Let every diagnosis be `named`, or what is put under "answer", and keep what was asked."""
    given: dict[str, Any] = {"answer": named}

    def diagnose(responses: list[OrderTrackedResponse], **more: Any) -> Diagnosis:
        given.update(more, responses=responses)
        more["progress"]("causes", 0.5)
        if isinstance(given["answer"], BaseException):
            raise given["answer"]
        return given["answer"]

    monkeypatch.setattr(diagnosing, "diagnose", diagnose)
    return given


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory, response: OrderTrackedResponse) -> str:
    path = tmp_path_factory.mktemp("responses") / "response.mcap"
    write_response(path, response)
    return str(path)


def test_the_verdict_its_causes_ties_next_run_and_gain_are_printed(
    rotor: Run, asked: dict[str, Any], file: str, named: Diagnosis
) -> None:
    code, out, _ = rotor("diagnose", file, "--out", "d.json")
    assert code == 0
    assert out.startswith(named.sentence)
    rows = [" ".join(line.split()) for line in out.splitlines()]
    assert "bow 18.00 ± 0.30 µm at 110.0 ± 1.0° 812 5.20 → 0.410 in the model, tied" in rows
    assert "cause size evidence data, µm 0-peak" in rows
    for words in ("Tied: bow; runout, plane 2.", "A run with a trial mass", "would not show: internal_damping."):
        assert words in out
    assert read_diagnosis(Path("d.json")).verdict is Verdict.NAMED


def test_json_is_the_file_without_its_arrays(rotor: Run, asked: dict[str, Any], file: str) -> None:
    code, out, _ = rotor("diagnose", file, "--out", "d.json", "--json", "--rig-out", "e.toml")
    assert code == 0
    said, written = json.loads(out), json.loads(Path("d.json").read_text())
    assert said == {key: written[key] for key in said}
    assert {"verdict", "causes", "tied", "next_run", "gain", "hidden", "base"} <= set(said)
    assert "residual" not in said


def test_the_extended_config_carries_what_was_chosen_and_is_taken_by_every_command(
    rotor: Run, asked: dict[str, Any], file: str, response: OrderTrackedResponse
) -> None:
    code, out, _ = rotor("diagnose", file, "--out", "d.json", "--rig-out", "e.toml")
    assert code == 0
    assert "e.toml: the config with bow in its model" in out
    extended = load(Path("e.toml"))
    assert [effect.label for effect in extended.effects] == ["bow"]
    assert set(extended.effects[0].sigmas) == {"bow re"}  # the other is not known
    assert extended.nameplate_hash == response.rig.hash
    code, out, _ = rotor("check", "e.toml")
    assert code == 0
    assert "bow: bow re -6.156e-06, bow im 1.691e-05 (SI)" in out  # 18 um at 110 deg
    assert rotor("diagnose", file, "--config", "e.toml", "--out", "again.json")[0] == 0
    assert asked["responses"][0].rig.effects == extended.effects


def test_effects_of_an_earlier_extension_stay(named: Diagnosis, response: OrderTrackedResponse) -> None:
    runout = Extension(name="runout", where="plane 2", parameters={"runout re": 1e-6, "runout im": 0.0})
    extended = diagnosing.extend_rig(extend(response.rig, [runout]), named)
    assert extended is not None
    assert [effect.label for effect in extended.effects] == ["runout, plane 2", "bow"]


def test_with_nothing_named_no_config_is_written(
    rotor: Run, asked: dict[str, Any], file: str, named: Diagnosis
) -> None:
    asked["answer"] = dataclasses.replace(named, verdict=Verdict.ADEQUATE, causes=())
    code, _, err = rotor("diagnose", file, "--out", "d.json", "--rig-out", "e.toml")
    assert code == 1
    assert err.startswith("error: e.toml: not written: no cause was named")
    assert not Path("e.toml").exists()
    assert Path("d.json").exists()


def test_what_of_the_config_is_wrong_is_printed_and_extends_no_model(
    rotor: Run, asked: dict[str, Any], file: str, named: Diagnosis
) -> None:
    cause = dataclasses.replace(named.causes[0], label="bearing_position, spring", nameplate=True, chosen=True)
    asked["answer"] = dataclasses.replace(named, causes=(cause,), nameplate=WRONG_CONFIG)
    code, out, err = rotor("diagnose", file, "--out", "d.json", "--rig-out", "e.toml")
    rows = [" ".join(line.split()) for line in out.splitlines()]
    assert "position of bearing spring 481 mm 483.10 ± 0.20 mm 4.6 σ (positions)" in rows
    assert "Bearing spring sits 2.10 ± 0.20 mm further from the coupling than the config says (4.6 sigma)." in rows
    assert (code, err.startswith("error: e.toml: not written")) == (1, True)
    asked["answer"] = dataclasses.replace(named, nameplate=NameplateCheck())
    assert (
        "The fit pulls at nothing the config states by more than 2 sigma." in rotor("diagnose", file, "-o", "e.json")[1]
    )


def test_held_out_and_quasi_static_are_passed_on(rotor: Run, asked: dict[str, Any], file: str) -> None:
    assert rotor("diagnose", file, file, "--holdout", file, "--model", "quasi-static", "--out", "d.json")[0] == 0
    assert len(asked["responses"]) == 2
    assert asked["holdout"] is not None
    assert asked["model"] == "quasi-static"


def test_ctrl_c_ends_in_one_sentence_and_leaves_no_file(rotor: Run, asked: dict[str, Any], file: str) -> None:
    asked["answer"] = KeyboardInterrupt()
    code, _, err = rotor("diagnose", file, "--out", "d.json")
    assert code == 130
    assert err == "interrupted: d.json was not written\n"
    assert not Path("d.json").exists()


def test_ctrl_c_asks_for_the_best_so_far_and_the_next_one_leaves(
    rotor: Run, asked: dict[str, Any], file: str, monkeypatch: pytest.MonkeyPatch, named: Diagnosis
) -> None:
    """The keys are pressed while the diagnosis runs."""
    seen: list[bool] = []

    def pressed(times: int) -> Callable[..., Diagnosis]:
        def diagnose(responses: list[OrderTrackedResponse], **more: Any) -> Diagnosis:
            seen.append(more["go_on"]())
            for _ in range(times):
                signal.raise_signal(signal.SIGINT)
                seen.append(more["go_on"]())
            return dataclasses.replace(named, cut_short=True)

        return diagnose

    monkeypatch.setattr(diagnosing, "diagnose", pressed(1))
    code, _, err = rotor("diagnose", file, "--out", "d.json")
    assert (code, seen) == (0, [True, False])
    assert "ending with the best so far; Ctrl-C again leaves at once" in err
    assert read_diagnosis(Path("d.json")).cut_short
    monkeypatch.setattr(diagnosing, "diagnose", pressed(2))
    code, _, err = rotor("diagnose", file, "--out", "e.json")
    assert (code, err.splitlines()[-1]) == (130, "interrupted: e.json was not written")
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


@pytest.mark.parametrize(
    ("given", "words"),
    [("5", "without a unit"), ("0 s", "want a time above zero"), ("5 mm", "want a time"), ("soon", "no number")],
)
def test_a_time_limit_that_is_none_is_refused(
    rotor: Run, asked: dict[str, Any], file: str, given: str, words: str
) -> None:
    code, _, err = rotor("diagnose", file, "--out", "d.json", "--time-limit", given)
    assert code == 1
    assert err.startswith("error: --time-limit: ")
    assert words in err
    assert not Path("d.json").exists()


def test_what_a_diagnosis_cut_short_leaves_extends_no_config(
    rotor: Run, asked: dict[str, Any], file: str, named: Diagnosis
) -> None:
    asked["answer"] = dataclasses.replace(named, verdict=Verdict.UNEXPLAINED, cut_short=True)
    code, _, err = rotor("diagnose", file, "--out", "d.json", "--rig-out", "e.toml")
    assert code == 1
    assert err.startswith("error: e.toml: not written: the diagnosis was cut short")
    assert not Path("e.toml").exists()
    assert Path("d.json").exists()


def test_a_time_limit_ends_the_search(rotor: Run, asked: dict[str, Any], file: str) -> None:
    assert rotor("diagnose", file, "--out", "d.json", "--time-limit", "1 ms")[0] == 0
    time.sleep(0.002)
    assert not asked["go_on"]()


def test_responses_of_two_rigs_are_refused(
    rotor: Run, asked: dict[str, Any], file: str, response: OrderTrackedResponse
) -> None:
    other = parse(response.rig.text.replace("0.809 kg", "0.9 kg"), where="other")
    write_response(Path("other.mcap"), dataclasses.replace(response, rig=other))
    code, _, err = rotor("diagnose", file, "other.mcap", "--out", "d.json")
    assert code == 1
    assert "other.mcap: is from another rig" in err
    assert "want responses of one rig" in err
    extended = extend(response.rig, [Extension(name="bow", parameters={"bow re": 1e-6, "bow im": 0.0})])
    write_response(Path("extended.mcap"), dataclasses.replace(response, rig=extended))
    assert rotor("diagnose", file, "extended.mcap", "--out", "d.json")[0] == 0


@pytest.mark.parametrize(
    ("effect", "said"),
    [
        (Extension(name="levitation", parameters={}), "effect 'levitation': there is none"),
        (
            Extension(name="bow", parameters={"height": 1.0}),
            r"'bow' has no 'height', want one of \['bow re', 'bow im'\]",
        ),
    ],
)
def test_an_effect_the_model_does_not_know_is_refused(
    response: OrderTrackedResponse, effect: Extension, said: str
) -> None:
    with pytest.raises(ConfigError, match=said):
        check_effects(extend(response.rig, [effect]))

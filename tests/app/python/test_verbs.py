"""The verbs as functions: what they take, what they refuse, and that they say what the command says."""

from pathlib import Path

import numpy as np
import pytest

import rotorrig as rr
from rotorrig.identify import identify
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig.config import RigConfig, parse
from tests.conftest import CONFIGS


def test_a_fit_is_the_same_however_the_response_is_given(blind_response: OrderTrackedResponse, tmp_path: Path) -> None:
    path = rr.Response.of(blind_response).save(tmp_path / "r.mcap")
    want = [e.value for e in identify([blind_response]).fits[0].estimates]
    for given in (path, [str(path)]):
        fit = rr.identify(given)
        assert isinstance(fit, rr.Identification)
        assert [e.value for e in fit.fits[0].estimates] == want


def test_a_config_given_takes_the_place_of_the_models_in_the_files(blind_response: OrderTrackedResponse) -> None:
    rig = blind_response.rig
    other = parse(
        rig.text.replace("[identify]", '[[effects]]\nname = "bow"\nparameters = { "bow re" = 1e-5 }\n\n[identify]', 1),
        where="with a bow",
    )
    assert rr.identify(blind_response, config=other).effects == ("bow",)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ([], "no response was given, want at least one"),
        ([3.0], "response 1: is a float, want a response or the path of one"),
        ("nowhere.mcap", "nowhere.mcap: "),
    ],
)
def test_what_is_no_response_is_said(given: object, words: str) -> None:
    for verb in (rr.identify, rr.diagnose):
        with pytest.raises(rr.DataError, match=words):
            verb(given)


def test_responses_of_two_rigs_are_refused(response: OrderTrackedResponse, brief_rig: RigConfig) -> None:
    from dataclasses import replace

    heavier = parse(brief_rig.text.replace('mass = "', 'mass = "1', 1), where="heavier")
    with pytest.raises(rr.DataError, match="response 2: is from another rig"):
        rr.identify([response, replace(response, rig=heavier)])


def test_a_time_limit_is_read_with_its_unit(response: OrderTrackedResponse) -> None:
    with pytest.raises(rr.ConfigError, match="time_limit: "):
        rr.diagnose(response, time_limit="5 rpm")


def test_a_report_is_written(response: OrderTrackedResponse, tmp_path: Path) -> None:
    assert "rotor report</title>" in rr.report(tmp_path / "r.html", response).read_text()


@pytest.mark.campaign
def test_a_simulated_sweep_shows_the_fault_it_was_given(brief_rig: RigConfig, tmp_path: Path) -> None:
    bent = {"bow": {"amount": 200e-6, "angle": 0.0}}
    straight, bowed = (
        rr.track(rr.simulate(brief_rig, tmp_path / f"{n}.mcap", faults=faults, seed=1, rate=1000.0), every="0.2 s")
        for n, faults in enumerate((None, bent))
    )
    sizes = [np.median(np.abs(each.order(1.0)[each.omega < 700 * np.pi / 30])) for each in (straight, bowed)]
    assert sizes[1] > 100e-6 > 5 * sizes[0]  # a slow roll shows most of a bow of 200 um at the probes beside its middle


def test_an_unknown_fault_is_said_before_anything_turns(tmp_path: Path) -> None:
    with pytest.raises(rr.RigError, match="gremlin"):
        rr.simulate(CONFIGS / "rk4.toml", tmp_path / "run.mcap", faults={"gremlin": {}})
    assert list(tmp_path.iterdir()) == []

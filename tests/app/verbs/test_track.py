"""`rotor track` with its options, from the command line to the response."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from rotorrig.acquisition.files.recording_mcap import write_recording
from rotorrig.app import cli
from rotorrig.processing.files.response_mcap import read_response
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.config.units import RPM
from tests.processing.synthetic import chirp, recording_of

RATE = 5_000.0


@pytest.fixture(scope="module")
def run(rig_config: RigConfig, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run-up from 300 to 1500 rpm in 30 s, unmarked."""
    t = np.arange(int(30 * RATE)) / RATE
    theta = chirp(t, start=300 / RPM, rate=40 / RPM, theta_0=-0.3)
    x = np.tile(20e-6 * np.cos(theta)[:, None], 4) + 1e-8 * np.random.default_rng(1).standard_normal((len(t), 4))
    path = tmp_path_factory.mktemp("track") / "run.mcap"
    write_recording(path, recording_of(rig_config, theta, x, rate=RATE))
    return path


def rotor(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *words: object) -> tuple[int, str, str]:
    monkeypatch.setattr(sys, "argv", ["rotor", *map(str, words)])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    printed = capsys.readouterr()
    assert isinstance(ended.value.code, int) or ended.value.code is None
    return ended.value.code or 0, printed.out, " ".join(printed.err.split())


@pytest.fixture
def tracked(monkeypatch, capsys, run: Path, tmp_path: Path):
    def track(*options: str) -> tuple[OrderTrackedResponse, str]:
        code, out, err = rotor(monkeypatch, capsys, "track", run, "--out", tmp_path / "response.mcap", *options)
        assert code == 0, err
        assert "rows in 1 runs" in out
        return read_response(tmp_path / "response.mcap"), err

    return track


def test_turns_orders_and_method_stand_in_the_response(tracked) -> None:
    response, err = tracked("--turns", "4", "--orders", "0,1,2X", "--method", "least-squares")
    assert (response.orders, response.method, response.window) == ((0.0, 1.0, 2.0), "least-squares", "hann")
    assert (response.revolutions == 4).all()
    assert err == ""
    np.testing.assert_allclose(response.order(1.0)[response.usable[:, 0], 0], 20e-6, atol=2e-8)


def test_a_vold_kalman_filter_says_over_how_many_turns_it_looks(tracked) -> None:
    response, _ = tracked("--method", "vold-kalman")
    assert (response.method, response.window) == ("vold-kalman", "vold-kalman")
    assert (response.revolutions > 8).all()
    assert any("window reaches beyond" in reason for row in response.reasons for reason in row)
    assert response.usable.any()


def test_rows_stand_at_steps_of_speed(tracked) -> None:
    response, err = tracked("--every", "100 rpm")
    np.testing.assert_allclose(response.omega * RPM, np.arange(400, 1500, 100), atol=0.05)
    assert err == ""


def test_steps_too_fine_for_rows_that_do_not_overlap_are_said(tracked) -> None:
    response, err = tracked("--every", "0.2 s")
    assert "of the rows are further apart than 0.2 s: closer rows of 8 turns would overlap" in err
    assert "fewer --turns allow closer rows" in err
    length = 8 * 2 * np.pi / response.omega
    assert (np.diff(response.t) > 0.95 * length[1:]).all()


def test_a_slow_roll_is_taken_where_it_is_asked_for(tracked) -> None:
    response, _ = tracked("--slow-roll", "300 to 450 rpm")
    assert 300 < response.slow_roll_omega * RPM < 450
    assert response.slow_roll[0, response.orders.index(1.0)] == pytest.approx(20e-6, abs=2e-8)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--every", "10"], "--every: got '10', want a step of speed or time such as '10 rpm' or '0.5 s'"),
        (["--slow-roll", "300 rpm"], "--slow-roll: got '300 rpm', want two speeds"),
        (["--orders", "one"], "--orders: got 'one', want numbers such as '0, 0.5, 1, 2, 3'"),
        (["--orders", "0.47,1"], "cannot tell order 0.47 from its neighbours"),
        (["--turns", "0"], "turns: got 0, want a whole number"),
        (["--turns", "8000"], "no run is as long as one row of 8000 turns"),
    ],
)
def test_what_cannot_be_tracked_is_said_in_a_sentence(
    monkeypatch, capsys, run: Path, tmp_path: Path, options: list[str], said: str
) -> None:
    code, _, err = rotor(monkeypatch, capsys, "track", run, "--out", tmp_path / "x.mcap", *options)
    assert code == 1
    assert said in err
    assert not (tmp_path / "x.mcap").exists()


def test_a_program_reads_what_came_of_it(monkeypatch, capsys, run: Path, tmp_path: Path) -> None:
    _, out, _ = rotor(monkeypatch, capsys, "track", run, "--out", tmp_path / "x.mcap", "--json", "--turns", "16")
    facts = json.loads(out)
    assert (facts["method"], facts["turns"]) == ("resampling", 16)

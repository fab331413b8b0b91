"""Times of a table's rows: those of a rotor whose speed is known in closed form."""

import numpy as np
import pytest

from rotorrig.processing.files.bode_table_times import SETTLED
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import ConfigError
from rotorrig.sims.rotor.swept.timeline import Timeline
from rotorrig.sims.rotor.swept.tracking_windows import tracked_rows
from tests.processing.files.test_bode_table import HEAD, PLAIN, RPM, STATED, TABLE, VECTOR, Files

BOTH = HEAD.replace("[speed]", 'run_column = "run"\n[speed]') + VECTOR + STATED


@pytest.fixture
def files(tmp_path, rk4: RigConfig) -> Files:
    return Files(tmp_path, rk4)


def run(name: str, direction: str, more: str) -> str:
    return f'[[runs]]\nname = "{name}"\nvalue = "{name}"\ndirection = "{direction}"\n{more}\n'


def rows(name: str, *rpm: float) -> str:
    return "".join(f"{name},{speed},10,-30\n" for speed in rpm)


def follow(response: OrderTrackedResponse) -> Timeline:
    """Return the time line, every row of a moving run within it, and check it against the rows."""
    timeline = Timeline(response.keyphasor_t)
    moving = np.isfinite(response.t)
    t = response.t[moving]
    tracked_rows(timeline, t=t, revolutions=response.revolutions[moving], window="rectangular")
    np.testing.assert_allclose(timeline.omega(t), response.omega[moving], rtol=1e-4)
    np.testing.assert_allclose(timeline.alpha(t), response.alpha[moving], rtol=0.02)
    return timeline


@pytest.mark.parametrize("direction", ["up", "down"])
@pytest.mark.parametrize("revolutions", [1, 8, 25.5])
def test_a_ramp_tells_when_the_rotor_had_the_speed_of_a_row(files: Files, direction: str, revolutions: float) -> None:
    rpm = np.array([600.0, 900.0, 1000.0, 3000.0])
    rpm = rpm if direction == "up" else rpm[::-1]
    ramp = f'direction = "{direction}"\nramp = "300 rpm/s"\nrevolutions = {revolutions}'
    table = "rpm,amp,phase\n" + "".join(f"{speed},10,-30\n" for speed in rpm)
    response = files.read(mapping=PLAIN.replace('direction = "up"', ramp), table=table)
    np.testing.assert_allclose(np.diff(response.t), np.abs(np.diff(rpm)) / 300)
    np.testing.assert_allclose(response.alpha, (1 if direction == "up" else -1) * 300 * RPM)
    np.testing.assert_allclose(response.revolutions, revolutions)
    assert response.derived_times
    assert response.remarks == ()
    follow(response)


def test_a_ramp_without_revolutions_takes_one_turn_and_says_so(files: Files) -> None:
    response = files.read(mapping=PLAIN.replace('direction = "up"', 'direction = "up"\nramp = "30 rpm/s"'))
    np.testing.assert_allclose(response.revolutions, 1)
    assert all(words[0].startswith("one turn supposed: the table gives a ramp but not") for words in response.remarks)
    follow(response)


def test_speeds_that_fall_back_a_little_are_times_that_do(files: Files) -> None:
    ramp = 'direction = "up"\nramp = "30 rpm/s"\nrevolutions = 8'
    table = "rpm,amp,phase\n1000,9,0\n1010,9,0\n1010,9,0\n1007,9,0\n1020,9,0\n"
    response = files.read(mapping=PLAIN.replace('direction = "up"', ramp), table=table)
    np.testing.assert_allclose(np.diff(response.t), np.array([10, 0, -3, 13]) / 30)
    follow(response)


def test_runs_stand_one_after_the_other_with_time_to_settle_between_them(files: Files) -> None:
    ramp = 'ramp = "300 rpm/s"\nrevolutions = 8'
    mapping = BOTH + run("up", "up", ramp) + run("down", "down", ramp) + run("again", "up", ramp)
    table = "run,rpm,amp,phase\n" + rows("up", 900, 3000) + rows("down", 3000, 900) + rows("again", 900, 3000)
    response = files.read(mapping=mapping, table=table)
    assert response.t[2] - response.t[1] > SETTLED
    assert response.t[4] - response.t[3] > SETTLED
    np.testing.assert_allclose(np.diff(response.t)[::2], 7.0)
    timeline = follow(response)
    turns = np.arange(len(timeline.t))
    np.testing.assert_allclose(timeline.theta(timeline.t) / (2 * np.pi), turns, atol=1e-6)
    assert len(timeline.t) == len(response.keyphasor_t), "no turn was taken for two"


def test_consecutive_revolutions_of_two_runs_tell_times_too(files: Files) -> None:
    each = 'rows = "one per revolution"'
    up = 900 + 30 * np.arange(40.0)
    table = "run,rpm,amp,phase\n" + rows("up", *up) + rows("down", *up[::-1])
    response = files.read(mapping=BOTH + run("up", "up", each) + run("down", "down", each), table=table)
    assert response.derived_times
    np.testing.assert_allclose(np.diff(response.t[:40]), 30 * (1 / up[1:] + 1 / up[:-1]))
    assert response.t[40] - response.t[39] > SETTLED
    Timeline(response.keyphasor_t)


def test_a_slow_roll_needs_no_ramp(files: Files) -> None:
    ramp = 'ramp = "300 rpm/s"\nrevolutions = 8'
    mapping = BOTH + run("slow roll", "dwell", "") + run("up", "up", ramp)
    response = files.read(
        mapping=mapping, table="run,rpm,amp,phase\n" + rows("slow roll", 240, 240) + rows("up", 900, 3000)
    )
    np.testing.assert_array_equal(np.isfinite(response.t), [False, False, True, True])
    follow(response)


def test_a_ramp_of_some_runs_is_refused(files: Files) -> None:
    mapping = BOTH + run("up", "up", 'ramp = "300 rpm/s"') + run("down", "down", "")
    with pytest.raises(ConfigError, match="'up' has a ramp or a row per revolution and 'down' has not"):
        files.read(mapping=mapping, table="run," + TABLE.replace("\n1", "\nup,1"))


def test_a_single_revolution_is_a_row(files: Files) -> None:
    each = PLAIN.replace('direction = "up"', 'direction = "up"\nrows = "one per revolution"')
    response = files.read(mapping=each, table="rpm,amp,phase\n1200,10,-30\n")
    assert response.t == pytest.approx([0.025])
    assert not response.derived_times

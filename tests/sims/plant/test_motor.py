import numpy as np
import pytest

from rotorrig.sims.plant.motor import LAG, Motor

from .by_hand import RPM

H = 1e-3  # s: the motor's equations are solved exactly over a step, so a coarse one will do


def motor(hunting: float = 0.0) -> Motor:
    return Motor(step=H, hunting=hunting, rng=np.random.default_rng(0))


def test_the_speed_follows_a_ramp_late_by_the_lag_and_settles_on_the_setpoint() -> None:
    drive = motor()
    drive.command(100.0, 5.0, True)
    _, speed, alpha = drive.run(30_000)
    assert speed[9_999] == pytest.approx(5.0 * (10.0 - LAG), abs=0.01)
    assert alpha[9_999] == pytest.approx(5.0, abs=1e-6)
    assert speed[-1] == pytest.approx(100.0, abs=1e-9)


def test_it_coasts_from_3600_to_480_rpm_in_about_45_seconds() -> None:
    drive = motor()
    drive.command(3600 * RPM, 1e4, True)
    drive.run(5_000)
    drive.command(0.0, 0.0, False)
    _, speed, alpha = drive.run(60_000)
    assert np.argmax(speed < 480 * RPM) * H == pytest.approx(45.0, abs=1.0)
    assert alpha[0] < alpha[40_000] < 0  # drag falls with speed


def test_the_speed_is_never_negative_and_the_shaft_stays_where_it_stopped() -> None:
    drive = motor(hunting=5e-4)
    drive.command(50.0, 1e4, True)
    drive.run(2_000)
    drive.command(0.0, 0.0, False)
    angle, speed, _ = drive.run(60_000)
    assert speed.min() == 0.0
    assert np.ptp(angle[-1000:]) == 0.0
    drive.command(0.0, 100.0, True)
    assert drive.run(2_000)[1].max() == 0.0


def test_power_taken_up_while_coasting_starts_from_the_speed_there_is() -> None:
    drive = motor()
    drive.command(200.0, 1e4, True)
    drive.run(2_000)
    drive.command(0.0, 0.0, False)
    before = drive.run(5_000)[1][-1]
    drive.command(200.0, 10.0, True)
    speed = drive.run(100)[1]
    assert np.abs(speed - before).max() < 1.1


def test_the_angle_is_the_integral_of_the_speed() -> None:
    drive = motor(hunting=5e-4)
    drive.command(300.0, 20.0, True)
    angle, speed, alpha = drive.run(20_000)
    assert np.diff(angle) == pytest.approx(H * (speed[1:] + speed[:-1]) / 2, abs=1e-9)
    assert np.diff(speed) == pytest.approx(H * (alpha[1:] + alpha[:-1]) / 2, abs=2e-3)


def test_hunting_is_slow_and_as_large_as_asked() -> None:
    drive = motor(hunting=5e-4)
    drive.command(200.0, 1e4, True)
    drive.run(20_000)
    _, speed, alpha = drive.run(1_000_000)
    assert np.std(speed) == pytest.approx(0.1, rel=0.15)  # 0.05 % of 200 rad/s; 500 correlation times
    assert np.std(alpha) < 1.0  # white jumps of that size would need 100 rad/s^2


@pytest.mark.parametrize(("setpoint", "ramp"), [(-1.0, 10.0), (100.0, -1.0), (float("inf"), 1.0), (float("nan"), 1.0)])
def test_a_command_that_makes_no_sense_is_refused(setpoint: float, ramp: float) -> None:
    with pytest.raises(ValueError, match="want both finite"):
        motor().command(setpoint, ramp, True)

"""The peer's rotor and its drive's output stage, against what can be computed by hand."""

import math

import pytest

from tests.peers.conftest import Time
from tests.peers.inverter import Inverter
from tests.peers.rotor import DRAG, FRICTION, Rotor


def pass_time(inverter: Inverter, time: Time, seconds: float, *, step: float = 0.01) -> float | None:
    """Advance in small steps; return the last output."""
    output = None
    for _ in range(round(seconds / step)):
        time.now += step
        output = inverter.advance(step)
    return output


def test_a_rotor_follows_its_drive_and_coasts_by_dry_friction_and_drag() -> None:
    rotor = Rotor()
    for _ in range(100):
        rotor.advance(0.01, output=600.0)
    assert rotor.rpm == pytest.approx(600.0, rel=1e-6)
    seconds = 0.0
    while rotor.rpm > 0:
        rotor.advance(0.001, output=None)
        seconds += 0.001
    assert seconds == pytest.approx(math.log(1 + DRAG * 600 / FRICTION) / DRAG, rel=0.01)


def test_a_turn_is_two_pi() -> None:
    rotor = Rotor(rpm=60.0)
    rotor.advance(0.25, output=60.0)
    assert rotor.angle == pytest.approx(math.pi / 2)


def test_an_output_ramps_up_and_a_ramped_stop_ends_with_the_output_off(inverter: Inverter, time: Time) -> None:
    inverter.run(200.0)
    assert pass_time(inverter, time, 1.0) == pytest.approx(100.0)
    assert pass_time(inverter, time, 2.0) == pytest.approx(200.0)
    inverter.stop("ramp")
    assert pass_time(inverter, time, 1.0) == pytest.approx(100.0)
    assert pass_time(inverter, time, 1.1) is None
    assert not inverter.on


def test_a_stop_only_gets_harder(inverter: Inverter, time: Time) -> None:
    inverter.quick = 1000.0
    inverter.run(200.0)
    pass_time(inverter, time, 2.0)
    inverter.stop("quick")
    inverter.stop("ramp")
    assert pass_time(inverter, time, 0.1) == pytest.approx(100.0)
    inverter.stop("coast")
    assert inverter.advance(0.01) is None


@pytest.mark.parametrize(
    ("switch", "obeyed"),
    [("ignores_stop", set()), ("only_coast", {"coast"}), ("deaf", set()), ("", {"ramp", "quick", "coast"})],
)
@pytest.mark.parametrize("kind", ["ramp", "quick", "coast"])
def test_what_is_wrong_with_a_drive_decides_which_stop_it_obeys(
    inverter: Inverter, time: Time, switch: str, obeyed: set[str], kind: str
) -> None:
    inverter.run(200.0)
    pass_time(inverter, time, 2.0)
    if switch:
        setattr(inverter.switches, switch, True)
    inverter.stop(kind)
    pass_time(inverter, time, 3.0)
    assert inverter.on == (kind not in obeyed)


def test_a_watchdog_trips_a_drive_that_nobody_speaks_to(inverter: Inverter, time: Time) -> None:
    inverter.watchdog, inverter.watchdog_fault = 2.0, 28
    inverter.run(100.0)
    inverter.heard()
    assert pass_time(inverter, time, 1.9) is not None
    inverter.heard()
    assert pass_time(inverter, time, 1.9) is not None
    assert pass_time(inverter, time, 0.2) is None
    assert inverter.report().fault == 28
    assert not inverter.run(100.0)

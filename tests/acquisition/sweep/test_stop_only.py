"""Stop without samples: by the drive's word, harder and harder until it is off."""

from pathlib import Path

import pytest

from rotorrig.acquisition.sweep.operator import Nobody
from rotorrig.acquisition.sweep.stop_only import stop_unseen
from rotorrig.rig.config.description import RigConfig, parse
from rotorrig.rig.control.direct import DirectControl
from rotorrig.rig.errors import LinkLost
from rotorrig.rig.motor import MotorState, Stop
from tests.acquisition.sweep.scripted_rig import ScriptedMotor, Shaft
from tests.manual_clock import ManualClock

RK4 = (Path(__file__).parents[3] / "configs/rk4.toml").read_text()
POWER_CUT = '\n[power_cut]\ncommand = ["sh", "-c", "touch {file}"]\n'


class Listener(Nobody):
    def __init__(self) -> None:
        self.heard: list[str] = []

    def tell(self, text: str) -> None:
        self.heard.append(text)


def stop(motor: ScriptedMotor, rig: RigConfig, clock: ManualClock) -> list[str]:
    control, listener = DirectControl(motor, clock=clock), Listener()
    control.start()
    control.stop(Stop.EMERGENCY)
    stop_unseen(control=control, rig=rig, operator=listener, watchdog=None, clock=clock)
    return listener.heard


@pytest.fixture
def shaft() -> Shaft:
    shaft = Shaft(speed=100.0)
    shaft.powered, shaft.setpoint = True, 100.0
    return shaft


@pytest.fixture
def rig() -> RigConfig:
    return parse(RK4, where="rk4.toml")


def test_a_drive_that_obeys_coast_alone_is_sent_coast(shaft: Shaft, rig: RigConfig) -> None:
    motor, clock = ScriptedMotor(shaft), ManualClock()
    motor.obeys = {Stop.COAST}
    heard = stop(motor, rig, clock)
    assert motor.commands == [("stop", Stop.EMERGENCY), ("stop", Stop.COAST)]
    assert not shaft.powered
    assert clock.now() < 5.0
    assert heard == ["The drive does not report that it stops: 'coast' comes next."]


def test_a_drive_that_obeys_no_stop_loses_its_power(shaft: Shaft, tmp_path: Path) -> None:
    motor, clock, switch = ScriptedMotor(shaft), ManualClock(), tmp_path / "off"
    motor.obeys = set()

    def read(state: MotorState) -> MotorState:
        shaft.powered = shaft.powered and not switch.exists()
        return state

    motor.on_read = read
    heard = stop(motor, parse(RK4 + POWER_CUT.format(file=switch), where="rk4.toml"), clock)
    assert not shaft.powered
    assert heard[-1] == "power cut: 'sh' was run"


def test_a_stop_that_the_drive_did_not_confirm_is_tried_until_it_does(shaft: Shaft, rig: RigConfig) -> None:
    motor, clock = ScriptedMotor(shaft), ManualClock()

    def lose(kind: Stop) -> None:
        if clock.now() < 2.0:
            raise LinkLost("motor: no answer")

    motor.on_stop = lose
    stop(motor, rig, clock)
    assert not shaft.powered
    assert motor.opened > 1
    assert 2.0 <= clock.now() < 3.0

"""What `rotor track` says of a response's quality."""

from dataclasses import replace

import numpy as np

from rotorrig.app.text.tracking import quality_lines
from rotorrig.rig.config.description import RigConfig
from tests.fuzz.corpus import response

RPM = np.pi / 30


def test_reasons_and_remarks_are_told_once_with_how_often_and_where(rig_config: RigConfig) -> None:
    said = replace(
        response(rig_config),
        omega=np.array([1000.0, 1010.0, 1020.0]) * RPM,
        reasons=((), ("1x: clipped",), ("1x: clipped", "1x: clipped")),
        remarks=(("hum falls into 3X: adds up to 0.3 um",), ("hum falls into 3X: adds up to 0.1 um",), ()),
        slow_roll_remarks=("600 rpm are 0.27 of the 2230 rpm at which 1X is largest",),
    )
    assert quality_lines(said) == [
        "slow roll: 600 rpm are 0.27 of the 2230 rpm at which 1X is largest",
        "masked: 1x: clipped (2 rows, 1010 to 1020 rpm)",
        "remark: hum falls into 3X (2 rows, 1000 to 1010 rpm)",
    ]


def test_nothing_is_said_of_a_sound_response_without_remarks(rig_config: RigConfig) -> None:
    sound = replace(response(rig_config), reasons=((), (), ()), remarks=(), slow_roll_remarks=())
    assert quality_lines(sound) == []

"""Keys of computations: another one with whatever may change the result."""

import pytest

from rotorrig.app.lab.settings import LabSettings
from rotorrig.rig import ConfigError
from rotorrig.rig.config.description import RigConfig


def test_steps_are_done_in_their_order_however_they_are_asked_for() -> None:
    assert LabSettings.read("diagnose, track").steps == ("track", "diagnose")


@pytest.mark.parametrize(
    ("asked", "said"),
    [("track,identfy", "got 'identfy', want some of track,identify"), ("identify", "want track among them")],
)
def test_steps_that_cannot_be_done_are_refused(asked: str, said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        LabSettings.read(asked)


def test_recording_version_steps_and_config_each_make_another_key(rig_config: RigConfig) -> None:
    usual = LabSettings()
    keys = {
        usual.key("a", code_version="1"),
        usual.key("b", code_version="1"),
        usual.key("a", code_version="2"),
        LabSettings(steps=("track",)).key("a", code_version="1"),
        LabSettings(config=rig_config).key("a", code_version="1"),
    }
    assert len(keys) == 5
    assert usual.key("a", code_version="1") in keys

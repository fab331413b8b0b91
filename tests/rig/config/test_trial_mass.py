"""Trial masses as people write them."""

import math

import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.config.trial_mass import read_trial_mass, trial_unbalance
from rotorrig.rig.errors import ConfigError


def test_a_quarter_turn_from_the_mark_is_imaginary(rig_config: RigConfig) -> None:
    mass = read_trial_mass("disk: 12 g mm at 90 deg", planes=rig_config.unbalance_planes)
    assert trial_unbalance([mass])["disk"] == pytest.approx(12e-6j)


def test_masses_on_one_disk_add_as_vectors(rig_config: RigConfig) -> None:
    masses = [
        read_trial_mass(f"disk: 10 g mm at {angle}", planes=rig_config.unbalance_planes)
        for angle in ("30 deg", "-30 deg")
    ]
    assert trial_unbalance(masses) == {"disk": pytest.approx(math.sqrt(3) * 10e-6)}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("12 g mm at 90 deg", "want a disk, an amount and an angle"),
        ("disk: 12 g mm", "want a disk, an amount and an angle"),
        ("disc: 12 g mm at 90 deg", "has no disk or plane 'disc', want one of ['disk']"),
        ("disk: 12 g at 90 deg", "amount: got '12 g' (g), want an unbalance"),
        ("disk: -12 g mm at 90 deg", "amount: got '-12 g mm'"),
        ("disk: 12 g mm at 90", "angle: got '90' without a unit"),
    ],
)
def test_a_mistake_is_one_sentence(rig_config: RigConfig, text: str, said: str) -> None:
    with pytest.raises(ConfigError) as caught:
        read_trial_mass(text, planes=rig_config.unbalance_planes)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)

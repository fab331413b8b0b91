"""The Campbell diagram's branches, and the onset of instability (its closed forms: tests/literature)."""

import numpy as np
import pytest

from rotorrig.rig.config.description import from_si
from rotorrig.sims.rotor.model.assembly import RotorModel, assemble, with_bearing
from rotorrig.sims.rotor.modes.campbell import campbell, stability_onset
from rotorrig.sims.rotor.modes.modes import critical_speeds, whirl_modes

SPEEDS = np.linspace(0.0, 400.0, 41)  # rad/s


@pytest.fixture(scope="module")
def gyroscopic() -> RotorModel:
    """A disk in the middle: bouncing feels no gyroscopic moment, and the backward tilting falls through it."""
    disk = {"mass": 40.0, "polar_inertia": 6.0, "transverse_inertia": 3.1}
    bearing = {"kxx": 1e6, "kyy": 1e6}
    rig = from_si(
        {
            "name": "one disk",
            "shaft": {"length": 1.5, "diameter": 0.05, "density": 7810.0, "youngs_modulus": 211e9},
            "disks": [{"name": "disk", "position": 0.75, **disk}],
            "bearings": [{"name": f"{z}", "position": z, **bearing} for z in (0.0, 1.5)],
            "probes": [{"name": "x", "position": 0.5, "angle": 0.0, "channel": 0}],
        }
    )
    return assemble(rig, max_element=0.25)


def test_at_every_speed_the_branches_are_the_modes(small):
    diagram = campbell(small, SPEEDS, count=4)
    for i in (0, 17, 40):
        modes = whirl_modes(small, SPEEDS[i], count=4)
        assert sorted(diagram.frequency[i]) == pytest.approx([mode.frequency for mode in modes])
        assert sorted(diagram.damping_ratio[i]) == pytest.approx(sorted(mode.damping_ratio for mode in modes))


def test_a_branch_keeps_its_sense_of_whirl_where_it_crosses_another(gyroscopic):
    diagram = campbell(gyroscopic, 4 * SPEEDS, count=6)
    order = np.argsort(diagram.frequency, axis=1)
    assert np.any(order[1] != order[-1]), "no branches cross, so this shows nothing"
    senses = np.sign(diagram.whirl[1:])
    np.testing.assert_array_equal(senses, np.broadcast_to(senses[0], senses.shape))
    assert sorted(senses[0]) == [-1, -1, -1, 1, 1, 1]


def test_a_branch_that_stops_vibrating_ends_and_leaves_the_others_alone(rk4):
    """Damping that rises with speed takes the bounce on the spring out of vibration."""
    soft = {"kxx": 1e3, "kyy": 1e3, "cxx": {"speed": (0.0, 400.0), "value": (1.0, 100.0)}}
    bearings = tuple(b.model_dump() | (soft if b.name == "spring" else {}) for b in rk4.bearings)
    rig = from_si(rk4.model_dump() | {"bearings": bearings, "identify": None})
    diagram = campbell(assemble(rig, max_element=0.1), np.linspace(0.0, 400.0, 81), count=4)
    ended = np.isnan(diagram.frequency)
    assert ended.any(axis=0).sum() == 1
    assert np.all(np.diff(ended.astype(int), axis=0) >= 0)  # once ended, for good
    others = diagram.frequency[:, ~ended.any(axis=0)]
    assert np.abs(np.diff(others, axis=0) / others[:-1]).max() < 0.25


def test_the_diagram_crosses_the_line_of_1x_at_the_critical_speeds(small):
    for critical in critical_speeds(small, up_to=400.0):
        assert np.abs(campbell(small, critical, count=4).frequency - critical).min() < 1e-6 * critical


def test_a_rotor_without_damping_is_not_called_unstable(gyroscopic):
    assert stability_onset(gyroscopic, up_to=2000.0) is None


def test_a_shaft_that_nothing_holds_drifts_but_is_not_unstable(small):
    free = with_bearing(small, [b.name for b in small.bearings], np.zeros((2, 2)), np.zeros((2, 2)))
    assert stability_onset(free, up_to=400.0) is None


def test_the_top_speed_must_be_above_zero(small):
    with pytest.raises(ValueError, match="up_to is -1 rad/s"):
        stability_onset(small, up_to=-1.0)

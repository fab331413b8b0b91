"""A screw that moves once."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import draw_fault, nameplate
from rotorrig.sims.plant.faults import unbalance_step
from rotorrig.sims.plant.plant import Plant
from rotorrig.sims.plant.truth import FaultSpec, Truth, UnbalanceTruth

from ..by_hand import RPM, driven, measured, run_to

STEP = {"amount": 6e-6, "angle": 2.0, "speed": 1200 * RPM}


def test_it_happens_at_its_speed_and_stays_when_the_speed_has_gone(rk4: RigConfig) -> None:
    """Afterwards the rig is one with the two unbalances' sum on its nameplate."""
    plant = Plant(rk4, nameplate(rk4, faults=[FaultSpec(name="unbalance_step", parameters=STEP)]))
    healthy, other = Plant(rk4, nameplate(rk4)), Plant(rk4, once_lost(rk4))
    for rpm, twin in ((1000, healthy), (1400, other), (1000, other)):
        got, want = (measured(run_to(p, rpm), 1.0) for p in (plant, twin))
        assert got == pytest.approx(want, abs=0.05e-6)


def test_it_leaves_over_half_a_second_and_not_at_once(rk4: RigConfig) -> None:
    """1 - exp(-t / 0.5 s) of it has gone: the law's force against that of the whole of it, along its own direction."""
    (force,) = unbalance_step.forces(rk4, nameplate(rk4), unbalance_step.PARAMETERS | {"speed": 100.0})
    f = driven(force, np.zeros(20_001), omega=200.0)
    t = 1e-4 * np.arange(1, 20_002)
    gone = (f[:, 0] * np.cos(200.0 * t - 1.2) + f[:, 1] * np.sin(200.0 * t - 1.2)) / (4e-6 * 200.0**2)
    assert gone == pytest.approx(1 - np.exp(-t / 0.5), abs=1e-3)


def test_before_its_time_nothing_happens(rk4: RigConfig) -> None:
    late = FaultSpec(name="unbalance_step", parameters=STEP | {"speed": 0.0, "time": 6.0})
    plant, healthy = Plant(rk4, nameplate(rk4, faults=[late])), Plant(rk4, nameplate(rk4))
    for p in (plant, healthy):
        p.command(1200 * RPM, 200.0, True)
    assert np.abs(plant.advance(5.9) - healthy.advance(5.9)).max() == 0
    plant.advance(9.0), healthy.advance(9.0)
    assert abs(measured(plant, 1.0)[0] - measured(healthy, 1.0)[0]) > 1e-6


def once_lost(rig: RigConfig) -> Truth:
    """Return the nameplate's rig with the two unbalances' sum."""
    total = 15e-6 + 6e-6 * np.exp(2j)
    return replace(nameplate(rig), unbalances=(UnbalanceTruth(disk="disk", amount=abs(total), angle=np.angle(total)),))


def at_slow_roll(rig: RigConfig, truth: Truth) -> np.ndarray:
    """Return the phasors at a speed that the step has not been waiting for."""
    return measured(run_to(Plant(rig, truth), 900), 1.0)


@pytest.mark.campaign
def test_it_falls_out_on_the_way_down_and_not_on_the_way_up(rk4: RigConfig) -> None:
    """Hunting about that speed on the way up is no falling."""
    down = FaultSpec(name="unbalance_step", parameters=STEP | {"speed": -1200 * RPM})
    plant = Plant(rk4, nameplate(rk4, faults=[down]))
    healthy, other = Plant(rk4, nameplate(rk4)), Plant(rk4, once_lost(rk4))
    for rpm, twin in ((1205, healthy), (1199, healthy), (1400, healthy), (1300, healthy), (1190, other), (1400, other)):
        got, want = (measured(run_to(p, rpm), 1.0) for p in (plant, twin))
        assert got == pytest.approx(want, abs=0.05e-6), rpm


@pytest.mark.parametrize(
    ("happens", "lost"), [(0.0, (False, True, True)), (0.5, (False, True, True)), (1.0, (False, False, True))]
)
def test_it_happens_once_and_every_later_recording_begins_without_the_screw(
    rk4: RigConfig, happens: float, lost: tuple[bool, ...]
) -> None:
    truth = nameplate(rk4, faults=[FaultSpec(name="unbalance_step", parameters=STEP | {"run": happens})])
    whole, less = at_slow_roll(rk4, nameplate(rk4)), at_slow_roll(rk4, once_lost(rk4))
    for run, gone in enumerate(lost):
        assert at_slow_roll(rk4, replace(truth, run=run)) == pytest.approx(less if gone else whole, abs=0.05e-6), run


def test_a_blind_case_of_one_recording_has_it_there(rk4: RigConfig) -> None:
    drawn = {
        runs: [draw_fault(rk4, "unbalance_step", seed=s, runs=runs).parameters for s in range(20)] for runs in (1, 2)
    }
    assert {values["run"] for values in drawn[1]} == {0.0}
    assert {values["run"] for values in drawn[2]} == {0.0, 0.5, 1.0}
    assert {values["speed"] > 0 for values in drawn[1]} == {True, False}

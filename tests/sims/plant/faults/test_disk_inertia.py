"""A disk that resists tilting more than its nameplate says."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults.base import apply_structure
from rotorrig.sims.plant.shaft import Rotor, build
from rotorrig.sims.plant.truth import FaultSpec


def with_inertia(rig: RigConfig, polar: float, transverse: float) -> Rotor:
    faults = [FaultSpec(name="disk_inertia", parameters={"polar": polar, "transverse": transverse})]
    truth = nameplate(rig, faults=faults)
    return apply_structure(rig, truth, build(rig, truth))


def test_it_is_a_disk_with_those_moments_on_the_nameplate(rk4: RigConfig) -> None:
    disk = rk4.disks[0]
    other = disk.model_copy(
        update={
            "polar_inertia": 1.2 * disk.polar_inertia,
            "transverse_inertia": 0.9 * disk.transverse_inertia,
            "position": 0.4,
        }
    )
    overhung, named = (
        rk4.model_copy(update={"disks": (d,)}) for d in (disk.model_copy(update={"position": 0.4}), other)
    )
    got, want = with_inertia(overhung, 0.2, -0.1), build(named, nameplate(named))
    assert got.critical_speeds(4) == pytest.approx(want.critical_speeds(4), rel=1e-4)
    assert np.abs(got.critical_speeds(4) / build(overhung, nameplate(overhung)).critical_speeds(4) - 1).max() > 2e-3

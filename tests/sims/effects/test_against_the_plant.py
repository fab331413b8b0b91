"""Force laws against the same ones at the same figures in the simulated rig, through the critical speed and down again.

The rig is another model (time, mesh, sensors) that is given the laws of the effects. The base is fitted to the same rig
without the fault, and nothing after that: what is left is the law and how it is followed. The balls are kept quiet, or
they would let a stuck contact creep; the noise of the probes leaves 0.05 um.
"""

from collections.abc import Iterator, Mapping

import numpy as np
import pytest
from numpy.typing import NDArray

from benchmarks.parts.blind.run import record
from rotorrig.identify import base_fit
from rotorrig.identify.extended_model.model import ExtendedModel
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.processing.pipeline import track
from rotorrig.processing.settings import Tracking
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.config.units import RPM
from rotorrig.sims.effects.base import find
from rotorrig.sims.plant.truth import FaultSpec, Noise
from tests.identify.matched import taken_for_exact
from tests.sims.effects.textbook_laws import textbook_faults

SEED = 11


@pytest.fixture(scope="module", autouse=True)
def _laws_of_the_effects() -> Iterator[None]:
    with textbook_faults():
        yield


@pytest.fixture(scope="module")
def rig(rk4: RigConfig) -> RigConfig:
    sweep = {"slow_roll_time": 2.0, "start": 700 / RPM, "end": 2600 / RPM, "ramp": 120 / RPM}
    return taken_for_exact(rk4.model_copy(update={"plans": {"default": rk4.plans["default"].model_copy(update=sweep)}}))


@pytest.fixture(scope="module")
def base(rig: RigConfig) -> base_fit.AssessedFit:
    return base_fit.fit_base([measured(rig)])


def measured(rig: RigConfig, *faults: FaultSpec) -> Recording:
    quiet = Noise(bearing_force=0.0)
    return Recording(
        track(
            record(rig, seed=SEED, faults=faults, noise=quiet, unmodelled=False), Tracking(orders=(0.0, 1.0, 2.0, 3.0))
        )
    )


def off(base: base_fit.AssessedFit, fault: FaultSpec, label: str, theta: Mapping[str, float]) -> NDArray[np.float64]:
    """By how much the effect's 1X vectors are off the plant's, (row, probe), as parts of the largest."""
    rig = base.problem.recordings[0].response.rig
    effect = find(rig, label)
    recording = measured(rig, fault)
    model = ExtendedModel([recording], (*base.problem.effects, effect))
    p = np.append(base.polished.p, [theta[q.name] / q.size for q in effect.parameters])
    predicted, z = model.predict(p, orders=(1,))[0][1], recording.measured[1].z  # NaN where nothing was measured
    return np.nan_to_num(np.abs(predicted - z) / np.nanmax(np.abs(z)))


@pytest.mark.campaign
def test_friction_is_the_plants_sticking_and_sliding(base: base_fit.AssessedFit) -> None:
    fault = FaultSpec(name="friction", parameters={"limit": 0.03, "stuck_stiffness": 1e5})
    error = off(base, fault, "friction", {"force": 0.03, "give": 0.03 / 1e5, "creep": 1e-5})
    assert error.max() < 2e-3  # 0.5e-3; without friction 28e-3 of some 350 um


@pytest.mark.campaign
def test_a_cubic_spring_leans_over_as_the_plants_does(base: base_fit.AssessedFit) -> None:
    error = off(base, FaultSpec(name="cubic_spring", parameters={"k3": 1e10}), "cubic_spring", {"k3": 1e10})
    assert error.max() < 2e-2  # 0.8e-2, where it falls off; without the spring 26e-2 of some 390 um

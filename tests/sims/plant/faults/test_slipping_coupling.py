"""A hub that creeps while the shaft is sped up."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.plant import Plant
from rotorrig.sims.plant.truth import FaultSpec

from ..by_hand import RPM, difference, measured, run_to

HUB = {"bore_force": 1.0, "bore_angle": 0.3, "creep": 0.02, "holds": 50.0}


def test_at_a_constant_speed_it_is_an_eccentric_bore(rk4: RigConfig) -> None:
    bore = {"bore_force": 1.0, "bore_angle": 0.3, "stiffness_variation": 0.0}
    hub = difference(rk4, "slipping_coupling", HUB | {"holds": 1e9}, rpm=600)
    assert hub == pytest.approx(difference(rk4, "coupling", bore, rpm=600), abs=0.05e-6)


@pytest.mark.campaign
def test_every_ramp_leaves_it_further_back(rk4: RigConfig) -> None:
    """From 600 to 900 rpm and back at 100 rad/s^2: 2 * (w1^2 - w0^2) / (2 * 100) rad turned, 2 % of that crept."""
    phases = []
    for creep in (0.0, 0.02):
        spec = FaultSpec(name="slipping_coupling", parameters=HUB | {"creep": creep})
        plant, plain = Plant(rk4, nameplate(rk4, faults=[spec])), Plant(rk4, nameplate(rk4))
        for p in (plant, plain):
            for rpm in (600, 900, 600):
                run_to(p, rpm, rate=100.0)
        phases.append(np.angle(measured(plant, 1.0)[0] - measured(plain, 1.0)[0]))
    turned = 2 * ((900 * RPM) ** 2 - (600 * RPM) ** 2) / 200 + (600 * RPM) ** 2 / 200
    assert np.angle(np.exp(1j * (phases[1] - phases[0]))) == pytest.approx(np.angle(np.exp(-0.02j * turned)), abs=0.1)

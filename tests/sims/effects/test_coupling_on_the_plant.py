"""The coupling's effect against integration in time of the law it states, on the simulated rig's mesh."""

from collections.abc import Iterator

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.effects.base import find
from rotorrig.sims.effects.shaft_motion import at_rest, position_rows
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.plant import Plant
from rotorrig.sims.plant.truth import FaultSpec
from rotorrig.sims.rotor.model.assembly import RotorModel
from tests.sims.effects.predicted import Complex, base_load, motion
from tests.sims.effects.textbook_laws import textbook_faults
from tests.sims.plant.by_hand import RPM, order_phasors, run_to, volts_of

FAULT = {
    "bore_force": 0.15,
    "bore_angle": 0.6,
    "offset": 1e-4,
    "offset_angle": 1.2,
    "stiffness_variation": 1500.0,
    "stiff_diameter": 0.4,
}
UNBALANCE = 15e-6  # kg m, of the nameplate


@pytest.fixture(scope="module", autouse=True)
def _laws_of_the_effects() -> Iterator[None]:
    with textbook_faults():
        yield


def shown(rig: RigConfig, fault: dict[str, float] | None, rpm: float) -> dict[int, Complex]:
    """Order -> vectors (probe,) [m] of the plant of the nameplate at a steady speed."""
    faults = [FaultSpec(name="coupling", parameters=fault)] if fault else []
    volts = volts_of(run_to(Plant(rig, nameplate(rig, faults=faults)), rpm), 1.5)
    return {order: order_phasors(volts, order=order) / 7874.0 for order in (1, 2)}


def effect_of(model: RotorModel, rig: RigConfig) -> dict[str, float]:
    """What that fault is to the effect: the motor stands off from where the end of the shaft lies at rest."""
    x, y = position_rows(model, 0.0) @ at_rest(model, rig.gravity)
    stands_off = FAULT["offset"] * np.exp(1j * FAULT["offset_angle"]) - (x + 1j * y)
    v = FAULT["stiffness_variation"] * np.exp(2j * FAULT["stiff_diameter"])
    phasors = {
        "force 1X": FAULT["bore_force"] * np.exp(1j * FAULT["bore_angle"]),
        "force 2X": v * np.conj(stands_off),
        "stiffness": v,
    }
    return {f"{name} {part}": f for name, z in phasors.items() for part, f in (("re", z.real), ("im", z.imag))}


@pytest.mark.parametrize("rpm", [900.0, 1900.0])
def test_it_moves_the_vectors_as_the_plants_fault_does(rk4: RigConfig, full: RotorModel, rpm: float) -> None:
    with_fault, without = (shown(rk4, fault, rpm) for fault in (FAULT, None))
    effect, theta, omega = find(rk4, "coupling"), effect_of(full, rk4), np.array([rpm * RPM])
    changed = effect.change_matrices(full, theta)
    base = base_load(full, UNBALANCE)
    for order in (1, 2):
        got = motion(changed, (*effect.loads(changed, theta), base), order, omega)[0]
        want = with_fault[order] - without[order]
        moved = got - motion(full, (base,), order, omega)[0]
        assert np.abs(moved - want).max() < 0.03 * np.abs(want).max(), order


def test_a_centred_bore_leaves_what_the_unbalance_makes_of_the_stiffness(rk4: RigConfig, full: RotorModel) -> None:
    """Near the critical speed, where the two models' unlike damping and stiffness show most."""
    effect, omega, base = find(rk4, "coupling"), np.array([2100 * RPM]), base_load(full, UNBALANCE)
    uneven = {name: 0.0 if name.startswith("force") else value for name, value in effect_of(full, rk4).items()}
    got = motion(effect.change_matrices(full, uneven), (base,), 1, omega)[0] - motion(full, (base,), 1, omega)[0]
    want = shown(rk4, {**FAULT, "bore_force": 0.0}, 2100.0)[1] - shown(rk4, None, 2100.0)[1]
    assert np.abs(got - want).max() < 0.1 * np.abs(want).max()

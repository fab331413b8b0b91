"""An asymmetric shaft and a crack against integration in time of the same laws, on the simulated rig's mesh."""

from collections.abc import Iterator

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.config.units import RPM
from rotorrig.sims.effects.base import find
from rotorrig.sims.rotor.model.assembly import assemble
from rotorrig.sims.rotor.model.reduction import reduce
from rotorrig.sims.rotor.nonlinear.steady_response import steady_with_law
from tests.sims.effects.predicted import Complex, base_load, motion, pair_at, simple_rig
from tests.sims.effects.textbook_laws import textbook_faults
from tests.sims.plant.by_hand import steady

UNBALANCE = 8e-6  # kg m at the disk: 10 um off its centre
SAG = 110e-6  # m, about
NOISE = 8e-9  # m, of the plant's vectors
#: of what the effect does; the curvature at a crack is read off the centre line, shear and all
PART = {"shaft_asymmetry": 0.02, "crack": 0.04}


@pytest.fixture(scope="module", autouse=True)
def _laws_of_the_effects() -> Iterator[None]:
    with textbook_faults():
        yield


@pytest.fixture(scope="module")
def lying() -> RigConfig:
    """A disk near the middle of a shaft that its weight bends by 0.11 mm; critical speed 2820 rpm, damping 5 %."""
    disk = {"name": "disk", "position": 0.18, "mass": 0.8, "polar_inertia": 5e-4, "transverse_inertia": 3e-4}
    pins = [{"name": name, "position": z, "kxx": 1e9, "kyy": 1e9} for name, z in (("A", 0.0), ("B", 0.4))]
    damper = {"name": "damper", "position": 0.18, "kxx": 0.0, "kyy": 0.0, "cxx": 24.0, "cyy": 24.0}
    return simple_rig(
        pair_at(0.25),
        disks=[disk | {"unbalance": {"amount": UNBALANCE, "angle": 0.0}}],
        bearings=[*pins, damper],
        keyphasor={"channel": 2},
    )


def expected(rig: RigConfig, label: str, theta: dict[str, float], rpm: float) -> dict[int, Complex]:
    """Order -> probes' vectors at a constant speed, force laws and all."""
    effect = find(rig, label)
    whole = effect.at_zero | theta
    model = effect.change_matrices(reduce(assemble(rig), modes=6), whole)
    loads, laws, omega = effect.loads(model, whole), effect.force_laws(model, whole), np.array([rpm / RPM])
    driving = (base_load(model, UNBALANCE), *loads)
    found = {n: motion(model, driving, n, omega)[0] for n in (1, 2, 3)}
    if laws:
        first = [load for load in driving if load.order == 1]
        z = steady_with_law(model, omega, first, np.ones(len(first)), laws, orders=(1, 2, 3))[0]
        found = {n: z[:, n - 1] + (found[n] if n > 1 else 0) for n in (1, 2, 3)}
    return found


def differs(rig: RigConfig, fault: str, values: dict[str, float], rpm: float, order: int) -> Complex:
    """The same order by the plant, less that of the sound rig."""
    return steady(rig, fault, values, rpm=rpm, order=order) - steady(rig, None, {}, rpm=rpm, order=order)


@pytest.mark.parametrize("delta", [0.002, 0.02])
@pytest.mark.parametrize(("order", "rpm"), [(1, 2700), (1, 2820), (2, 1420)])
def test_an_asymmetric_shaft_moves_as_in_the_plant(lying: RigConfig, delta: float, order: int, rpm: float) -> None:
    turn = np.exp(0.8j)
    theta = {"asymmetry re": delta * turn.real, "asymmetry im": delta * turn.imag}
    got = expected(lying, "shaft_asymmetry", theta, rpm)[order] - expected(lying, "shaft_asymmetry", {}, rpm)[order]
    want = differs(lying, "shaft_asymmetry", {"asymmetry": delta, "stiff_plane": 0.4}, rpm, order)
    assert np.abs(want).max() > 0.1 * delta * SAG
    assert np.abs(got - want).max() < PART["shaft_asymmetry"] * np.abs(want).max() + NOISE


@pytest.mark.parametrize("compliance", [2e-6, 2e-5])
@pytest.mark.parametrize(("order", "rpm"), [(1, 600), (1, 2700), (1, 2820), (2, 1420), (3, 940)])
def test_a_crack_breathes_as_in_the_plant(lying: RigConfig, compliance: float, order: int, rpm: float) -> None:
    softness = find(lying, "crack").softness_of(compliance, 0.23)
    theta = {"softness": softness, "mouth": np.pi / 4 + 0.1, "place": 0.23}
    got = expected(lying, "crack", theta, rpm)[order] - expected(lying, "crack", {}, rpm)[order]
    values = {"compliance": compliance, "angle": np.pi / 4 + 0.1, "position": 0.23}
    want = differs(lying, "crack", values, rpm, order)
    assert np.abs(got - want).max() < PART["crack"] * np.abs(want).max() + NOISE

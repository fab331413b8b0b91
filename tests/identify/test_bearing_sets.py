"""Every set of unknowns is given back from responses that hide it, and where the data cannot tell, that is said.

The responses come from the rotor model itself, so this shows that unknowns reach the right places of the model, that
they are found, and that the uncertainties are right; not that the model is. That the last test shows: the blind plant
shares none of it.
"""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from rotorrig.identify.base_fit.fit import identify
from rotorrig.identify.identification import Fit
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig, from_si
from rotorrig.sims.plant.draw import draw, expected_estimates
from tests.conftest import BLIND_SEED
from tests.identify.matched import matched_response, sought, taken_for_exact

U = 12e-6 * np.exp(2j)
SPRING = (np.diag([31e3, 37e3]), np.diag([18.0, 12.0]))
HEAVY_SPOT = {"u": 12e-6, "phase": 2.0}


def diagonal(prefix: str, pair: tuple[np.ndarray, np.ndarray]) -> dict[str, float]:
    K, C = pair
    return {f"{prefix}{k}{a}{a}": float(m[i, i]) for k, m in (("k", K), ("c", C)) for i, a in enumerate("xy")}


def check(found: Fit, truth: Mapping[str, float], *, undetermined: tuple[str, ...] = (), noise: float = 1.0) -> None:
    """Every estimate is within 4 sigma of its truth, or said not to be determined; chi2 is that of noise.

    By `noise` times the stated variance at most, and by chance in all but one case of 10^4.
    """
    assert {e.name for e in found.estimates} == set(truth)
    low, high = stats.chi2.interval(1 - 1e-4, found.dof)
    assert low < found.chi2 < noise * high
    for name, value in truth.items():
        estimate = found.estimate(name)
        if name in undetermined:
            assert not estimate.determined
            assert math.isinf(estimate.sigma)
            continue
        assert estimate.determined, name
        off = math.remainder(estimate.value - value, math.tau) if estimate.unit == "rad" else estimate.value - value
        assert abs(off) < 4 * estimate.sigma, f"{name}: {estimate.value:.6g} ± {estimate.sigma:.2g}, truth {value:.6g}"


@pytest.mark.campaign
def test_all_eight_coefficients_are_found_negative_ones_too(rig_config: RigConfig, rng: np.random.Generator) -> None:
    K, C = np.array([[30e3, 6e3], [-4e3, 38e3]]), np.array([[18.0, 3.0], [-2.0, 12.0]])
    rig = sought(rig_config, coefficients="all")
    response = matched_response(rig, bearings={"spring": (K, C)}, unbalance={"disk": U}, rng=rng)
    found = identify([response]).fits[0]
    names = [f"{kind}{i}{j}" for kind in "kc" for i in "xy" for j in "xy"]
    check(found, dict(zip(names, np.ravel([K, C]), strict=True)) | HEAVY_SPOT)
    assert found.estimate("kyx").sigma < 300
    assert found.unknowns == (*names, "u")


@pytest.mark.campaign
def test_bearings_to_either_side_are_found_apart_and_their_unseen_damping_is_named(
    rig_config: RigConfig, rng: np.random.Generator
) -> None:
    left = (np.diag([1.6e6, 2.4e6]), np.diag([40.0, 60.0]))
    # where the left bearings are, 15 mm apart, and how they tilt looks like their stiffness
    known = rig_config.prior.model_copy(update={"position": 1e-5, "hub": 1e-4, "tilt": 1e-3})
    rig_config = rig_config.model_copy(update={"prior": known})
    rig = sought(rig_config, bearings=[["left A", "left B"], ["spring"]], k_bounds=[1e2, 1e8], c_bounds=[0.1, 1e4])
    hidden = {"left A": left, "left B": left, "spring": SPRING}
    exact = taken_for_exact(rig)
    response = matched_response(exact, bearings=hidden, unbalance={"disk": U}, rng=rng, noise=2e-7)
    found = identify([response]).fits[0]
    damping = ("left A+left B cxx", "left A+left B cyy")  # they hardly move there
    truth = diagonal("left A+left B ", left) | diagonal("spring ", SPRING) | HEAVY_SPOT
    check(found, truth, undetermined=damping)
    for name in damping:
        assert any(sentence.startswith(f"{name} is not determined") for sentence in found.words)
    assert max(found.directions[0].weights, key=lambda name: abs(found.directions[0].weights[name])) in damping


def test_two_planes_are_found_with_their_phases(rig_config: RigConfig, rng: np.random.Generator) -> None:
    table = rig_config.model_dump(mode="json")
    inertia = {"mass": 0.4, "polar_inertia": 2e-4, "transverse_inertia": 1e-4}
    table["disks"].append(table["disks"][0] | inertia | {"name": "disk 2", "position": 0.42})
    rig = sought(from_si(table), unbalance=["disk", "disk 2"])
    hidden = {"disk": U, "disk 2": 7e-6 * np.exp(-1j)}
    found = identify([matched_response(rig, bearings={"spring": SPRING}, unbalance=hidden, rng=rng)]).fits[0]
    truth = {"u disk": 12e-6, "phase disk": 2.0, "u disk 2": 7e-6, "phase disk 2": -1.0}
    check(found, diagonal("", SPRING) | truth)
    assert found.estimate("u disk 2").nameplate == pytest.approx(15e-6)


def test_modulus_and_density_are_found_when_sought(rig_config: RigConfig, rng: np.random.Generator) -> None:
    rig = sought(rig_config, also=["youngs_modulus", "density"])
    response = matched_response(
        rig, bearings={"spring": SPRING}, unbalance={"disk": U}, rng=rng, youngs_modulus=0.9, density=1.2
    )
    found = identify([response]).fits[0]
    check(found, diagonal("", SPRING) | HEAVY_SPOT | {"E": 0.9 * 208.11e9, "density": 1.2 * 7801})
    assert "E" not in [e.name for e in found.nuisances]


def test_a_plane_that_is_no_disk_may_carry_the_unbalance(rig_config: RigConfig, rng: np.random.Generator) -> None:
    table = rig_config.model_dump(mode="json")
    table["planes"] = [{"name": "ring", "position": 0.35}]
    rig = sought(from_si(table), unbalance="ring")
    response = matched_response(rig, bearings={"spring": SPRING}, unbalance={"ring": U}, rng=rng)
    found = identify([response]).fits[0]
    check(found, diagonal("", SPRING) | HEAVY_SPOT)
    assert math.isnan(found.estimate("u").nameplate)


@pytest.mark.campaign
def test_far_below_the_critical_speed_damping_is_said_to_be_unknown(
    rig_config: RigConfig, rng: np.random.Generator
) -> None:
    rig = sought(rig_config)
    response = matched_response(
        rig, bearings={"spring": SPRING}, unbalance={"disk": U}, rng=rng, noise=1e-6, top=1000.0
    )
    found = identify([response]).fits[0]
    said = " ".join(found.words)
    for name in ("cxx", "cyy"):
        assert not found.estimate(name).determined
        assert name in said


@pytest.mark.campaign
def test_with_one_probe_what_moves_across_it_is_not_determined(rig_config: RigConfig, rng: np.random.Generator) -> None:
    rig = sought(rig_config, coefficients="all")
    response = matched_response(rig, bearings={"spring": SPRING}, unbalance={"disk": U}, rng=rng)
    usable = response.usable.copy()
    usable[:, 1:] = False
    found = identify([replace(response, usable=usable)]).fits[0]
    assert found.words[0] == "No probe looks along y: kxy, kyx, kyy, cxy, cyx and cyy are not determined."
    assert not any(found.estimate(name).determined for name in ("kxy", "kyx", "kyy", "cxy", "cyx", "cyy"))


@pytest.mark.campaign
@pytest.mark.parametrize(
    "unknowns", [{"coefficients": "all"}, {"also": ["youngs_modulus", "density"]}], ids=["all eight", "E, density"]
)
def test_what_the_blind_plant_hides_is_found(blind_response: OrderTrackedResponse, unknowns: dict[str, object]) -> None:
    rig = sought(blind_response.rig, **unknowns)
    found = identify([replace(blind_response, rig=rig)]).fits[0]
    truth = expected_estimates(rig, draw(blind_response.rig, seed=BLIND_SEED))
    check(found, truth, noise=1.25)  # its noise grows with speed, not alike at all frequencies

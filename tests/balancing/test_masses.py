"""Which masses: min-max, holes, what is not determined, combination of methods, the grade."""

import itertools

import numpy as np
import pytest

from rotorrig.balancing.combination import combine, disagreement
from rotorrig.balancing.correction import Correction, least_squares_correction
from rotorrig.balancing.determinacy import judge_determinacy, leave_out
from rotorrig.balancing.discrete import Holes, place_masses
from rotorrig.balancing.grade import grade_of, rotor_mass
from rotorrig.balancing.influence import estimate_influence
from rotorrig.balancing.min_max import min_max_correction
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import DataError
from tests.balancing.made import PRIOR, conditions_of


def drawn(seed: int, entries: int = 6) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    z, H = (rng.standard_normal(s) + 1j * rng.standard_normal(s) for s in ((entries,), (entries, 2)))
    return z, H


@pytest.mark.parametrize("seed", range(4))
def test_no_small_step_lowers_the_largest_amplitude(seed: int) -> None:
    z, H = drawn(seed)
    start = np.linalg.lstsq(H, -z, rcond=None)[0]
    W = min_max_correction(z, H, start)
    least = np.abs(z + H @ W).max()
    assert least < np.abs(z + H @ start).max()
    rng = np.random.default_rng(100)
    steps = 0.02 * (rng.standard_normal((2000, 2)) + 1j * rng.standard_normal((2000, 2)))
    assert np.abs(z + (W + steps) @ H.T).max(axis=1).min() > least * (1 - 2e-4)


def test_of_two_unequal_probes_the_lower_one_rises_to_the_higher() -> None:
    z, H = np.array([2.0 + 0j, -1.0]), np.array([[1.0 + 0j], [1.0]])
    W = min_max_correction(z, H, np.array([0j]))
    assert W.real == pytest.approx([-0.5], abs=1e-3)
    assert np.abs(z + H @ W) == pytest.approx([1.5, 1.5], rel=1e-3)


@pytest.mark.parametrize("seed", range(3))
def test_the_holes_chosen_are_the_best_of_all(seed: int) -> None:
    z, H = drawn(seed)
    W0 = np.linalg.lstsq(H, -z, rcond=None)[0]
    holes = Holes(count=5, masses=(0.5, 1.0), radius=1.0, first=0.3, most=2)
    found = place_masses(W0, H, [holes, holes])
    single = [holes.vector(h, m) for h in range(1, 6) for m in (0.5, 1.0)]
    hole = [h for h in range(1, 6) for _ in range(2)]
    pairs = [single[i] + single[j] for i, j in itertools.combinations(range(10), 2) if hole[i] != hole[j]]
    ways = np.array([0, *single, *pairs])
    cost = np.linalg.norm(z[:, None, None] + H[:, :1, None] * ways[:, None] + H[:, 1:, None] * ways, axis=0)
    assert np.linalg.norm(z + H @ found.W) == pytest.approx(cost.min())
    for filled, w in zip(found.filled, found.W, strict=True):
        assert sum((holes.vector(h, m) for h, m in filled), 0j) == pytest.approx(w)


def test_hole_one_is_at_its_angle_and_the_next_in_the_sense_of_rotation() -> None:
    holes = Holes(count=4, masses=(2.0,), radius=3.0, first=np.pi / 2)
    assert holes.vector(1, 2.0) == pytest.approx(6j)
    assert holes.vector(2, 2.0) == pytest.approx(-6)


def test_too_many_placings_are_refused() -> None:
    holes = Holes(count=64, masses=tuple(range(1, 9)), radius=1.0, most=4)
    with pytest.raises(DataError, match="fill fewer holes"):
        place_masses(np.array([1j]), np.array([[1.0 + 0j]]), [holes])


def near_parallel(apart: float) -> tuple[np.ndarray, np.ndarray]:
    """Return b and H of two planes whose influence vectors differ by a share `apart`."""
    first, other = np.array([1.0, 1j, -0.5, 0.7j]), np.array([1.0, -1j, 2.0, 1.0])
    return first * (0.9 + 0.1j), np.stack([first, first + apart * other], axis=1)


def test_planes_that_act_alike_are_named_and_the_unknown_part_is_left_out() -> None:
    b, H = near_parallel(0.01)
    trial = np.array([[0, 0], [0, 0], [1, 0], [0, 1], [0, -1]], complex)
    rng = np.random.default_rng(5)
    errors = 0.02 * (rng.standard_normal((5, 4)) + 1j * rng.standard_normal((5, 4)))
    made = conditions_of(b, H, trial, errors=errors)
    influence = estimate_influence(made, planes=made.planes, prior=PRIOR)
    correction = least_squares_correction(influence)
    found = judge_determinacy(influence, correction)
    assert found.alike and not found.needed
    assert found.worst.sigma > 10 * found.best.sigma
    weights = found.worst.weights / found.worst.weights[0]
    assert weights[1] == pytest.approx(-1, abs=0.1)  # a mass on one, taken away on the other
    rest = leave_out(correction, found.worst)
    assert abs(found.worst.weights.conj() @ rest.W) < 1e-12
    assert np.linalg.norm(b + H @ rest.W) < 0.05 * np.linalg.norm(b)
    assert max(a for a, _ in rest.half_widths) < 0.2 * max(a for a, _ in correction.half_widths)


def test_planes_that_act_differently_are_told_apart() -> None:
    b, H = near_parallel(1.0)
    made = conditions_of(b, H, np.array([[0, 0], [1, 0], [0, 1]], complex))
    influence = estimate_influence(made, planes=made.planes, prior=PRIOR)
    assert not judge_determinacy(influence, least_squares_correction(influence)).alike


def correction(w: complex, sigma: float) -> Correction:
    return Correction(
        by="a method", planes=("one",), W=np.array([w]), covariance=sigma**2 * np.eye(2), dof=float("inf")
    )


def test_the_better_known_of_two_corrections_is_followed_and_no_more_is_claimed() -> None:
    both = combine(correction(1.0, 0.01), correction(1.1, 1.0))
    assert pytest.approx([1.0], abs=1e-3) == both.W
    assert np.sqrt(both.covariance[0, 0]) == pytest.approx(0.01, rel=0.01)


def test_corrections_further_apart_than_their_errors_disagree() -> None:
    assert disagreement(correction(1.0, 0.1), correction(1.1, 0.1)) < 1
    # apart by 1, a standard deviation of 0.1 sqrt 2, the 95 % limit of two numbers is 2.448 of them
    assert disagreement(correction(1.0, 0.1), correction(2.0, 0.1)) == pytest.approx(1 / (0.1414 * 2.448), rel=1e-3)


def test_the_grade_is_of_residual_mass_and_speed() -> None:
    # 24 g mm on 4 kg at 2000 rpm: 6 um x 209.4 rad/s = 1.26 mm/s
    grade = grade_of(np.array([14e-6, 10e-6]), mass=4.0, top_speed=209.44)
    assert grade.product == pytest.approx(1.257, rel=1e-3)
    assert grade.grade == 2.5


def test_the_rotors_mass_is_that_of_shaft_and_disks(rig_config: RigConfig) -> None:
    shaft = rig_config.shaft
    want = shaft.density * shaft.length * np.pi / 4 * shaft.diameter**2 + sum(d.mass for d in rig_config.disks)
    assert rotor_mass(rig_config) == pytest.approx(want)

"""Forces and readings that a diagnosis finds: their laws over a turn in time, and against effects of the same law."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.effects.base import find
from rotorrig.sims.effects.found_force import FoundForce, found_force, slope_rows
from rotorrig.sims.effects.found_laws import LAWS, LinearForce, NonlinearForce, ResonantForce
from rotorrig.sims.effects.found_reading import SHARES, found_reading
from rotorrig.sims.effects.shaft_motion import position_rows
from rotorrig.sims.rotor.model.assembly import RotorModel, with_bearing
from tests.sims.effects.predicted import ORDERS, predicted, typical

SPRING = 0.481  # m, the spring bearing of the RK4
ANGLE = np.linspace(0.0, 2 * np.pi, 256, endpoint=False)
F, B = 30e-6 * np.exp(0.4j), 8e-6 * np.exp(-1.1j)  # m, of an elliptic orbit
OMEGA = 180.0  # rad/s

each = pytest.mark.parametrize("name", LAWS)


def orbit(f: complex = F, b: complex = B) -> tuple[np.ndarray, ...]:
    """Return x, y and their velocities over a turn from x to y."""
    x, y = f + b, -1j * f + 1j * b
    turn = np.exp(1j * ANGLE)
    return tuple((part * turn).real for part in (x, y, 1j * OMEGA * x, 1j * OMEGA * y))


def phasors(fx: np.ndarray, fy: np.ndarray) -> tuple[complex, complex]:
    """Return what of a force over a turn turns with the shaft and against it."""
    x, y = (2 * np.mean(part * np.exp(-1j * ANGLE)) for part in (fx, fy))
    return (x + 1j * y) / 2, (x - 1j * y) / 2


def theta_of(effect: FoundForce, **values: float) -> dict[str, float]:
    return effect.at_zero | values


@pytest.mark.parametrize("name", [n for n, law in LAWS.items() if isinstance(law, LinearForce)])
def test_a_linear_law_is_its_matrix_on_the_orbit(name: str, small: RotorModel, rk4: RigConfig) -> None:
    law = LAWS[name]
    x, y, vx, vy = orbit()
    units = law.units(np.array([F]), np.array([B]), np.array([OMEGA]))
    for unknown, (forward, backward) in zip(law.unknowns, units, strict=True):
        effect = found_force(rk4, [name], SPRING)
        added = effect.change_matrices(small, effect.at_zero | {unknown: 1.0}).added
        rows = slope_rows(small, SPRING) if law.tilts else position_rows(small, SPRING)
        hold = np.linalg.pinv(rows)  # a motion whose x and y there are those asked for
        none = np.zeros((small.dof, small.dof))
        K, C, H, S = (none if A is None else A for A in (added.K, added.C, added.H, added.S))
        k, c = hold.T @ (K + OMEGA * H + OMEGA**2 * S) @ hold, hold.T @ C @ hold
        force = -(k @ np.array([x, y])) - c @ np.array([vx, vy])
        np.testing.assert_allclose([forward[0], backward[0]], phasors(*force), rtol=1e-9, atol=1e-18)


@pytest.mark.parametrize(("name", "b"), [("cubic stiffness", B), ("cubic stiffness", 0j), ("dry friction", 0j)])
def test_the_first_order_of_a_nonlinear_law_is_that_of_its_force_over_a_turn(name: str, b: complex) -> None:
    law = LAWS[name]
    assert isinstance(law, NonlinearForce)
    forces = [law.force(*point, np.array([1.0])) for point in zip(*orbit(b=b), strict=True)]
    got = law.units(np.array([F]), np.array([b]), np.array([OMEGA]))[0]
    size = abs(got[0][0])
    np.testing.assert_allclose([got[0][0], got[1][0]], phasors(*np.array(forces).T), rtol=2e-4, atol=2e-4 * size)


def test_an_unbalance_found_is_an_unbalance(small: RotorModel, rk4: RigConfig) -> None:
    known = find(rk4, "unbalance_plane, at 400 mm")
    told = {"unbalance re": 3e-6, "unbalance im": -1e-6}
    found = found_force(rk4, ["speed squared"], 0.4)
    want = predicted(known, known.at_zero | told, rig=rk4, model=small)
    got = predicted(found, theta_of(found, **told), rig=rk4, model=small)
    np.testing.assert_allclose(got[1], want[1], rtol=1e-9)


@pytest.mark.parametrize(
    ("label", "amount", "law", "unknown"),
    [
        ("cross_stiffness", "k", "skew stiffness", "kxy"),
        ("skew_stiffness", "k", "cross-coupled stiffness", "cross-coupled stiffness"),
    ],
)
def test_a_law_at_a_bearing_is_the_effect_of_that_law(
    label: str, amount: str, law: str, unknown: str, small: RotorModel, rk4: RigConfig
) -> None:
    known, found = find(rk4, label), found_force(rk4, [law], SPRING)
    changes = []
    for effect, theta in ((known, {amount: 900.0}), (found, theta_of(found, **{unknown: 900.0}))):
        changes.append(predicted(effect, theta, rig=rk4, model=small)[1])
    away = predicted(known, {amount: 0.0}, rig=rk4, model=small)[1]
    assert np.abs(changes[0] - away).max() > 1e-7
    np.testing.assert_allclose(changes[1], changes[0], rtol=1e-3, atol=1e-10)


def test_a_resonance_is_a_bearing_on_a_pedestal(small: RotorModel, rk4: RigConfig) -> None:
    """k in series with M (w^2 - s^2 + 2 j z w s) is k less k^2 over their sum."""
    pedestal = find(rk4, "pedestal, x")
    mass, omega, ratio = 2.0, 150.0, 0.04
    k = float(rk4.bearing("spring").kxx)  # type: ignore[arg-type]
    theta = pedestal.at_zero | {"lightness": 1 / mass, "omega": omega, "damping ratio": ratio, "compliance across": 0.0}
    bare = with_bearing(small, "spring", small.bearing("spring").at(0.0)[0], np.zeros((2, 2)))
    stiff = k + mass * omega**2
    tuned = {
        "resonant stiffness x": k**2 / stiff,
        "natural frequency": np.sqrt(stiff / mass),
        "damping ratio": ratio * omega / np.sqrt(stiff / mass),
    }
    found = found_force(rk4, ["resonance"], SPRING)
    want = predicted(pedestal, theta, rig=rk4, model=bare)[1]
    got = predicted(found, theta_of(found, **tuned), rig=rk4, model=bare)[1]
    assert np.abs(want - predicted(found, found.at_zero, rig=rk4, model=bare)[1]).max() > 1e-6
    np.testing.assert_allclose(got, want, rtol=1e-3, atol=1e-9)


@each
def test_without_amounts_nothing_changes(name: str, small: RotorModel, rk4: RigConfig) -> None:
    effect = found_force(rk4, [name], 0.3)
    got, want = (predicted(e, e.at_zero, rig=rk4, model=small) for e in (effect, found_force(rk4, ["force"])))
    for order in ORDERS:
        np.testing.assert_allclose(got[order], want[order], rtol=1e-9, atol=1e-18)


@each
def test_it_acts_on_no_more_than_its_law_wants_and_says_how_large(name: str, rk4: RigConfig) -> None:
    effect = found_force(rk4, [name], 0.3)
    linear = isinstance(LAWS[name], LinearForce | ResonantForce)
    want = {"matrices"} if linear else {"force laws"} if LAWS[name].is_nonlinear else {"loads"}
    assert effect.acts_on == want
    words = effect.words(typical(effect))
    assert "mm from the coupling acts" in words and not words.endswith(".")


def test_laws_at_one_place_add_up(small: RotorModel, rk4: RigConfig) -> None:
    both = found_force(rk4, ["speed squared", "damping"], 0.3)
    assert both.acts_on == {"loads", "matrices"}
    theta = theta_of(both, **{"unbalance re": 2e-6, "damping": 5.0})
    heavy, damped = found_force(rk4, ["speed squared"], 0.3), found_force(rk4, ["damping"], 0.3)
    model = damped.change_matrices(small, theta)
    want = predicted(heavy, theta, rig=rk4, model=model)[1]
    np.testing.assert_allclose(predicted(both, theta, rig=rk4, model=small)[1], want, rtol=1e-9)


def test_a_fit_that_goes_past_an_end_of_the_shaft_comes_back(rk4: RigConfig) -> None:
    effect, length = found_force(rk4, ["stiffness"]), rk4.shaft.length
    places = [effect.place({"place": z}) for z in (-0.02, length + 0.03, 0.2)]
    assert places == pytest.approx([0.02, length - 0.03, 0.2])


def test_a_share_of_a_reading_is_a_gain_and_a_share_of_the_other_a_cross_talk(
    small: RotorModel, rk4: RigConfig
) -> None:
    gain, own = find(rk4, "probe_gain, probe 2x"), found_reading(rk4, "2x", ["share"])
    want = predicted(gain, {"error": 0.04}, rig=rk4, model=small)
    got = predicted(own, own.at_zero | {"share re": 0.04}, rig=rk4, model=small)
    for order in ORDERS:
        np.testing.assert_allclose(got[order], want[order], rtol=1e-12)
    crossed = found_reading(rk4, "1y", ["other probe"])
    plain = predicted(crossed, crossed.at_zero, rig=rk4, model=small)[1]
    leaked = predicted(crossed, crossed.at_zero | {"other probe im": 0.1}, rig=rk4, model=small)[1]
    np.testing.assert_allclose(leaked[:, 1] - plain[:, 1], 0.1j * plain[:, 0], rtol=1e-9)
    assert np.array_equal(leaked[:, [0, 2, 3]], plain[:, [0, 2, 3]])


@pytest.mark.parametrize("law", SHARES)
def test_a_reading_says_its_share(law: str, rk4: RigConfig) -> None:
    effect = found_reading(rk4, "1x", [law])
    assert effect.words(typical(effect)).startswith("probe 1x reads besides 4.2 % at 45 deg of ")


def test_both_are_found_by_what_a_config_says(rk4: RigConfig) -> None:
    assert find(rk4, "found_force, damping + resonance").acts_on == {"matrices"}
    assert find(rk4, "found_reading, probe 1x: share + other probe").acts_on == {"probes"}
    with pytest.raises(ValueError, match="there is no law 'magic', want some of force, speed squared, "):
        find(rk4, "found_force, magic")
    with pytest.raises(ValueError, match="there is no probe '9z', want one of 1x, 1y"):
        find(rk4, "found_reading, probe 9z: share")
    with pytest.raises(ValueError, match="there is no law 'half', want some of share, "):
        find(rk4, "found_reading, probe 1x: half")

"""The rotor of a result: the fitted model, its modes and deflections, against the config's model and closed forms."""

import dataclasses

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.app.viewer.plots.rotor_3d import BACKWARD, FORWARD, NEITHER, orbit_loop, sense, sense_colour
from rotorrig.app.viewer.result.data import result_of
from rotorrig.app.viewer.result.rotor_motion import (
    fitted_model,
    fitted_unbalance,
    mode_words,
    modes_in_range,
    rotor_motion,
)
from rotorrig.identify.identification import Estimate, Fit, Identification
from rotorrig.processing.response import OrderTrackedResponse, Run
from rotorrig.rig.config.description import RigConfig, parse
from rotorrig.sims.rotor.model.assembly import assemble
from rotorrig.sims.rotor.modes.modes import critical_modes
from rotorrig.sims.rotor.steady.harmonic_response import probe_response

RAD = np.pi / 30  # rad/s per rpm


def fit_of(values: dict[str, float], nuisances: dict[str, float], prediction: NDArray[np.complex128]) -> Fit:
    def estimate(name: str, value: float) -> Estimate:
        return Estimate(name=name, value=value, sigma=1.0, unit="", nameplate=np.nan)

    return Fit(
        name="whole sweep",
        band=(50.0, 380.0),
        estimates=tuple(estimate(*pair) for pair in values.items()),
        nuisances=tuple(estimate(*pair) for pair in nuisances.items()),
        unknowns=tuple(values),
        optima=(),
        objective="f1",
        evaluations=1,
        stop="converged",
        seed=0,
        chi2=1.0,
        dof=1,
        prediction=prediction,
        words=(),
    )


@pytest.fixture
def fit(response: OrderTrackedResponse) -> Fit:
    values = {"kxx": 40e3, "kyy": 30e3, "cxx": 20.0, "cyy": 25.0, "u": 2e-5, "phase": 0.5}
    nuisances = {"E": 0.02, "disk mass": -0.01, "bearing left A x": 0.1, "gain 1x": 0.03}
    return fit_of(values, nuisances, response.order(1.0))


def test_the_fitted_model_is_that_of_a_config_with_the_fitted_values(rig: RigConfig, fit: Fit) -> None:
    """The same numbers by another way: written into the config's text and assembled from there."""
    text = rig.text
    for old, new in (
        ('kxx = "33.9 kN/m"', 'kxx = "40 kN/m"'),
        ('kyy = "34.6 kN/m"', 'kyy = "30 kN/m"'),
        ('cxx = "15 N s/m"', 'cxx = "20 N s/m"'),
        ('cyy = "15 N s/m"', 'cyy = "25 N s/m"'),
        ('youngs_modulus = "208.11 GPa"', f'youngs_modulus = "{208.11 * 1.02} GPa"'),
        ('mass = "0.809 kg"', f'mass = "{0.809 * 0.99} kg"'),
        ('polar_inertia = "568.46e-6', f'polar_inertia = "{568.46 * 0.99}e-6'),
        ('transverse_inertia = "327.60e-6', f'transverse_inertia = "{327.60 * 0.99}e-6'),
    ):
        assert old in text
        text = text.replace(old, new)
    text = text.replace('kxx = "2.0e6 N/m"', 'kxx = "2.2e6 N/m"', 1)  # left A comes first
    wanted = critical_modes(assemble(parse(text, where="fitted")), up_to=400.0)
    found = critical_modes(fitted_model(rig, fit), up_to=400.0)
    assert [m.omega for m in found] == pytest.approx([m.omega for m in wanted], rel=1e-9)
    assert [m.damping_ratio for m in found] == pytest.approx([m.damping_ratio for m in wanted], rel=1e-6)
    nameplate = [m.omega for m in critical_modes(fitted_model(rig, None), up_to=400.0)]
    assert nameplate != pytest.approx([m.omega for m in wanted], rel=1e-2)


def test_unbalance_is_that_of_the_fit_or_of_the_nameplate(rig: RigConfig, fit: Fit) -> None:
    assert fitted_unbalance(rig, fit) == pytest.approx({"disk": 2e-5 * np.exp(0.5j)})
    assert fitted_unbalance(rig, None) == pytest.approx({"disk": 15e-6})  # 15 g mm at 0 degrees


def test_mode_shapes_drawn_are_those_of_the_whole_model(rig: RigConfig) -> None:
    """The ones drawn come from a reduced model: compared by how far one is from a multiple of the other (1 - MAC)."""
    model = assemble(rig)
    fastest = 3600 * RAD
    for drawn, whole in zip(modes_in_range(model, fastest), critical_modes(model, up_to=1.25 * fastest), strict=True):
        a, b = drawn.shape.ravel(), whole.shape.ravel()
        assert drawn.omega == pytest.approx(whole.omega, rel=1e-6)
        assert abs(np.vdot(a, b)) ** 2 == pytest.approx(np.vdot(a, a).real * np.vdot(b, b).real, rel=1e-6)


def test_the_deflection_at_the_probes_is_what_they_would_see_trial_mass_included(
    rig: RigConfig, response: OrderTrackedResponse, fit: Fit
) -> None:
    runs = (*response.runs[:1], Run(name="up", direction=1, trial_unbalance={"disk": 1e-5j}), *response.runs[2:])
    response = dataclasses.replace(response, runs=runs)
    found = Identification(fits=(fit,), effects=(), wall_s=0.0, source=response.source)
    rows = [50, 200, 300]
    motion = rotor_motion(result_of(response, found), rows)
    model = fitted_model(rig, fit)
    seen = probe_response(model, response.omega[rows], unbalance={"disk": 2e-5 * np.exp(0.5j) + 1e-5j})
    for p, probe in enumerate(rig.probes):
        (node,) = np.flatnonzero(np.isclose(motion.z, probe.position))
        towards = np.array([np.cos(probe.angle), np.sin(probe.angle)])
        assert motion.deflection[:, :, node] @ towards == pytest.approx(seen[:, p], rel=1e-9)


def test_a_mode_says_its_speed_its_sense_and_its_damping(rig: RigConfig) -> None:
    lower, upper = modes_in_range(assemble(rig), 3600 * RAD)[:2]
    assert mode_words(lower, rotation="x-to-y").startswith("critical speed 2226 rpm")  # configs/rk4.toml
    assert mode_words(upper, rotation="x-to-y").startswith("critical speed 2237 rpm")
    assert "forward" in mode_words(upper, rotation="x-to-y")
    assert "backward" in mode_words(upper, rotation="y-to-x")


def test_a_rig_that_meets_no_critical_speed_shows_its_lowest_modes(rig: RigConfig) -> None:
    slow = modes_in_range(assemble(rig), 500 * RAD)
    assert len(slow) == 2
    assert "Hz at 500 rpm" in mode_words(slow[0], rotation="x-to-y")


def test_orbits_turn_the_way_their_colour_says() -> None:
    forward, backward = np.array([2.0, -2.0j]), np.array([2.0, 1.0j])
    loop = orbit_loop(0.3, forward)
    assert loop[0] == pytest.approx([0.3, 2.0, 0.0])
    assert loop[len(loop) // 4] == pytest.approx([0.3, 0.0, 2.0], abs=1e-12)  # a quarter turn later at +y, drawn up
    assert sense_colour(sense(forward)) == FORWARD
    assert sense_colour(sense(backward)) == BACKWARD
    assert sense(backward) == pytest.approx(-2 * 2 * 1 / (2**2 + 1**2))
    assert sense_colour(sense(np.array([1.0 + 0j, 3.0]))) == NEITHER

"""Derivatives of the polynomials against differences of the polynomials themselves, in the same gauge."""

from dataclasses import fields, replace

import numpy as np
import pytest

from rotorrig.sims.rotor.model.assembly import RotorModel, scale_properties, with_bearing
from rotorrig.sims.rotor.model.derivatives import along_bearing, along_density, along_disk_mass, along_modulus
from rotorrig.sims.rotor.model.loads import unbalance_pattern
from rotorrig.sims.rotor.swept.passed_modes import PassedModes, fit_passed_modes, solve_spectra
from rotorrig.sims.rotor.swept.passed_modes_derivatives import differentiate_passed_modes
from rotorrig.sims.rotor.swept.timeline import SpeedRange
from tests.sims.rotor.off_nameplate import CHANGES as OFF

SPEEDS = SpeedRange(50.0, 377.0)
STEP = 1e-4


def springs(model: RotorModel, p: float) -> RotorModel:
    return with_bearing(model, "spring", np.array([[34e3 * (1 + p), 2e3 * p], [0, 34e3]]), np.diag([15, 15 * (1 + p)]))


CHANGES = {
    "spring": (
        springs,
        lambda model: along_bearing(model, "spring", K=[[34e3, 2e3], [0, 0]], C=np.diag([0, 15.0])),
    ),
    "modulus": (lambda model, p: scale_properties(model, youngs_modulus=1 + p), along_modulus),
    "density": (lambda model, p: scale_properties(model, density=1 + p), along_density),
    "disk mass": (lambda model, p: scale_properties(model, disk_mass=1 + p), along_disk_mass),
}


@pytest.mark.parametrize("structural_damping", [0.0, 0.01])
@pytest.mark.parametrize("change", CHANGES)
def test_every_part_of_the_passage_has_its_derivative(small, change, structural_damping):
    changed, direction = CHANGES[change]
    check(springs(replace(small, structural_damping=structural_damping), 0.0), changed, direction)


@pytest.mark.parametrize("change", OFF)
def test_so_have_they_where_the_nameplate_is_off(adjustable, change):
    check(springs(OFF[change][0](adjustable, 0.0), 0.0), *OFF[change], step=5e-3, tolerance=5e-5)


def check(model: RotorModel, changed, direction, *, step: float = STEP, tolerance: float = 1e-5) -> None:
    """Its x and y modes nearly coincide.

    Where nodes move past a probe, differences see its row bend: see test_swept_derivatives.
    """
    loads = unbalance_pattern(model, {"disk": 1.0})[:, None]
    found = solve_spectra(model, SPEEDS)

    def moved(p: float) -> PassedModes:
        return fit_passed_modes(replace(solve_spectra(changed(model, p), SPEEDS), gauge=found.gauge), loads)

    got = differentiate_passed_modes(found, loads, [along_modulus(model), direction(model)])
    up, down = moved(step), moved(-step)
    for part in fields(PassedModes):
        want = (getattr(up, part.name) - getattr(down, part.name)) / (2 * step)
        size = max(np.abs(want).max(), 1e-2 * np.abs(getattr(up, part.name)).max())
        rounding = 1e-10 if part.name == "T" else 0  # s; of the differences: the RK4's modes hardly turn with speed
        atol = tolerance * size + rounding
        np.testing.assert_allclose(getattr(got, part.name)[:, 1], want, atol=atol, err_msg=part.name)

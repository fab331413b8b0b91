"""Beam closed forms: Roark (7th ed., table 8.1) for deflections, Rayleigh's rotating beam for critical speeds."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig, from_si
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.force_laws import Deflection
from rotorrig.sims.plant.plant import GRAVITY
from rotorrig.sims.plant.shaft import build
from rotorrig.sims.rotor.model.assembly import assemble
from rotorrig.sims.rotor.model.reduction import reduce
from rotorrig.sims.rotor.modes.modes import critical_speeds

from .by_hand import RPM

EI = 200e9 * np.pi / 64 * 0.01**4  # N m^2, of the Jeffcott rig
L = 0.4  # m


def test_a_force_at_midspan_bends_a_simply_supported_shaft_by_f_l3_over_48_e_i(jeffcott: RigConfig) -> None:
    rotor = build(jeffcott, nameplate(jeffcott))
    force = np.zeros(2 * rotor.n)
    force[rotor.station(0.2)] = 10.0
    assert np.linalg.solve(rotor.K, force)[rotor.station(0.2)] == pytest.approx(10.0 * L**3 / (48 * EI), rel=1e-5)


def test_a_force_off_midspan_bends_the_shaft_there_by_f_a2_b2_over_3_e_i_l(jeffcott: RigConfig) -> None:
    a, b = 0.13, 0.27
    rotor = build(jeffcott, nameplate(jeffcott), extra=[Deflection(a)])
    force = np.zeros(2 * rotor.n)
    force[rotor.n + rotor.station(a)] = 10.0
    q = np.linalg.solve(rotor.K, force)
    assert q[rotor.n + rotor.station(a)] == pytest.approx(10.0 * a**2 * b**2 / (3 * EI * L), rel=1e-5)
    assert np.abs(q[: rotor.n]).max() == 0.0  # nothing across


def test_a_disk_on_a_massless_shaft_is_critical_at_the_root_of_k_over_m(jeffcott: RigConfig) -> None:
    rotor = build(jeffcott, nameplate(jeffcott))
    expected = np.sqrt(48 * EI / L**3 / 1.0)
    assert rotor.critical_speeds(2) == pytest.approx([expected, expected], rel=1e-4)  # the shaft weighs 31 mg


def test_a_uniform_beam_is_critical_where_rayleigh_says_backward_below_forward(jeffcott: RigConfig) -> None:
    """w^2 (1 + e) = w0^2 + 2 e W w with e = (pi r / L)^2, r = d / 4; forward W = w, backward W = -w.

    Green, J. Appl. Mech. 15 (1948) 369: rotary inertia e, gyroscopic moment twice that, no shear.
    """
    thick, density = 0.04, 7800.0
    shaft = jeffcott.shaft.model_copy(update={"diameter": thick, "density": density})
    feather = jeffcott.disks[0].model_copy(update={"mass": 1e-9, "polar_inertia": 1e-15, "transverse_inertia": 1e-15})
    rigid = tuple(b.model_copy(update={"kxx": b.kxx * 1e3, "kyy": b.kyy * 1e3}) for b in jeffcott.bearings)
    rig = jeffcott.model_copy(update={"shaft": shaft, "disks": (feather,), "bearings": rigid})
    e = (np.pi * thick / 4 / L) ** 2
    w0 = (np.pi / L) ** 2 * np.sqrt(200e9 / density) * thick / 4
    backward, forward = w0 / np.sqrt(1 + 3 * e), w0 / np.sqrt(1 - e)
    assert build(rig, nameplate(rig)).critical_speeds(2) == pytest.approx([backward, forward], rel=1e-4)
    assert forward / backward - 1 > 0.01  # so that the tolerance tells the two apart


def test_bearings_carry_the_weight_of_shaft_and_disk(rk4: RigConfig) -> None:
    rotor = build(rk4, nameplate(rk4))
    sag = rotor.static_sag((0.0, -GRAVITY))
    carried = -sum(b.kyy * sag[rotor.n + rotor.station(b.position)] for b in rk4.bearings)
    shaft = 7801 * np.pi / 4 * 0.01**2 * 0.56
    assert carried == pytest.approx((shaft + 0.809) * GRAVITY, rel=1e-9)


def test_material_damping_alone_turns_with_the_shaft(rk4: RigConfig) -> None:
    rotor = build(rk4, nameplate(rk4))
    bearings = rotor.C.copy()
    bearings[: rotor.n, : rotor.n] -= rotor.D
    bearings[rotor.n :, rotor.n :] -= rotor.D
    spring = rotor.station(0.481)
    assert bearings[spring, spring] == pytest.approx(15.0)
    assert np.count_nonzero(np.abs(bearings) > 1e-9) == 2


def test_deviations_move_the_critical_speed_as_the_closed_form_says(jeffcott: RigConfig) -> None:
    plain = nameplate(jeffcott)
    stiffer = replace(plain, modulus_factor=1.02)
    heavier = replace(plain, disk_mass_factors=(1.04,))
    speeds = [build(jeffcott, truth).critical_speeds(1)[0] for truth in (plain, stiffer, heavier)]
    assert speeds[1] / speeds[0] == pytest.approx(np.sqrt(1.02), rel=1e-5)
    assert speeds[2] / speeds[0] == pytest.approx(1 / np.sqrt(1.04), rel=1e-5)


def test_the_first_critical_speeds_agree_with_the_config_and_not_too_well_with_the_fit_s_model(rk4: RigConfig) -> None:
    """Same nameplate, another beam theory and mesh: within 3 % and not within 0.01 %, or nothing would be tested."""
    free = rk4.model_copy(
        update={"bearings": tuple(b.model_copy(update={"cxx": 0.0, "cyy": 0.0}) for b in rk4.bearings)}
    )
    own = build(free, nameplate(free)).critical_speeds(2)
    theirs = critical_speeds(reduce(assemble(free)), up_to=3000 * RPM)[:2]
    assert own / RPM == pytest.approx([2226, 2237], rel=0.03)
    apart = np.abs(own / theirs - 1)
    assert (apart < 0.03).all()
    assert (apart > 1e-4).all()


def test_a_stepped_shaft_has_the_critical_speeds_of_the_timoshenko_model_nearly(rk4: RigConfig) -> None:
    table = rk4.model_dump()
    table["shaft"] |= {
        "diameter": 0.014,
        "sections": [
            {"length": 0.2, "diameter": 0.010},
            {"length": 0.1, "diameter": 0.014, "inner_diameter": 0.006},
            {"length": 0.26, "diameter": 0.009, "youngs_modulus": 180e9, "density": 8000.0},
        ],
    }
    stepped = from_si(table)
    plant = build(stepped, nameplate(stepped)).critical_speeds()
    finite_elements = critical_speeds(reduce(assemble(stepped)), up_to=400.0)
    difference = np.abs(plant / finite_elements[:2] - 1)
    assert np.all(difference < 0.03)  # another theory of the beam, and material damping
    assert np.all(difference > 1e-6)
    uniform = build(rk4, nameplate(rk4)).critical_speeds()
    assert np.all(np.abs(plant / uniform - 1) > 0.01)

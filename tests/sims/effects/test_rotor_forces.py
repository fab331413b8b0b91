"""Forces that turn with the rotor, against beams and springs worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig, from_si
from rotorrig.sims.effects.base import Effect, catalogue, find
from rotorrig.sims.effects.unbalance_step import Stretch
from rotorrig.sims.rotor.model.assembly import assemble
from rotorrig.sims.rotor.steady.harmonic_response import load_columns
from tests.sims.effects.predicted import Complex, motion, pair_at, predicted, simple_rig

EI = 210e9 * np.pi * 0.01**4 / 64  # of simple_rig
LENGTH = 0.4
LIGHT = {"length": LENGTH, "diameter": 0.01, "density": 1e-3, "youngs_modulus": 210e9}
POINT = {"name": "disk", "position": 0.2, "mass": 0.8, "polar_inertia": 0.0, "transverse_inertia": 0.0}
PINNED = [{"name": name, "position": z, "rigid": True} for name, z in (("A", 0.0), ("B", LENGTH))]
SHEAR = 3e-3  # of the bending of a shaft this slender


def alone(effect: Effect, theta: dict[str, float], rig: RigConfig, omega: float, order: int = 1) -> Complex:
    """The vectors of an effect without any unbalance, at one speed."""
    return predicted(effect, theta, rig=rig, model=assemble(rig), base=False, omega=np.array([omega]))[order][0]


def jeffcott() -> RigConfig:
    """A point mass in the middle of a pinned shaft without mass: k = 48 E I / L^3."""
    return simple_rig(pair_at(0.2), shaft=LIGHT, disks=[POINT], bearings=PINNED)


CRITICAL = np.sqrt(48 * EI / LENGTH**3 / 0.8)


@pytest.mark.parametrize("name", ["rk4", "jeffcott"])
def test_turned_by_hand_a_bowed_shaft_shows_its_bow(name: str, rk4: RigConfig) -> None:
    rig = rk4.model_copy(update={"probes": rk4.probes[:2]}) if name == "rk4" else jeffcott()
    at_disk = tuple(p.model_copy(update={"position": rig.disks[0].position}) for p in rig.probes)
    z = alone(find(rig, "bow"), {"bow re": 3e-6, "bow im": 4e-6}, rig.model_copy(update={"probes": at_disk}), 0.0)
    assert z == pytest.approx([3e-6 + 4e-6j, 4e-6 - 3e-6j], rel=1e-6)


@pytest.mark.parametrize("ratio", [0.5, 0.9, 1.5, 4.0])
def test_a_jeffcott_rotor_amplifies_its_bow(ratio: float) -> None:
    rig = jeffcott()
    z = alone(find(rig, "bow"), {"bow re": 1e-5, "bow im": 0.0}, rig, ratio * CRITICAL)
    assert z[0] == pytest.approx(1e-5 / (1 - ratio**2), rel=SHEAR * 5)  # Nicholas et al. (1976), eq. 6, no damping


def test_bow_is_a_constant_and_an_unbalance_of_the_mass_that_stands_off() -> None:
    rig = jeffcott()
    bow = alone(find(rig, "bow"), {"bow re": 1e-5, "bow im": 0.0}, rig, 150.0)
    model = assemble(rig)
    mass = 0.8 * 1e-5 * (model.disks[0].rows[0] - 1j * model.disks[0].rows[1])
    (step,) = find(rig, "unbalance_step").loads(model, {"step re": 0.8 * 1e-5, "step im": 0.0, "time": 0.0})
    assert step.pattern == pytest.approx(mass)
    unbalance = motion(model, (step,), 1, np.array([150.0]))[0]
    assert bow == pytest.approx(unbalance + 1e-5 * np.array([1, -1j]), rel=1e-4)


def test_a_shaft_is_not_bent_by_a_push_at_a_bearing_but_may_be_bent_evenly() -> None:
    rig = simple_rig(pair_at(0.2), disks=[{**POINT, "position": LENGTH}])
    assert [e.label for e in catalogue(rig) if e.name == "bow"] == ["bow, even"]


def test_an_even_bow_shows_at_rest_as_the_arc_it_is(rk4: RigConfig) -> None:
    one = [{"name": n, "position": z, "kxx": 1e7, "kyy": 1e7} for n, z in (("a", 0.065), ("b", 0.481))]
    table = rk4.model_dump(mode="json", exclude_unset=True) | {"bearings": one, "identify": None}
    rig = from_si(table)
    model = assemble(rig)
    (load,) = find(rig, "bow, even").loads(model, {"bow re": 10e-6, "bow im": 0.0})
    z = load_columns(model, np.array([1e-3]), [load])[0, :, 0]
    x = np.array([probe.position for probe in rig.probes])
    arc = 10e-6 * (1 - (2 * (x - 0.273) / 0.416) ** 2)
    assert np.abs(z) == pytest.approx(arc, rel=2e-3)


@pytest.mark.parametrize("shift", [0.0, -0.013])
def test_unbalance_between_the_parts_acts_as_at_a_plane_there(rk4: RigConfig, shift: float) -> None:
    rig = rk4.model_copy(update={"planes": ()})
    there = find(rig, "unbalance_plane, at 400 mm")
    theta = {"unbalance re": 5e-6, "unbalance im": -2e-6, "shift": shift}
    table = rk4.model_dump(mode="json", exclude_unset=True)
    with_plane = from_si({**table, "planes": [{"name": "hub", "position": 0.4 + shift}]})
    hub = find(with_plane, "unbalance_plane, at hub")
    assert alone(there, theta, rig, 200.0) == pytest.approx(alone(hub, theta, with_plane, 200.0), rel=1e-4)


def test_a_scan_along_the_shaft_keeps_off_disks_and_bearings(rk4: RigConfig) -> None:
    places = [e.position for e in catalogue(rk4) if e.name == "unbalance_plane"]
    parts = [part.position for part in (*rk4.disks, *rk4.bearings)]
    assert places[0] == 0.0 and places[-1] == rk4.shaft.length
    assert min(abs(z - part) for z in places for part in parts) > 0.01
    assert max(np.diff(places)) < 0.09


def test_a_skew_disk_bends_the_shaft_into_an_s() -> None:
    disk = {**POINT, "polar_inertia": 2e-4, "transverse_inertia": 5e-4}
    rig = simple_rig(pair_at(0.3), shaft=LIGHT, disks=[disk], bearings=PINNED)
    omega = 1.0  # far below any resonance
    moment = omega**2 * (5e-4 - 2e-4) * 1e-3
    z = alone(find(rig, "couple"), {"skew re": 1e-3, "skew im": 0.0}, rig, omega)
    assert z == pytest.approx(moment * LENGTH**2 / (128 * EI) * np.array([1, -1j]), rel=2 * SHEAR)


def test_a_disk_as_round_as_a_ball_has_no_couple() -> None:
    rig = simple_rig(pair_at(0.3), disks=[{**POINT, "polar_inertia": 3e-4, "transverse_inertia": 3e-4}])
    assert "couple" not in {e.name for e in catalogue(rig)}


def test_at_rest_the_coupling_tilts_a_stiff_shaft_about_the_other_bearing() -> None:
    rig = simple_rig(pair_at(0.2), k=1e3)  # springs 200 times as soft as the shaft
    theta = {"force 1X re": 0.0, "force 1X im": 0.2, "force 2X re": 0.1, "force 2X im": 0.0}
    assert alone(find(rig, "coupling"), theta, rig, 0.0) == pytest.approx([0.1e-3j, 0.1e-3], rel=1e-9)
    assert alone(find(rig, "coupling"), theta, rig, 0.0, order=2) == pytest.approx([0.05e-3, -0.05e-3j], rel=1e-9)


def test_a_force_twice_per_turn_resonates_at_half_the_critical_speed() -> None:
    rig = jeffcott()
    omega = CRITICAL * np.linspace(0.3, 0.7, 401)
    overhung = rig.model_copy(update={"shaft": rig.shaft.model_copy(update={"length": 0.5})})
    bearings = tuple(b.model_copy(update={"position": b.position + 0.1}) for b in rig.bearings)
    disks = tuple(d.model_copy(update={"position": 0.3}) for d in rig.disks)
    overhung = overhung.model_copy(update={"bearings": bearings, "disks": disks})
    theta = {"force 1X re": 0.0, "force 1X im": 0.0, "force 2X re": 0.1, "force 2X im": 0.0}
    z = predicted(find(rig, "coupling"), theta, rig=overhung, model=assemble(overhung), base=False, omega=omega)[2]
    assert omega[np.argmax(np.abs(z[:, 0]))] == pytest.approx(CRITICAL / 2, rel=3e-3)
    assert abs(z[:, 1]) == pytest.approx(abs(z[:, 0]))


def test_a_step_of_unbalance_acts_from_its_time_on(rk4: RigConfig) -> None:
    (load,) = find(rk4, "unbalance_step").loads(assemble(rk4), {"step re": 1e-6, "step im": 0.0, "time": 42.0})
    assert (load.since, load.law, load.order) == (42.0, "unbalance", 1)


@pytest.mark.parametrize(
    ("time", "when"),
    [
        (15.0, "15.0 s into recording 1 (at 900 rpm in run 'up')"),
        (1e6 + 75.0, "75.0 s into recording 2"),
        (0.5e6, "before recording 2 began"),
        (0.0, "before recording 1 began"),
    ],
)
def test_a_step_of_unbalance_says_when_it_was(rk4: RigConfig, time: float, when: str) -> None:
    step = find(rk4, "unbalance_step")
    up = Stretch(run="up", t=np.array([10.0, 20.0]), omega=np.array([600.0, 1200.0]) * np.pi / 30)
    words = replace(step, runs=(up,)).words({"step re": 0.0, "step im": 2e-6, "time": time})
    assert words == f"the unbalance of disk changed by 2.0 g mm at 90 deg from the keyphasor mark, {when}"

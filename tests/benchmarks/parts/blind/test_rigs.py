"""Drawn rigs are valid, can be run, and are what they are said to be; faults and wrong nameplates fit them."""

from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from benchmarks.parts.blind.cases import Case, nameplate, sizes
from benchmarks.parts.blind.rigs.deviants import DEVIANTS, DIAMETER, HUB, POSITION, TILT, Deviation, put_together
from benchmarks.parts.blind.rigs.drawn import DAMPING, GRADES, LAYOUTS, LIMIT, character, draw_rig, layout
from benchmarks.parts.blind.rigs.fault_sizes import BESIDE_THE_DISK, BETWEEN_BEARINGS, POWERS, fault_of
from rotorrig.app.cli import app
from rotorrig.rig.config import RPM, RigConfig, load
from rotorrig.rig.config.extended_config import extend
from rotorrig.sims.plant.deviations import as_built
from rotorrig.sims.plant.draw import draw_fault
from rotorrig.sims.plant.draw import nameplate as truth_of_nameplate
from rotorrig.sims.plant.faults import load_fault
from rotorrig.sims.plant.faults.base import fault_names
from rotorrig.sims.plant.shaft import build
from rotorrig.sims.plant.truth import Geometry

SEEDS = range(6)
AS_DRAWN = {  # angles, pure numbers, times of heat, and what belongs to the probes
    "bow": "angle",
    "couple": "skew angle",
    "coupling": "bore_angle offset offset_angle stiff_diameter",
    "crack": "angle",
    "cross_talk": "share probe",
    "delay": "time",
    "disk_inertia": "polar transverse",
    "hysteresis": "loss_factor",
    "line_hum": "amount phase",
    "loose_pedestal": "loss",
    "magnetic_pull": "angle",
    "pedestal": "damping_ratio",
    "probe_angle": "turn probe",
    "probe_bracket": "share frequency damping_ratio probe",
    "probe_curvature": "quadratic cubic probe",
    "probe_gain": "gain probe",
    "rub": "friction",
    "runout": "eccentricity angle oval oval_angle probe",
    "seal": "share",
    "shaft_asymmetry": "asymmetry stiff_plane",
    "slipping_coupling": "bore_angle creep",
    "snubber": "offset angle",
    "stiffness_over_speed": "gain",
    "twice_line_pull": "angle phase",
    "unbalance_drift": "angle time",
    "unbalance_plane": "angle",
    "unbalance_step": "angle run",
}


@pytest.fixture(scope="module")
def rigs() -> list[RigConfig]:
    """Some rigs."""
    return [draw_rig(seed) for seed in SEEDS]


def test_a_rig_is_that_of_its_seed_and_all_layouts_come(rigs: list[RigConfig]) -> None:
    assert draw_rig.__wrapped__(3).hash == rigs[3].hash
    assert len({rig.hash for rig in rigs}) == len(rigs)
    assert {layout(rig) for rig in rigs} == set(LAYOUTS)


def test_rigs_are_as_large_and_as_well_balanced_as_is_said(rigs: list[RigConfig]) -> None:
    for rig in rigs:
        top = rig.plans["default"].fastest
        assert 8e-3 <= rig.shaft.diameter <= 20e-3
        for disk in rig.disks:
            assert disk.unbalance is not None
            grade = disk.unbalance.amount / disk.mass * top  # m/s: ISO 21940-11
            assert GRADES[0] * 0.95 < grade < GRADES[1] * 1.05
    assert {rig.bearing("sought").kxy != 0 for rig in rigs} == {True, False}


def test_the_critical_speed_lies_within_the_sweep_by_another_beam_theory(rigs: list[RigConfig]) -> None:
    """By the simulated rig's own elements, and no other critical speed with it."""
    for rig in rigs:
        whirls = sorted(build(rig, truth_of_nameplate(rig)).critical_speeds(3))
        plan = rig.plans["default"]
        assert 850 / RPM < whirls[0] < 3200 / RPM
        assert whirls[1] < plan.fastest / 1.3
        assert whirls[2] > plan.fastest * 1.05
        assert plan.start < 0.5 * whirls[0]


def test_motion_stays_below_half_the_limit_and_damping_is_a_rigs(rigs: list[RigConfig]) -> None:
    for rig in rigs:
        seen = character(rig)
        assert seen.peak < LIMIT / 2
        assert DAMPING[0] <= seen.damping_ratio <= DAMPING[1]


def test_its_config_can_be_written_read_and_checked(rigs: list[RigConfig], tmp_path: Path) -> None:
    for rig in rigs[:3]:
        path = tmp_path / f"{rig.name}.toml"
        path.write_text(extend(rig, ()).text, encoding="utf-8")
        assert load(path).hash == rig.hash
    done = CliRunner().invoke(app, ["check", str(path)])
    assert done.exit_code == 0, done.output
    assert "critical speeds" in done.output


def test_one_plane_of_the_same_rig_has_two_probes() -> None:
    one, two = draw_rig(5, planes=1), draw_rig(5)
    assert [probe.name for probe in one.probes] == ["1x", "1y"]
    assert (one.shaft, one.disks, one.bearings) == (two.shaft, two.disks, two.bearings)


def test_where_a_fault_is_of_the_cross_coefficients_they_are_not_sought() -> None:
    for fault in ("cross_stiffness", "skew_stiffness"):
        drawn = next(c for s in range(3) if (c := Case(design="P2", faults=(fault,), seed=s)).is_drawn)
        assert drawn.rig.identify is not None
        assert drawn.rig.identify.coefficients == "direct"


def test_every_parameter_that_is_drawn_says_how_it_goes_with_the_rig() -> None:
    drawn = {(fault, p) for fault in fault_names() for p in load_fault(fault).RANGE}
    scaled = {*POWERS, *BETWEEN_BEARINGS, *BESIDE_THE_DISK}
    kept = {(fault, p) for fault, names in AS_DRAWN.items() for p in names.split()}
    assert drawn <= scaled | kept
    assert not scaled & kept
    assert all(p in load_fault(fault).PARAMETERS for fault, p in scaled), "nothing is scaled that is not there"


def test_faults_keep_their_sizes_on_the_rk4_and_take_the_measure_of_another_rig(rigs: list[RigConfig]) -> None:
    rk4, own = nameplate("P2"), character(nameplate("P2"))
    assert fault_of(rk4, "rub", seed=7, runs=1) == draw_fault(rk4, "rub", seed=7)
    for rig in rigs[:4]:
        there, seen = draw_fault(rk4, "cubic_spring", seed=7).parameters["k3"], character(rig)
        here = fault_of(rig, "cubic_spring", seed=7, runs=1).parameters["k3"]
        # the spring's share in the bearing's force at the largest motion is what it is on the RK4
        assert here * seen.peak**2 / seen.stiffness == pytest.approx(there * own.peak**2 / own.stiffness)
        assert rig.identify is not None
        screw = fault_of(rig, "unbalance_plane", seed=7, runs=1).parameters["position"]
        ends = sorted([rig.bearing("sought").position, *(d.position for d in rig.disks)])
        assert ends[0] < screw < ends[-1]


def standing_apart(rig: RigConfig, kind: str, *, seed: int = 3) -> tuple[dict[tuple[str, str], float], Deviation]:
    """Return by how much every dimension of a deviant is off from that of the healthy rig, and what is asked for."""
    healthy, deviant = (put_together(rig, each, seed=seed)[1] for each in ("", kind))
    moved = {(d.kind, d.part): d.value - h.value for d, h in zip(deviant, healthy, strict=True) if d.value != h.value}
    (asked,) = [d for d in deviant if d.asked]
    return moved, asked


@pytest.mark.parametrize("kind", DEVIANTS)
def test_a_deviant_is_a_healthy_rig_that_is_off_in_one_dimension(kind: str) -> None:
    ranges = {"diameter": DIAMETER, "hub": HUB, "tilt": TILT}
    for rig in (nameplate("P2"), draw_rig(2)):
        moved, asked = standing_apart(rig, kind)
        assert list(moved) == [(kind, asked.part)]
        least, most = ranges.get(kind, POSITION)
        assert least <= abs(asked.value) <= most
    assert not any(d.asked for d in put_together(rig, "", seed=3)[1])


def test_the_simulated_rig_is_built_as_the_deviation_says() -> None:
    """Seen from its counterpart: a nearer bearing, a thicker shaft, a hub and a bearing against tilt all stiffen it."""
    rig = nameplate("P2")
    plain = truth_of_nameplate(rig)
    own = build(rig, plain).critical_speeds(1)[0]
    for kind in ("diameter", "hub", "tilt", "bearing_position"):
        for seed in range(4):
            full, deviations = put_together(rig, kind, seed=seed)
            (asked,) = [d for d in deviations if d.asked]
            shifts = tuple(asked.value * (bearing.name == asked.part) for bearing in rig.bearings)
            alone = {
                "diameter": {"diameter_factor": full.diameter_factor},
                "hub": {"hub_factors": full.hub_factors},
                "tilt": {"tilt_stiffnesses": full.tilt_stiffnesses},
                "bearing_position": {"bearing_shifts": shifts},
            }[kind]
            truth = replace(plain, geometry=Geometry(**alone))
            stiffer = build(as_built(rig, truth), truth).critical_speeds(1)[0] > own
            assert stiffer == (asked.value > 0 if kind != "bearing_position" else asked.value < 0), (kind, seed)


def test_an_unknown_departure_is_refused() -> None:
    with pytest.raises(ValueError, match="want one of bearing_position"):
        put_together(nameplate("P2"), "colour", seed=1)


def test_what_is_built_is_what_was_sealed_and_what_is_asked_for() -> None:
    case = Case(design="P2", deviant="probe_position", seed=1)
    geometry, deviations = case.geometry
    (asked,) = [d for d in deviations if d.asked]
    at = [i for i, probe in enumerate(case.rig.probes) if probe.name == asked.part]
    assert [geometry.probe_shifts[i] for i in at] == [asked.value]
    assert sizes(case) == ()

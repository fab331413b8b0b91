"""Healthy deviations: how far their tails reach, and what each of them does to a rig."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.deviations import as_built, draw_tailed
from rotorrig.sims.plant.draw import draw, nameplate
from rotorrig.sims.plant.plant import Plant
from rotorrig.sims.plant.sealed_truth import seal, unseal
from rotorrig.sims.plant.shaft import build
from rotorrig.sims.plant.truth import Geometry, Noise, Truth, Unmodelled

from .by_hand import measured, order_phasors, run_to, volts_of

SEEDS = range(4000)


def drawn(name: str) -> NDArray[np.float64]:
    return np.array([draw_tailed(seed, name, 0.01) / 0.01 for seed in SEEDS])


@pytest.mark.parametrize("name", ["modulus", "gain 0", "keyphasor", "position disk"])
def test_deviations_are_student_s_with_four_degrees_and_a_normal_core(name: str) -> None:
    """By Kolmogorov and Smirnov: red by chance once in a thousand, for seeds that stand in this file."""
    got = drawn(name)
    core = stats.t(4).ppf(stats.norm.cdf(1.0))  # 1.1416
    assert stats.kstest(got, stats.t(4, scale=1 / core).cdf).pvalue > 1e-3
    assert stats.binomtest(int(np.sum(np.abs(got) > 3)), len(got), 2 * stats.norm.sf(3)).pvalue < 1e-3  # no normal is
    inside = int(np.sum(np.abs(got) < 1.0))
    assert stats.binomtest(inside, len(got), 0.6827).pvalue > 1e-3


def test_a_truth_takes_its_deviations_from_there(rk4: RigConfig) -> None:
    """Beyond three sigma lie 2.66 % of t with four degrees, 0.27 % of a normal: of 800 drawn 21, and 2."""
    truths = [draw(rk4, seed=seed) for seed in range(200)]
    gains = (np.array([t.probe_gain_factors for t in truths]) - 1).ravel() / 0.01
    beyond = int(np.sum(np.abs(gains) > 3))
    share = 2 * stats.t(4).sf(3 * stats.t(4).ppf(stats.norm.cdf(1.0)))
    assert stats.binomtest(beyond, len(gains), share).pvalue > 1e-3
    assert stats.binomtest(beyond, len(gains), 2 * stats.norm.sf(3)).pvalue < 1e-3


def test_every_healthy_rig_has_what_no_nameplate_speaks_of_and_can_be_drawn_without(rk4: RigConfig) -> None:
    one, other = (draw(rk4, seed=seed).unmodelled for seed in (1, 2))
    for name in Unmodelled.__dataclass_fields__:
        assert getattr(one, name) != getattr(other, name)
        assert getattr(one, name) != getattr(Unmodelled(), name)
    bare = draw(rk4, seed=1, unmodelled=False)
    assert bare.unmodelled == Unmodelled()
    assert bare.geometry == draw(rk4, seed=1).geometry == Geometry()
    assert replace(bare, unmodelled=one) == draw(rk4, seed=1)  # nothing else is drawn otherwise


def with_unmodelled(rig: RigConfig, **values: object) -> Truth:
    return replace(nameplate(rig), unmodelled=Unmodelled(**values))  # type: ignore[arg-type]


def test_the_coupling_holds_the_driven_end_as_a_spring(rk4: RigConfig) -> None:
    """Its compliance adds to the shaft's own at that end: 1 / k' = 1 / (k + 1 / c), c of the rig without it."""
    plain, held = build(rk4, nameplate(rk4)), build(rk4, with_unmodelled(rk4, coupling_stiffness=2e4))
    end = plain.station(0.0)
    for plane in (end, end + plain.n):
        c = np.linalg.inv(plain.K)[plane, plane]
        assert np.linalg.inv(held.K)[plane, plane] == pytest.approx(1 / (2e4 + 1 / c), rel=1e-9)


def test_the_coupling_s_rubber_loses_a_share_of_its_stiffness_at_the_reference(rk4: RigConfig) -> None:
    plain = build(rk4, with_unmodelled(rk4, coupling_stiffness=2e4))
    lossy = build(rk4, with_unmodelled(rk4, coupling_stiffness=2e4, coupling_loss=0.2))
    end, added = plain.station(0.0), 230 * (lossy.C - plain.C)
    assert np.diag(added)[[end, end + plain.n]] == pytest.approx([0.2 * 2e4] * 2)
    assert np.count_nonzero(added) == 2
    np.testing.assert_array_equal(lossy.K, plain.K)


def test_the_supply_ripples_at_twice_the_mains_in_all_probes_alike(rk4: RigConfig) -> None:
    wave = volts_of(Plant(rk4, with_unmodelled(rk4, supply_ripple=4e-3)), 1.0)
    tone = 2 * np.mean(
        (wave - wave.mean(axis=0)) * np.exp(-2j * np.pi * 100 * np.arange(10_000) / 1e4)[:, None], axis=0
    )
    assert np.abs(tone[:4]) == pytest.approx(4e-3, rel=0.05)
    assert np.abs(tone[:4] - tone[0]).max() < 2e-4
    assert abs(tone[4]) < 1e-4


@pytest.mark.campaign
def test_probes_warm_up_over_minutes(rk4: RigConfig) -> None:
    """Of 1.4 % and 70 um, 1 - exp(-t / 600 s): after 5 s and after 65 s of a steady whirl."""
    gains, gaps = (0.014, 0.0, -0.014, 0.0), (0.0, 7e-5, 0.0, -7e-5)
    plant, plain = Plant(rk4, with_unmodelled(rk4, gain_drift=gains, gap_drift=gaps)), Plant(rk4, nameplate(rk4))
    seen = []
    for rig in (plant, plain):
        run_to(rig, 1500, settle=4.0)
        rows = []
        for until in (5.0, 65.0):
            rig.advance(until - 0.5)
            volts = volts_of(rig, 1.0)
            rows.append((np.abs(order_phasors(volts, order=1)), volts[:, :4].mean(axis=0)))
        seen.append(np.array(rows))
    share = 1 - np.exp(-np.array([5.0, 65.0]) / 600)
    assert seen[0][:, 0] / seen[1][:, 0] - 1 == pytest.approx(share[:, None] * gains, abs=2e-4)
    moved = (seen[0][:, 1] - seen[1][:, 1]) / 7874.0
    assert moved[:, [1, 3]] == pytest.approx(share[:, None] * np.array([7e-5, -7e-5]), abs=0.2e-6)


def test_the_bearing_s_rattling_grows_with_speed_below_its_corner_most(rk4: RigConfig) -> None:
    """White S, and on top g W / 230 rad/s of it through a corner of 60 Hz, in step: |1 + g / (1 + j f / 60)|^2."""
    silent = replace(Noise.none(), bearing_force=1e-3)
    plant = Plant(rk4, replace(nameplate(rk4), noise=silent, unmodelled=Unmodelled(noise_growth=3.0)))
    white = np.random.default_rng(3).standard_normal((400_000, 1, 2))
    got = plant._colour(white)[:, 0, 0]
    f, own = stats_spectrum(white[:, 0, 0])
    _, coloured = stats_spectrum(got)
    for low, high in ((5, 15), (50, 70), (150, 250)):
        band = (f > low) & (f < high)
        want = np.mean(1 / (1 + (f[band] / 60) ** 2))
        assert coloured[band].sum() / own[band].sum() == pytest.approx(want, rel=0.05)


def stats_spectrum(x: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return np.fft.rfftfreq(len(x), 1e-4), np.abs(np.fft.rfft(x)) ** 2


def test_a_rig_with_growing_noise_is_quiet_at_rest_and_louder_at_speed(rk4: RigConfig) -> None:
    silent = replace(Noise.none(), bearing_force=5e-2)
    spread = []
    for growth in (0.0, 4.0):
        truth = replace(nameplate(rk4), noise=silent, unmodelled=Unmodelled(noise_growth=growth))
        truth = replace(truth, unbalances=(replace(truth.unbalances[0], amount=0.0),))
        plant = Plant(rk4, truth)
        plant.advance(0.5)
        still = volts_of(plant, 8.0)[:, 0].std()
        run_to(plant, 3000)
        spread.append((still, volts_of(plant, 8.0)[:, 0].std()))
    assert spread[1][0] == pytest.approx(spread[0][0], rel=1e-6)
    assert spread[1][1] > 2.5 * spread[0][1]


@pytest.mark.parametrize("rpm", [900.0, 2150.0])
def test_the_damping_is_the_truth_s_at_the_reference_and_grows_from_there(rk4: RigConfig, rpm: float) -> None:
    """At a steady W it is a bearing with c (1 + g (W / 230 - 1)) and nothing else."""
    plain = nameplate(rk4)
    spring = plain.bearings[2]
    factor = 1 + 0.5 * (rpm * math.pi / 30 / 230 - 1)
    other = replace(spring, cxx=factor * spring.cxx, cyy=factor * spring.cyy)
    named = Plant(rk4, replace(plain, bearings=(*plain.bearings[:2], other)))
    want = measured(run_to(named, rpm), 1.0)
    got = measured(run_to(Plant(rk4, with_unmodelled(rk4, damping_growth=0.5)), rpm), 1.0)
    assert got == pytest.approx(want, rel=2e-3)


def test_parts_stand_where_they_were_put(rk4: RigConfig) -> None:
    built = Geometry(
        disk_shifts=(2e-3,),
        bearing_shifts=(0.0, 1e-3, -1e-3),
        probe_shifts=(1e-3, 1e-3, 0.0, 0.0),
        diameter_factor=1.01,
    )
    rig = as_built(rk4, replace(nameplate(rk4), geometry=built))
    assert rig.disks[0].position - rk4.disks[0].position == pytest.approx(2e-3)
    assert [b.position - a.position for a, b in zip(rk4.bearings, rig.bearings, strict=True)] == pytest.approx(
        [0.0, 1e-3, -1e-3]
    )
    assert {t.diameter for t in rig.shaft.tubes} == {0.01 * 1.01}
    assert sum(t.length for t in rig.shaft.tubes) == pytest.approx(0.56)
    assert as_built(rk4, nameplate(rk4)) is rk4


def test_a_shifted_disk_and_a_thicker_shaft_have_the_textbook_s_critical_speed(jeffcott: RigConfig) -> None:
    """k = 3 E I L / (a^2 b^2) with the disk at a = 220 mm, b = 180 mm, and d^4 = 1.02^4 of it."""
    built = Geometry(disk_shifts=(0.02,), bearing_shifts=(0.0, 0.0, 0.02), probe_shifts=(0, 0), diameter_factor=1.02)
    truth = replace(nameplate(jeffcott), geometry=built)
    rotor = build(as_built(jeffcott, truth), truth)
    k = 3 * 98.17 * 1.02**4 * 0.4 / (0.22**2 * 0.18**2)
    assert rotor.critical_speeds(1)[0] == pytest.approx(np.sqrt(k), rel=2e-3)  # the disk tilts a little


def test_a_hub_stiffens_the_shaft_over_its_length_alone(jeffcott: RigConfig) -> None:
    """Midspan of a beam whose middle 25 mm are thicker by 5 %: Mohr's integral of (z / 2)^2 / E I."""
    truth = replace(nameplate(jeffcott), geometry=Geometry(hub_factors=(1.05,)))
    rotor = build(as_built(jeffcott, truth), truth)
    disk = rotor.station(0.2)
    edge = 0.2 - 0.0125
    compliance = 2 / 4 * (edge**3 / 3 / 98.17 + (0.2**3 - edge**3) / 3 / (98.17 * 1.05**4))
    assert np.linalg.inv(rotor.K)[disk, disk] == pytest.approx(compliance, rel=2e-3)


def test_a_bearing_that_resists_tilt_is_a_spring_on_the_slope(jeffcott: RigConfig) -> None:
    """A beam with springs k at both ends against turning: midspan L^3 / 48 E I less M L^2 / 8 E I, M by its slope."""
    k = 300.0
    truth = replace(nameplate(jeffcott), geometry=Geometry(tilt_stiffnesses=(k, k, 0.0)))
    rotor = build(jeffcott, truth)
    L, EI = 0.4, 98.17
    moment = k * (L**2 / 16 / EI) / (1 + k * L / 2 / EI)
    assert np.linalg.inv(rotor.K)[rotor.station(0.2)][rotor.station(0.2)] == pytest.approx(
        L**3 / 48 / EI - moment * L**2 / 8 / EI, rel=1e-3
    )


def test_geometry_is_drawn_on_request_within_the_shaft_and_planes_stay_planes(rk4: RigConfig) -> None:
    shifts = []
    for seed in range(60):
        built = draw(rk4, seed=seed, geometry=True).geometry
        rig = as_built(rk4, replace(nameplate(rk4), geometry=built))
        assert all(0 <= part.position <= 0.56 for part in (*rig.disks, *rig.bearings, *rig.probes))
        assert built.probe_shifts[0] == built.probe_shifts[1] != built.probe_shifts[2]
        assert min(built.hub_factors) >= 1.0
        assert min(built.tilt_stiffnesses) >= 0.0
        shifts += [*built.disk_shifts, *built.bearing_shifts]
        if seed < 3:
            Plant(rk4, replace(draw(rk4, seed=seed), geometry=built)).advance(0.05)
    assert 0.7e-3 < np.quantile(np.abs(shifts), 0.683) < 1.4e-3  # of 240: 1 mm within 4 sigma


def test_a_truth_that_was_sealed_before_there_were_deviations_can_be_read(rk4: RigConfig, tmp_path: Path) -> None:
    path = tmp_path / "sealed.json"
    seal(nameplate(rk4), path)
    table = json.loads(path.read_text())
    del table["unmodelled"], table["geometry"]
    path.write_text(json.dumps(table))
    assert unseal(path) == nameplate(rk4)
    whole = draw(rk4, seed=2, geometry=True)
    seal(whole, path)
    assert unseal(path) == whole

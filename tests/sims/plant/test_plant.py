"""The whole blind rig through its counts alone: what a lab would see on a scope and a vector filter."""

import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import DataError
from rotorrig.sims.plant.draw import draw, nameplate
from rotorrig.sims.plant.faults.base import fault_names
from rotorrig.sims.plant.plant import Plant
from rotorrig.sims.plant.truth import FaultSpec, Noise

from .by_hand import RPM, falling_edges, measured, order_phasors, volts_of

SENSITIVITY = 7874.0  # V/m
FIRST_SAMPLES = """
import sys
from pathlib import Path
from numba.core.dispatcher import Dispatcher
from rotorrig.rig.config import load
from rotorrig.sims.plant import FaultSpec, Plant, draw
from rotorrig.sims.plant.faults.base import fault_names

def compiled():
    modules = [module for name, module in sys.modules.items() if name.startswith("rotorrig.sims.")]
    kernels = [each for module in modules for each in vars(module).values() if isinstance(each, Dispatcher)]
    assert len(kernels) > 10
    return {(kernel.__module__, kernel.__name__, str(types)) for kernel in kernels for types in kernel.signatures}

rig = load(Path(sys.argv[1]))
for faults in ([], *([FaultSpec(name=name)] for name in fault_names())):
    plant = Plant(rig, draw(rig, seed=1, faults=faults))
    before = compiled()
    plant.command(30.0, 20.0, True)
    plant.advance(0.3)
    plant.command(0.0, 20.0, False)
    plant.advance(0.4)
    print(*sorted(compiled() - before) or [faults[0].name if faults else "healthy"])
"""


def turning(plant: Plant, rpm: float, *, settle: float = 2.0) -> Plant:
    """Bring `plant` to a steady speed."""
    plant.command(rpm * RPM, 200.0, True)
    plant.advance(plant.t + rpm * RPM / 200.0 + settle)
    return plant


def with_unbalance(rig: RigConfig, angle: float, *, keyphasor_offset: float = 0.0) -> Plant:
    plain = nameplate(rig)
    heavy = replace(plain.unbalances[0], angle=angle)
    return Plant(rig, replace(plain, unbalances=(heavy,), keyphasor_offset=keyphasor_offset))


@pytest.mark.campaign
def test_counts_do_not_depend_on_the_size_of_the_blocks(rk4: RigConfig) -> None:
    truth = draw(rk4, seed=3, faults=[FaultSpec(name="coupling")])
    sizes = np.random.default_rng(0).integers(0, 3000, 400)

    def run(pieces: np.ndarray) -> np.ndarray:
        plant, counts = Plant(rk4, truth), []
        for powered, until in ((True, 20_000), (False, 30_000)):
            plant.command(150.0, 100.0, powered)
            samples = round(plant.t * 1e4)
            for size in pieces:
                samples = min(samples + int(size), until)
                counts.append(plant.advance(samples / 1e4))
            counts.append(plant.advance(until / 1e4))
        return np.concatenate(counts)

    whole = run(np.array([], int))
    assert whole.shape == (30_000, 5)
    assert np.array_equal(run(sizes), whole)
    assert np.array_equal(run(np.full(20_000, 1)), whole)


@pytest.mark.parametrize("rate", ["10 kHz", "4 kHz"])  # of one step per sample, and of several
def test_no_sample_waits_for_a_compilation(rate: str, rk4: RigConfig, tmp_path: Path) -> None:
    """In a process of its own: in this one, other tests have compiled kernels."""
    (tmp_path / "rig.toml").write_text(rk4.text.replace('"10 kHz"', f'"{rate}"'))
    command = [sys.executable, "-c", FIRST_SAMPLES, str(tmp_path / "rig.toml")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.stdout.splitlines() == ["healthy", *fault_names()], done.stderr


def test_a_seed_repeats_its_counts_and_another_seed_does_not(rk4: RigConfig) -> None:
    def run(seed: int) -> np.ndarray:
        plant = Plant(rk4, draw(rk4, seed=seed))
        plant.command(100.0, 100.0, True)
        return plant.advance(1.0)

    assert np.array_equal(run(1), run(1))
    assert not np.array_equal(run(1), run(2))


def test_advance_gives_every_sample_up_to_the_time_asked_for_once(rk4: RigConfig) -> None:
    plant = Plant(rk4, nameplate(rk4))
    assert plant.advance(0.0).shape == (0, 5)
    assert plant.advance(0.1).shape == (1000, 5)
    assert plant.t == 0.1
    assert plant.advance(0.05).shape == (0, 5)  # the past is past
    assert plant.advance(0.1 + 1.5e-4).shape == (1, 5)
    assert plant.advance(0.3).shape == (1999, 5)


def test_a_slow_rotor_s_heavy_spot_faces_a_probe_as_its_angle_says(rk4: RigConfig) -> None:
    """Far below critical the shaft bends towards the heavy spot: at angle 0 it faces probe x at the keyphasor's edge.

    Then x = Re(z e^{j theta}) with arg z = 0, and y, a quarter turn on, lags by 90 degrees.
    """
    z = measured(turning(with_unbalance(rk4, 0.0), 480), 2.0)
    assert np.degrees(np.angle(z)) == pytest.approx([0.0, -90.0, 0.0, -90.0], abs=1.0)
    # U W^2 / (m (w^2 - W^2)) at the disk: 15 g mm on 0.83 kg at 480 of 2230 rpm is 0.88 um, less at the probes
    assert (np.abs(z) > 0.6e-6).all()
    assert (np.abs(z) < 0.95e-6).all()


def test_an_unbalance_further_on_leads_by_its_angle(rk4: RigConfig) -> None:
    z = measured(turning(with_unbalance(rk4, math.radians(60.0)), 480), 2.0)
    assert np.degrees(np.angle(z)) == pytest.approx([60.0, -30.0, 60.0, -30.0], abs=1.0)


def test_a_late_keyphasor_edge_adds_to_every_phase(rk4: RigConfig) -> None:
    """Angles count from the emitted edge, so theta is less by the offset and z e^{j theta} keeps its place."""
    z = measured(turning(with_unbalance(rk4, 0.0, keyphasor_offset=math.radians(40.0)), 480), 2.0)
    assert np.degrees(np.angle(z)) == pytest.approx([40.0, -50.0, 40.0, -50.0], abs=1.0)


def test_far_above_critical_the_heavy_spot_points_away(rk4: RigConfig) -> None:
    z = measured(turning(with_unbalance(rk4, 0.0), 3600, settle=6.0), 2.0)
    assert np.degrees(np.angle(-z[[0, 2]])) == pytest.approx([0.0, 0.0], abs=5.0)


def test_a_rotor_turning_from_y_to_x_shows_y_first(rk4: RigConfig) -> None:
    rig = rk4.model_copy(update={"rotation": "y-to-x"})
    z = measured(turning(with_unbalance(rig, math.radians(20.0)), 480), 2.0)
    assert np.degrees(np.angle(z)) == pytest.approx([20.0, 110.0, 20.0, 110.0], abs=1.0)


def test_doubling_the_unbalance_doubles_the_vibration(rk4: RigConfig) -> None:
    plain = nameplate(rk4)
    double = replace(plain, unbalances=(replace(plain.unbalances[0], amount=30e-6),))
    one, two = (measured(turning(Plant(rk4, truth), 1500), 2.0) for truth in (plain, double))
    assert two == pytest.approx(2 * one, rel=2e-3)


def test_a_trial_mass_adds_the_whirl_of_its_own_unbalance(rk4: RigConfig) -> None:
    """Twice the disk's own unbalance at its own angle is three times the vibration."""
    bare = replace(draw(rk4, seed=8), noise=Noise.none(), runout_seed=None)
    own = bare.unbalances[0]
    loaded = replace(bare, trial=(replace(own, amount=2 * own.amount),))
    one, three = (measured(turning(Plant(rk4, truth), 1500), 2.0) for truth in (bare, loaded))
    assert three == pytest.approx(3 * one, rel=5e-3)


def test_another_run_is_the_same_rig_with_other_noise(rk4: RigConfig) -> None:
    first, second = (turning(Plant(rk4, draw(rk4, seed=8, run=run)), 600) for run in (0, 1))
    z = [measured(plant, 4.0) for plant in (first, second)]
    assert z[0] == pytest.approx(z[1], abs=0.25e-6)
    assert np.count_nonzero(first.advance(first.t + 0.1) != second.advance(second.t + 0.1)) > 1000


def test_a_trial_mass_for_a_disk_of_another_rig_is_refused(rk4: RigConfig) -> None:
    plain = nameplate(rk4)
    with pytest.raises(DataError, match=r"has a trial mass on 'rim', which 'RK4 with spring bearing .* has not"):
        Plant(rk4, replace(plain, trial=(replace(plain.unbalances[0], disk="rim"),)))


def test_the_keyphasor_falls_once_per_turn_at_the_true_speed(rk4: RigConfig) -> None:
    plant = turning(Plant(rk4, nameplate(rk4)), 1200)
    edges = falling_edges(volts_of(plant, 2.0)[:, 4])
    assert len(edges) == 40
    assert np.diff(edges) == pytest.approx(500.0, abs=1.0)
    assert plant.speed == pytest.approx(1200 * RPM, rel=1e-9)


def test_weight_pulls_the_shaft_from_a_vertical_probe_s_gap(rk4: RigConfig) -> None:
    """170 to 190 um of sag: m g over 50 kN/m, plus the left end's tilt; horizontal probes read their gap voltage."""
    mean = Plant(rk4, nameplate(rk4)).advance(0.1).mean(axis=0) * 24 / 32768
    assert mean[[0, 2]] == pytest.approx([-10.0, -10.0], abs=1e-3)
    assert (mean[[1, 3]] + 10.0) / SENSITIVITY == pytest.approx([-180e-6, -180e-6], abs=15e-6)
    up = rk4.model_copy(update={"gravity": "none"})
    assert Plant(up, nameplate(up)).advance(0.1).mean(axis=0)[1] * 24 / 32768 == pytest.approx(-10.0, abs=1e-3)


def test_run_out_is_what_a_slow_roll_sees(rk4: RigConfig) -> None:
    """At 240 rpm the unbalance bends the shaft by 0.2 um; a track of 2 to 5 um stands out, 2X and more of it too."""
    round_, rough = (Plant(rk4, replace(nameplate(rk4), runout_seed=seed)) for seed in (None, 5))
    assert np.abs(measured(turning(round_, 240), 5.0)).max() < 0.3e-6
    wave = volts_of(turning(rough, 240), 5.0)
    first, second = (np.abs(order_phasors(wave, order=n)) / SENSITIVITY for n in (1, 2))
    assert (first > 1.5e-6).all()
    assert (first < 5.5e-6).all()
    assert (second > 0.3e-6).all()


@pytest.mark.campaign
def test_a_rattling_bearing_shakes_the_shaft_at_its_natural_frequency_by_half_a_micrometre(rk4: RigConfig) -> None:
    noise = replace(Noise.none(), bearing_force=Noise().bearing_force)
    x = volts_of(Plant(rk4, replace(nameplate(rk4), noise=noise)), 60.0)[:, [0, 2]] / SENSITIVITY
    assert x.std(axis=0) == pytest.approx([0.5e-6, 0.5e-6], rel=0.4)
    spectrum = np.abs(np.fft.rfft(x[:, 0] - x[:, 0].mean())) ** 2
    frequency = np.fft.rfftfreq(len(x), 1e-4)
    near = (frequency > 32.0) & (frequency < 42.0)  # 2226 rpm is 37.1 Hz
    assert spectrum[near].sum() > 0.8 * spectrum.sum()


def test_power_off_coasts_the_rotor_down(rk4: RigConfig) -> None:
    plant = turning(Plant(rk4, nameplate(rk4)), 600, settle=0.5)
    plant.command(0.0, 0.0, False)
    counts = plant.advance(plant.t + 30.0)
    assert plant.speed == 0.0
    assert np.ptp(counts[-1000:, 4]) == 0


def test_a_slow_sample_rate_is_integrated_in_smaller_steps(rk4: RigConfig) -> None:
    plant = turning(Plant(rk4, nameplate(rk4), sample_rate=2000.0), 1487)
    fine = turning(Plant(rk4, nameplate(rk4)), 1487)  # no whole number of samples per turn
    assert plant.advance(plant.t + 0.01).shape == (20, 5)
    assert measured(plant, 2.0)[0] == pytest.approx(measured(fine, 2.0)[0], rel=5e-3)


def test_a_truth_of_another_rig_is_refused(rk4: RigConfig, jeffcott: RigConfig) -> None:
    with pytest.raises(DataError, match=r"has bearings .* want those of 'RK4 with spring bearing"):
        Plant(rk4, nameplate(jeffcott))


def test_what_the_daq_says_of_itself(rk4: RigConfig, jeffcott: RigConfig) -> None:
    plant = Plant(rk4, nameplate(rk4))
    assert (plant.sample_rate, plant.channels, plant.full_scale_counts) == (10_000.0, 5, 32768)
    assert plant.volts_per_count == (24.0 / 32768,) * 5
    assert Plant(jeffcott, nameplate(jeffcott)).channels == 4
    assert Plant(jeffcott, nameplate(jeffcott)).sample_rate == 10_000.0

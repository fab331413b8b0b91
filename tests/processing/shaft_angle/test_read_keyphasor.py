"""The keyphasor's channel to the shaft angle, as the config says; truth is the angle that made the channel's volts."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.acquisition.recording import RawRecording
from rotorrig.processing.pipeline import track
from rotorrig.processing.shaft_angle.read_keyphasor import read_keyphasor
from rotorrig.processing.shaft_angle.shaft_angle import TURN, UNMARKED
from rotorrig.processing.waveform import Waveforms
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import DataError
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.sensors.chain import make_chain
from rotorrig.sims.plant.sensors.channels import VOLTS_PER_COUNT, Sensors
from tests.processing.synthetic import chirp, falling_notch, recording_of

RATE = 10_000.0
RPM = np.pi / 30
T = np.arange(int(20 * RATE)) / RATE
THETA = chirp(T, start=600 * RPM, rate=60 * RPM, theta_0=-0.3)


def set_to(rig: RigConfig, **changed: object) -> RigConfig:
    assert rig.keyphasor
    return rig.model_copy(update={"keyphasor": rig.keyphasor.model_copy(update=changed)})


def sensed(rig: RigConfig) -> RawRecording:
    """Return what the sensors of the plant make of a circle of 20 um that lags by 40 degrees, without noise."""
    truth = nameplate(rig)
    motion = np.zeros((len(T), len(rig.probes), 2))
    motion[:, :, 0] = 20e-6 * np.cos(THETA - np.radians(40))[:, None]
    motion[:, :, 1] = 20e-6 * np.sin(THETA - np.radians(40))[:, None]
    counts = Sensors(rig, truth, make_chain(rig, truth), sample_rate=RATE).counts(motion, THETA)
    channel = rig.keyphasor.channel
    blank = recording_of(
        rig, THETA, np.zeros((len(T), 4)), rate=RATE, marks=[(0.0, "up")], notch=counts[:, channel] * VOLTS_PER_COUNT
    )
    scale = replace(blank.daq, volts_per_count=(VOLTS_PER_COUNT,) * counts.shape[1], full_scale_counts=32768)
    return replace(blank, daq=scale, blocks=(replace(blank.blocks[0], counts=counts),))


def angle_error(recording: RawRecording) -> NDArray[np.float64]:
    """Return the angle found less the true one [rad], whole turns taken out."""
    shaft = read_keyphasor(Waveforms(recording))
    inside = slice(np.searchsorted(T, shaft.t[0]), np.searchsorted(T, shaft.t[-1]))
    error = shaft.theta(T[inside]) - THETA[inside]
    return error - TURN * np.round(error.mean() / TURN)


@pytest.mark.parametrize("pulses", [1, 2, 6])
@pytest.mark.parametrize("edge", ["falling", "rising"])
def test_the_plant_s_wheel_gives_the_shaft_s_angle(rk4: RigConfig, pulses: int, edge: str) -> None:
    error = angle_error(sensed(set_to(rk4, pulses_per_revolution=pulses, edge=edge)))
    assert np.sqrt(np.mean(error**2)) < np.radians(0.1)  # flanks of 2 degrees, 3 samples at most


@pytest.mark.parametrize("pulses", [1, 6])
def test_vectors_are_the_same_by_one_pulse_and_by_several(rk4: RigConfig, pulses: int) -> None:
    response = track(sensed(set_to(rk4, pulses_per_revolution=pulses)))
    x_probes = [i for i, probe in enumerate(response.probes) if probe.endswith("x")]
    want = 20e-6 * np.exp(-1j * np.radians(40))
    np.testing.assert_allclose(response.order(1.0)[:, x_probes], want, atol=0.003 * 20e-6)
    assert response.usable.all()


def test_phases_by_a_wheel_without_a_mark_are_remarked(rk4: RigConfig) -> None:
    twice = recording_of(
        set_to(rk4, pulses_per_revolution=2),
        THETA,
        np.tile(20e-6 * np.cos(THETA)[:, None], 4),
        rate=RATE,
        marks=[(0.0, "up")],
        notch=falling_notch(2 * THETA),
    )
    response = track(twice)
    assert all(UNMARKED in row for row in response.remarks)
    assert np.abs(np.abs(response.order(1.0)) - 20e-6).max() < 0.01e-6


def with_volts(rig: RigConfig, volts: NDArray[np.float64]) -> Waveforms:
    return Waveforms(recording_of(rig, THETA, np.zeros((len(T), 4)), rate=RATE, notch=volts))


def test_the_threshold_of_the_config_moves_the_edge_along_its_flank(rk4: RigConfig) -> None:
    """The flank falls by 8 V over 10 degrees, so 2 V above the middle it is passed 2.5 degrees sooner."""
    volts = falling_notch(THETA, slope=np.radians(10))
    middle = read_keyphasor(with_volts(rk4, volts))
    above = read_keyphasor(with_volts(set_to(rk4, threshold=-4.0), volts))
    t = np.linspace(1, 19, 1000)
    np.testing.assert_allclose(above.theta(t) - middle.theta(t), np.radians(2.5), atol=np.radians(0.02))


def test_a_wider_hysteresis_is_deaf_to_more_noise(rk4: RigConfig, rng: np.random.Generator) -> None:
    volts = falling_notch(THETA, slope=np.radians(10)) + 0.8 * rng.standard_normal(len(T))
    turns = int(THETA[-1] // TURN) + 1
    wide = read_keyphasor(with_volts(set_to(rk4, hysteresis=6.0), volts))
    assert len(wide.t) == turns
    assert wide.repairs == ()
    with pytest.raises(DataError, match="keyphasor pulses come too early"):
        read_keyphasor(with_volts(set_to(rk4, hysteresis=0.1), volts))


def test_a_threshold_or_hysteresis_beyond_the_pulses_is_said(rk4: RigConfig) -> None:
    volts = falling_notch(THETA)
    with pytest.raises(DataError, match=r"threshold is -12 V, want it between the levels of -10\.00 and -2\.00 V"):
        read_keyphasor(with_volts(set_to(rk4, threshold=-12.0), volts))
    with pytest.raises(DataError, match=r"hysteresis is 9 V, want less than 8\.00 V"):
        read_keyphasor(with_volts(set_to(rk4, hysteresis=9.0), volts))
    with pytest.raises(DataError, match=r"hysteresis is 5 V, want less than 4\.00 V"):
        read_keyphasor(with_volts(set_to(rk4, threshold=-8.0, hysteresis=5.0), volts))

"""What proves that the rotor is at rest, and what does not: on samples whose rotor is known."""

import math

import numpy as np
import pytest

from rotorrig.acquisition.sweep.rest import RestEvidence, RotorState
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.probes.base import Block, DaqInfo
from rotorrig.rig.probes.keyphasor_speed import KeyphasorSpeed
from tests.acquisition.sweep.scripted_rig import notch
from tests.parameters import defer_rest

SCANS = 200
UNEVEN = (0.0, 1.5, 3.0, 4.9)  # rad, of four teeth


class Machine:
    """A rotor, its samples and the evidence from them."""

    def __init__(self, rig: RigConfig, info: DaqInfo, *, teeth: tuple[float, ...] = (0.0,)) -> None:
        assert rig.keyphasor
        keyphasor = rig.keyphasor.model_copy(update={"pulses_per_revolution": len(teeth)})
        self._rig, self._info, self._teeth = rig.model_copy(update={"keyphasor": keyphasor}), info, teeth
        self._keyphasor = KeyphasorSpeed(self._rig, info)
        self._evidence = RestEvidence(self._rig, self._keyphasor)
        self._random = np.random.default_rng(3)
        self.speed = self._angle = 0.0
        self._first = 0

    def run(
        self,
        seconds: float,
        *,
        deceleration: float = 0.0,
        vibration: float = 50e-6,
        noise: float = 2e-3,
        keyphasor: float | None = None,
        dead: bool = False,
        gap: int = 0,
        hum: float = 0.0,
        weak: frozenset[int] = frozenset(),
    ) -> None:
        """Turn for so long at `deceleration` [rad/s^2] and `vibration` [m]; after every 25th block lose `gap` samples.

        `keyphasor` [V] is what its channel reads instead of pulses; `dead` samples do not differ at all; `hum` [V] of
        50 Hz is on the probes; in `weak` turns, counted from the first, the pulses have 1.8 V of 8.
        """
        rate, self._begun = self._info.sample_rate, math.tau * round(self._angle / math.tau)
        for number in range(1, round(seconds * rate / SCANS) + 1):
            angle = self._advance(SCANS, deceleration)
            volts = np.zeros((SCANS, self._info.channels))
            for probe in self._rig.probes:
                wave = vibration * np.cos(angle - probe.angle) if self.speed else 0.0
                volts[:, probe.channel] = probe.gap_voltage + probe.sensitivity * wave
                volts[:, probe.channel] += self._random.normal(0, noise, SCANS)
                volts[:, probe.channel] += hum * np.sin(100 * np.pi * (self._first + np.arange(SCANS)) / rate)
            assert self._rig.keyphasor
            turn = np.floor((angle - self._begun + math.pi) / math.tau)
            height = np.where(np.isin(turn, list(weak)), 1.8, 8.0)
            pulses = -2.0 - height * sum(notch(angle - tooth) for tooth in self._teeth)
            volts[:, self._rig.keyphasor.channel] = pulses if keyphasor is None else keyphasor
            self._take(np.zeros_like(volts) if dead else volts)
            if gap and number % 25 == 0:
                self._advance(gap, deceleration)
                self._first += gap

    def judge(self, *, drive_off: bool = False, fastest: float = 100.0, stopped_at: float = 0.0) -> RotorState:
        return self._evidence.judge(drive_off=drive_off, fastest=fastest, stopped_at=stopped_at)

    def take_as_rest(self) -> None:
        self._evidence.take_as_rest()

    def _advance(self, samples: int, deceleration: float) -> np.ndarray:
        dt = 1 / self._info.sample_rate
        speeds = np.maximum(self.speed - deceleration * dt * np.arange(1, samples + 1), 0.0)
        angles = self._angle + np.cumsum(speeds) * dt
        self.speed, self._angle = float(speeds[-1]), float(angles[-1])
        return angles

    def _take(self, volts: np.ndarray) -> None:
        counts = np.round(volts / np.array(self._info.volts_per_count)).astype(np.int32)
        block = Block(counts=counts, first_sample=self._first, t_ns=round(self._first * 1e9 / self._info.sample_rate))
        self._first += len(counts)
        self._keyphasor.update(block)
        self._evidence.take(block)


@pytest.fixture
def machine(rig: RigConfig, daq_info: DaqInfo) -> Machine:
    made = Machine(rig, daq_info)
    made.speed = 60.0
    made.run(3.0)
    return made


def test_pulses_seen_slowing_to_a_stop_are_rest_whatever_the_drive_says(machine: Machine) -> None:
    machine.run(2.0, deceleration=40.0)
    assert machine.speed == 0.0
    assert machine.judge() is RotorState.TURNING  # a pulse came within the last turn at 30 rpm
    machine.run(3.0)
    assert machine.judge() is RotorState.AT_REST


@pytest.mark.parametrize("drive_off", [False, True])
def test_pulses_that_end_at_speed_are_no_rest_whatever_the_drive_says(machine: Machine, drive_off: bool) -> None:
    machine.run(12.0, keyphasor=-2.0)
    assert machine.speed == 60.0
    assert machine.judge(drive_off=drive_off, stopped_at=3.0) is RotorState.UNKNOWN


def test_pulses_that_end_while_a_fast_rotor_slows_down_are_no_rest(machine: Machine) -> None:
    machine.run(0.75, deceleration=40.0)
    machine.run(0.75, deceleration=40.0, keyphasor=-2.0)
    machine.speed = 30.0  # it was let go again
    machine.run(3.0, keyphasor=-2.0)
    assert machine.judge() is RotorState.UNKNOWN


def test_the_drives_word_and_a_probe_that_sees_nothing_move_for_8_s_are_rest_and_neither_alone(
    machine: Machine,
) -> None:
    machine.run(1.5, deceleration=40.0, keyphasor=-2.0)
    machine.run(7.0, keyphasor=-2.0)
    assert machine.judge(drive_off=True) is RotorState.UNKNOWN
    machine.run(3.0, keyphasor=-2.0)
    assert machine.judge(drive_off=True) is RotorState.AT_REST
    assert machine.judge(drive_off=False) is RotorState.UNKNOWN


def test_probes_in_whose_noise_the_rotor_cannot_be_seen_prove_no_rest(rig: RigConfig, daq_info: DaqInfo) -> None:
    machine = Machine(rig, daq_info)
    machine.speed = 60.0
    machine.run(3.0, vibration=1e-6, noise=20e-3)
    machine.run(1.5, vibration=1e-6, noise=20e-3, deceleration=40.0, keyphasor=-2.0)
    machine.run(12.0, noise=20e-3, keyphasor=-2.0)
    assert machine.judge(drive_off=True) is RotorState.UNKNOWN


def test_what_a_probe_sees_of_the_inverter_is_not_the_rotor(rig: RigConfig, daq_info: DaqInfo) -> None:
    machine = Machine(rig, daq_info)
    machine.speed = 60.0
    machine.run(3.0, vibration=0.0, hum=0.2)
    machine.run(12.0, vibration=0.0, keyphasor=-2.0)
    assert machine.speed == 60.0
    assert machine.judge(drive_off=True) is RotorState.UNKNOWN


def test_a_rotor_that_moves_less_than_it_did_but_more_than_before_the_start_is_not_at_rest(
    rig: RigConfig, daq_info: DaqInfo
) -> None:
    machine = Machine(rig, daq_info)
    machine.run(2.5)
    machine.take_as_rest()
    machine.speed = 60.0
    machine.run(3.0)
    machine.run(1.4, deceleration=40.0, keyphasor=-2.0)
    assert machine.speed == pytest.approx(4.0)  # 38 rpm
    machine.run(12.0, keyphasor=-2.0, vibration=10e-6)
    assert machine.judge(drive_off=True) is RotorState.UNKNOWN
    machine.run(0.2, deceleration=40.0, keyphasor=-2.0)
    machine.run(10.0, keyphasor=-2.0)
    assert machine.judge(drive_off=True) is RotorState.AT_REST


def test_pulses_that_fade_at_speed_are_no_rotor_that_slows_down(machine: Machine) -> None:
    machine.run(1.0)
    machine.run(4.0, weak=frozenset({2, 4, 5, 6, *range(8, 100)}))
    assert machine.speed == 60.0
    assert machine.judge() is RotorState.UNKNOWN


def test_samples_that_do_not_differ_prove_nothing(machine: Machine) -> None:
    machine.run(0.5, deceleration=40.0)
    machine.run(12.0, dead=True)
    assert machine.judge(drive_off=True) is RotorState.UNKNOWN


def test_a_daq_that_dies_after_the_last_pulse_proves_no_rest_any_more(machine: Machine) -> None:
    machine.run(2.0, deceleration=40.0)
    machine.run(3.0, dead=True)
    assert machine.judge(drive_off=True) is RotorState.UNKNOWN
    machine.run(3.0)
    assert machine.judge() is RotorState.AT_REST


@pytest.mark.parametrize("level", [0.0, -1.0])
def test_a_keyphasor_that_reads_what_it_never_read_before_proves_no_rest_by_its_silence(
    machine: Machine, level: float
) -> None:
    machine.run(2.0, deceleration=40.0)
    machine.run(3.0, keyphasor=level)
    assert machine.judge() is RotorState.UNKNOWN


@pytest.mark.parametrize("gap", defer_rest([200, 0, 100, 150]))
@pytest.mark.parametrize("teeth", [(0.0,), UNEVEN])
def test_uneven_teeth_and_missing_samples_neither_hide_a_stop_nor_make_one(
    rig: RigConfig, daq_info: DaqInfo, teeth: tuple[float, ...], gap: int
) -> None:
    machine = Machine(rig, daq_info, teeth=teeth)
    machine.speed = 60.0
    machine.run(3.0, gap=gap)
    assert machine.judge(drive_off=True) is RotorState.TURNING
    machine.run(6.0, gap=gap, deceleration=15.0)
    assert machine.speed == 0.0
    machine.run(3.0, gap=gap)
    assert machine.judge() is RotorState.AT_REST
    blind = Machine(rig, daq_info, teeth=teeth)
    blind.speed = 60.0
    blind.run(3.0, gap=gap)
    blind.run(12.0, gap=gap, keyphasor=-2.0)
    assert blind.judge(drive_off=True, stopped_at=3.0) is RotorState.UNKNOWN


def test_a_rotor_that_was_never_sent_anywhere_is_at_rest_by_the_drives_word_and_living_samples(
    rig: RigConfig, daq_info: DaqInfo
) -> None:
    machine = Machine(rig, daq_info)
    machine.run(3.0)
    assert machine.judge(drive_off=True, fastest=0.0) is RotorState.AT_REST
    assert machine.judge(drive_off=True, fastest=2 * math.pi) is RotorState.UNKNOWN
    assert machine.judge(drive_off=False, fastest=0.0) is RotorState.UNKNOWN

"""A recording to order vectors: runs, masks with reasons, slow roll, and sentences for what cannot be tracked."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from rotorrig.acquisition.recording import Event, RawRecording
from rotorrig.processing.pipeline import track
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.settings import Tracking
from rotorrig.rig.config.trial_mass import TrialMass
from rotorrig.rig.errors import DataError
from tests.processing.synthetic import FULL_SCALE, VOLTS_PER_COUNT, chirp, falling_notch

RPM = np.pi / 30
RATE = 5_000.0
RUNOUT = np.array([3e-6, 3e-6 * np.exp(-0.5j * np.pi), 2e-6j, 1e-6])
UNBALANCE = np.array([20e-6j, 10e-6, 5e-6, 4e-6])


def reasons(response: OrderTrackedResponse) -> set[str]:
    return {reason for row in response.reasons for reason in row}


@pytest.fixture(scope="module")
def sweep(record: Callable[..., RawRecording]) -> RawRecording:
    """Slow roll at 240 rpm, up from 480 to 1280 rpm, down again; the unbalance answers above 300 rpm."""
    t = np.arange(int(66 * RATE)) / RATE
    speed = np.interp(t, [0, 12, 16, 36, 40, 60, 66], np.array([240, 240, 480, 1280, 1280, 480, 480]) * RPM)
    theta = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2 / RATE)]) - 0.3
    A = RUNOUT + UNBALANCE * (speed > 300 * RPM)[:, None]
    x = (
        30e-6
        + np.real(A * np.exp(1j * theta[:, None]))
        + 0.02e-6 * np.random.default_rng(0).standard_normal((len(t), 4))
    )
    marks = [(0.0, "settling"), (1.0, "slow roll"), (12.0, "settling"), (16.0, "up"), (39.0, "down"), (60.0, "end")]
    return record(theta, x, rate=RATE, marks=marks)


@pytest.fixture(scope="module")
def response(sweep: RawRecording) -> OrderTrackedResponse:
    return track(sweep)


def steady(record: Callable[..., RawRecording], **changes: object) -> RawRecording:
    """Return 20 s rising slowly from 600 rpm, unmarked but for "up"."""
    t = np.arange(int(20 * RATE)) / RATE
    theta = chirp(t, start=600 * RPM, rate=20 * RPM, theta_0=-0.3)
    x = np.tile(20e-6 * np.cos(theta)[:, None], 4) + 1e-8 * np.random.default_rng(1).standard_normal((len(t), 4))
    return record(theta, x, rate=RATE, marks=[(0.0, "up")], **changes)


def with_counts(recording: RawRecording, begin: float, end: float, channel: int, volts: float) -> RawRecording:
    """Return `recording` with one channel held at `volts` from `begin` to `end` [s]."""
    counts = recording.blocks[0].counts.copy()
    held = np.clip(round(volts / VOLTS_PER_COUNT), -FULL_SCALE, FULL_SCALE - 1)
    counts[int(begin * RATE) : int(end * RATE), channel] = held
    return replace(recording, blocks=(replace(recording.blocks[0], counts=counts),))


def test_the_runs_of_the_plan_come_out_with_their_vectors(response: OrderTrackedResponse) -> None:
    assert [(run.name, run.direction) for run in response.runs] == [("slow roll", 0), ("up", 1), ("down", -1)]
    assert response.usable.all() and reasons(response) == set()
    swept = response.run > 0
    np.testing.assert_allclose(response.order(1)[swept], np.tile(RUNOUT + UNBALANCE, (swept.sum(), 1)), atol=2e-8)
    np.testing.assert_allclose(response.order(0).real, 30e-6, atol=1e-8)
    assert (response.order(0).imag == 0).all()
    assert (np.diff(response.t) > 0).all()
    assert response.window == "blackman" and (response.revolutions == 8).all()


def test_the_slow_roll_vector_stands_beside_the_raw_ones(response: OrderTrackedResponse) -> None:
    np.testing.assert_allclose(response.slow_roll[:, response.orders.index(1.0)], RUNOUT, atol=5e-9)
    assert response.slow_roll_omega == pytest.approx(240 * RPM, rel=1e-4)
    swept = response.run > 0
    np.testing.assert_allclose(response.compensated()[swept], np.tile(UNBALANCE, (swept.sum(), 1)), atol=3e-8)


def test_rows_neither_overlap_nor_leave_their_run(response: OrderTrackedResponse, sweep: RawRecording) -> None:
    half = 8 * np.pi / response.omega
    assert (np.diff(response.t) > 0.99 * (half[1:] + half[:-1])).all()
    for name, begin, end in (("slow roll", 1, 12), ("up", 16, 39), ("down", 39, 60)):
        index = [run.name for run in response.runs].index(name)
        mine = response.run == index
        assert (response.t[mine] - half[mine]).min() > begin - 0.01
        assert (response.t[mine] + half[mine]).max() < end + 0.01


def test_where_every_pulse_came_is_kept(response: OrderTrackedResponse) -> None:
    turns = 2 * np.pi / np.diff(response.keyphasor_t)
    assert turns.min() == pytest.approx(240 * RPM, rel=1e-3)
    assert turns.max() == pytest.approx(1280 * RPM, rel=1e-3)


def test_the_result_is_the_same_whatever_the_blocks(sweep: RawRecording, response: OrderTrackedResponse) -> None:
    counts = sweep.blocks[0].counts
    cut = tuple(
        replace(sweep.blocks[0], counts=counts[a : a + 777], first_sample=a) for a in range(0, len(counts), 777)
    )
    np.testing.assert_array_equal(track(replace(sweep, blocks=cut)).z, response.z)


def test_more_orders_and_other_windows_may_be_asked_for(sweep: RawRecording) -> None:
    told: list[float] = []
    found = track(sweep, Tracking(turns=6, orders=(0.5, 1, 3)), progress=told.append)
    assert found.orders == (0.5, 1.0, 3.0)
    assert np.abs(found.order(0.5)[found.run > 0]).max() < 1e-7
    assert told == sorted(told) and told[-1] == 1.0


def test_a_trial_mass_noted_by_the_sweep_is_on_in_every_run_unless_another_is_given(sweep: RawRecording) -> None:
    noted = Event(t_ns=0, kind="trial", text="disk: 12 g mm at 90 deg")
    recording = replace(sweep, events=(noted, *sweep.events))
    for trial, unbalance in ((None, 12e-6j), ([TrialMass(disk="disk", amount="5 g mm", angle="0 deg")], 5e-6)):
        runs = track(recording, trial=trial).runs
        assert [run.trial_unbalance["disk"] for run in runs] == [pytest.approx(unbalance)] * 3


def test_an_unmarked_recording_is_split_by_its_speed(sweep: RawRecording) -> None:
    found = track(replace(sweep, events=()))
    assert [run.name for run in found.runs] == ["slow roll", "up", "dwell 1280 rpm", "down", "dwell 480 rpm"]
    assert np.isfinite(found.slow_roll).all()


def test_a_clipped_probe_is_masked_and_named_alone(record: Callable[..., RawRecording]) -> None:
    found = track(with_counts(steady(record), 10.0, 10.01, 1, -30.0))
    assert reasons(found) == {"1y: clipped"}
    assert not found.usable[:, 1].all()
    assert found.usable[:, [0, 2, 3]].all()
    assert (~found.usable[:, 1]).sum() == 1  # the row that holds it, no other


def test_a_gap_out_of_the_linear_range_is_said(record: Callable[..., RawRecording]) -> None:
    assert reasons(track(with_counts(steady(record), 10.0, 10.01, 2, -1.5))) == {"2x: gap out of range"}


def test_a_missed_pulse_is_bridged_and_remarked(record: Callable[..., RawRecording]) -> None:
    whole = steady(record)
    found = track(with_counts(whole, 10.0, 10.09, 4, -2.0))
    assert reasons(found) == set()
    assert found.usable.all()
    said = ["missed pulse bridged" in row for row in found.remarks]
    assert 1 <= sum(said) <= 2
    np.testing.assert_allclose(found.order(1), track(whole).order(1), atol=1e-9)


def test_too_many_missed_pulses_mask_their_rows_and_turn_no_other(record: Callable[..., RawRecording]) -> None:
    whole = steady(record)
    found = track(with_counts(whole, 10.0, 10.9, 4, -2.0))  # some ten turns
    assert reasons(found) == {"missed pulse"}
    masked = ~found.usable[:, 0]
    assert 2 <= masked.sum() <= 3
    np.testing.assert_allclose(found.order(1)[~masked], track(whole).order(1)[~masked], atol=1e-8)


def test_an_extra_pulse_is_said(record: Callable[..., RawRecording]) -> None:
    t = np.arange(int(20 * RATE)) / RATE
    notch = falling_notch(chirp(t, start=600 * RPM, rate=20 * RPM, theta_0=-0.3))
    notch[int(10.05 * RATE)] = -10.0 if notch[int(10.05 * RATE)] > -6 else -2.0
    found = track(steady(record, notch=notch))
    assert reasons(found) == set()
    assert 1 <= sum("extra pulse dropped" in row for row in found.remarks) <= 2


def test_missing_samples_mask_their_rows_and_are_never_filled(record: Callable[..., RawRecording]) -> None:
    found = track(steady(record, blocks=[(0, 50_000), (50_500, 100_000)]))
    assert reasons(found) == {"gap in the samples"}
    masked = ~found.usable[:, 0]
    assert 1 <= masked.sum() <= 2
    assert np.isnan(found.z[masked]).all()
    np.testing.assert_allclose(found.order(1)[~masked], 20e-6, atol=2e-8)


def test_too_few_samples_per_turn_are_said(record: Callable[..., RawRecording]) -> None:
    rate = 400.0
    t = np.arange(int(20 * rate)) / rate
    theta = chirp(t, start=900 * RPM, rate=20 * RPM, theta_0=-0.3)
    x = np.tile(20e-6 * np.cos(theta)[:, None], 4)
    found = track(record(theta, x, rate=rate, marks=[(0.0, "up")]))
    few = found.omega > 1200 * RPM * 1.05
    assert not found.usable[few].any()
    assert found.usable[found.omega < 1200 * RPM * 0.95].all()
    assert "19 samples per turn, want 20" in reasons(found)


def test_a_run_up_that_turns_back_is_masked_there(sweep: RawRecording) -> None:
    marked = tuple(e for e in sweep.events if e.text != "down")
    found = track(replace(sweep, events=marked))
    assert reasons(found) == {"speed reversal"}
    assert found.usable[found.t < 39].all()
    assert not found.usable[found.t > 43].any()


def test_a_slow_roll_that_is_none_is_said(record: Callable[..., RawRecording]) -> None:
    recording = steady(record)
    found = track(replace(recording, events=(replace(recording.events[0], text="slow roll"),)))
    assert any("speed varies" in reason for reason in reasons(found))
    assert not found.usable.any()


def test_what_cannot_be_tracked_is_said_in_a_sentence(record: Callable[..., RawRecording]) -> None:
    good = steady(record)
    dead = with_counts(good, 0.0, 20.0, 4, -2.0)
    for recording, words in (
        (dead, r"synthetic: keyphasor \(channel 4\): no pulse found"),
        (replace(good, blocks=()), "holds no samples"),
        (replace(good, events=(replace(good.events[0], text="settling"),)), "has no run"),
        (replace(good, rig=good.rig.model_copy(update={"keyphasor": None})), r"no \[keyphasor\]"),
    ):
        with pytest.raises(DataError, match=words):
            track(recording)
    with pytest.raises(DataError, match="no run is as long as one row of 5000 turns"):
        track(good, Tracking(turns=5000))


def test_a_threshold_outside_the_pulse_is_said(record: Callable[..., RawRecording]) -> None:
    good = steady(record)
    assert good.rig.keyphasor is not None
    rig = good.rig.model_copy(update={"keyphasor": good.rig.keyphasor.model_copy(update={"threshold": -11.0})})
    with pytest.raises(DataError, match=r"threshold is -11 V, want it between the levels of -10.00 and -2.00 V"):
        track(replace(good, rig=rig))

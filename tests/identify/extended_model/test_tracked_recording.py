"""A recording: which of its rows count, what stands in for its vectors, and how its loads move the rotor."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.extended_model.model import ExtendedModel
from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.rotor.model.assembly import assemble
from rotorrig.sims.rotor.model.loads import ONE_RECORDING, Load, between_recordings, unbalance_loads
from rotorrig.sims.rotor.model.reduction import reduce
from tests.identify.swept import swept_response


def test_orders_that_no_model_predicts_are_left_out(short: OrderTrackedResponse) -> None:
    assert Recording(short).orders == (1, 2, 3)
    assert Recording(replace(short, orders=(1.0, 0.5, -1.0))).orders == (1,)


def test_only_hides_every_other_row_at_every_order_and_keeps_the_slow_roll(short: OrderTrackedResponse) -> None:
    whole = Recording(short)
    keep = np.arange(len(whole.rows)) % 2 == 0
    half = whole.only(keep)
    for measured in half.measured.values():
        assert measured.usable[:-1][keep].all()
        assert not measured.usable[:-1][~keep].any()
        assert measured.usable[-1].all()
    assert all(measured.usable.all() for measured in whole.measured.values()), "the recording itself is as it was"


def test_hidden_rows_have_no_say_in_the_residual(short: OrderTrackedResponse, hidden: np.ndarray) -> None:
    recording = Recording(short)
    keep = np.arange(len(recording.rows)) < 10
    changed = {n: m.z.copy() for n, m in recording.measured.items()}
    for z in changed.values():
        z[:-1][~keep] += 1e-3
    before, after = (
        ExtendedProblem(ExtendedModel([r.only(keep)])) for r in (recording, recording.instead(changed))
    )  # the same but for rows that do not count
    p = before.parameters.start(hidden)
    np.testing.assert_array_equal(before.residual(p), after.residual(p))
    assert before.size < ExtendedProblem(ExtendedModel([recording])).size


def test_vectors_given_instead_keep_the_noise_of_those_measured(short: OrderTrackedResponse) -> None:
    recording = Recording(short)
    other = recording.instead({n: np.zeros_like(m.z) for n, m in recording.measured.items()})
    for n, measured in other.measured.items():
        assert not measured.z.any()
        np.testing.assert_array_equal(measured.whiten, recording.measured[n].whiten)


@pytest.mark.parametrize("order", [1, 2])
def test_slow_speed_changes_make_the_swept_response_the_steady_one(rig: RigConfig, order: int) -> None:
    slow = swept_response(rig, speeds=(900, 1000), ramp=4, orders=(1, 2))
    model = reduce(assemble(rig))
    (unit,) = unbalance_loads(model, ["disk"], order=order)
    moving, steady = (Recording(slow, swept=swept).columns(model, [unit], order=order) for swept in (True, False))
    assert Recording(slow).swept
    assert not Recording(slow, swept=False).swept
    np.testing.assert_allclose(moving, steady, rtol=3e-3)


def test_a_table_without_times_is_taken_as_steady(short: OrderTrackedResponse) -> None:
    assert not Recording(replace(short, t=np.full(len(short.t), np.nan), keyphasor_t=np.empty(0))).swept


def test_no_loads_give_no_columns(short: OrderTrackedResponse, rig: RigConfig) -> None:
    model = reduce(assemble(rig))
    assert Recording(short).columns(model, [], order=2).shape == (len(short.t) + 1, 4, 0)


def test_a_load_that_begins_later_is_not_in_the_slow_roll(short: OrderTrackedResponse, rig: RigConfig) -> None:
    model = reduce(assemble(rig))
    (always,) = unbalance_loads(model, ["disk"])
    half = float(short.keyphasor_t[-1] / 2)
    later = Load(always.pattern, "unbalance", since=half)
    z = Recording(short).columns(model, [always, later], order=1)
    assert abs(z[-1, :, 0]).min() > 0
    assert not z[-1, :, 1].any()
    before = short.t < half - 8 * 60 / 2600  # a row's window away
    assert not z[:-1][before, :, 1].any()


def test_one_clock_runs_through_all_recordings(short: OrderTrackedResponse, rig: RigConfig) -> None:
    """What begins in one is nothing in those before, and in those after there from the start."""
    model = reduce(assemble(rig))
    (always,) = unbalance_loads(model, ["disk"])
    half = float(short.keyphasor_t[-1] / 2) + 0.003  # s, between two pulses
    second = Load(always.pattern, "unbalance", since=ONE_RECORDING + half)
    gap = Load(always.pattern, "unbalance", since=between_recordings(2))
    first, own, last = (Recording(short, number=i).columns(model, [always, second, gap], order=1) for i in range(3))
    assert not first[..., 1:].any() and not own[..., 2].any()
    np.testing.assert_allclose(last, np.repeat(last[..., :1], 3, axis=-1), rtol=1e-13)  # summed in another order
    alone = Recording(short).columns(model, [Load(always.pattern, "unbalance", since=half)], order=1)
    np.testing.assert_allclose(own[..., 1], alone[..., 0], rtol=1e-6, atol=1e-3)  # m per kg m, of some 100


def test_it_is_known_when_a_load_begins_in_a_recording(short: OrderTrackedResponse, rig: RigConfig) -> None:
    recording = Recording(short, number=1)
    for since, begins in ((-np.inf, -np.inf), (7.0, -np.inf), (1e6 + 3.0, 3.0), (1e6 + 1e4, np.inf), (2e6, np.inf)):
        assert recording.begins(Load(np.zeros(1, complex), "unbalance", since=since)) == begins


def test_a_steady_model_knows_too_what_has_not_begun(short: OrderTrackedResponse, rig: RigConfig) -> None:
    model = reduce(assemble(rig))
    (always,) = unbalance_loads(model, ["disk"])
    half = float(short.keyphasor_t[-1] / 2)
    later = Load(always.pattern, "unbalance", since=half)
    z = Recording(short, swept=False).columns(model, [always, later], order=1)
    begun = np.append(short.t >= half, False)[:, None]
    np.testing.assert_array_equal(z[..., 1], np.where(begun, z[..., 0], 0))
    table = replace(short, t=np.full(len(short.t), np.nan), keyphasor_t=np.empty(0))
    gap = Load(always.pattern, "unbalance", since=between_recordings(1))
    before, after = (Recording(table, number=i).columns(model, [gap], order=1) for i in range(2))
    assert not before.any()
    assert np.abs(after).min() > 0


def test_the_trial_mass_of_a_run_stands_in_its_rows_and_not_in_the_slow_roll(short: OrderTrackedResponse) -> None:
    up, down = short.runs
    with_one = replace(short, runs=(up, replace(down, trial_unbalance={})))
    trial = Recording(with_one).trial["disk"]
    np.testing.assert_array_equal(trial[:-1], np.where(short.run == 0, 4e-6 + 3e-6j, 0))
    assert trial[-1] == 0


def test_fewer_rows_have_responses_of_their_own(short: OrderTrackedResponse) -> None:
    whole, model = Recording(short), reduce(assemble(short.rig), modes=4)
    loads = unbalance_loads(model, ["disk"])
    assert len(whole.columns(model, loads, order=1)) == len(whole.rows) + 1
    assert len(whole.thinned(np.array([3, 8])).columns(model, loads, order=1)) == 3

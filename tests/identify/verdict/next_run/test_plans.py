"""Runs that were not made: their speeds, rows and noise."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.verdict.next_run.planned_recordings import plan_recordings
from rotorrig.identify.verdict.next_run.plans import Plan, plans
from rotorrig.processing.response import MainsHum, OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.config.units import RPM
from tests.identify.swept import RAMP, SIGMA, swept_response


def planned(response: OrderTrackedResponse, plan: Plan) -> list[Recording]:
    recordings, _ = plan_recordings(plan, [Recording(response)])
    return [each for each in recordings if each.planned]


@pytest.fixture(scope="module")
def below(one_plane: RigConfig) -> OrderTrackedResponse:
    return swept_response(one_plane, speeds=(480, 1500))


def test_what_needs_no_tools_comes_first_and_more_probes_last(below: OrderTrackedResponse) -> None:
    kinds = [plan.kind for plan in plans(below)]
    want = ["ramp rate", "through critical", "reverse rotation", "trial mass", "second plane"]
    assert list(dict.fromkeys(kinds)) == want


def test_speeds_are_held_one_after_the_other_and_no_row_is_of_a_ramp_between(below: OrderTrackedResponse) -> None:
    held = [1400 / RPM, 700 / RPM, 1000 / RPM]
    (plan,) = (plan for plan in plans(below, dwells=held) if plan.kind == "dwells")
    assert plan.words == "Hold 700, 1000, 1400 rpm for 20 s each."
    (recording,) = planned(below, plan)
    response = recording.response
    assert [run.direction for run in response.runs] == [0, 0, 0]
    for number, speed in enumerate(sorted(held)):
        rows = response.run == number
        np.testing.assert_allclose(response.omega[rows], speed, rtol=1e-5)
        np.testing.assert_allclose(response.alpha[rows], 0.0, atol=2e-3 * plan.ramp)
        seconds = rows.sum() * plan.every * 2 * np.pi / speed
        assert 19.0 < seconds <= 20.0
    assert response.t[-1] < plan.seconds < response.t[-1] + 5.0, "up from rest"


def test_probes_that_are_added_pick_up_the_mains_as_those_that_they_are_like(below: OrderTrackedResponse) -> None:
    """A second plane had no forecast where tracking had followed the mains."""
    shares = np.array([1.2, 0.7j])
    hum = MainsHum(frequency=50.0, t=below.t[[0, -1]], stray=np.zeros(2), shares=shares)
    humming = replace(below, mains=(hum,))
    plan = next(plan for plan in plans(humming) if plan.kind == "second plane")
    (recording,) = planned(humming, plan)
    leaks = recording.hum[1][50.0]
    assert leaks.shape == (len(recording.rows) + 1, 4)
    np.testing.assert_allclose(leaks[:-1, :2] / leaks[:-1, 2:], 1.0)
    np.testing.assert_allclose(leaks[:-1, 0] * shares[1], leaks[:-1, 1] * shares[0])


def test_what_hands_do_takes_time(below: OrderTrackedResponse) -> None:
    seconds = {plan.kind: plan.seconds for plan in plans(below, dwells=[100.0])}
    assert seconds["ramp rate"] < 60.0
    assert 180.0 < seconds["trial mass"] < 300.0
    assert 300.0 < seconds["reverse rotation"] < 400.0
    assert seconds["second plane"] > 1380.0, "with a trial mass"


def test_a_trial_mass_may_go_against_the_unbalance(below: OrderTrackedResponse) -> None:
    u = 15e-6 * np.exp(1j * np.radians(33.0))
    free, against = (plan for plan in plans(below, unbalance=u) if plan.kind == "trial mass")
    assert free.trial == {"disk": 12e-6j}
    (mass,) = against.trial.values()
    assert abs(mass) == pytest.approx(7.5e-6)
    assert np.degrees(np.angle(mass)) % 360 == pytest.approx(215.0)
    assert "7.5 g mm at 215 deg on 'disk', against the unbalance" in against.words


def test_what_the_run_had_already_is_not_planned(rig: RigConfig) -> None:
    top = swept_response(rig, trial=1e-6, speeds=(900, 3800), ramp=600)
    assert {plan.kind for plan in plans(top)} == {"ramp rate", "reverse rotation"}


def test_no_plan_goes_beyond_the_limits(below: OrderTrackedResponse) -> None:
    limits = below.rig.limits
    assert limits is not None
    assert limits.overspeed
    for plan in plans(below):
        assert plan.high <= 0.95 * limits.overspeed
        for recording in planned(below, plan):
            assert recording.response.omega.max() <= plan.high * (1 + 1e-6)


def test_a_planned_run_goes_up_and_down_at_its_ramp(below: OrderTrackedResponse) -> None:
    for plan in plans(below):
        response = planned(below, plan)[0].response
        up, down = (response.alpha[response.run == i][1:-1] for i in (0, 1))
        np.testing.assert_allclose(up, plan.ramp, rtol=0.05)
        np.testing.assert_allclose(down, -plan.ramp, rtol=0.05)
        turns = np.diff(response.keyphasor_t)
        slowest, fastest = 2 * np.pi / plan.low, 2 * np.pi / plan.high
        assert turns.min() == pytest.approx(fastest, rel=0.05), "one turn between any two pulses"
        assert turns.max() == pytest.approx(slowest, rel=0.1)


def test_slower_and_faster_are_a_third_and_three_times_the_ramp(below: OrderTrackedResponse) -> None:
    ramps = [plan.ramp * RPM for plan in plans(below) if plan.kind == "ramp rate"]
    assert ramps == pytest.approx([RAMP * 3, RAMP / 3], rel=0.03)


def test_the_noise_is_that_of_rows_at_like_speeds_and_a_covariance(below: OrderTrackedResponse) -> None:
    for plan in plans(below):
        for recording in planned(below, plan):
            covariance = recording.response.covariance
            assert np.linalg.eigvalsh(covariance).min() > 0
            np.testing.assert_allclose(np.diagonal(covariance, axis1=-2, axis2=-1), SIGMA**2)


def test_probes_like_others_are_as_noisy_and_independent_of_them(below: OrderTrackedResponse) -> None:
    correlated = np.array(below.covariance)
    root = np.tril(np.ones((4, 4))) * SIGMA
    correlated[:] = root @ root.T
    noisy = replace(below, covariance=correlated, slow_roll_covariance=correlated[0])
    plan = next(p for p in plans(noisy) if p.kind == "second plane")
    response = planned(noisy, plan)[0].response
    assert response.probes == ("1x", "1y", "1x (2nd plane)", "1y (2nd plane)")
    for covariance in (response.covariance[3, 0], response.slow_roll_covariance[0]):
        np.testing.assert_allclose(covariance[:4, :4], root @ root.T)
        np.testing.assert_allclose(covariance[4:, 4:], root @ root.T)
        assert not covariance[:4, 4:].any()


@pytest.fixture
def untimed(rig: RigConfig) -> OrderTrackedResponse:
    """A table of the first plane, as an import leaves it: no ramp, no turns, no slow roll, a row without a value."""
    made = swept_response(rig, speeds=(480, 1500))
    covariance = np.array(made.covariance)
    covariance[..., 4:, :] = covariance[..., :, 4:] = covariance[7] = np.nan
    usable = np.broadcast_to(np.arange(4) < 2, made.usable.shape).copy()
    usable[7] = False
    return replace(
        made,
        t=np.full_like(made.t, np.nan),
        alpha=np.full_like(made.alpha, np.nan),
        revolutions=np.full_like(made.revolutions, np.nan),
        keyphasor_t=np.empty(0),
        covariance=covariance,
        usable=usable,
        slow_roll=np.full_like(made.slow_roll, np.nan),
        slow_roll_covariance=np.full_like(made.slow_roll_covariance, np.nan),
        slow_roll_omega=np.nan,
    )


def test_what_a_table_does_not_say_is_supposed_and_said(untimed: OrderTrackedResponse) -> None:
    made = list(plans(untimed))
    own = untimed.rig.plans["default"]
    assert [plan.ramp for plan in made if plan.kind == "ramp rate"] == pytest.approx([own.ramp * 3, own.ramp / 3])
    for plan in made:
        assert plan.assumed.startswith("Assumed, as the recording does not say: a ramp of 30 rpm/s, ")
        assert plan.assumed.endswith("turns to a row, no slow roll.")
        for recording in planned(untimed, plan):
            assert recording.swept
            for measured in recording.measured.values():
                assert np.isfinite(measured.whiten).all()
                assert not measured.usable[-1].any(), "there is no slow roll to measure"
                assert measured.usable[:-1].all()


def test_a_planned_run_has_about_as_many_rows_on_the_way_up_as_the_table(untimed: OrderTrackedResponse) -> None:
    plan = next(p for p in plans(untimed) if p.kind == "reverse rotation")
    up = planned(untimed, plan)[0].response.run == 0
    assert up.sum() == pytest.approx(len(untimed.omega), rel=0.2)


def test_rows_far_apart_are_not_smeared_over_what_is_between_them(untimed: OrderTrackedResponse) -> None:
    few = np.arange(0, len(untimed.omega), 4)
    names = ("run", "t", "omega", "alpha", "revolutions", "z", "covariance", "usable")
    sparse = replace(untimed, **{name: getattr(untimed, name)[few] for name in names}, reasons=((),) * len(few))
    plan = next(p for p in plans(sparse) if p.kind == "reverse rotation")
    made = planned(sparse, plan)[0].response
    assert (made.run == 0).sum() == pytest.approx(len(few), abs=2)
    assert (made.revolutions == 8).all()


def test_a_table_of_one_speed_has_plans_too(untimed: OrderTrackedResponse) -> None:
    one = replace(untimed, omega=np.full_like(untimed.omega, 150.0))
    for plan in plans(one):
        assert plan.low < plan.high
        for recording in planned(one, plan):
            assert np.isfinite(recording.response.t).all()


def test_a_config_without_plans_has_a_ramp_supposed(untimed: OrderTrackedResponse) -> None:
    bare = replace(untimed, rig=untimed.rig.model_copy(update={"plans": {}}))
    assert "a ramp of 28.6 rpm/s" in next(plans(bare)).assumed  # 3 rad/s^2


def test_the_second_plane_of_the_config_is_proposed_where_its_probes_did_not_read(
    untimed: OrderTrackedResponse,
) -> None:
    plan = next(p for p in plans(untimed) if p.kind == "second plane")
    assert plan.words == "Measure in the second plane too, with 2x and 2y."
    assert planned(untimed, plan)[0].response.probes == ("1x", "1y", "2x", "2y")
    others = [p for p in plans(untimed) if p.kind != "second plane"]
    assert {planned(untimed, p)[0].response.probes for p in others} == {("1x", "1y")}


def test_a_recording_that_says_all_has_nothing_supposed(below: OrderTrackedResponse) -> None:
    assert {plan.assumed for plan in plans(below)} == {""}


def test_a_trial_mass_of_another_recording_counts(below: OrderTrackedResponse) -> None:
    assert "trial mass" not in {plan.kind for plan in plans(below, with_trial=True)}


def test_a_planned_run_joins_those_that_were_made(below: OrderTrackedResponse) -> None:
    plan = next(p for p in plans(below) if p.kind == "trial mass")
    measured = [Recording(below), Recording(below, number=1)]
    recordings, unknown = plan_recordings(plan, measured)
    assert recordings[:2] == measured
    assert [each.planned for each in recordings] == [False, False, True]
    assert (recordings[2].number, set(recordings[2].trial), unknown) == (2, {"disk"}, ())


def test_a_run_with_other_probes_stands_alone_and_its_trial_mass_needs_a_run_without(
    below: OrderTrackedResponse,
) -> None:
    plan = [p for p in plans(below) if p.kind == "second plane"][-1]
    first, second = plan_recordings(plan, [Recording(below)])[0]
    assert (first.planned, second.planned) == (True, True)
    assert not first.trial
    assert set(second.trial) == {"disk"}
    assert (first.number, second.number) == (0, 1)


def test_a_reverse_run_is_one_more_after_a_forward_one_by_a_mark_of_unknown_width(below: OrderTrackedResponse) -> None:
    plan = next(p for p in plans(below) if p.kind == "reverse rotation")
    (forward, reverse), unknown = plan_recordings(plan, [Recording(below)])
    assert (forward.backward, reverse.backward) == (False, True)
    assert reverse.number == 1
    assert [effect.recording for effect in unknown] == [1]
    assert all(effect.is_nuisance for effect in unknown), "a nuisance, no discovery"


def test_a_reverse_run_of_a_table_whose_second_plane_does_not_read_comes_after_a_forward_one(
    untimed: OrderTrackedResponse,
) -> None:
    plan = next(p for p in plans(untimed) if p.kind == "reverse rotation")
    (forward, reverse), unknown = plan_recordings(plan, [Recording(untimed)])
    assert [each.planned for each in (forward, reverse)] == [True, True]
    assert [each.backward for each in (forward, reverse)] == [False, True]
    assert [effect.recording for effect in unknown] == [1]


def test_higher_speeds_are_gone_to_in_quarters(below: OrderTrackedResponse) -> None:
    tops = [plan.high * RPM for plan in plans(below) if plan.kind == "through critical"]
    first = below.omega.max() * RPM
    assert tops == pytest.approx([first + share * (3800 - first) for share in (0.25, 0.5, 0.75, 1.0)])

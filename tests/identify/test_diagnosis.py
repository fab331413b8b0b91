"""Diagnoses of recordings whose truth is known: what is named, what is not, and what bad data may do."""

from collections.abc import Collection
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.parts.blind.run import record
from rotorrig.identify.diagnosis import Diagnosis, Verdict, diagnose
from rotorrig.processing.pipeline import track
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig, load
from rotorrig.rig.config.extension import Extension
from rotorrig.rig.errors import ConfigError, DataError
from rotorrig.sims.effects.base import catalogue, find
from rotorrig.sims.plant.truth import FaultSpec
from rotorrig.sims.rotor.model.loads import ONE_RECORDING
from tests.conftest import CONFIGS
from tests.identify.matched import taken_for_exact
from tests.identify.swept import DRAWN, SIGMA, C, K, U, swept_response
from tests.parameters import defer_rest

KINDS = {effect.name for effect in catalogue(load(CONFIGS / "rk4.toml"))}
QUICK = {"unbalance_plane", "delay", "skew_stiffness", "coupling", "stiffness_over_speed"}  # without force laws
DELAY = 3e-4  # s


def judged(*responses: OrderTrackedResponse, tried: Collection[str] = QUICK, **more: object) -> Diagnosis:
    return diagnose(responses, without=KINDS - set(tried), **more)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def late(rig: RigConfig) -> OrderTrackedResponse:
    """Probe 2y comes late."""
    return swept_response(rig, rng=np.random.default_rng(31), hidden=[(find(rig, "delay, probe 2y"), {"delay": DELAY})])


@pytest.fixture(scope="module")
def named(late: OrderTrackedResponse) -> Diagnosis:
    return judged(late)


def test_a_healthy_rig_is_adequate_and_nothing_is_blamed(healthy: OrderTrackedResponse) -> None:
    found = judged(healthy)
    assert found.verdict is Verdict.ADEQUATE
    assert not any(cause.chosen for cause in found.causes)
    assert (found.tied, found.next_run, found.gain, found.extended_residual) == ((), None, None, None)
    assert found.noise_floor == pytest.approx(SIGMA, rel=0.5)
    assert found.p > 0.5


def test_the_hidden_cause_is_named_with_its_size(named: Diagnosis) -> None:
    assert named.verdict is Verdict.NAMED
    first = named.causes[0]
    assert (first.label, first.chosen, first.plausible) == ("delay, probe 2y", True, True)
    assert [cause.label for cause in named.causes if cause.chosen] == ["delay, probe 2y"]
    delay = first.parameters["delay"]
    assert abs(delay.value - DELAY) < 4 * delay.sigma < DELAY
    assert "late" in named.sentence


def test_a_diagnosis_cut_short_leaves_the_best_so_far_and_names_nothing(late: OrderTrackedResponse) -> None:
    stages: list[str] = []
    found = judged(
        late,
        progress=lambda stage, share: stages.append(stage),
        go_on=lambda: "cause 2" not in stages,
    )
    assert found.cut_short
    assert found.verdict is Verdict.UNEXPLAINED
    assert found.sentence.startswith("Cut short before every cause was tried")
    assert "Best so far is delay, probe 2y, with which" in found.sentence
    assert [cause.label for cause in found.causes if cause.chosen] == ["delay, probe 2y"]
    assert (found.gain, found.next_run) == (None, None)
    assert found.extended_residual is not None


def test_a_diagnosis_cut_short_at_once_tells_the_test_of_the_base(
    late: OrderTrackedResponse, healthy: OrderTrackedResponse
) -> None:
    for response, verdict in ((late, Verdict.UNEXPLAINED), (healthy, Verdict.CANNOT_TELL)):
        found = judged(response, go_on=lambda: False)
        assert (found.cut_short, found.verdict) == (True, verdict)
        assert not any(cause.chosen for cause in found.causes)
        assert "No cause was found so far." in found.sentence
        assert len(found.residual) == len(response.omega)


def test_the_extension_predicts_what_no_fit_saw(named: Diagnosis) -> None:
    assert named.gain.heldout_after < 0.6 * named.gain.heldout_before
    assert named.gain.over_noise_floor == pytest.approx(named.gain.heldout_after / named.gain.noise_floor)
    assert named.extended_residual is not None
    before, after = (np.nanmean(np.abs(z[..., 0]) ** 2) for z in (named.residual, named.extended_residual))
    assert after < before


def test_where_the_extended_model_is_right_its_residual_is_noise_wherever_the_base_is_by_chance(
    named: Diagnosis,
) -> None:
    before, after = named.sigmas[..., 0], named.extended_sigmas
    assert after is not None
    known = after[..., 0][np.isfinite(after[..., 0])]
    assert 0.5 < np.sqrt(np.mean(known**2)) < 1.1  # noise, and what may be the error of any model
    at_chance = after[..., 0][before < 0.1]  # cells where the wrong model crosses the measurement
    assert at_chance.size > 3 and at_chance.max() < 4.0


def test_the_gain_tells_the_base_before_and_after(named: Diagnosis) -> None:
    base = named.gain.base
    assert set(base) == {"kxx", "kyy", "cxx", "cyy", "u"}
    for name, value in zip(("kxx", "kyy", "cxx", "cyy", "u"), (*K, *C, abs(U)), strict=True):
        assert abs(base[name].after - value) < 4 * base[name].sigma, name


@pytest.mark.campaign
def test_with_the_true_cause_left_out_it_is_not_named(late: OrderTrackedResponse) -> None:
    """A control: the name above is not given to whatever comes; but what a probe reads besides is told."""
    found = judged(late, tried=QUICK - {"delay"})
    assert found.verdict is Verdict.DESCRIBED
    assert all(cause.effect != "delay" for cause in found.causes)
    assert found.sentence.startswith("The model is NOT adequate")
    assert found.missing is not None and found.missing.kind == "reading"
    assert found.missing.laws[0] == "share over speed"  # a lag by omega tau, at 270 degrees
    assert found.missing.words.startswith("probe 2y reads besides")
    (chosen,) = (cause for cause in found.causes if cause.chosen)
    effect = find(late.rig, chosen.label)
    share = complex(chosen.theta["share over speed re"], chosen.theta["share over speed im"])
    assert share / effect.reference == pytest.approx(-1j * DELAY, rel=0.15)  # type: ignore[attr-defined]


def test_the_extended_config_is_adequate_the_second_time(late: OrderTrackedResponse, named: Diagnosis) -> None:
    cause = named.causes[0]
    rig = late.rig.model_copy(
        update={"effects": (Extension(name=cause.effect, where=cause.where, parameters=cause.theta),)}
    )
    again = judged(replace(late, rig=rig))
    assert again.verdict is Verdict.ADEQUATE


@pytest.mark.campaign
def test_a_holdout_is_what_the_gain_is_measured_on(rig: RigConfig, late: OrderTrackedResponse) -> None:
    effect = find(rig, "delay, probe 2y")
    unseen = swept_response(rig, rng=np.random.default_rng(32), hidden=[(effect, {"delay": DELAY})])
    found = judged(late, tried={"delay"}, holdout=unseen)
    assert found.gain.on == "the recording no fit saw"
    assert found.gain.heldout_after == pytest.approx(DRAWN * SIGMA * np.sqrt(2), rel=0.2)
    assert found.gain.heldout_before > 1.5 * found.gain.heldout_after


@pytest.mark.campaign
def test_a_cause_in_one_recording_of_two_is_named_there(rig: RigConfig) -> None:
    rng = np.random.default_rng(33)
    responses = [swept_response(rig, rng=rng), swept_response(rig, rng=rng, unbalance=U + 5e-6j)]
    found = judged(*responses, tried={"unbalance_step", "skew_stiffness"})
    assert found.verdict is Verdict.NAMED
    assert found.causes[0].words.endswith("before recording 2 began")
    step = found.causes[0].parameters["step"]
    assert abs(step.value - 5e-6) < 4 * step.sigma
    assert found.responses == tuple((r.source.source_hash, len(r.omega)) for r in responses)
    assert len(found.residual) == sum(len(r.omega) for r in responses)


@pytest.mark.campaign
@pytest.mark.parametrize(("moment", "run"), [(7.31, "up"), (14.62, "down")])
def test_a_step_within_a_run_is_found_at_its_moment(rig: RigConfig, moment: float, run: str) -> None:
    theta = {"step re": 1.6e-6, "step im": -1.2e-6, "time": moment}
    broken = swept_response(
        taken_for_exact(rig), rng=np.random.default_rng(34), hidden=[(find(rig, "unbalance_step"), theta)]
    )
    found = judged(broken, tried={"unbalance_step", "skew_stiffness", "bow"})
    assert found.verdict is Verdict.NAMED
    (step,) = (cause for cause in found.causes if cause.chosen)
    assert step.label == "unbalance_step"
    turn = 2 * np.pi / np.interp(moment, broken.t, broken.omega)
    assert abs(step.theta["time"] - moment) < min(turn, 4 * step.sigmas["time"])
    for name in ("step re", "step im"):
        assert abs(step.theta[name] - theta[name]) < 4 * step.sigmas[name]
    assert f"{moment:.1f} s into recording 1 (at " in step.words and step.words.endswith(f"rpm in run '{run}')")
    assert found.gain.heldout_after == pytest.approx(DRAWN * SIGMA * np.sqrt(2), rel=0.1)


@pytest.mark.campaign
def test_what_was_lost_in_one_recording_is_gone_in_the_next_and_the_extended_config_knows(rig: RigConfig) -> None:
    rng, effect = np.random.default_rng(35), find(rig, "unbalance_step")
    theta = {"step re": 2e-6, "step im": 1e-6, "time": 15.0}
    after = theta | {"time": theta["time"] - ONE_RECORDING}
    responses = [swept_response(rig, rng=rng, hidden=[(effect, of)]) for of in (theta, after)]
    found = judged(*responses, tried={"unbalance_step", "skew_stiffness"})
    assert found.verdict is Verdict.NAMED
    (step,) = (cause for cause in found.causes if cause.chosen)
    assert step.theta["time"] == pytest.approx(15.0, abs=0.05)
    extension = Extension(name=step.effect, where=step.where, parameters=step.theta)
    extended = rig.model_copy(update={"effects": (extension,)})
    again = judged(*(replace(r, rig=extended) for r in responses), tried={"skew_stiffness"})
    assert again.verdict is Verdict.ADEQUATE


def test_a_swept_recording_taken_as_steady_is_wrong_and_says_so(rig: RigConfig, healthy: OrderTrackedResponse) -> None:
    found = judged(healthy, tried={"skew_stiffness"}, model="quasi-static")
    assert found.model == "quasi-static"
    assert found.verdict is Verdict.NAMED
    assert found.causes[0].label == "moving speed"
    assert found.causes[0].heldout_after < 0.5 * found.causes[0].heldout_before
    assert found.sentence.startswith("The quasi-static model is wrong here: the speed was moving")


def test_bow_and_runout_are_tied_in_one_plane_below_the_critical_speed_and_the_next_run_tells_them_apart(
    one_plane: RigConfig,
) -> None:
    bow = (find(one_plane, "bow"), {"bow re": 22e-6, "bow im": 0.0})
    low = swept_response(one_plane, rng=np.random.default_rng(3), hidden=[bow], speeds=(480, 1500), ramp=240)
    found = judged(low, tried={"bow", "runout"})
    assert found.verdict is Verdict.TIED
    ((*labels,),) = found.tied
    assert {label.split(",")[0] for label in labels} == {"bow", "runout"}
    assert found.next_run.kind in {"ramp rate", "through critical", "trial mass", "second plane"}
    assert set(found.next_run.separates) == set(labels)


def test_what_the_data_cannot_show_is_told_with_what_is_missing(one_plane: RigConfig) -> None:
    low = swept_response(one_plane, rng=np.random.default_rng(34), orders=(1,), speeds=(480, 900), ramp=120)
    found = judged(low, tried=QUICK | {"bow", "runout", "probe_gain", "internal_damping", "disk_inertia"})
    assert found.verdict is Verdict.CANNOT_TELL
    assert "cannot tell" in found.sentence
    assert found.hidden
    for each in found.hidden:
        assert "a second plane of probes" in each.missing
        assert "a run with a known trial mass" in each.missing


@pytest.mark.parametrize("stage", defer_rest(["causes", "base model", "cause 1", "unseen data"]))
def test_an_interrupt_ends_it_at_once_and_leaves_nothing_behind(
    late: OrderTrackedResponse, named: Diagnosis, stage: str
) -> None:
    def stop(at: str, share: float) -> None:
        if at == stage:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        judged(late, progress=stop)
    if stage == "unseen data":
        assert judged(late).causes[0] == named.causes[0]


def test_progress_goes_from_nothing_to_all(healthy: OrderTrackedResponse) -> None:
    told: list[float] = []
    judged(healthy, tried={"delay"}, progress=lambda stage, share: told.append(share))
    assert told == sorted(told)
    assert (told[0], told[-1]) == (0.0, 1.0)


@pytest.mark.campaign
def test_rows_of_nan_are_left_out(late: OrderTrackedResponse) -> None:
    z = late.z.copy()
    z[20:26] = np.nan
    z[40, 1, 0] = np.nan
    usable = np.isfinite(z).all(axis=2)
    found = judged(replace(late, z=z, usable=usable))
    assert found.verdict is Verdict.NAMED
    assert found.causes[0].label == "delay, probe 2y"
    assert np.isnan(found.residual[20:26]).all()


@pytest.mark.campaign
def test_nan_in_rows_called_usable_does_not_matter_either(late: OrderTrackedResponse) -> None:
    z = late.z.copy()
    z[20:26, 1:] = np.nan
    assert judged(replace(late, z=z)).causes[0].label == "delay, probe 2y"


def test_a_probe_that_is_missing_lowers_what_can_be_said(late: OrderTrackedResponse) -> None:
    usable = late.usable.copy()
    usable[:, late.probes.index("2y")] = False
    slow = late.slow_roll.copy()
    slow[late.probes.index("2y")] = np.nan
    found = judged(replace(late, usable=usable, slow_roll=slow))
    assert found.verdict in {Verdict.ADEQUATE, Verdict.CANNOT_TELL}, "it was that probe that came late"


@pytest.mark.campaign
def test_without_a_coast_down_the_cause_is_still_found(late: OrderTrackedResponse) -> None:
    up = late.run == 0
    alone = replace(
        late,
        runs=late.runs[:1],
        run=late.run[up],
        t=late.t[up],
        omega=late.omega[up],
        alpha=late.alpha[up],
        revolutions=late.revolutions[up],
        z=late.z[up],
        covariance=late.covariance[up],
        usable=late.usable[up],
        reasons=late.reasons[: int(up.sum())],
    )
    found = judged(alone)
    assert found.causes[0].effect == "delay"


def test_too_few_rows_are_refused(late: OrderTrackedResponse) -> None:
    usable = np.zeros_like(late.usable)
    usable[:4] = True
    with pytest.raises(DataError, match="4 usable rows"):
        judged(replace(late, usable=usable))


def test_a_rig_without_an_identify_table_is_refused(late: OrderTrackedResponse) -> None:
    with pytest.raises(ConfigError, match=r"no \[identify\] section"):
        judged(replace(late, rig=late.rig.model_copy(update={"identify": None})))


@pytest.mark.campaign
def test_no_cause_to_try_leaves_what_the_base_lacks(late: OrderTrackedResponse) -> None:
    found = judged(late, tried=())
    assert found.verdict is Verdict.DESCRIBED
    assert {cause.effect for cause in found.causes if cause.chosen} == {"found_reading"}
    assert all("probe 2y" in label for group in found.tied for label in group)  # laws, but no other probe


def test_a_slow_roll_that_was_not_measured_is_done_without(healthy: OrderTrackedResponse) -> None:
    unknown = replace(healthy, slow_roll=np.full_like(healthy.slow_roll, np.nan), slow_roll_omega=np.nan)
    assert judged(unknown).verdict is Verdict.ADEQUATE


def test_a_stretch_of_a_few_rows_cannot_tell(healthy: OrderTrackedResponse) -> None:
    few = np.arange(len(healthy.t)) < 14
    assert judged(replace(healthy, usable=healthy.usable & few[:, None])).verdict is Verdict.CANNOT_TELL


@pytest.mark.parametrize("unlike", ["probes", "orders", "none"])
def test_recordings_that_do_not_go_together_are_refused(
    rig: RigConfig, one_plane: RigConfig, healthy: OrderTrackedResponse, unlike: str
) -> None:
    given = {
        "probes": (healthy, swept_response(one_plane)),
        "orders": (healthy, swept_response(rig, orders=(1,))),
        "none": (),
    }
    with pytest.raises(DataError):
        judged(*given[unlike])


@pytest.mark.campaign
def test_a_force_twice_per_turn_is_located_where_it_meets_the_first_critical_speed(hurried_rig: RigConfig) -> None:
    hidden = FaultSpec(name="coupling", parameters={})
    response = track(record(hurried_rig, seed=12, faults=(hidden,)))
    found = diagnose([response], without={effect.name for effect in catalogue(hurried_rig)})
    assert found.verdict is Verdict.UNEXPLAINED
    assert "2X" in found.sentence
    rpm = 30 / np.pi
    half = [m for m in found.worst if m.order == 2 and m.speed_from * rpm < 1113 < m.speed_to * rpm]
    assert half, "2X is strongest where twice the speed meets the first critical, 2226 / 2 rpm"


@pytest.mark.campaign
def test_runs_of_both_senses_of_rotation_are_diagnosed_together(one_plane: RigConfig) -> None:
    """A late probe and a turned one look alike below the critical speed while the rotor turns one way alone."""
    late, below = [(find(one_plane, "delay, probe 1y"), {"delay": 1.5e-3})], {"speeds": (480, 2000)}
    forward = swept_response(one_plane, rng=np.random.default_rng(5), hidden=late, **below)
    reverse = swept_response(
        one_plane.turned_over, rng=np.random.default_rng(6), hidden=late, unbalance=np.conj(U), **below
    )
    found = diagnose([forward, reverse])
    assert found.verdict is Verdict.NAMED
    (cause,) = (cause for cause in found.causes if cause.chosen)
    assert cause.label == "delay, probe 1y"
    assert cause.theta["delay"] == pytest.approx(1.5e-3, rel=0.05)
    assert found.extended_residual is not None
    # the residual is told as the response is: measured less model is what was measured
    part = found.extended_residual[len(forward.omega) :, :, 0]
    assert np.nanmax(np.abs(part)) < 6 * SIGMA

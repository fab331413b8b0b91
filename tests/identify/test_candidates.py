"""The causes worth a try, for what was recorded."""

from dataclasses import replace

import numpy as np

from rotorrig.identify.candidates import background, candidates
from rotorrig.identify.recording import Recording
from rotorrig.processing.response import OrderTrackedResponse, Run
from rotorrig.sims.effects.base import catalogue


def test_every_effect_of_the_library_is_tried_unless_left_out(short: OrderTrackedResponse) -> None:
    known = {effect.name for effect in catalogue(short.rig)}
    assert {effect.name for effect in candidates([Recording(short)])} == known
    fewer = candidates([Recording(short)], without=["bow", "crack"])
    assert {effect.name for effect in fewer} == known - {"bow", "crack"}


def test_labels_are_each_others_only(short: OrderTrackedResponse) -> None:
    for count in (1, 2):
        labels = [e.label for e in candidates([Recording(short, number=i) for i in range(count)])]
        assert len(set(labels)) == len(labels)


def test_orders_that_were_not_tracked_leave_their_unknowns_out(bare: Recording, short: OrderTrackedResponse) -> None:
    def unknowns(recording: Recording) -> dict[str, list[str]]:
        return {e.label: [q.name for q in e.parameters] for e in candidates([recording]) if e.name == "crack"}

    for names in unknowns(bare).values():
        assert names == ["kink 1X re", "kink 1X im"]
    for names in unknowns(Recording(short)).values():
        assert len(names) == 6


def test_a_step_of_unbalance_may_come_with_every_run_but_the_first(short: OrderTrackedResponse) -> None:
    (step,) = (e for e in candidates([Recording(short)]) if e.name == "unbalance_step")
    assert "from run 'down' on" in step.where
    time = step.parameters[-1]
    assert time.low == time.high == short.t[short.run == 1].min()


def test_a_slow_roll_run_is_no_run_that_a_step_could_precede(short: OrderTrackedResponse) -> None:
    runs = (Run(name="slow roll", direction=0), *short.runs)
    begun = replace(short, runs=runs, run=np.where(np.arange(len(short.run)) < 5, 0, short.run + 1))
    steps = [e for e in candidates([Recording(begun)]) if e.name == "unbalance_step"]
    assert [e.where for e in steps] == [steps[0].where]
    assert "from run 'down' on" in steps[0].where


def test_what_differs_between_recordings_is_tried_in_each(short: OrderTrackedResponse) -> None:
    found = candidates([Recording(short, number=i) for i in range(2)])
    hums = [e for e in found if e.name == "line_hum" and "50 Hz" in e.where]
    assert [e.recording for e in hums] == [0, 1]
    steps = {e.label: e.recording for e in found if e.name == "unbalance_step"}
    assert any("before recording 2" in label for label in steps)
    assert {e.recording for e in found if e.name == "bow"} == {None}


def test_the_background_is_restrained_by_the_configs_prior(short: OrderTrackedResponse) -> None:
    (slight,) = background(short.rig)
    assert slight.name == "internal_damping"
    assert {q.prior for q in slight.parameters} == {short.rig.prior.rotating_damping}

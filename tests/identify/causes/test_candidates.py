"""The causes worth a try, for what was recorded."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.causes.candidates import candidates
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.processing.response import MainsHum, OrderTrackedResponse, Run
from rotorrig.sims.effects.base import Effect, catalogue


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
        return {e.label: [q.name for q in e.parameters] for e in candidates([recording]) if e.name == "coupling"}

    for names in unknowns(bare).values():
        assert names == ["force 1X re", "force 1X im", "stiffness re", "stiffness im"]
    for names in unknowns(Recording(short)).values():
        assert len(names) == 6


def step_of(*recordings: Recording) -> Effect | None:
    return next((e for e in candidates(recordings) if e.name == "unbalance_step"), None)


def test_a_step_of_unbalance_is_looked_for_throughout_a_recording(short: OrderTrackedResponse) -> None:
    step = step_of(Recording(short))
    assert step is not None
    (moments,) = step.grid
    assert moments[0] == short.t.min() and moments[-1] == short.t.max()
    assert 12 <= len(moments) <= 24
    assert np.all(np.diff(moments) > 0)


def test_it_may_also_have_happened_between_two_recordings(short: OrderTrackedResponse) -> None:
    step = step_of(Recording(short), Recording(short, number=1))
    assert step is not None
    first, gap, second = step.grid
    assert len(gap) == 1
    assert first[-1] < gap[0] < second[0]
    assert np.array(second) - np.array(first) == pytest.approx(1e6)


def test_no_moment_of_a_slow_roll_is_tried(short: OrderTrackedResponse) -> None:
    runs = (Run(name="slow roll", direction=0), *short.runs)
    begun = replace(short, runs=runs, run=np.where(np.arange(len(short.run)) < 5, 0, short.run + 1))
    step = step_of(Recording(begun))
    assert step is not None
    assert step.grid[0][0] == short.t[5]


def test_without_times_a_step_can_only_be_between_recordings(short: OrderTrackedResponse) -> None:
    table = replace(short, t=np.full_like(short.t, np.nan), keyphasor_t=np.zeros(0))
    assert step_of(Recording(table)) is None
    step = step_of(Recording(table), Recording(table, number=1))
    assert step is not None
    assert [len(stretch) for stretch in step.grid] == [1]


def test_a_hum_has_another_phase_in_every_recording(short: OrderTrackedResponse) -> None:
    found = candidates([Recording(short, number=i) for i in range(2)])
    hums = [e for e in found if e.name == "line_hum" and "50 Hz" in e.where]
    assert [[p.name for p in e.parameters] for e in hums] == [["hum re", "hum im", "hum 2 re", "hum 2 im"]]


def test_hum_is_looked_for_at_the_mains_whose_lines_were_found(short: OrderTrackedResponse) -> None:
    line = MainsHum(frequency=60.0, t=short.t[[0, -1]], stray=np.zeros(2))
    for response, tried in (
        (short, ["50 Hz", "60 Hz", "100 Hz", "120 Hz"]),
        (replace(short, mains=(line,)), ["60 Hz", "120 Hz"]),
        (replace(short, derived_times=True), []),
    ):
        found = [e.where for e in candidates([Recording(response)]) if e.name == "line_hum"]
        assert sorted(found) == sorted(tried)

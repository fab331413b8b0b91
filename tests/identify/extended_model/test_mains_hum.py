"""Which lines of the mains a fit has among its nuisances, and how their phase goes."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.extended_model.mains_hum import find_hum_lines, hum_strays
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.processing.response import MainsHum, OrderTrackedResponse

T = np.array([0.0, 5.0, 10.0])


def line(frequency: float, *stray: float) -> MainsHum:
    return MainsHum(frequency=frequency, t=T, stray=np.array(stray))


@pytest.mark.parametrize(
    ("found", "strays"),
    [
        ([], {}),
        ([line(60.0, 0.1, 0.2, 0.4)], {60.0: [0.1, 0.2, 0.4], 120.0: [0.2, 0.4, 0.8], 180.0: [0.3, 0.6, 1.2]}),
        (
            [line(100.0, 0.2, 0.4, 0.8)],
            {50.0: [0.1, 0.2, 0.4], 100.0: [0.2, 0.4, 0.8], 150.0: [0.3, 0.6, 1.2]},
        ),
        (
            [line(50.0, 0.1, 0.2, 0.4), line(150.0, 1.0, 1.0, 1.0)],
            {50.0: [0.1, 0.2, 0.4], 100.0: [0.2, 0.4, 0.8], 150.0: [1.0, 1.0, 1.0]},
        ),
    ],
)
def test_harmonics_that_were_not_found_stray_with_those_that_were(
    short: OrderTrackedResponse, found: list[MainsHum], strays: dict[float, list[float]]
) -> None:
    told = hum_strays(replace(short, mains=tuple(found)))
    assert sorted(told) == sorted(strays)
    for frequency, (_, stray) in told.items():
        assert stray == pytest.approx(np.array(strays[frequency]))


def test_where_no_line_was_found_both_mains_may_hum_and_without_times_none(short: OrderTrackedResponse) -> None:
    assert sorted(Recording(replace(short, mains=())).hum[1]) == [50.0, 60.0, 100.0, 120.0]
    assert sorted(Recording(replace(short, mains=(line(50.0, 0.0, 0.0, 0.0),))).hum[2]) == [50.0, 100.0, 150.0]
    assert not Recording(replace(short, derived_times=True)).hum[1]


def test_a_line_that_was_found_has_a_phasor_at_each_probe_any_other_one_of_all(short: OrderTrackedResponse) -> None:
    found = replace(short, mains=(line(50.0, 0.0, 0.0, 0.0),))
    first, second, *_ = find_hum_lines(1, found, [50.0, 100.0])
    assert first.names(["x", "y"]) == ["hum 50 Hz 2 x re", "hum 50 Hz 2 x im", "hum 50 Hz 2 y re", "hum 50 Hz 2 y im"]
    assert second.names(["x", "y"]) == ["hum 100 Hz 2 re", "hum 100 Hz 2 im"]

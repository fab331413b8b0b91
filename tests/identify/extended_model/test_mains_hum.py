"""Which lines of the mains a fit has among its nuisances, and how their phase goes."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.extended_model.mains_hum import hum_names, hum_strays
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


def test_every_line_has_one_phasor_in_each_recording() -> None:
    assert hum_names([(0, 50.0), (1, 150.0)]) == [
        "hum 50 Hz 1 re",
        "hum 50 Hz 1 im",
        "hum 150 Hz 2 re",
        "hum 150 Hz 2 im",
    ]


def test_the_probes_have_the_shares_that_tracking_found(short: OrderTrackedResponse) -> None:
    shares = np.array([1.0, 0.5, -1.0, 1j])
    told = Recording(replace(short, mains=(replace(line(50.0, 0.0, 0.0, 0.0), shares=shares),)))
    leaked = told.hum[2][50.0]
    assert np.abs(leaked[:, 0]).max() > 0.1
    assert leaked == pytest.approx(leaked[:, :1] * shares)
    assert told.hum[2][100.0] == pytest.approx(told.hum[2][100.0][:, :1] * np.ones(4)), "nobody knows"

"""What the report says of the tracking is what the response says."""

import dataclasses

import numpy as np

from rotorrig.app.report.sections.tracking import tracking_section
from rotorrig.processing.response import OrderTrackedResponse, Run


def said(response: OrderTrackedResponse) -> str:
    """Return the section with its markup taken for blanks."""
    words, inside = "", False
    for letter in tracking_section(response).html:
        inside = letter == "<" or (inside and letter != ">")
        words += " " if inside or letter == ">" else letter
    return " ".join(words.split())


def test_method_window_and_orders_are_named(response: OrderTrackedResponse) -> None:
    words = said(dataclasses.replace(response, method="least-squares"))
    assert "method joint least-squares fit of all orders over shaft angle" in words
    assert "window Hann, over 8 turns per vector" in words
    assert "orders 0X (gap), 1X, 2X" in words
    assert "vectors 740 rows, 0.0% of their vectors masked" in words


def test_runs_come_with_their_speeds_and_trial_masses(response: OrderTrackedResponse) -> None:
    trial = Run(name="down", direction=-1, trial_unbalance={"disk": 12e-6 * np.exp(0.5j * np.pi)})
    words = said(dataclasses.replace(response, runs=(*response.runs[:2], trial)))
    assert "up 365 480 to 3600" in words
    assert "8 turns 100.0% 12 g mm at 90° on disk" in words


def test_jitter_is_a_time_and_an_angle(response: OrderTrackedResponse) -> None:
    rows = len(response.omega)
    omega = np.full(rows, 100 * np.pi)  # 3000 rpm: 50 us are 0.9 degrees
    words = said(
        dataclasses.replace(response, omega=omega, jitter=np.full(rows, 50e-6), omega_sigma=np.full(rows, 0.1))
    )
    assert "median 50 µs (0.9° of shaft angle)" in words
    assert "0.95 rpm" in words  # 0.1 rad/s


def test_rows_left_out_are_counted_by_reason(response: OrderTrackedResponse) -> None:
    clipped, hum = [[] for _ in response.omega], [[] for _ in response.omega]
    for row in range(20, 25):
        clipped[row] = ["1x: clipped"]
    hum[374] = ["line interference, 50 Hz"]  # the fastest row of the speed-up
    words = said(dataclasses.replace(response, reasons=tuple(map(tuple, clipped)), remarks=tuple(map(tuple, hum))))
    assert "Masked rows, by reason reason rows rpm 1x: clipped 5 566 to 600" in words  # 480 + 8.57 a row
    assert "Remarks on usable rows remark rows rpm line interference, 50 Hz 1 3600 to 3600" in words


def test_the_slow_roll_comes_with_what_speaks_against_it(response: OrderTrackedResponse) -> None:
    words = said(dataclasses.replace(response, slow_roll_remarks=("the vector changes with speed",)))
    assert "Slow roll at 240 rpm" in words
    assert "The slow roll is doubtful: the vector changes with speed" in words
    bare = dataclasses.replace(response, slow_roll=response.slow_roll * np.nan, slow_roll_omega=np.nan)
    assert "No slow roll" in said(bare)

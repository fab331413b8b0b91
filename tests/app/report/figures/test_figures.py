"""The figures show what they are given; the responses are closed forms with known peaks, see tests/app/conftest.py."""

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.app.plot_data.centreline_paths import CentrelinePath, ClearanceCircle
from rotorrig.app.plot_data.curves import curves
from rotorrig.app.plot_data.diagnosis_of_response import predictions
from rotorrig.app.plot_data.order_spectrum import order_spectra
from rotorrig.app.plot_data.resonances import critical_speeds
from rotorrig.app.plot_data.speed_spectra import SpeedSpectra
from rotorrig.app.report.figures.amplitudes import order_amplitudes
from rotorrig.app.report.figures.bode import bode
from rotorrig.app.report.figures.cascade import cascade
from rotorrig.app.report.figures.centreline import centreline
from rotorrig.app.report.figures.look import COLOURS
from rotorrig.app.report.figures.maps import full_spectrum_map, residual_map
from rotorrig.app.report.figures.polar import polar, rows_to_label
from rotorrig.identify.diagnosis import Diagnosis
from rotorrig.identify.identification import Identification
from rotorrig.processing.response import OrderTrackedResponse


def test_the_extended_model_is_drawn_over_the_base_model(
    response: OrderTrackedResponse, poorly_fitted: Identification, named: Diagnosis
) -> None:
    base, extended = predictions(response, poorly_fitted.fits[0], named)
    figure = bode(response, 0, prediction=extended, before=base)
    peak = {
        trace.name: float(np.nanmax(trace.y))
        for trace in figure.data
        if trace.yaxis == "y" and trace.name in ("base model", "up, model")
    }
    assert peak["up, model"] == pytest.approx(187.5, rel=0.01)  # e / (2 zeta)
    assert peak["base model"] == pytest.approx(187.5 * 0.04 / 0.055, rel=0.01)


def test_critical_speeds_are_marked_and_labelled_together(response: OrderTrackedResponse) -> None:
    mine = [each for each in critical_speeds(response) if each.probe == response.probes[0]]
    figure = bode(response, 0, resonances=mine)
    speeds = [each.measured.omega.value * 30 / np.pi for each in mine]
    assert sorted({line.x0 for line in figure.layout.shapes}) == pytest.approx(sorted(speeds))
    (label,) = figure.layout.annotations
    first, *_ = label.text.split("<br>")
    assert first.split()[1] in ("2233", "2234")  # 2230 / sqrt(1 - 2 * 0.04^2) = 2233.6
    assert label.text.count("AF 12.") == 2  # about 1 / (2 * 0.04)


def test_second_order_peaks_at_half_the_critical_speed(response: OrderTrackedResponse) -> None:
    figure = order_amplitudes(response, 2.0)
    trace = figure.data[0]
    assert np.asarray(trace.x)[np.argmax(trace.y)] == pytest.approx(1115, abs=15)
    assert np.max(trace.y) == pytest.approx(0.05 * 187.5, abs=1.5)


def test_a_polar_plot_puts_the_peak_where_its_lag_is(
    response: OrderTrackedResponse, closed_form: Callable[[NDArray[np.float64]], NDArray[np.complex128]]
) -> None:
    (up, *_) = [trace for trace in polar(response, 0).data if trace.name == "up"]
    peak = int(np.argmax(up.r))
    assert up.r[peak] == pytest.approx(187.5, abs=1.5)  # e / (2 zeta)
    at_peak = closed_form(np.array([up.customdata[peak] * np.pi / 30]))  # the row nearest to resonance
    assert up.theta[peak] == pytest.approx(-np.degrees(np.angle(at_peak[0])), abs=0.5)


def test_lag_grows_against_the_rotation_from_the_probe_on(response: OrderTrackedResponse) -> None:
    y = response.probes.index("1y")
    axis = polar(response, y).layout.polar.angularaxis
    assert (axis.direction, axis.rotation) == ("clockwise", pytest.approx(90))  # x to y is anticlockwise on paper
    turned = dataclasses.replace(response, rig=response.rig.model_copy(update={"rotation": "y-to-x"}))
    assert polar(turned, y).layout.polar.angularaxis.direction == "counterclockwise"


def test_speeds_are_written_along_the_polar_path_the_peak_among_them(response: OrderTrackedResponse) -> None:
    up = curves(response, 0)[0]
    rows = rows_to_label(up)
    assert up.rpm[rows[0]] == pytest.approx(2230, abs=10)
    assert len(rows) >= 4
    z = up.amplitude[rows] * np.exp(-1j * np.radians(up.lag[rows]))
    apart = np.abs(z[:, None] - z) + np.eye(len(rows)) * 1e9
    assert apart.min() > 0.16 * 187.5 * 0.98


def test_the_full_spectrum_is_drawn_forward_above_backward(response: OrderTrackedResponse) -> None:
    figure = full_spectrum_map(next(iter(order_spectra(response))))
    assert list(figure.data[0].y) == ["+2X", "+1X", "-1X", "-2X"]
    colours = np.asarray(figure.data[0].z)
    assert np.nanmax(colours[1]) == pytest.approx(np.log10(187.5), abs=0.02)


def test_a_map_of_one_row_is_high_enough_for_the_numbers_of_its_scale(response: OrderTrackedResponse) -> None:
    few = dataclasses.replace(response, probes=response.probes[:1], usable=response.usable[:, :1])
    one = dataclasses.replace(few, runs=(few.runs[0], few.runs[1], dataclasses.replace(few.runs[2], direction=0)))
    figure = residual_map(one, np.ones((len(one.omega), 1, len(one.orders))))
    assert len(figure.data[0].y) == 1
    margin = figure.layout.margin
    per_sigma = (figure.layout.height - margin.t - margin.b) / 8  # px: 2 and 3 sigma stand next to each other
    assert per_sigma > 12  # px, a line of letters


def test_a_cross_has_the_colour_of_its_run(response: OrderTrackedResponse) -> None:
    marks = polar(response, 0).data[-1].marker
    assert marks.symbol == "x-thin"
    assert marks.line.color == COLOURS[1]  # its lines are all there is of it: without, they are black on black


def test_no_label_stands_at_the_centre_where_paths_begin_and_end(response: OrderTrackedResponse) -> None:
    figure = polar(response, 0)
    assert min(figure.data[-1].r) > 0.2 * max(figure.data[-1].r)
    assert min(figure.layout.polar.radialaxis.tickvals) > 0


def path_of(reach: float) -> CentrelinePath:
    x = np.linspace(0.0, reach, 50)
    return CentrelinePath(plane="here", position=0.1, run="up", direction=1, rpm=100 * x, x=x, y=0 * x)


def test_the_clearance_circle_is_drawn_where_the_path_can_be_seen_in_it() -> None:
    circle = ClearanceCircle(bearing="left", radius=100.0, x=0.0, y=100.0)
    figure = centreline([path_of(20.0)], circle, reach=150.0)
    with_circle = figure.data[0]
    assert with_circle.name == "clearance of left"
    assert (min(with_circle.y), max(with_circle.y)) == (0.0, 200.0)  # it stands on where the path begins
    assert (figure.layout.xaxis.range, figure.layout.yaxis.range) == ((-150.0, 150.0), (-50.0, 250.0))
    alone = centreline([path_of(1.0)], circle, reach=5.0)
    assert [trace.name for trace in alone.data] == ["up"]
    assert alone.layout.yaxis.range == (-5.0, 5.0)


@pytest.mark.parametrize("count", [1, 3])
def test_every_probe_has_a_panel_whatever_their_number(response: OrderTrackedResponse, count: int) -> None:
    few = dataclasses.replace(response, probes=response.probes[:count], usable=response.usable[:, :count])
    titles = [note.text for note in order_amplitudes(few, 2.0).layout.annotations]
    assert titles == list(response.probes[:count])


def test_a_cascade_reads_in_decibels_and_has_its_orders_where_they_belong() -> None:
    spectra = SpeedSpectra(
        place="1x, 1y",
        run="up",
        direction=1,
        rpm=np.array([600.0, 3000.0]),
        frequency=np.linspace(-250.0, 250.0, 5),
        amplitude=np.array([[0.1, 1.0, 10.0, 100.0, np.nan]] * 2),
        seconds=1.0,
    )
    heat, *lines = cascade(spectra, top=100.0).data
    assert np.asarray(heat.z)[0].tolist() == [-20, 0, 20, 40, -128]
    assert (heat.x0, heat.dx) == (-250.0, 125.0)
    assert (heat.zmin, heat.zmax) == (-40.0, 40.0)  # four decades
    assert dict(zip(heat.colorbar.ticktext, heat.colorbar.tickvals, strict=True))["10"] == 20
    assert [line.x[1] for line in lines] == [-25.0, -50.0, -100.0, 25.0, 50.0, 100.0]  # Hz at 3000 rpm


def test_a_cascade_of_one_probe_begins_at_zero() -> None:
    spectra = SpeedSpectra(
        place="1x", run="down", direction=-1, rpm=np.array([600.0, 3000.0]), frequency=np.array([25.0, 75.0]),
        amplitude=np.ones((2, 2)), seconds=1.0,
    )  # fmt: skip
    figure = cascade(spectra, top=1.0)
    assert figure.layout.xaxis.range == (0.0, 100.0)
    assert [note.text for note in figure.layout.annotations] == ["½X", "1X", "2X"]

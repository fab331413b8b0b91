"""Figures of a response, against its own numbers."""

import numpy as np
import pytest

import rotorrig as rr
from rotorrig.identify import Identification
from rotorrig.processing import OrderTrackedResponse

PEAK = 187.5  # um: e / (2 zeta) of the closed form


@pytest.fixture
def seen(response: OrderTrackedResponse) -> rr.Response:
    return rr.Response.of(response)


def test_the_bode_plot_peaks_where_the_rotor_does(seen: rr.Response, identification: Identification) -> None:
    figure = seen.plot.bode("1x", identification=identification)
    assert figure.layout.title.text == "1x, 1X"
    drawn = {trace.name: trace for trace in figure.data if trace.yaxis == "y"}
    assert max(drawn["up"].y) == pytest.approx(PEAK, rel=0.02)
    assert max(drawn["up, model"].y) == pytest.approx(PEAK, rel=0.05)


def test_the_polar_plot_has_both_runs(seen: rr.Response) -> None:
    figure = seen.plot.polar("1y")
    assert {trace.name for trace in figure.data} >= {"up", "down"}


def test_an_orbit_has_the_radius_of_the_circular_whirl_and_a_dot_at_its_beginning(seen: rr.Response) -> None:
    line, dot = seen.plot.orbit(2230.0).data
    radius = np.hypot(np.asarray(line.x), np.asarray(line.y))
    np.testing.assert_allclose(radius, PEAK, rtol=0.03)
    assert (dot.x[0], dot.y[0]) == (line.x[0], line.y[0])


def test_an_orbit_is_by_default_that_of_the_largest_vector(seen: rr.Response) -> None:
    line, _ = seen.plot.orbit().data
    assert np.hypot(line.x[0], line.y[0]) == pytest.approx(PEAK, rel=0.03)


def test_the_cascade_says_which_plane_and_run(seen: rr.Response) -> None:
    assert "down" in seen.plot.cascade(run="down").layout.title.text


@pytest.mark.parametrize(
    ("draw", "words"),
    [
        (lambda plot: plot.bode("7x"), "probe '7x': the response has 1x, 1y"),
        (lambda plot: plot.orbit(plane=9), "plane 9: the response has 2 planes"),
        (lambda plot: plot.cascade(run="sideways"), "run 'sideways', want one of up, down"),
    ],
)
def test_what_there_is_not_is_said(seen: rr.Response, draw, words: str) -> None:
    with pytest.raises(rr.DataError, match=words):
        draw(seen.plot)

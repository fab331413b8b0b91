"""The full spectrum of circular orbits, which have one sense of whirl each."""

import dataclasses

import numpy as np
import pytest

from rotorrig.app.plot_data.order_spectrum import order_spectra
from rotorrig.processing.response import OrderTrackedResponse


def test_a_forward_circle_is_all_at_plus_one(response: OrderTrackedResponse) -> None:
    spectra = list(order_spectra(response))
    assert [(one.plane.probes, one.run) for one in spectra] == [
        (("1x", "1y"), "up"), (("1x", "1y"), "down"), (("2x", "2y"), "up"), (("2x", "2y"), "down"),
    ]  # fmt: skip
    first = dict(zip(spectra[0].orders, spectra[0].at_peak, strict=True))
    assert spectra[0].peak_rpm == pytest.approx(2230, abs=10)
    assert first[1.0] == pytest.approx(187.5, abs=1.5)  # e / (2 zeta)
    assert first[-1.0] < 1.5  # noise of 0.3 um a component, in 365 rows


def test_the_same_orbit_is_backward_where_the_rotor_turns_the_other_way(response: OrderTrackedResponse) -> None:
    rig = response.rig.model_copy(update={"rotation": "y-to-x"})
    first = next(iter(order_spectra(dataclasses.replace(response, rig=rig))))
    at = dict(zip(first.orders, first.at_peak, strict=True))
    assert at[-1.0] == pytest.approx(187.5, abs=1.5)


def test_each_speed_has_its_own_amplitude(response: OrderTrackedResponse) -> None:
    first = next(iter(order_spectra(response)))
    twice = first.amplitude[first.orders.index(2.0)]
    middle = (first.edges[:-1] + first.edges[1:]) / 2
    assert middle[np.nanargmax(twice)] == pytest.approx(1115, abs=30)  # half the critical speed
    assert np.nanmax(twice) == pytest.approx(0.05 * 187.5, rel=0.06)


def test_probes_that_make_no_plane_have_no_full_spectrum(response: OrderTrackedResponse) -> None:
    parallel = tuple(probe.model_copy(update={"angle": 0.0}) for probe in response.rig.probes)
    rig = response.rig.model_copy(update={"probes": parallel})
    assert list(order_spectra(dataclasses.replace(response, rig=rig))) == []

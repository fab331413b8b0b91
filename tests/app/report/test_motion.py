"""Mean position and gap voltages of a shaft that is moved on purpose."""

import dataclasses
from html.parser import HTMLParser

import numpy as np

from rotorrig.app.report.sections.motion import centreline_section
from rotorrig.processing.response import OrderTrackedResponse


class Rows(HTMLParser):
    """The rows of all tables, a list of words each."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag == "tr":
            self.rows.append([])

    def handle_data(self, data: str) -> None:
        if self.rows:
            self.rows[-1].append(data)


def raised(response: OrderTrackedResponse) -> OrderTrackedResponse:
    """Return the response of a shaft 20 µm nearer to its first probe from 2000 rpm on."""
    z = response.z.copy()
    z[response.omega > 2000 * np.pi / 30, 0, 0] = 20e-6
    return dataclasses.replace(response, z=z)


def test_gap_voltages_are_those_of_the_probe(response: OrderTrackedResponse) -> None:
    section = centreline_section(raised(response))
    assert section is not None
    # 7.874 mV/µm about -10 V: 20 µm are 0.157 V
    assert ["1x", "-10.000", "-9.843", "+20.00", "-18 to -2"] in Rows(section.html).rows
    assert ["1y", "-10.000", "-10.000", "+0.00", "-18 to -2"] in Rows(section.html).rows


def test_the_way_is_said_as_a_share_of_the_clearance_where_that_is_known(response: OrderTrackedResponse) -> None:
    bearings = tuple(b.model_copy(update={"clearance": 100e-6}) for b in response.rig.bearings)
    known = dataclasses.replace(raised(response), rig=response.rig.model_copy(update={"bearings": bearings}))
    section = centreline_section(known)
    assert section is not None
    assert ["1x, 1y at 250.5 mm, up", "20 µm", "480", "3600", "40.0% (left B)"] in Rows(section.html).rows  # of 50 µm


def test_the_scale_and_the_clearance_are_said(response: OrderTrackedResponse) -> None:
    section = centreline_section(raised(response))
    assert section is not None
    assert ">1x, 1y at 250.5 mm: axes ±30 µm, no bearing clearance in the config</figcaption>" in section.html
    assert ">2x, 2y at 380.5 mm: axes ±30 µm, no" in section.html, "one scale, though this plane does not move"
    for clearance, words in ((100e-6, "radius 50 µm<"), (5e-3, "radius 2500 µm, far outside<")):
        bearings = tuple(b.model_copy(update={"clearance": clearance}) for b in response.rig.bearings)
        known = dataclasses.replace(raised(response), rig=response.rig.model_copy(update={"bearings": bearings}))
        section = centreline_section(known)
        assert section is not None
        assert f"clearance of left B: {words}/figcaption>" in section.html


def test_single_probes_have_gaps_and_no_centreline(response: OrderTrackedResponse) -> None:
    parallel = tuple(probe.model_copy(update={"angle": 0.0}) for probe in response.rig.probes)
    section = centreline_section(
        dataclasses.replace(response, rig=response.rig.model_copy(update={"probes": parallel}))
    )
    assert section is not None
    assert "data-figure" not in section.html
    assert len(Rows(section.html).rows) == 1 + len(response.probes)


def test_without_0x_there_is_nothing_to_say(response: OrderTrackedResponse) -> None:
    moving = dataclasses.replace(
        response,
        orders=response.orders[1:],
        z=response.z[:, :, 1:],
        covariance=response.covariance[:, 1:],
        slow_roll=response.slow_roll[:, 1:],
        slow_roll_covariance=response.slow_roll_covariance[1:],
    )
    assert centreline_section(moving) is None

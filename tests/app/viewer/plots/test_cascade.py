"""Cascades: the height of a spectrum beside the bar that says its scale, read back from what was logged."""

import re
from pathlib import Path

import numpy as np
import pytest
import rerun as rr

from rotorrig.app.text.amplitude_units import AmplitudeUnit
from rotorrig.app.viewer.plots.cascade import CascadePicture
from tests.app.viewer.rrd_content import chunks, words_in


@pytest.mark.parametrize(("name", "expected"), [("µm 0-peak", 25.4), ("µm pp", 50.8), ("mil pp", 2.0)])
def test_a_spectrum_is_as_high_as_its_amplitude_beside_the_bar(tmp_path: Path, name: str, expected: float) -> None:
    rrd, unit = tmp_path / "cascade.rrd", AmplitudeUnit(name)
    stream = rr.RecordingStream("cascade", recording_id=name)
    stream.save(str(rrd))
    order = np.linspace(-2, 2, 41)
    amplitude = np.where(np.isclose(order, 1), 25.4e-6, 0.0)[None]  # m, 0-peak
    picture = CascadePicture(stream, "cascade", title="", static=True, unit=unit)
    picture.draw(np.array([1200.0]), order, amplitude * unit.by)
    stream.disconnect()
    per_view_unit = bar(rrd) / tall(rrd, "/cascade/scale/bar")
    assert tall(rrd, "/cascade/spectra") * per_view_unit == pytest.approx(expected, rel=1e-6)


def bar(rrd: Path) -> float:
    """Return what the words beside the bar say it stands for."""
    (found,) = [m for word in words_in(rrd) if (m := re.fullmatch(r"([\d.]+) (µm|mil)", word))]
    return float(found[1])


def tall(rrd: Path, entity: str) -> float:
    """Return how high the lines of an entity reach, view units."""
    (chunk,) = [chunk for place, chunk in chunks(rrd) if place == entity]
    column = next(name for name in chunk.schema.names if name.endswith("strips"))
    heights = np.array([point[1] for strip in chunk[column].to_pylist()[0] for point in strip])
    return float(np.ptp(heights))

"""The cascades of a sweep: full spectra of every plane over speed, one picture rising and one falling."""

import rerun as rr

from rotorrig.app.text import AmplitudeUnit
from rotorrig.app.viewer.live.data import WAYS, SpectraSoFar
from rotorrig.app.viewer.live.parts.vectors import COLOURS, NAMES
from rotorrig.app.viewer.plots import CascadePicture
from rotorrig.processing import planes
from rotorrig.rig.config import RigConfig


class CascadesPart:
    """Two cascades per probe plane, drawn when they have grown."""

    def __init__(self, stream: rr.RecordingStream, rig: RigConfig, *, static: bool, unit: AmplitudeUnit) -> None:
        self._by = unit.by
        self._drawn = dict.fromkeys(WAYS, 0)
        self._pictures = {
            (i, way): CascadePicture(
                stream,
                f"cascade/{i}/{NAMES[way]}",
                title=f"{', '.join(plane.probes)}: full spectrum, {unit.name}, speed going {NAMES[way]}",
                static=static,
                unit=unit,
            )
            for i, plane in enumerate(planes(rig))
            for way in WAYS
        }

    def draw(self, spectra: SpectraSoFar) -> None:
        """Draw the cascades that have grown."""
        grown = [way for way in WAYS if spectra.count(way) > self._drawn[way]]
        for (plane, way), picture in self._pictures.items():
            if way in grown:
                cascade = spectra.cascade(plane, direction=way)
                picture.draw(cascade.rpm, cascade.order, cascade.amplitude * self._by, colour=COLOURS[way])
        self._drawn.update({way: spectra.count(way) for way in grown})

"""`Recording`: a run.mcap, whose samples stay in their file until they are asked for."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rotorrig.acquisition.files import open_recording
from rotorrig.app.python.card import Card, Shown
from rotorrig.processing import Waveforms
from rotorrig.rig import DataError

if TYPE_CHECKING:
    import xarray as xr

SECONDS = 1.0  # of waveform that are read unless told otherwise


class Recording(Shown):
    """A recording in its file; it is opened for every question and closed again."""

    def __init__(self, path: str | Path) -> None:
        """Take a run.mcap. Raises DataError for a file that is none."""
        self.path = Path(path)
        with open_recording(self.path) as stored:
            self.rig, self.daq, self.events = stored.rig, stored.daq, stored.events
            self.motor, self.source, self.complete = stored.motor, stored.source, stored.complete
            self.samples = stored.samples

    @property
    def seconds(self) -> float:
        """Length of what is recorded, gaps left out [s]."""
        return self.samples / self.daq.sample_rate

    def to_xarray(self, begin: float = 0.0, seconds: float = SECONDS) -> "xr.Dataset":
        """Return the probes' displacement [m] towards the probe, 0 at its gap voltage, from `begin` [s] on.

        Dataset of (time, probe). Raises DataError for a stretch with missing samples or beyond the recording.
        """
        import xarray as xr

        with open_recording(self.path) as stored:
            stretch = Waveforms(stored).between(begin, begin + seconds)
        if stretch is None:
            raise DataError(
                f"{self.path}: {begin:g} to {begin + seconds:g} s is not all there, want a stretch without gaps within "
                f"the {self.seconds:.1f} s recorded"
            )
        names = [probe.name for probe in self.rig.probes]
        return xr.Dataset(
            {
                "displacement": (
                    ("time", "probe"),
                    stretch.x,
                    {"units": "m", "long_name": "displacement towards the probe, 0 at its gap voltage"},
                )
            },
            coords={"time": ("time", stretch.t, {"units": "s"}), "probe": ("probe", names)},
            attrs={"title": f"Recording of {self.rig.name}", "sample_rate_hz": self.daq.sample_rate},
        )

    @property
    def _card(self) -> Card:
        kinds = [event.kind for event in self.events]
        counts = ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds)) or "none"
        speeds = [sample.speed for sample in self.motor]
        lines = [
            ("length", f"{self.seconds:.1f} s, {self.samples} scans at {self.daq.sample_rate:g} Hz"),
            ("probes", ", ".join(probe.name for probe in self.rig.probes)),
            ("top speed", f"{np.max(speeds) * 60 / (2 * np.pi):.0f} rpm" if speeds else "unknown"),
            ("events", counts),
            ("file", f"{self.path}{'' if self.complete else ' (cut short)'}"),
        ]
        return Card(f"Recording of {self.rig.name}", lines)

"""`Response`: order vectors over speed with their ways out of this program."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Self

import numpy as np

from rotorrig.app.plot_data import slow_roll_known, vectors
from rotorrig.app.python.card import Card, Shown, values
from rotorrig.processing import OrderTrackedResponse
from rotorrig.processing.files import write_response
from rotorrig.rig.config import RPM, UM

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from rotorrig.app.python.plots import ResponsePlots

PathLike = str | Path


@dataclass(frozen=True, slots=True, kw_only=True, repr=False, eq=False)
class Response(Shown, OrderTrackedResponse):
    """`OrderTrackedResponse` as `rr.read` and `rr.track` return it; it adds views and files, and changes nothing."""

    @classmethod
    def of(cls, response: OrderTrackedResponse) -> Self:
        """Return the same response with these views."""
        return cls(**values(response))

    def to_xarray(self) -> "xr.Dataset":
        """Return a dataset of (speed, probe, order), SI, units in `attrs`; `displacement` is complex, raw, 0-peak.

        Compensated are `ds.displacement - ds.slow_roll`; one run is `ds.where(ds.run == "up", drop=True)`.
        """
        from rotorrig.app.python.labelled import dataset

        return dataset(self)

    def to_pandas(self, *, compensated: bool = False) -> "pd.DataFrame":
        """Return a row for each speed, probe and order; units in the names: rpm, µm 0-peak, degrees of phase lag.

        `compensated`: less the slow-roll vector; NaN where there is none.
        """
        from rotorrig.app.python.labelled import frame

        return frame(self, compensated=compensated)

    def to_parquet(self, path: PathLike, *, compensated: bool = False) -> Path:
        """Write `to_pandas` to a Parquet file. Raises DataError if it cannot be written."""
        from rotorrig.app.python.labelled import write_parquet

        return write_parquet(Path(path), self.to_pandas(compensated=compensated))

    def to_mat(self, path: PathLike) -> Path:
        """Write a MATLAB file: arrays z (speed, probe, order) m, omega rad/s and so on, as `docs/python.md` lists them.

        Raises DataError if it cannot be written.
        """
        from rotorrig.app.python.labelled import write_mat

        return write_mat(Path(path), self)

    def save(self, path: PathLike) -> Path:
        """Write a response.mcap. Raises DataError if it cannot be written."""
        write_response(Path(path), self)
        return Path(path)

    @property
    def plot(self) -> "ResponsePlots":
        """Plotly figures: `.plot.bode()`, `.polar()`, `.orbit()`, `.cascade()`."""
        from rotorrig.app.python.plots import ResponsePlots

        return ResponsePlots(self)

    @property
    def _card(self) -> Card:
        rpm, size = self.omega * RPM, np.where(self.usable, np.abs(vectors(self)) * UM, np.nan)
        runs = ", ".join(f"{run.name} ({np.sum(self.run == i)} rows)" for i, run in enumerate(self.runs))
        lines = [
            ("probes", ", ".join(self.probes)),
            ("orders", ", ".join(f"{order:g}X" if order else "gap" for order in self.orders)),
            ("runs", runs),
            ("speed", f"{rpm.min():.0f} to {rpm.max():.0f} rpm"),
        ]
        if np.isfinite(size).any():
            row, probe = np.unravel_index(int(np.nanargmax(size)), size.shape)
            raw = "slow roll subtracted" if slow_roll_known(self) else "raw"
            lines.append(
                ("largest 1X", f"{size[row, probe]:.3g} um 0-peak at {rpm[row]:.0f} rpm, {self.probes[probe]}, {raw}")
            )
        return Card(f"Response of {self.rig.name}", [*lines, ("source", self.source.source)])

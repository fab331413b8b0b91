"""Fit a response with a progress bar, or take the fit a file holds."""

from pathlib import Path

from rotorrig.app.console import progress_bars
from rotorrig.identify.fit import fit
from rotorrig.identify.identification import Identification
from rotorrig.identify.result_files import read_identification
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.errors import DataError


def reused(path: Path, response: OrderTrackedResponse) -> Identification:
    """Return the fits in a fit.json. Raises DataError if they are of another response."""
    found = read_identification(path)
    ours, theirs = response.source, found.source
    same = (ours.config_hash, ours.source, ours.source_hash) == (theirs.config_hash, theirs.source, theirs.source_hash)
    if not same or found.fits[0].prediction.shape != response.z.shape[:2]:
        raise DataError(
            f"{path}: is the fit of another response (of {theirs.source}, {theirs.source_hash}), "
            f"want that of {ours.source}, {ours.source_hash}"
        )
    return found


def identified(response: OrderTrackedResponse, *, objective: str = "f2", seed: int = 0) -> Identification:
    """Return the fits of a response. Raises DataError, ConfigError."""
    with progress_bars() as bars:
        task = bars.add_task("identifying (CHEA)", total=None, note="")
        found = fit(response, objective=objective, seed=seed, progress=lambda text: bars.update(task, note=text))
        bars.update(task, total=1.0, completed=1.0, note="")
    return found

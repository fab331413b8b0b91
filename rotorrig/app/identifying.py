"""Read a response and fit it, with a progress bar."""

from pathlib import Path

from rotorrig.app.console import progress_bars
from rotorrig.identify.fit import fit
from rotorrig.identify.identification import Identification
from rotorrig.identify.objective import OBJECTIVES
from rotorrig.processing.response_file import read_response
from rotorrig.rig.errors import ConfigError


def identified(path: Path, *, objective: str = "f2", seed: int = 0) -> Identification:
    """Return the fits of the response in `path`. Raises DataError, ConfigError."""
    if objective not in OBJECTIVES:
        raise ConfigError(f"--objective: got '{objective}', want one of {', '.join(OBJECTIVES)}")
    response = read_response(path)
    with progress_bars() as bars:
        task = bars.add_task("identifying (CHEA)", total=None, note="")
        found = fit(response, objective=objective, seed=seed, progress=lambda text: bars.update(task, note=text))
        bars.update(task, total=1.0, completed=1.0, note="")
    return found

"""`rotor identify`: fit responses of one rig with a progress bar."""

from collections.abc import Sequence

from rich.progress import Progress

from rotorrig.app.terminal import progress_bars
from rotorrig.identify import Identification, identify
from rotorrig.identify.base_model import ObjectiveName, SearchName
from rotorrig.identify.uncertainty import Resampling
from rotorrig.processing import OrderTrackedResponse


def identify_responses(
    responses: Sequence[OrderTrackedResponse],
    *,
    objective: ObjectiveName = "residual",
    method: SearchName | None = None,
    profile: bool = False,
    draws: int = 0,
    workers: int = 1,
    seed: int = 0,
) -> Identification:
    """Fit responses of one rig, with `draws` of a bootstrap. Ctrl-C ends the bootstrap and keeps the draws done.

    Raises DataError, ConfigError.
    """
    with progress_bars() as bars:
        task = bars.add_task("identifying", total=None, note="")
        resampling = _resampling(bars, draws, workers) if draws else None
        identification = identify(
            responses,
            objective=objective,
            method=method,
            profile=profile,
            resampling=resampling,
            seed=seed,
            progress=lambda text: bars.update(task, note=text),
        )
        bars.update(task, total=1.0, completed=1.0, note="")
    return identification


def _resampling(bars: Progress, draws: int, workers: int) -> Resampling:
    task = bars.add_task("bootstrap (Ctrl-C keeps the draws done)", total=draws, start=False, note="")

    def show(done: int) -> None:
        if done == 1:
            bars.start_task(task)
        bars.update(task, completed=done, note=f"{done} of {draws} draws")

    return Resampling(draws=draws, workers=workers, progress=show)

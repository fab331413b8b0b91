"""`rotor balance`: from responses and options to a printed correction."""

from collections.abc import Sequence
from pathlib import Path

from rotorrig.app.commands.balancing.options import HoleOptions, read_bands, read_holes, read_planes, read_radii
from rotorrig.app.commands.diagnose import read_responses
from rotorrig.app.terminal import comparison_table, corrections_table, out, prediction_table, working
from rotorrig.app.text import (
    AMPLITUDE_UNITS,
    comparison_sentence,
    grade_sentence,
    hole_lines,
    known_sentences,
    mounted_sentence,
)
from rotorrig.balancing import Balance, Task, balance
from rotorrig.identify import read_identification
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig.config import RigConfig


def read_task(
    responses: Sequence[OrderTrackedResponse],
    *,
    planes: str | None,
    speeds: str | None,
    holes: HoleOptions,
    min_max: bool,
    fitted: bool,
) -> Task:
    """Return what is wanted, in SI. Raises ConfigError."""
    rig = responses[0].rig
    wanted = read_planes(planes, known=rig.unbalance_planes)
    mounted = dict.fromkeys(p for r in responses for run in r.runs for p, u in run.trial_unbalance.items() if u)
    corrected = wanted or tuple(mounted) or (rig.identify.unbalance if fitted and rig.identify else ())
    radii = read_radii(holes.radius, known=rig.unbalance_planes)
    return Task(
        planes=corrected,
        bands=read_bands(speeds),
        holes=read_holes(holes, corrected, radii),
        radii=radii,
        min_max=min_max,
    )


def balance_responses(
    paths: Sequence[Path],
    *,
    fit: Path | None,
    after: Path | None,
    planes: str | None,
    speeds: str | None,
    holes: HoleOptions,
    min_max: bool,
) -> tuple[Balance, RigConfig]:
    """Balance responses of one rig, and return that, too. Raises DataError, ConfigError."""
    every = read_responses([*paths, after] if after else paths)
    measured, last = every[: len(paths)], every[-1] if after else None
    identification = read_identification(fit) if fit else None
    task = read_task(measured, planes=planes, speeds=speeds, holes=holes, min_max=min_max, fitted=fit is not None)
    with working("balancing"):
        return balance(measured, task, identification=identification, after=last), measured[0].rig


def show_balance(balance: Balance, unit: str = AMPLITUDE_UNITS[0]) -> None:
    """Print corrections, what of them is known, the masses to mount and what they will do, amplitudes in `unit`."""
    out.print(corrections_table(balance))
    for words in (*known_sentences(balance), *hole_lines(balance), mounted_sentence(balance)):
        out.print(words, highlight=False, markup=False)
    out.print(prediction_table(balance.prediction, unit))
    out.print(grade_sentence(balance), highlight=False, markup=False)
    if balance.comparison:
        out.print(comparison_table(balance, unit))
        out.print(comparison_sentence(balance), highlight=False, markup=False)

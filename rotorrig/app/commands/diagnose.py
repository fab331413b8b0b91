"""`rotor diagnose`: read responses of one rig, diagnose them with a progress bar, print or save the result."""

import math
import signal
import threading
import time
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import FrameType
from typing import Literal

from rotorrig.app.commands.config_model import check_effects
from rotorrig.app.terminal import err, out, progress_bars, tables
from rotorrig.app.text import (
    NOTHING_PULLED,
    finding_sentences,
    gain_sentence,
    hidden_effects_sentence,
    missing_lines,
    next_run_sentence,
    tie_sentences,
)
from rotorrig.identify import Diagnosis, NameplateCheck, Verdict, diagnose
from rotorrig.identify.verdict import Cause
from rotorrig.processing import OrderTrackedResponse
from rotorrig.processing.files import read_response
from rotorrig.rig import DataError, write_whole_text
from rotorrig.rig.config import Extension, RigConfig, extend, read_quantity


def read_responses(paths: Sequence[Path], *, config: RigConfig | None = None) -> list[OrderTrackedResponse]:
    """Read responses of one rig; with `config`, its model replaces the one in the files. Raises DataError likewise."""
    return of_one_rig([(str(path), read_response(path)) for path in paths], config=config)


def of_one_rig(
    responses: Sequence[tuple[str, OrderTrackedResponse]], *, config: RigConfig | None = None
) -> list[OrderTrackedResponse]:
    """Return responses, given with their names, with the model of the first or of `config`.

    Raises DataError if their nameplates differ from each other's or from `config`'s. Effects in the model and the sense
    of rotation may differ.
    """
    if config:
        check_effects(config)
    first, response = responses[0]
    rig, where = (config, "the config given") if config else (response.rig, first)
    for name, response in responses:
        if rig.nameplate_hash not in (response.rig.nameplate_hash, response.rig.turned_over.nameplate_hash):
            raise DataError(
                f"{name}: is from another rig ({response.rig.name}, {response.rig.nameplate_hash}) than "
                f"{where} ({rig.name}, {rig.nameplate_hash}), want responses of one rig"
            )
    return [with_model_of(response, rig) for _, response in responses]


def with_model_of(response: OrderTrackedResponse, rig: RigConfig) -> OrderTrackedResponse:
    """Return the response with the model of `rig`, in the response's own sense of rotation."""
    if response.rig.rotation != rig.rotation:
        rig = rig.turned_over
    return replace(response, rig=rig, source=replace(response.source, config_hash=rig.hash))


def diagnose_responses(
    responses: Sequence[OrderTrackedResponse],
    *,
    holdout: OrderTrackedResponse | None = None,
    model: Literal["swept", "quasi-static"] = "swept",
    not_possible: Collection[str] = (),
    seed: int = 0,
    time_limit: str | None = None,
) -> Diagnosis:
    """Diagnose responses of one rig with a progress bar. Raises DataError, ConfigError.

    Kinds of runs in `not_possible` are not proposed for the next.
    After `time_limit`, "5 min", or on Ctrl-C it ends with the best so far; on the next one with KeyboardInterrupt.
    """
    limit = math.inf if time_limit is None else read_quantity(time_limit, "time", where="--time-limit", positive=True)
    with progress_bars() as bars, _patience(limit) as go_on:
        task = bars.add_task("diagnosing", total=1.0, note="")

        def show(stage: str, done: float) -> None:
            bars.update(task, completed=done, note=stage)

        diagnosis = diagnose(
            responses,
            holdout=holdout,
            model=model,
            not_possible=not_possible,
            seed=seed,
            progress=show,
            go_on=go_on,
        )
        bars.update(task, completed=1.0, note="")
    return diagnosis


@contextmanager
def _patience(limit: float) -> Iterator[Callable[[], bool]]:
    """Yield what says whether to go on: not after `limit` [s], nor after the first Ctrl-C."""
    until, was_asked = time.monotonic() + limit, threading.Event()

    def stop(number: int, frame: FrameType | None) -> None:
        if was_asked.is_set():
            raise KeyboardInterrupt
        was_asked.set()
        err.print("ending with the best so far; Ctrl-C again leaves at once", highlight=False)

    before = signal.signal(signal.SIGINT, stop)
    try:
        yield lambda: not was_asked.is_set() and time.monotonic() < until
    finally:
        signal.signal(signal.SIGINT, before)


def show(diagnosis: Diagnosis) -> None:
    """Print the verdict, the table of causes, ties, the next run and the cross-validation error."""
    style = "green" if diagnosis.verdict is Verdict.ADEQUATE else "yellow"
    out.print(diagnosis.sentence, style=style, highlight=False, markup=False)
    for misfit in diagnosis.worst[1:4] if diagnosis.verdict is Verdict.UNEXPLAINED else ():
        out.print(f"  {misfit.sentence}", highlight=False, markup=False)
    if diagnosis.causes:
        out.print(tables.causes_table(diagnosis))
    show_nameplate(diagnosis.nameplate, told=diagnosis.sentence)
    in_sentence = diagnosis.verdict in (Verdict.NAMED, Verdict.TIED, Verdict.DESCRIBED)  # it has the gain
    missing = list(missing_lines(diagnosis.missing))[1:] if diagnosis.missing else []  # the first is in the sentence
    sentences = [
        *missing,
        *tie_sentences(diagnosis),
        next_run_sentence(diagnosis),
        "" if in_sentence else gain_sentence(diagnosis),
        diagnosis.character,
        hidden_effects_sentence(diagnosis),
    ]
    for words in filter(None, sentences):
        out.print(words, highlight=False, markup=False)


def show_nameplate(check: NameplateCheck, *, told: str = "") -> None:
    """Print what the fit pulls at in the config, and the findings that are not in the text `told`."""
    table = tables.nameplate_table(check)
    if table is None:
        out.print(NOTHING_PULLED, highlight=False, markup=False)
    else:
        out.print(table)
    for finding, words in zip(check.findings, finding_sentences(check), strict=True):
        if finding.words not in told:
            out.print(words, highlight=False, markup=False)


def write_extended(path: Path, rig: RigConfig, diagnosis: Diagnosis) -> RigConfig:
    """Write and return the config of `rig` extended by the named causes. Raises DataError if none was named."""
    if diagnosis.cut_short:
        raise DataError(f"{path}: not written: the diagnosis was cut short, and what it leaves is not tested")
    extended = extend_rig(rig, diagnosis)
    if extended is None:
        raise DataError(f"{path}: not written: no cause was named that extends the model")
    write_whole_text(path, extended.text)
    return extended


def extend_rig(rig: RigConfig, diagnosis: Diagnosis) -> RigConfig | None:
    """Return the rig with the chosen causes added to the effects of its model; None if none was chosen."""
    chosen = {cause.label: _extension(cause) for cause in diagnosis.causes if cause.chosen and not cause.nameplate}
    if not chosen:
        return None
    return extend(rig, tuple(({effect.label: effect for effect in rig.effects} | chosen).values()))


def _extension(cause: Cause) -> Extension:
    sigmas = {name: sigma for name, sigma in cause.sigmas.items() if math.isfinite(sigma)}
    return Extension(name=cause.effect, where=cause.where, parameters=cause.theta, sigmas=sigmas)

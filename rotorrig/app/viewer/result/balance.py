"""A balance in the result view: the correction in words, and the vectors before and as predicted after."""

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.text import (
    CONVENTION,
    correction_rows,
    grade_sentence,
    hole_lines,
    known_sentences,
    mounted_sentence,
)
from rotorrig.app.viewer.plots import DOWN, MODEL_DOWN, MODEL_UP, UP, PolarPicture, displayable
from rotorrig.app.viewer.result.data import Result
from rotorrig.balancing import DIRECTIONS, Balance
from rotorrig.rig.config import RPM

MOVED = (176, 132, 214)  # the arrow of the largest vector
COLOURS = {1: (UP, MODEL_UP), -1: (DOWN, MODEL_DOWN), 0: (UP, MODEL_UP)}  # before, after


def draw_balance(stream: rr.RecordingStream, result: Result) -> None:
    """Draw the balance of a result, if it has one."""
    if result.balance is None:
        return
    words = displayable(_words(result.balance))
    stream.log("correction", rr.TextDocument(words, media_type=rr.MediaType.MARKDOWN), static=True)
    for probe in np.unique(result.balance.prediction.probe).tolist():
        _draw_probe(stream, result, result.balance, probe)


def _draw_probe(stream: rr.RecordingStream, result: Result, balance: Balance, p: int) -> None:
    prediction, rig = balance.prediction, result.response.rig
    name = prediction.probes[p]
    picture = PolarPicture(
        stream,
        f"balance/{name}",
        title=f"{name}: 1X before and with the masses on, {result.unit.name}",
        probe_angle=rig.probe(name).angle,
        rotation=rig.rotation,
        static=True,
        unit=result.unit,
    )
    curves = []
    rpm: dict[str, NDArray[np.float64]] = {}
    for way, (before, after) in COLOURS.items():
        rows = prediction.rows_of(p, way)
        if rows.size:
            curves += [
                (f"{DIRECTIONS[way]}-before", prediction.before[rows], before),
                (f"{DIRECTIONS[way]}-after", prediction.after[rows], after),
            ]
            rpm = rpm or {f"{DIRECTIONS[way]}-before": prediction.omega[rows] * RPM}  # of one path is enough
    picture.draw(curves, rpm=rpm)
    mine = np.flatnonzero(prediction.probe == p)
    largest = mine[np.argmax(np.abs(prediction.before[mine]))]
    picture.arrow("moved", np.array([prediction.before[largest], prediction.after[largest]]), MOVED)


def _words(balance: Balance) -> str:
    """Return the correction as Markdown: a table, what to mount, what is known of it."""
    head = ["plane", "by", "amount", "angle"]
    told = [[plane, by, amount, angle] for plane, by, amount, _, angle, _ in correction_rows(balance)]
    rows = [" | ".join(cells) for cells in (head, ["---"] * len(head), *told)]
    lines = [f"- {line}" for line in (*hole_lines(balance), *known_sentences(balance))]
    said = [mounted_sentence(balance), grade_sentence(balance)]
    key = "Blue and orange: before; pale: as predicted with the masses on; violet: what they do to the largest vector."
    convention = f"{CONVENTION[0].upper()}{CONVENTION[1:]}."
    return "\n".join([convention, "", *rows, "", *lines, "", "\n\n".join([*said, key])])

"""What a model lacks, in the result view: in words, where along the shaft, and its force over speed and motion."""

import numpy as np
import rerun as rr

from rotorrig.app.text import missing_lines
from rotorrig.app.viewer.plots import (
    BACKWARD,
    FORWARD,
    MODEL_DOWN,
    MODEL_UP,
    SpeedPicture,
    displayable,
)
from rotorrig.app.viewer.result.data import Result
from rotorrig.app.viewer.result.missing.over_motion import ForceOverMotionPicture
from rotorrig.app.viewer.result.missing.place import LikelyPlacePicture
from rotorrig.identify.discovery import ForceOverSpeed, MissingForce
from rotorrig.rig.config import RPM

PATH = "missing"
SENSES = (("forward", FORWARD, MODEL_UP), ("backward", BACKWARD, MODEL_DOWN))  # as measured, by the law
MILLI = 1e3


def draw_missing(stream: rr.RecordingStream, result: Result) -> None:
    """Draw what the diagnosis of a result found missing, if it has that."""
    if result.diagnosis is None or (missing := result.diagnosis.missing) is None:
        return
    lines = [f"- {line}" for line in missing_lines(missing)]
    words = displayable("\n".join([f"**{_heading(missing.shortfall)}**", "", *lines]))
    stream.log(f"{PATH}/words", rr.TextDocument(words, media_type=rr.MediaType.MARKDOWN), static=True)
    if missing.places.size:
        place = LikelyPlacePicture(stream, f"{PATH}/place", result.response.rig)
        place.draw(missing.places, missing.probability, FORWARD)
    if missing.over_speed is not None:
        _draw_force(stream, result, missing, missing.over_speed)


def _draw_force(stream: rr.RecordingStream, result: Result, missing: MissingForce, over: ForceOverSpeed) -> None:
    """Draw the force over speed, and the part that turns with the shaft over the motion of its place."""
    drawn = []
    for i, (name, measured, law) in enumerate(SENSES):
        for what, force, colour in (("measured", over.force, measured), ("law", over.law, law)):
            drawn.append((f"{name}/{what}", over.omega * RPM, np.abs(force[:, i]) * MILLI, colour))
    unit = "mN m" if missing.kind == "moment" else "mN"
    title = f"{missing.kind} at {1e3 * missing.place:.0f} mm, {unit} 0-peak"
    picture = SpeedPicture(stream, f"{PATH}/force", title=title, fastest=result.fastest)
    names = [(f"{name}{of}", c) for name, *each in SENSES for of, c in zip(("", ", by the law"), each, strict=True)]
    picture.draw(drawn, names=names)
    against = ForceOverMotionPicture(
        stream,
        f"{PATH}/motion",
        title=f"{missing.kind} that turns with the shaft, {unit} 0-peak",
        unit=result.unit.name,
    )
    motion, with_shaft, by_law = (np.abs(values[:, 0]) for values in (over.motion, over.force, over.law))
    against.draw(motion * result.unit.by, with_shaft * MILLI, by_law * MILLI, colours=SENSES[0][1:])


def _heading(shortfall: str) -> str:
    return f"What comes nearest, no finding: {shortfall}" if shortfall else "What is missing"

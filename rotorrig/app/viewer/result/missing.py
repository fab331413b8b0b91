"""What a model lacks, in the result view: in words, and its force over speed as measured and by its law."""

import numpy as np
import rerun as rr

from rotorrig.app.text import missing_lines
from rotorrig.app.viewer.plots import BACKWARD, FORWARD, MODEL_DOWN, MODEL_UP, SpeedPicture, displayable
from rotorrig.app.viewer.result.data import Result
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
    if (over := missing.over_speed) is None:
        return
    drawn = []
    for i, (name, measured, law) in enumerate(SENSES):
        for what, force, colour in (("measured", over.force, measured), ("law", over.law, law)):
            drawn.append((f"{name}/{what}", over.omega * RPM, np.abs(force[:, i]) * MILLI, colour))
    unit = "mN m" if missing.kind == "moment" else "mN"
    title = f"{missing.kind} at {1e3 * missing.place:.0f} mm, {unit} 0-peak"
    picture = SpeedPicture(stream, f"{PATH}/force", title=title, fastest=result.fastest)
    legend = [(f"{name}{of}", c) for name, *each in SENSES for of, c in zip(("", ", by the law"), each, strict=True)]
    picture.draw(drawn, legend=legend)


def _heading(shortfall: str) -> str:
    return f"What comes nearest, no finding: {shortfall}" if shortfall else "What is missing"

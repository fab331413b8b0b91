"""The speed a result opens at: where model and measurement part most.

A layout of Rerun (0.41) has no place for the cursor, and a viewer plays the timeline of a file to its end. So the speed
stands in the file as a property, and `rotor view` moves the cursor there; a viewer started by other means does not.
"""

import contextlib
import warnings
from pathlib import Path

import numpy as np
import rerun as rr
from rerun.chunk import RrdReader

from rotorrig.app.viewer.result.data import Result
from rotorrig.identify import Verdict
from rotorrig.rig.config import RPM

TIMELINE = "speed_rpm"
PROPERTY, FIELD = "rotorrig", "opens_at_rpm"


def opening_rpm(result: Result, rows: list[int]) -> int | None:
    """Return the shown speed [rpm] nearest to the largest misfit; without one to speak of, that of the largest vector.

    `rows` are those the cursor can stand at; None if there is none.
    """
    if not rows:
        return None
    rpm = result.rpm[rows]
    size = np.nan_to_num(np.abs(result.z[rows]).max(axis=1))
    wanted = rpm[int(np.argmax(size))]
    if (diagnosis := result.diagnosis) and diagnosis.verdict is not Verdict.ADEQUATE and diagnosis.worst:
        wanted = RPM * (diagnosis.worst[0].speed_from + diagnosis.worst[0].speed_to) / 2
    return round(float(rpm[int(np.argmin(np.abs(rpm - wanted)))]))


def note_opening(stream: rr.RecordingStream, rpm: int | None) -> None:
    """Write the speed into the file, if there is one."""
    if rpm is not None:
        stream.send_property(PROPERTY, rr.AnyValues(drop_untyped_nones=True, **{FIELD: rpm}))


def read_opening(path: Path) -> int | None:
    """Return the speed [rpm] an .rrd says it opens at; None if it says nothing, or cannot be read."""
    with contextlib.suppress(RuntimeError), warnings.catch_warnings():  # what is wrong with a file, the viewer says
        warnings.simplefilter("ignore")
        for chunk in RrdReader(str(path)).stream():
            if str(chunk.entity_path).strip("/") == f"__properties/{PROPERTY}":
                batch = chunk.to_record_batch()
                column = next((name for name in batch.schema.names if name.endswith(FIELD)), None)
                return None if column is None else int(batch.column(column)[0].as_py()[0])
    return None

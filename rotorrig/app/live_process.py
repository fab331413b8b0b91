"""The process that tracks and draws a live view.

`python -m rotorrig.app.live_process`, started by `LiveView`. Standard input: see live_pipe. Standard output: a line
when it is ready. Standard error: one sentence if it cannot go on.
"""

import contextlib
import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import rerun as rr

from rotorrig.app.blueprint import live_blueprint
from rotorrig.app.live_pipe import READY, BlockReader
from rotorrig.app.live_scene import LiveScene
from rotorrig.app.sinks import Sink
from rotorrig.rig.description import RigConfig
from rotorrig.rig.errors import RigError
from rotorrig.rig.probes.base import Block

FRAME = 0.12  # s of wall time between pictures
_NICENESS = 5  # a picture is worth less than a sample


def main() -> int:
    """Track and draw what comes in, until its end; return 0, or 1 after one sentence on standard error."""
    with contextlib.suppress(OSError):
        os.nice(_NICENESS)
    try:
        _draw_all(BlockReader(sys.stdin.fileno()))
    except Exception as error:  # for whoever started this to say
        print(f"{type(error).__name__}: {error}", file=sys.stderr)
        return 1
    return 0


def _draw_all(reader: BlockReader) -> None:
    rig, info, targets = reader.opening()
    stream = open_stream(rig, "live", targets)
    scene = LiveScene(rig, info, stream)
    os.write(sys.stdout.fileno(), READY)
    while not reader.ended:
        if blocks := reader.blocks(FRAME):
            for block in joined(blocks):
                scene.take(block)
            scene.draw()
    for block in joined(reader.blocks(0.0)):
        scene.take(block)
    scene.draw(last=True)
    stream.disconnect()


def open_stream(rig: RigConfig, kind: str, targets: Sequence[str | Path]) -> rr.RecordingStream:
    """Return a stream of pictures to viewers' addresses and files. Raises RigError if there are none."""
    if not targets:
        raise RigError("live view: the sink has nowhere to write to, want one of serve() or to_file()")
    stream = rr.RecordingStream("rotorrig run", recording_id=f"{kind}-{time.time_ns():x}")
    stream.set_sinks(*Sink(targets=tuple(targets)).opened(), default_blueprint=live_blueprint(rig))
    stream.send_recording_name(f"{rig.name}, {kind}")
    return stream


def joined(blocks: list[Block]) -> list[Block]:
    """Return the blocks with those that follow on each other put together: tracking pays per call."""
    runs: list[list[Block]] = []
    for block in blocks:
        last = runs[-1][-1] if runs else None
        if last is not None and block.first_sample == last.first_sample + len(last.counts):
            runs[-1].append(block)
        else:
            runs.append([block])
    return [
        Block(counts=np.concatenate([b.counts for b in run]), first_sample=run[0].first_sample, t_ns=run[0].t_ns)
        for run in runs
    ]


if __name__ == "__main__":
    sys.exit(main())

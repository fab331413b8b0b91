"""The process that tracks and draws a live view.

`python -m rotorrig.app.viewer.live.process`, started by `LiveView`. Standard input: see pipe.py. Standard output: a
line when it is ready. Standard error: one sentence if it cannot go on.
"""

import contextlib
import os
import sys
import time
from collections.abc import Sequence
from datetime import timedelta
from pathlib import Path
from typing import Literal

import numpy as np
import rerun as rr

from rotorrig.app.viewer.live.data import STEP
from rotorrig.app.viewer.live.parts import LiveScene, live_blueprint, replay_blueprint
from rotorrig.app.viewer.live.pipe import READY, BlockReader
from rotorrig.app.viewer.plots import displayable
from rotorrig.app.viewer.sinks import Sink
from rotorrig.rig import RigError
from rotorrig.rig.config import RigConfig
from rotorrig.rig.probes import Block

FRAME = 0.12  # s of wall time between pictures
VIEWER_TICK = timedelta(milliseconds=20)  # what is drawn waits this long for more
FILE_TICK = timedelta(seconds=15)  # in a file each such batch costs about two kilobytes per thing drawn
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
    opening = reader.opening()
    stream = open_stream(opening.rig, "live" if opening.events is None else "replay", opening.targets)
    scene = LiveScene(opening.rig, opening.info, stream, events=opening.events or (), unit=opening.unit)
    most = max(1, round(STEP * opening.info.sample_rate))
    os.write(sys.stdout.fileno(), READY)
    while not reader.ended:
        if blocks := reader.blocks(FRAME):
            for block in join_blocks(blocks, most=most):
                scene.take(block)
            scene.draw()
    for block in join_blocks(reader.blocks(0.0), most=most):
        scene.take(block)
    scene.draw(last=True)
    stream.disconnect()


def open_stream(rig: RigConfig, kind: Literal["live", "replay"], targets: Sequence[str | Path]) -> rr.RecordingStream:
    """Return a stream of pictures to viewers' addresses and files. Raises RigError if there are none."""
    if not targets:
        raise RigError("live view: the sink has nowhere to write to, want one of serve() or to_file()")
    batches = rr.ChunkBatcherConfig.DEFAULT()
    batches.flush_tick = FILE_TICK if all(isinstance(target, Path) for target in targets) else VIEWER_TICK
    # a viewer keeps a layout per application from one day to the next: either kind is one, and its own is made active
    stream = rr.RecordingStream(f"rotorrig {kind}", recording_id=f"{kind}-{time.time_ns():x}", batcher_config=batches)
    stream.set_sinks(*Sink(targets=tuple(targets)).open_targets())
    stream.send_blueprint(live_blueprint(rig) if kind == "live" else replay_blueprint(rig))
    stream.send_recording_name(displayable(f"{rig.name}, {kind}"))
    return stream


def join_blocks(blocks: list[Block], *, most: int = sys.maxsize) -> list[Block]:
    """Return the blocks with those that follow on each other put together, to about `most` scans.

    Tracking pays per call; what is seen of a waveform is the last turns of each.
    """
    runs: list[list[Block]] = []
    scans = 0
    for block in blocks:
        last = runs[-1][-1] if runs else None
        scans += len(block.counts)
        if last is not None and scans <= most and block.first_sample == last.first_sample + len(last.counts):
            runs[-1].append(block)
        else:
            runs.append([block])
            scans = len(block.counts)
    return [
        Block(counts=np.concatenate([b.counts for b in run]), first_sample=run[0].first_sample, t_ns=run[0].t_ns)
        for run in runs
    ]


if __name__ == "__main__":
    sys.exit(main())

"""Read a recording of the recorder's benchmark and compare every sample with what was sent.

`python -m benchmarks.parts.recorder.read RUN.mcap SIGNAL.npz STOPPING`, the scan from which on the rotor slowed down;
prints a JSON object: scans missing and wrong, seconds and the bytes of memory that reading took.
"""

import json
import sys
import time
from pathlib import Path

import numpy as np

from rotorrig.acquisition.files import read_recording


def main() -> None:
    """Read, compare, print."""
    before, began = _peak(), time.monotonic()
    recording = read_recording(Path(sys.argv[1]))
    segments = recording.segments()
    seconds, taken = time.monotonic() - began, _peak() - before
    with np.load(sys.argv[2]) as file:
        loops = [(file["rest"], 0), (file["running"], 0), (file["stopping"], int(sys.argv[3]))]
    wrong = 0
    for block in recording.blocks:
        scans = block.first_sample + np.arange(len(block.counts))
        wrong += min(
            int((block.counts != loop[(scans - begin) % len(loop)]).any(axis=1).sum()) for loop, begin in loops
        )
    first, counts = segments[-1]
    missing = first + len(counts) - recording.samples
    print(json.dumps({"missing": missing, "wrong": wrong, "seconds": seconds, "rss": taken}))


def _peak() -> int:
    """Return the most memory this process has had, in bytes; getrusage would count its parent's."""
    (line,) = (line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
    return 1024 * int(line.split()[1])


if __name__ == "__main__":
    main()

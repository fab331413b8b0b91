"""Peak memory of `rotor`: `python -m benchmarks.parts.tracking.memory track run.mcap --out response.mcap`.

The last line is the peak in bytes, of this process alone: what `wait` tells of a child includes its parent's.
"""

from pathlib import Path

from rotorrig.app.cli import main


def peak() -> int:
    """Return the largest resident size of this process so far [bytes]; Linux."""
    lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    (kilobytes,) = (line.split()[1] for line in lines if line.startswith("VmHWM:"))
    return 1024 * int(kilobytes)


if __name__ == "__main__":
    try:
        main()
    except SystemExit as end:
        if end.code:
            raise
    print(peak())

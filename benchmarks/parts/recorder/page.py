"""docs/recorder.md: what benchmarks/recorder.py measured, in words and tables."""

import numpy as np

from benchmarks.parts.recorder.report import Report
from benchmarks.parts.tables import markdown

HEAD = """# The recorder under load

Measured by `python benchmarks/recorder.py`, which made this page. The DAQ is a process that sends 8 channels at 50 kS/s
over a pseudo-terminal in the framed serial stream (docs/daq-stream.md), the drive an emulated PowerFlex 400 on Modbus
RTU at 19200 baud. The engine of `rotor sweep` records, in a process of its own. The samples are those of a simulated
RK4 at 3000 rpm, computed before; every recorded sample is compared with what was sent.

The machine had {cores} cores, and {load:.1f} programs at work on them at a time, on average: these and others.
"""
VIEWERS = {
    "none": "without a viewer",
    "attached": "with a viewer",
    "hung": "with a viewer that hangs (SIGSTOP)",
    "killed": "with a viewer that dies (kill -9)",
}


def page(report: Report) -> str:
    """Return the page."""
    head = HEAD.format(cores=report.cores, load=report.load)
    measured = {long_run: report.samples, trips: report.trips_ms, kills: report.kills_lost_s}
    return "\n".join([head, *(f"{section(report)}\n" for section, found in measured.items() if found)])


def long_run(report: Report) -> str:
    """Return the section on the long recording."""
    return f"""## {report.minutes:g} minutes, with a viewer attached

- {report.samples} scans of 8 channels recorded, {report.samples_lost} lost or wrong.
- The recording process (DAQ reader, sweep, interlock, motor, recorder) took {100 * report.cpu_share:.1f} % of one core;
  tracking and drawing have a process of their own.
- {report.file_bytes / 1e6:.0f} MB for {16 * report.samples / 1e6:.0f} MB of int16: {report.compression:.3f}.
- Reading it back takes {report.read_s:.0f} s and {report.read_rss / 1e6:.0f} MB of memory,
  {report.read_rss / report.file_bytes:.1f} times the file: its samples as 32 bit numbers, once."""


def trips(report: Report) -> str:
    """Return the section on trips."""
    head = ["", "trips", "median, ms", "p99, ms", "worst, ms"]
    rows = []
    for name, words in VIEWERS.items():
        if found := report.trips_ms.get(name):
            figures = (np.median(found), np.percentile(found, 99), max(found))
            rows.append([words, str(len(found)), *(f"{ms:.1f}" for ms in figures)])
    return f"""## From the sample to the stop

From the moment the last byte of the first frame beyond the vibration limit is on the port to the moment the emulated
drive has obeyed the stop: an exchange under way and the stop's own 8 bytes at 19200 baud are in it. Trips missed:
{report.missed_trips}. A viewer is disturbed after a third of its trips.

{markdown(head, rows)}

Of that, {_median_p99(report.decided_ms)} pass from a block's receipt by the sweep to its decision, and
{_median_p99(report.handed_ms)} until the drive's driver is called; the rest is the
wire's and the machine's."""


def kills(report: Report) -> str:
    """Return the section on kill -9."""
    lost = report.kills_lost_s
    return f"""## kill -9

The recording process was killed {len(lost)} times at a random moment, and what it left was salvaged. Everything older
than {1e3 * max(lost):.0f} ms before the kill was there each time, {1e3 * float(np.median(lost)):.0f} ms in the median.
That is counted from the moment the first missing sample was taken, so the 20 ms of a frame, the port and all queues are
in it. The `mcap` package read all the files; {report.kills_bad} of them held anything else than what was sent."""


def _median_p99(ms: list[float]) -> str:
    return f"{np.median(ms):.1f} ms (p99 {np.percentile(ms, 99):.1f} ms)"

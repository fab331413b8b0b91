"""The recorder under load: 8 channels at 50 kS/s over a serial port, a Modbus drive, sweeps by the engine itself.

`python benchmarks/recorder.py [--minutes 10] [--kills 50] [--trips 120] [--write] [--json]`

Measures what share of a core a long recording takes and whether a sample is lost; how soon a stop reaches the drive
after the sample that called for it, without a viewer, with one, with one that hangs and one that dies; what is lost to
`kill -9`; how far samples are compressed. Rig, recording process and viewer are processes of their own. The last line
is a JSON object; `--json` prints nothing else. `--write` makes docs/recorder.md.
"""

import argparse
import contextlib
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any, get_args

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np
from mcap.reader import make_reader

from benchmarks.parts.recorder import page
from benchmarks.parts.recorder.report import Report
from benchmarks.parts.recorder.signal import write_signal
from benchmarks.parts.recorder.sweep import Task, Viewer
from rotorrig.acquisition.files import read_recording, salvage
from rotorrig.rig.config import RigConfig, load, parse

ROOT = Path(__file__).parents[1]
CHANNELS, RATE = 8, 50_000.0
LOUD_AFTER = (0.2, 0.7)  # s at speed before a trip: at any moment of the motor's polling
KILL_AFTER = (0.3, 2.5)  # s of recording
PATIENCE = 60.0  # s for a process to begin or end
THIRD_PLANE = """
[[probes]]
name = "3x"
position = "440 mm"
angle = "0 deg"
channel = 4

[[probes]]
name = "3y"
position = "440 mm"
angle = "90 deg"
channel = 5

[keyphasor]
channel = 7
"""


def main() -> None:
    """Measure, print the report and its summary."""
    given = _arguments()
    report = Report(minutes=given.minutes)
    say = (lambda *_: None) if given.json else print
    with tempfile.TemporaryDirectory(prefix="recorder-", dir=given.folder) as folder:
        bench = Bench(Path(folder))
        if given.minutes:
            measure_long_run(bench, report)
            say(page.long_run(report))
        if given.trips:
            measure_trips(bench, report, each=max(1, given.trips // len(get_args(Viewer))))
            say(page.trips(report))
        if given.kills:
            measure_kills(bench, report, kills=given.kills)
            say(page.kills(report))
    report.load = os.getloadavg()[2]
    if given.write:
        (ROOT / "docs/recorder.md").write_text(page.page(report))
    print(json.dumps(report.summary()))


class Bench:
    """The rig's config and samples in a folder, and processes that use them."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.config, self.signal = folder, folder / "rig.toml", folder / "signal.npz"
        self.config.write_text(_config_text())
        self.rig: RigConfig = load(self.config)
        write_signal(self.signal, self.rig)

    @contextmanager
    def emulated(self, *, loud: tuple[float, float] | None = None) -> Iterator["Teller"]:
        """Run the rig while the block does."""
        words = [str(self.config), str(self.signal), *(["--loud", *map(str, loud)] if loud else [])]
        with _process("benchmarks.parts.recorder.rig", *words) as process:
            yield Teller(process)

    @contextmanager
    def recording(self, ports: dict[str, Any], **fields: Any) -> Iterator[subprocess.Popen[bytes]]:
        """Run the recording process while the block does, or until it ends."""
        task = Task(config=str(self.config), motor=ports["motor"], daq=ports["daq"], **fields)
        with _process("benchmarks.parts.recorder.sweep", json.dumps(asdict(task))) as process:
            yield process


class Teller:
    """Collects the lines of JSON a process prints, with no one waiting for it."""

    def __init__(self, process: subprocess.Popen[bytes]) -> None:
        self.said: list[dict[str, Any]] = []
        self._process = process
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    def ports(self) -> dict[str, Any]:
        """Wait for the line that names the ports and return it."""
        return self.wait_for("daq")

    def wait_for(self, key: str, *, after: int = 0) -> dict[str, Any]:
        """Wait for a line with this key among those from number `after` on, and return it."""
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            for line in self.said[after:]:
                if key in line:
                    return line
            time.sleep(0.002)
        raise TimeoutError(f"the rig said nothing of '{key}' in {PATIENCE:g} s")

    def all_of(self, key: str) -> list[Any]:
        """Return the values of a key in all lines so far."""
        return [line[key] for line in self.said if key in line]

    def _listen(self) -> None:
        assert self._process.stdout
        for line in self._process.stdout:
            self.said.append(json.loads(line))


def measure_long_run(bench: Bench, report: Report) -> None:
    """Record for `report.minutes` with a viewer attached, then look at every sample of the file."""
    with bench.emulated() as rig:
        out = bench.folder / "long"
        with bench.recording(rig.ports(), out=str(out), seconds=60 * report.minutes, viewer="attached") as process:
            lines = _lines(process, patience=60 * report.minutes + PATIENCE)
        (unsent,), (stopping,) = rig.all_of("lost"), rig.all_of("stopping")
    result = lines[0]
    report.cpu_share = result["cpu_s"] / result["wall_s"]
    path = Path(result["out"])
    report.samples, report.file_bytes = result["samples"], path.stat().st_size
    report.compression = report.file_bytes / (2 * CHANNELS * report.samples)
    read = json.loads(_run("benchmarks.parts.recorder.read", str(path), str(bench.signal), str(stopping)))
    report.read_s, report.read_rss = read["seconds"], read["rss"]
    report.samples_lost = unsent + read["missing"] + read["wrong"]
    path.unlink()


def measure_trips(bench: Bench, report: Report, *, each: int) -> None:
    """Let the rotor vibrate too much, again and again; a viewer is disturbed after a third of the sweeps."""
    for viewer in get_args(Viewer):
        with bench.emulated(loud=LOUD_AFTER) as rig:
            out = bench.folder / f"trip-{viewer}"
            with bench.recording(rig.ports(), out=str(out), seconds=30.0, sweeps=each, viewer=viewer) as process:
                lines = _lines(process, patience=40.0 * each + PATIENCE)
            found = rig.all_of("trip_s")
        report.trips_ms[viewer] = [1e3 * seconds for seconds in found if seconds is not None]
        tripped = [line for line in lines if line.get("trip", "").startswith("probe")]
        report.decided_ms += [1e3 * line["decided_s"] for line in tripped]
        report.handed_ms += [1e3 * line["handed_s"] for line in tripped]
        report.missed_trips += each - min(len(report.trips_ms[viewer]), len(tripped))
        for file in bench.folder.glob("trip-*"):
            file.unlink()


def measure_kills(bench: Bench, report: Report, *, kills: int) -> None:
    """Kill the recording process at a random moment, salvage what it left, and compare that with what was sent."""
    with bench.emulated() as rig:
        ports = rig.ports()
        with np.load(bench.signal) as loops:
            kinds = {name: loops[name] for name in ("rest", "running")}
        for number in range(kills):
            heard = len(rig.said)
            with bench.recording(ports, out=str(bench.folder / f"kill{number}"), seconds=60.0) as process:
                began = rig.wait_for("start", after=heard)["start"]
                time.sleep(random.uniform(*KILL_AFTER))
                killed = time.monotonic()
                process.send_signal(signal.SIGKILL)
                process.wait()
            part, saved = (bench.folder / f"kill{number}.{end}" for end in ("0.mcap.part", "saved.mcap"))
            salvage(part, saved)
            with saved.open("rb") as file:
                for _ in make_reader(file, validate_crcs=True).iter_messages():
                    pass
            read = read_recording(saved)
            upto = read.blocks[-1].first_sample + len(read.blocks[-1].counts)
            report.kills_lost_s.append(killed - (began + upto / RATE))
            report.kills_bad += upto != read.samples or any(
                _wrong(b.counts, b.first_sample, kinds) for b in read.blocks
            )
            part.unlink(), saved.unlink()


def _wrong(counts: np.ndarray, first: int, kinds: dict[str, np.ndarray]) -> bool:
    """Return whether a block is none of the frames that could have been sent for it."""
    return not any(
        np.array_equal(counts, loop[(first + np.arange(len(counts))) % len(loop)]) for loop in kinds.values()
    )


@contextmanager
def _process(module: str, *words: str) -> Iterator[subprocess.Popen[bytes]]:
    """Run a module of the checkout in a process that ends with the block."""
    process = subprocess.Popen(
        [sys.executable, "-m", module, *words], cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    assert process.stdin and process.stdout
    try:
        yield process
    finally:
        with contextlib.suppress(BrokenPipeError):
            process.stdin.close()
        try:
            process.wait(5.0)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        process.stdout.close()


def _lines(process: subprocess.Popen[bytes], *, patience: float) -> list[dict[str, Any]]:
    """Wait for a process to end and return the lines of JSON it printed."""
    assert process.stdout
    overdue = threading.Timer(patience, process.kill)
    overdue.start()
    lines = [json.loads(line) for line in process.stdout.read().splitlines()]
    overdue.cancel()
    if process.wait():
        raise RuntimeError(f"the recording process ended with {process.returncode}")
    return lines


def _run(module: str, *words: str) -> bytes:
    return subprocess.run([sys.executable, "-m", module, *words], cwd=ROOT, stdout=subprocess.PIPE, check=True).stdout


def _config_text() -> str:
    """Return configs/rk4.toml with a third probe plane, the keyphasor on channel 7 and 50 kHz."""
    text = (ROOT / "configs/rk4.toml").read_text()
    for old, new in (('sample_rate = "10 kHz"', 'sample_rate = "50 kHz"'), ("[keyphasor]\nchannel = 4\n", THIRD_PLANE)):
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    parse(text, where="the benchmark's config")
    return text


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="The recorder under load.")
    parser.add_argument("--minutes", type=float, default=10.0, help="of the long recording; 0: none")
    parser.add_argument("--trips", type=int, default=120, help="0: none")
    parser.add_argument("--kills", type=int, default=50, help="0: none")
    parser.add_argument("--folder", type=Path, help="where recordings are written for the time being")
    parser.add_argument("--write", action="store_true", help="docs/recorder.md")
    parser.add_argument("--json", action="store_true", help="print the summary alone")
    return parser.parse_args()


if __name__ == "__main__":
    main()

"""How exact and how quick `rotor track` is, beside rota-order and a plain scipy script, on run-ups in closed form.

    make tracking                               (writes docs/tracking.md)
    python benchmarks/tracking.py --json        (one JSON object on the last line)

Every recording goes through a file `run.mcap`, as a user's does. Times are of the process's CPU in one thread, the
best of some rounds. The live view's latency is measured in real time, through its own process and a viewer.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np
from numpy.typing import NDArray

from benchmarks.parts.tracking import page as tracking_page
from benchmarks.parts.tracking import peers
from benchmarks.parts.tracking.accuracy import Coverage, Score, instant_truth, windowed_truth
from benchmarks.parts.tracking.figures import Figures
from benchmarks.parts.tracking.live import measure_latency
from benchmarks.parts.tracking.page import METHODS
from benchmarks.parts.tracking.signal import RunUp, resonant, standard, without, write_run
from docs.tracking_drawing import windows
from rotorrig.acquisition import RawRecording
from rotorrig.acquisition.files import read_recording
from rotorrig.processing import Tracking, track
from rotorrig.processing.response import Method
from rotorrig.processing.settings import USUAL
from rotorrig.rig.probes import ProbeScale, channel_volts

ROOT = Path(__file__).parents[1]
COVERED = (0.0, 1.0, 2.0, 3.0)  # orders whose truth is known: 0.47X is within the window of 0.5X
JITTERED = {"jitter": 50e-6, "missed": 0.01}
PEER_ORDERS = (1.0, 2.0, 3.0)
ENDS = 2  # rows at either end that are left out of the comparison with peers: rota-order's own advice
BANDWIDTH = 5.0  # Hz of rota's Vold-Kalman filter: 0.09 orders, ours, at 55 turns a second


def main() -> None:
    """Measure, print, and write the page if asked."""
    options = arguments()
    figures = Figures()
    if options.live_seconds:
        figures.latency = measure_latency(options.live_seconds)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        measure_memory(figures, folder)
        measure_accuracy(figures, folder)
        measure_peers(figures, folder, rounds=options.rounds)
        measure_speed(figures, folder, rounds=options.rounds)
        measure_coverage(figures, folder, draws=options.draws)
    page = tracking_page.page(figures, draws=options.draws, rounds=options.rounds)
    if options.write:
        (ROOT / "docs/tracking.md").write_text(page, encoding="utf-8")
        windows().save(ROOT / "docs/img/tracking-windows.svg")
    if not options.json:
        print(page)
    print(json.dumps(figures.summary()))


def arguments() -> argparse.Namespace:
    """Return the checked command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--draws", type=int, default=60, help="recordings for the intervals' coverage (default 60)")
    parser.add_argument("--rounds", type=int, default=5, help="samples per time (default 5)")
    parser.add_argument("--live-seconds", type=float, default=30.0, help="of live view; 0: none (default 30)")
    parser.add_argument("--json", action="store_true", help="print nothing but one JSON object")
    parser.add_argument("--write", action="store_true", help="write docs/tracking.md and its picture")
    options = parser.parse_args()
    if options.draws < 1 or options.rounds < 1:
        parser.error(f"--draws {options.draws} and --rounds {options.rounds}: want at least 1 of each")
    return options


def measure_accuracy(figures: Figures, folder: Path) -> None:
    """Score every method on every case: all that a run-up has, its parts alone, jitter, a resonance."""
    for case, run in cases().items():
        recording = read_recording(write_run(folder / "run.mcap", run))
        for method in METHODS:
            response = track(recording, Tracking(method=method))
            truth = windowed_truth(run, response)
            figures.first[case, method] = Score.of(response.order(1.0), truth, response.usable)
            figures.second[case, method] = Score.of(response.order(2.0), run.truth(2.0), response.usable)
            if run.resonance:
                figures.smear[method] = Score.of(truth, instant_truth(run, response), response.usable)


def cases() -> dict[str, RunUp]:
    """Return the run-ups: with all there is, and what is left when parts of it are taken away."""
    whole = standard()
    return {
        "ideal": whole,
        "jitter": replace(whole, **JITTERED),
        "noise alone": without(whole, orders=(0.47, 4.0, 5.0)),
        "0.47X alone": without(replace(whole, noise=0.0), orders=(4.0, 5.0)),
        "neither": without(replace(whole, noise=0.0), orders=(0.47,)),
        "resonance": resonant(),
    }


def measure_coverage(figures: Figures, folder: Path, *, draws: int) -> None:
    """Count over many recordings, two probes each, how often the 95 % intervals hold the truth."""
    for case, faults in (("ideal", {}), ("jitter", JITTERED)):
        for draw in range(draws):
            run = standard(2, seed=1 + draw, **faults)
            recording = read_recording(write_run(folder / "run.mcap", run))
            for method in METHODS:
                response = track(recording, Tracking(method=method))
                figures.coverage.setdefault((case, method), Coverage()).add(response, run, COVERED)


def measure_peers(figures: Figures, folder: Path, *, rounds: int) -> None:
    """Track the same four probes by the peers' means, in turns, and score them."""
    for suffix, faults in (("", {}), (", jitter", JITTERED)):
        run = standard(**faults)
        recording = read_recording(write_run(folder / "run.mcap", run))
        volts, x = arrays(recording)
        given = {"rate": run.rate, "orders": PEER_ORDERS}
        works: dict[str, Callable[[], NDArray[np.complex128]]] = {
            "ours": lambda recording=recording: ours(recording, USUAL.method),
            "ours, Vold-Kalman": lambda recording=recording: ours(recording, "vold-kalman"),
            "rota-order": lambda v=volts, x=x, g=given: peers.rota_harmonics(v, x, turns=8, **g),
            "plain scipy": lambda v=volts, x=x, g=given: peers.plain_scipy(v, x, turns=8, **g),
        }
        for name, work in works.items():
            figures.peers[name + suffix] = scored(work(), run)
            figures.seconds.setdefault(name, timed(work, rounds))
        began = time.process_time()
        slow = peers.rota_vold_kalman(volts, x, turns=8, bandwidth=BANDWIDTH, **given)
        figures.seconds["rota-order, Vold-Kalman"] = time.process_time() - began
        figures.peers["rota-order, Vold-Kalman" + suffix] = scored(slow, run)


def ours(recording: RawRecording, method: Method) -> NDArray[np.complex128]:
    """Return the vectors of the orders that peers are compared on, (row, probe, order); NaN where not usable."""
    response = track(recording, Tracking(method=method, orders=(0.0, *PEER_ORDERS)))
    return np.where(response.usable[..., None], response.z[..., 1:], np.nan)


def scored(z: NDArray[np.complex128], run: RunUp) -> Score:
    """Score the 1X of z (row, probe, order), the ends left out."""
    first = z[ENDS:-ENDS, :, 0]
    return Score.of(first, run.truth(1.0), np.isfinite(first))


def arrays(recording: RawRecording) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the keyphasor's volts (sample,) and the probes' metres (sample, probe)."""
    ((_, counts),) = recording.segments()
    channel = recording.rig.keyphasor.channel
    scale = ProbeScale.of(recording.rig, recording.daq)
    return channel_volts(counts, channel=channel, info=recording.daq), scale.displacement(counts)


def measure_speed(figures: Figures, folder: Path, *, rounds: int) -> None:
    """Time the whole of `track`: seconds of one probe's samples in a second of CPU."""
    for probes in (1, 8):
        run = standard(probes)
        recording = read_recording(write_run(folder / "run.mcap", run))
        for method in METHODS:
            seconds = timed(lambda m=method, r=recording: track(r, Tracking(method=m)), rounds)
            figures.realtime[method, probes] = probes * run.seconds / seconds


def timed(work: Callable[[], object], rounds: int) -> float:
    """Return the least CPU time [s] of some rounds: what is above it is other work's; compiled before."""
    work()
    samples = []
    for _ in range(rounds):
        began = time.process_time()
        work()
        samples.append(time.process_time() - began)
    return min(samples)


def measure_memory(figures: Figures, folder: Path) -> None:
    """Track files of once and ten times the length with `rotor track`, each in a process of its own."""
    for seconds in (30.0, 300.0):
        file = write_run(folder / "long.mcap", standard(seconds=seconds))
        for method in METHODS:
            words = ["track", str(file), "--method", method, "--out", str(folder / f"{method}-{seconds:.0f}.mcap")]
            command = [sys.executable, "-m", "benchmarks.parts.tracking.memory", *words]
            said = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True, cwd=ROOT).stdout
            figures.memory[method, seconds] = int(said.splitlines()[-1])


if __name__ == "__main__":
    main()

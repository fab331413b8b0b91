"""How long after its last sample a row's vector stands in the live view: 8 channels at 50 kS/s in real time.

Blocks of 20 ms, as the DAQ's driver hands them on, go to the view's own process when they are due; its stream goes to a
viewer of its own process and to a file. In between is a relay that notes when bytes arrive, for a stream does not say
when it was received. A picture of the Bode plots at sample time T, logged at L, has all rows that ended before T; it
has arrived when the burst of bytes after L is over.
"""

import socket
import tempfile
import threading
import time
from bisect import bisect_left
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from urllib.parse import urlsplit

import numpy as np
from numpy.typing import NDArray
from rerun.chunk import RrdReader

from benchmarks.parts.tracking.signal import RunUp, blocks, daq_of, rig_of, standard
from rotorrig.app.viewer.live import LiveView
from rotorrig.app.viewer.sinks import LOOPBACK, Sink, proxy, serve
from rotorrig.rig.probes import Block

CHANNELS, RATE = 8, 50_000.0  # the keyphasor's among them
BLOCK_SECONDS = 0.02  # a frame of the serial DAQ
ROW_TURNS = 8  # of the Bode plot's points
PICTURE = "bode"  # in the names of what shows the vectors
PAUSE = 0.01  # s without a byte: a burst is over


def live_run(seconds: float) -> RunUp:
    """Return the run-up that is shown."""
    return replace(standard(CHANNELS - 1), seconds=seconds, rate=RATE)


def measure_latency(seconds: float) -> NDArray[np.float64]:
    """Return (row,) how long [s] after the hand-over of its last sample each row's vector had arrived at the viewer."""
    run = live_run(seconds)
    rig = rig_of(run.probes, RATE)
    ready = list(blocks(run, rig, round(BLOCK_SECONDS * RATE)))  # made before: it must not cost time while they go
    with tempfile.TemporaryDirectory() as folder, _viewer(Path(folder) / "live.rrd") as (sink, arrivals):
        with LiveView(rig, daq_of(run), sink) as view:
            handed = _hand_over(ready, view)
        if view.fault or view.dropped:
            raise SystemExit(f"the live view failed: {view.fault or 'dropped'} ({view.dropped} blocks)")
        shown, logged = _pictures(Path(folder) / "live.rrd")
    return latencies(row_ends(run), handed, shown, np.array([_arrived(arrivals, at) for at in logged]))


def latencies(
    ends: NDArray[np.float64], handed: NDArray[np.float64], shown: NDArray[np.float64], arrived: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return (row,) from hand-over to arrival, of rows that ended at `ends` [s of the samples], as far as shown.

    `handed` (block,) is when each block went, `shown` and `arrived` (picture,) up to which sample time each picture
    goes and when it was there.
    """
    first = np.searchsorted(shown, ends)
    seen = first < len(shown)
    block = (ends[seen] / BLOCK_SECONDS).astype(int)
    return arrived[first[seen]] - handed[block]


def row_ends(run: RunUp) -> NDArray[np.float64]:
    """Return when the last turn of every row ends [s]: edge 8, 16, ... in closed form, as long as the run goes on."""
    last = int(run.theta(np.array(run.seconds)) / (2 * np.pi))
    angle = 2 * np.pi * np.arange(ROW_TURNS, last, ROW_TURNS)
    return (run.omega(angle) - run.start) / run.acceleration


def _hand_over(ready: list[Block], view: LiveView) -> NDArray[np.float64]:
    """Show each block when its last sample would have been taken; return when each was handed over [s, wall clock]."""
    began, handed = time.time(), []
    for number, block in enumerate(ready):
        time.sleep(max(0.0, began + (number + 1) * BLOCK_SECONDS - time.time()))
        handed.append(time.time())
        view.show(block)
    return np.array(handed)


@contextmanager
def _viewer(file: Path) -> Iterator[tuple[Sink, list[float]]]:
    """Start a viewer with a relay before it; yield the sink that feeds both it and a file, and when bytes arrived."""
    with serve(headless=True) as real, socket.create_server((LOOPBACK, 0)) as server:
        (address,) = real.targets
        arrivals: list[float] = []
        port = urlsplit(str(address)).port
        threading.Thread(target=_relay, args=(server, port, arrivals), daemon=True).start()
        yield Sink(targets=(proxy(server.getsockname()[1]), file)), arrivals
        server.shutdown(socket.SHUT_RDWR)  # a close alone would not wake who waits for a connection


def _relay(server: socket.socket, port: int, arrivals: list[float]) -> None:
    """Pass on what comes on every connection to the viewer's port and back; note when something came."""
    with suppress(OSError):  # the server was closed: the end
        while True:
            near, _ = server.accept()
            threading.Thread(target=_carry, args=(near, port, arrivals), daemon=True).start()


def _carry(near: socket.socket, port: int, arrivals: list[float]) -> None:
    """Carry one connection both ways until both ends have hung up."""
    with suppress(OSError), near, socket.create_connection((LOOPBACK, port)) as far:
        back = threading.Thread(target=_pass_on, args=(far, near, None), daemon=True)
        back.start()
        _pass_on(near, far, arrivals)
        back.join()


def _pass_on(source: socket.socket, target: socket.socket, arrivals: list[float] | None) -> None:
    with suppress(OSError):
        while data := source.recv(1 << 20):
            target.sendall(data)
            if arrivals is not None:
                arrivals.append(time.time())
    with suppress(OSError):
        target.shutdown(socket.SHUT_WR)


def _arrived(arrivals: list[float], logged: float) -> float:
    """Return when the burst of bytes that follows `logged` was over."""
    i = bisect_left(arrivals, logged)
    while i + 1 < len(arrivals) and arrivals[i + 1] - arrivals[i] < PAUSE:
        i += 1
    return arrivals[i]


def _pictures(file: Path) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return of every Bode picture the sample time it goes up to [s] and when it was logged [s, wall clock]."""
    last: dict[float, float] = {}
    for chunk in RrdReader(file).stream():
        if PICTURE not in str(chunk.entity_path) or chunk.is_static:
            continue
        batch = chunk.to_record_batch()
        if {"time", "log_time"} <= set(batch.schema.names):
            times = batch.column("time").cast("int64").to_numpy() / 1e9
            logs = batch.column("log_time").cast("int64").to_numpy() / 1e9
            for at, log in zip(times, logs, strict=True):
                last[at] = max(log, last.get(at, log))  # the slowest part of a picture
    if not last:
        raise SystemExit(f"{file}: nothing with '{PICTURE}' in its name was drawn at a time of the samples")
    shown = np.array(sorted(last))
    return shown, np.array([last[at] for at in shown])

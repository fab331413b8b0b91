"""The recorder's benchmark in small: real processes, ports, sweeps and kills; its figures are for the long one."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from benchmarks import recorder
from benchmarks.parts.recorder import page as recorder_page
from benchmarks.parts.recorder.report import Report
from benchmarks.recorder import Bench, measure_kills, measure_long_run, measure_trips

PROCESSES = 3  # one after another a sample goes through: the board, the recording process, this one that kills it


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Bench:
    return Bench(tmp_path_factory.mktemp("recorder"))


def test_a_sweep_at_full_rate_loses_no_sample(bench: Bench) -> None:
    report = Report(minutes=0.03)
    measure_long_run(bench, report)
    assert report.samples_lost == 0
    assert report.samples > 0.03 * 60 * recorder.RATE
    assert report.compression < 0.8


def test_whatever_moment_it_is_killed_at_the_last_quarter_second_is_all_that_is_lost(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recorder, "KILL_AFTER", (0.3, 0.8))
    report = Report()
    with held_up() as worst:
        measure_kills(bench, report, kills=3)
    assert report.kills_bad == 0
    assert len(report.kills_lost_s) == 3
    assert max(report.kills_lost_s) < 0.25 + PROCESSES * max(worst)


@contextmanager
def held_up() -> Iterator[list[float]]:
    """Measure by how much a busy machine is late to wake who has slept for 10 ms [s]."""
    late, done = [0.0], threading.Event()

    def sleep() -> None:
        while not done.is_set():
            began = time.monotonic()
            time.sleep(0.01)
            late.append(time.monotonic() - began - 0.01)

    sleeper = threading.Thread(target=sleep)
    sleeper.start()
    try:
        yield late
    finally:
        done.set()
        sleeper.join()


def test_too_much_vibration_stops_the_drive_though_the_viewer_has_died(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recorder, "get_args", lambda _: ("killed",))
    report = Report()
    measure_trips(bench, report, each=1)
    assert (report.missed_trips, len(report.trips_ms["killed"])) == (0, 1)


def test_a_sample_that_is_none_of_those_sent_is_found(bench: Bench) -> None:
    with np.load(bench.signal) as loops:
        loop = loops["running"]
    frame = loop[np.arange(1000) + 500].copy()
    assert not recorder._wrong(frame, 500 + len(loop), {"running": loop})
    frame[7, 3] += 1
    assert recorder._wrong(frame, 500 + len(loop), {"running": loop})


def test_the_page_says_what_was_measured(tmp_path: Path) -> None:
    report = Report(
        cores=4,
        load=9.5,
        minutes=10.0,
        cpu_share=0.123,
        samples=30_000_000,
        file_bytes=130_000_000,
        compression=130 / 480,
        read_s=4.0,
        read_rss=1e9,
        decided_ms=[1.0],
        handed_ms=[1.5],
        trips_ms={"none": [10.0, 20.0], "hung": [15.0]},
        kills_lost_s=[0.05, 0.11],
    )
    page = recorder_page.page(report)
    assert "30000000 scans of 8 channels recorded, 0 lost or wrong" in page
    assert "12.3 % of one core" in page
    assert "had 4 cores, and 9.5 programs at work" in page
    assert "| without a viewer                   |     2 |       15.0 |    19.9 |      20.0 |" in page
    assert "killed 2 times" in page and "110 ms before the kill" in page
    assert report.summary() == {
        "cpu_share": 0.123,
        "samples_lost": 0,
        "trip_ms_p99": 19.9,
        "trips_missed": 0,
        "salvage_lost_s_max": 0.11,
        "salvage_bad": 0,
        "compression": 0.2708,
    }

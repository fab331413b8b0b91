"""The live view's process: what goes to it, and that its death or sleep is its own affair."""

import itertools
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import psutil
import pytest
from numpy.typing import NDArray

from rotorrig.acquisition.recording import Event
from rotorrig.acquisition.sweep.fanout import Viewer
from rotorrig.app.text.amplitude_units import AmplitudeUnit
from rotorrig.app.viewer.live import view as live_view
from rotorrig.app.viewer.live.pipe import BlockReader, Opening, block_parts, opening
from rotorrig.app.viewer.live.view import LiveView
from rotorrig.app.viewer.sinks import Sink, to_file
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import RigError
from rotorrig.rig.probes.base import Block, DaqInfo
from tests.app.viewer.rrd_content import words_in

Swept = tuple[NDArray[np.int32], DaqInfo]


def blocks_of(swept: Swept, *, seconds: float = 4.0) -> list[Block]:
    counts, info = swept
    ends = range(0, int(seconds * info.sample_rate), 200)
    return [Block(counts=counts[i : i + 200], first_sample=i, t_ns=i * 100_000) for i in ends]


def put_to_sleep(pid: int) -> None:
    """Stop a process, and return when it has."""
    os.kill(pid, signal.SIGSTOP)
    while psutil.Process(pid).status() != psutil.STATUS_STOPPED:
        time.sleep(0.001)


def test_what_is_sent_to_the_process_arrives_however_it_is_cut(rig: RigConfig, swept: Swept) -> None:
    blocks, info = blocks_of(swept, seconds=0.2), swept[1]
    targets = ("rerun+http://127.0.0.1:9876/proxy", Path("/tmp/live.rrd"))
    events = (Event(t_ns=5, kind="mark", text="up"),)
    unit = AmplitudeUnit("mil pp")
    sent = opening(rig, info, targets, events=events, unit=unit)
    sent += b"".join(bytes(part) for block in blocks for part in block_parts(block))
    out, into = os.pipe()

    def trickle() -> None:
        for at in range(0, len(sent), 777):
            os.write(into, sent[at : at + 777])
        os.close(into)

    writer = threading.Thread(target=trickle)
    writer.start()
    reader = BlockReader(out)
    assert reader.opening() == Opening(rig=rig, info=info, targets=targets, events=events, unit=unit)
    read: list[Block] = []
    while not reader.ended:
        read += reader.blocks(0.01)
    writer.join()
    os.close(out)
    assert [(b.first_sample, b.t_ns) for b in read] == [(b.first_sample, b.t_ns) for b in blocks]
    assert all(np.array_equal(a.counts, b.counts) for a, b in zip(read, blocks, strict=True))


def test_the_process_draws_in_the_unit_asked_for(rig: RigConfig, swept: Swept, tmp_path: Path) -> None:
    blocks, info = blocks_of(swept), swept[1]
    told = {}
    for name in ("µm 0-peak", "mil pp"):
        rrd = tmp_path / f"{name}.rrd"
        with LiveView(rig, info, to_file(rrd), unit=AmplitudeUnit(name)) as live:
            for block in blocks:
                live.show(block)
        assert live.fault == ""
        told[name] = " ".join(words_in(rrd))
    assert "mil pp" in told["mil pp"]
    assert "µm" not in told["mil pp"]
    assert "µm 0-peak" in told["µm 0-peak"]
    assert "mil" not in told["µm 0-peak"]


def test_a_killed_view_costs_its_picture_and_says_so(
    rig: RigConfig, swept: Swept, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    blocks, info = blocks_of(swept), swept[1]
    with LiveView(rig, info, to_file(tmp_path / "live.rrd")) as live:
        live.show(blocks[0])
        os.kill(live.pid, signal.SIGKILL)
        for block in blocks[1:]:
            live.show(block)
    assert live.fault == "its process was ended by signal 9"
    assert 0 < live.dropped < len(blocks)
    with pytest.raises(RigError, match=r"signal 9, and left \d+ blocks undrawn"):
        live.listen(blocks[0])
    assert "the live view ended" in caplog.text


def test_a_sweep_hears_of_a_lost_view_so_that_its_recording_says_so(
    rig: RigConfig, swept: Swept, tmp_path: Path
) -> None:
    blocks, info = blocks_of(swept), swept[1]
    with LiveView(rig, info, to_file(tmp_path / "live.rrd")) as live:
        viewer = Viewer(live.listen)
        viewer.show(blocks[0])
        os.kill(live.pid, signal.SIGKILL)
        for block in itertools.cycle(blocks):
            viewer.show(block)
            if viewer.fault:
                break
    viewer.close()
    assert "signal 9" in viewer.fault


@pytest.mark.campaign
def test_a_view_that_sleeps_drops_the_oldest_blocks_and_goes_on_when_it_wakes(
    rig: RigConfig, swept: Swept, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live_view, "WAITING_SAMPLES", 2000)
    blocks, info = blocks_of(swept), swept[1]
    with LiveView(rig, info, to_file(tmp_path / "live.rrd")) as live:
        put_to_sleep(live.pid)
        for block in blocks:  # were one of these to wait for the sleeper, this would never end
            live.show(block)
        held = len(blocks) - live.dropped
        os.kill(live.pid, signal.SIGCONT)
    assert live.fault == ""
    assert held < 2000 / 200 + 64 * 1024 / 4000 + 20  # those that wait, those in the pipe
    assert (tmp_path / "live.rrd").stat().st_size > 10_000


@pytest.mark.campaign
def test_a_view_that_never_wakes_is_ended_when_the_sweep_is_over(
    rig: RigConfig, swept: Swept, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live_view, "FAREWELL", 0.3)
    blocks, info = blocks_of(swept), swept[1]
    with LiveView(rig, info, to_file(tmp_path / "live.rrd")) as live:
        put_to_sleep(live.pid)
        for block in blocks:
            live.show(block)
    assert live.fault == "its process was ended by signal 9"
    assert not psutil.pid_exists(live.pid)


ORPHAN = """
import sys
from pathlib import Path
from rotorrig.app.viewer.live.view import LiveView
from rotorrig.app.viewer.sinks import to_file
from rotorrig.rig.config.description import load
from rotorrig.rig.probes.base import DaqInfo

info = DaqInfo(model="", serial="", sample_rate=1e4, channels=5, volts_per_count=(1.0,) * 5, full_scale_counts=32768)
print(LiveView(load(Path(sys.argv[1])), info, to_file(Path(sys.argv[2]))).pid, flush=True)
sys.stdin.read()
"""


@pytest.mark.campaign
def test_a_view_ends_with_the_program_it_belongs_to(tmp_path: Path) -> None:
    config = Path(__file__).parents[4] / "configs/rk4.toml"
    words = [sys.executable, "-c", ORPHAN, str(config), str(tmp_path / "live.rrd")]
    with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as program:
        assert program.stdout
        view = psutil.Process(int(program.stdout.readline()))
        assert view.nice() > psutil.Process(program.pid).nice()  # a picture is worth less than a sample
        program.kill()
        gone, _ = psutil.wait_procs([view], timeout=10)
    assert gone


@pytest.mark.campaign
def test_a_view_with_nowhere_to_draw_does_not_start(rig: RigConfig, swept: Swept) -> None:
    with pytest.raises(RigError, match="nowhere to write to"):
        LiveView(rig, swept[1], Sink(targets=()))

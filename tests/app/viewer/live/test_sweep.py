"""`rotor sweep --simulate --view` and `rotor replay --view`, with a headless viewer where a window would be."""

import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from rerun.experimental import ViewerClient

from rotorrig.app import viewer
from rotorrig.app.commands import replay, sweep
from rotorrig.app.viewer.sinks import Sink, free_port, proxy
from rotorrig.rig.config.description import RigConfig
from tests.app.headless import headless_viewer, marked, needs_vulkan, show_tab, views

BLUE, ORANGE, WHITE = (74, 163, 223), (242, 142, 43), (240, 240, 240)

pytestmark = [pytest.mark.viewer, pytest.mark.campaign, needs_vulkan]


@pytest.fixture(scope="module")
def screen() -> Iterator[tuple[ViewerClient, int]]:
    port = free_port()
    with headless_viewer(port=port) as client:
        yield client, port


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("live") / "run.mcap"


def at_the_screen(port: int) -> Sink:
    return Sink(targets=(proxy(port),))


def assert_drawn(client: ViewerClient, folder: Path, *, events: bool) -> None:
    patient_until = time.monotonic() + 60  # a busy machine draws late
    while len(client.get_state().views) < 27 + events and time.monotonic() < patient_until:
        time.sleep(0.5)
    time.sleep(2.0)
    assert len(client.get_state().views) == 27 + events
    seen = views(client, folder, but_hidden=True)  # fails on any report of a view
    show_tab(client, "Orbits")
    seen |= views(client, folder, but_hidden=True)
    for name, picture in seen.items():
        if name.startswith("Bode"):
            assert marked(picture, BLUE).sum() > 60, f"{name}: no speed-up"
            assert marked(picture, ORANGE).sum() > 50, f"{name}: no coast-down"
        elif name.startswith(("Orbit", "Time base")):
            assert marked(picture, BLUE).sum() > 10, f"{name}: no orbit"
            assert marked(picture, WHITE).sum() > 10, f"{name}: no keyphasor dot"
        else:
            assert np.ptp(picture) > 100, f"{name}: blank"


def test_a_sweep_is_seen_while_it_runs(
    screen: tuple[ViewerClient, int],
    run: Path,
    tmp_path: Path,
    hurried_rig: RigConfig,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    client, port = screen
    monkeypatch.setattr(viewer, "serve", lambda: at_the_screen(port))
    simulation = sweep.SimulatedRig(seed=3)
    result = sweep.sweep(hurried_rig, out=run, plan="default", simulation=simulation, view=True)
    assert result.gaps == 0
    assert_drawn(client, tmp_path, events=False)


def test_a_replay_is_seen_as_the_sweep_was(
    screen: tuple[ViewerClient, int], run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    client, port = screen
    client.close("all")
    monkeypatch.setattr(viewer, "serve", lambda: at_the_screen(port))
    assert replay.play(run, rate="max", view=True) > 60
    assert_drawn(client, tmp_path, events=True)

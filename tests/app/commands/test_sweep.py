"""Sweeps over real wires that do not end as planned; the drive and the DAQ are in another process."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from rotorrig.acquisition.files.recording_mcap import read_recording
from rotorrig.acquisition.sweep.operator import Nobody
from rotorrig.acquisition.sweep.plans import Step
from rotorrig.acquisition.sweep.rest import RotorState
from rotorrig.app.commands.simulate import SimulatedRig
from rotorrig.app.commands.sweep import record_sweep, sweep
from rotorrig.rig.config.description import RigConfig, parse
from rotorrig.rig.config.units import RPM
from rotorrig.rig.errors import ConfigError, DataError
from rotorrig.sims.wire.launch import BenchPorts, simulated_bench

RK4 = (Path(__file__).parents[3] / "configs/rk4.toml").read_text()
HASTY = {
    'slow_roll_time = "10 s"': 'slow_roll_time = "0.2 s"',
    'start = "480 rpm"': 'start = "1000 rpm"',
    'ramp = "30 rpm/s"': 'ramp = "300 rpm/s"',
    "address = 100": 'watchdog = "1 s"\naddress = 100',
}


def hasty() -> RigConfig:
    text = RK4
    for old, new in HASTY.items():
        assert old in text
        text = text.replace(old, new)
    return parse(text, where="hasty.toml")


@pytest.fixture(scope="module")
def ports() -> Iterator[BenchPorts]:
    with simulated_bench(hasty().text, seed=3) as ports:
        yield ports


def test_a_limit_stops_the_rotor_and_the_recording_follows_it_to_rest(ports: BenchPorts, tmp_path: Path) -> None:
    rig = hasty()
    assert rig.limits
    strict = rig.model_copy(update={"limits": rig.limits.model_copy(update={"vibration": 250e-6})})
    result = record_sweep(strict, out=tmp_path / "run.mcap", ports=ports, remark="no proof test")
    assert (result.ending, result.state, result.gaps) == ("trip", RotorState.AT_REST, 0)
    assert "limit 250 um" in result.trip
    times = result.stop_times
    assert times
    assert times.received <= times.decided <= times.handed <= times.confirmed
    recording = read_recording(tmp_path / "run.mcap")
    assert recording.complete
    assert (recording.events[0].kind, recording.events[0].text) == ("note", "no proof test")
    (trip,) = [event for event in recording.events if event.kind == "trip"]
    end = recording.samples / recording.daq.sample_rate
    assert end - trip.t_ns / 1e9 > 2.0  # the rotor's way to rest, and two seconds without a pulse
    assert recording.events[-1].text.startswith("at rest")


def test_the_operator_ends_a_sweep_over_the_wire(ports: BenchPorts, tmp_path: Path) -> None:
    class Impatient(Nobody):
        def wants_stop(self) -> bool:
            return True

    result = record_sweep(hasty(), out=tmp_path / "run.mcap", ports=ports, operator=Impatient())
    assert (result.ending, result.trip, result.state) == ("stop", "", RotorState.AT_REST)


def test_a_mass_cannot_be_mounted_on_a_simulated_rig(tmp_path: Path) -> None:
    text = f'{RK4}\n[plans.test]\nkind = "trial-mass"\nmasses = ["disk: 12 g mm at 0 deg"]'
    with pytest.raises(ConfigError, match="impossible on a simulated rig"):
        sweep(parse(text, where="x"), out=tmp_path / "x.mcap", plan="test", simulation=SimulatedRig(seed=1), view=False)


def test_a_sweep_that_will_not_fit_on_its_disk_is_refused_before_it_starts(tmp_path: Path) -> None:
    text = f'{RK4}\n[plans.test]\nkind = "dwell"\nspeed = "900 rpm"\ntime = "1000000 h"\nramp = "60 rpm/s"'
    with pytest.raises(DataError, match=r"x\.mcap: \d+ MB free, want 180000\d\d\d MB for this sweep"):
        sweep(parse(text, where="x"), out=tmp_path / "x.mcap", plan="test", simulation=SimulatedRig(seed=1), view=False)


@pytest.mark.campaign
def test_a_sweep_whose_folder_is_deleted_ends_as_planned_and_says_where_its_recording_is(
    ports: BenchPorts, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    out = tmp_path / "out" / "run.mcap"
    out.parent.mkdir()
    told: list[str] = []
    places: list[Path] = []

    class Told(Nobody):
        def tell(self, text: str) -> None:
            told.append(text)
            raise OSError("the terminal is gone")

        def wants_stop(self) -> bool:
            return bool(told)

    def slip(step: Step, fraction: float, speed: float) -> None:
        if speed * RPM > 1200:
            shutil.rmtree(out.parent, ignore_errors=True)

    result = record_sweep(hasty(), out=out, ports=ports, progress=slip, operator=Told(), on_move=places.append)
    assert (result.ending, result.state) == ("stop", RotorState.AT_REST)
    (place,) = places
    assert told == [f"{out}: the file or its folder has vanished; the recording goes on as {place}"]
    recording = read_recording(place)
    assert recording.complete
    assert recording.samples == result.samples

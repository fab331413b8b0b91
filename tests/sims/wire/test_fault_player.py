"""When faults begin and end, and what is reported; time is the toy plant's and moves when told to."""

import json
import time
from typing import Any

import pytest

from rotorrig.rig.errors import ConfigError
from rotorrig.sims.wire import fault_player
from rotorrig.sims.wire.cables.interference import Interference
from rotorrig.sims.wire.drive import Drive
from rotorrig.sims.wire.fault_player import Player, Targets
from rotorrig.sims.wire.fault_script import Script, parse_script
from rotorrig.sims.wire.inputs import Inputs
from rotorrig.sims.wire.probe_daq import Firmware


class Wire:
    """A link that notes what happens to it."""

    def __init__(self) -> None:
        self.interference = Interference()
        self.unplugged = self.diverted = False

    def unplug(self, unplugged: bool) -> None:
        self.unplugged = unplugged

    def divert(self, diverted: bool) -> None:
        self.diverted = diverted


class Rig:
    """A player on the toy plant, and all it acts on."""

    def __init__(self, plant: Any, clock: Any) -> None:
        self.plant = plant
        self.motor, self.daq = Wire(), Wire()
        self.drive = Drive(plant, clock=clock, silence_fault=81)
        self.board = Firmware(plant, serial="T1", waits=False)
        self.inputs = Inputs(self.board, keyphasor=2)
        self.said: list[dict[str, Any]] = []
        targets = Targets(motor=self.motor, daq=self.daq, drive=self.drive, inputs=self.inputs, disguise=None)
        self.player = Player(targets, plant=plant, report=self.said.append)

    def play(self, *faults: dict[str, Any]) -> None:
        self.player.play(script(*faults))

    def pass_time(self, t: float) -> None:
        self.inputs.measure(self.plant.advance(t))
        self.player.look()

    def events(self) -> list[tuple[float, int, str]]:
        return [(line["t"], line["fault"], line["event"]) for line in self.said]


def script(*faults: dict[str, Any]) -> Script:
    return parse_script(json.dumps(faults), where="test")


@pytest.fixture
def rig(plant: Any, clock: Any) -> Rig:
    return Rig(plant, clock)


def test_a_fault_begins_at_its_time_after_the_script_was_given_and_ends_when_it_has_lasted(rig: Rig) -> None:
    rig.pass_time(10.0)
    rig.play({"kind": "keyphasor-lost", "at": 1.0, "lasts": 0.5})
    for t in (10.9, 11.0, 11.4, 11.5, 20.0):
        rig.pass_time(t)
    assert rig.events() == [(11.0, 0, "begins"), (11.5, 0, "ends")]
    assert rig.said[0].keys() == {"t", "wall", "fault", "kind", "on", "event"}
    assert (rig.said[0]["kind"], rig.said[0]["on"]) == ("keyphasor-lost", "daq")


def test_a_fault_above_a_speed_waits_for_it_and_for_its_time(rig: Rig) -> None:
    rig.play({"kind": "stuck-speed", "above": "600 rpm", "at": 2.0})
    rig.plant.speed = 70.0
    rig.pass_time(1.0)
    rig.plant.speed = 60.0  # 573 rpm
    rig.plant.command(60.0, 1.0, True)
    rig.pass_time(2.0)
    assert rig.events() == []
    rig.plant.speed = 63.0  # 602 rpm
    rig.pass_time(2.1)
    assert rig.events() == [(2.1, 0, "begins")]


def test_a_fault_of_a_link_lasts_in_wall_time(rig: Rig) -> None:
    rig.play({"kind": "disconnect", "on": "motor", "lasts": 0.3}, {"kind": "silent", "on": "daq"})
    assert rig.motor.unplugged
    rig.pass_time(5.0)
    assert rig.motor.unplugged
    assert rig.daq.interference.disturb(b"x", "to-device") == ([], 0.0)
    time.sleep(0.31)
    rig.player.look()
    assert not rig.motor.unplugged
    assert [(fault, event) for _, fault, event in rig.events()] == [(0, "begins"), (1, "begins"), (0, "ends")]


def test_a_fault_of_so_many_messages_ends_with_the_last_and_says_how_many(rig: Rig) -> None:
    rig.play({"kind": "drop", "on": "daq", "count": 2})
    for _ in range(3):
        rig.daq.interference.disturb(b"x", "from-device")
        rig.player.look()
    assert [line["event"] for line in rig.said] == ["begins", "ends"]
    assert rig.said[1]["hits"] == 2


def test_the_shaft_sticks_while_the_drive_believes_it_follows(rig: Rig) -> None:
    rig.drive.set_reference(50.0, rising=100.0, falling=100.0)
    rig.drive.start()
    rig.pass_time(1.0)
    rig.play({"kind": "stuck-speed", "lasts": 2.0})
    rig.drive.set_reference(80.0, rising=100.0, falling=100.0)
    rig.pass_time(2.0)
    assert (rig.plant.speed, rig.drive.speed) == (50.0, 80.0)
    rig.pass_time(3.0)
    rig.pass_time(4.0)
    assert rig.plant.speed == 80.0


def test_a_tripped_drive_lets_the_rotor_coast_and_remembers_why(rig: Rig) -> None:
    rig.drive.set_reference(50.0, rising=100.0, falling=100.0)
    rig.drive.start()
    rig.pass_time(1.0)
    rig.play({"kind": "drive-fault", "code": 12})
    rig.pass_time(2.0)
    assert rig.drive.fault == 12
    assert rig.plant.commands[-1][2] is False
    assert [event for _, _, event in rig.events()] == ["begins", "ends"]


def test_an_overrun_loses_scans_and_says_how_many(rig: Rig) -> None:
    rig.board.hear(b"START\n")
    rig.play({"kind": "daq-overrun", "at": 0.1, "lasts": 0.06})
    for step in range(1, 20):
        rig.pass_time(step * 0.02)
    (end,) = (line for line in rig.said if line["event"] == "ends")
    assert end["scans"] == 60  # at 1000 Hz
    flags = [frame[3] for frame in rig.board.outbox if frame[2] == 2]  # of DATA, docs/daq-stream.md
    assert sum(flags) == 1
    assert len(flags) == 19 - 3


def test_a_lost_keyphasor_reads_nought_and_the_probes_go_on(rig: Rig) -> None:
    rig.plant.speed = 10.0
    rig.plant.command(10.0, 1.0, True)
    rig.board.hear(b"START\n")
    rig.play({"kind": "keyphasor-lost", "lasts": 0.02})
    for t in (0.02, 0.04):
        rig.pass_time(t)
    lost, back = (frame[21:-4] for frame in rig.board.outbox)  # scans of three int24
    assert {lost[i : i + 3] for i in range(6, len(lost), 9)} == {b"\0\0\0"}
    assert {back[i : i + 3] for i in range(6, len(back), 9)} == {(100).to_bytes(3, "little")}  # 0.1 rad/s per count
    assert lost[9:12] == (1).to_bytes(3, "little")


def test_a_calming_script_ends_what_has_begun_and_forgets_what_has_not(rig: Rig) -> None:
    rig.play({"kind": "keyphasor-lost"}, {"kind": "daq-overrun", "at": 2.0})
    rig.pass_time(1.0)
    rig.player.play(parse_script('{"calm": true, "faults": [{"kind": "disconnect", "on": "daq"}]}', where="test"))
    rig.pass_time(3.0)
    assert [(line["kind"], line["event"]) for line in rig.said] == [
        ("keyphasor-lost", "begins"),
        ("keyphasor-lost", "ends"),
        ("disconnect", "begins"),
    ]


def test_another_address_is_refused_for_a_controller_that_has_none(rig: Rig) -> None:
    with pytest.raises(ConfigError, match=r"faults\[1\]\.address: got 7, want none"):
        rig.player.check(script({"kind": "stuck-speed"}, {"kind": "wrong-device", "on": "motor", "address": 7}))


def test_the_same_seed_hits_the_same_messages(plant: Any, clock: Any) -> None:
    struck = []
    for _ in range(2):
        rig = Rig(plant, clock)
        rig.play({"kind": "drop", "on": "daq", "share": 0.5}, {"kind": "drop", "on": "motor", "share": 0.5})
        struck.append(
            [[wire.interference.disturb(b"x", "to-device")[0] for _ in range(50)] for wire in (rig.motor, rig.daq)]
        )
    assert struck[0] == struck[1]
    assert struck[0][0] != struck[0][1]


def test_faults_are_looked_for_while_time_stands_still() -> None:
    assert fault_player._LOOK < 0.05  # a disconnect of 0.1 s must not last twice as long

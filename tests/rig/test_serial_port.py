"""Serial ports: the terminal settings of one that a driver has opened."""

import os
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from rotorrig.rig.config.devices import CanOpen, ModbusRtu
from rotorrig.rig.errors import LinkLost
from rotorrig.rig.motor.can_link import CanLink
from rotorrig.rig.motor.line_link import LineLink
from rotorrig.rig.motor.modbus_link import ModbusLink
from rotorrig.rig.probes.stream import daq
from rotorrig.rig.probes.stream.daq import StreamDaq
from rotorrig.rig.serial_port import ReopenedPort, open_serial

if sys.platform == "win32":
    pytest.skip("no terminal settings there", allow_module_level=True)

import termios
import tty


class Terminal:
    """A pty whose lines drop when it is closed, as those of a serial port do by default."""

    def __init__(self) -> None:
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        self.port = os.ttyname(self._slave)
        settings = termios.tcgetattr(self._slave)
        settings[2] |= termios.HUPCL
        termios.tcsetattr(self._slave, termios.TCSANOW, settings)

    @property
    def drops_its_lines(self) -> bool:
        return bool(termios.tcgetattr(self._slave)[2] & termios.HUPCL)

    def close(self) -> None:
        os.close(self._master)
        os.close(self._slave)


@pytest.fixture
def terminal() -> Iterator[Terminal]:
    terminal = Terminal()
    assert terminal.drops_its_lines
    yield terminal
    terminal.close()


def open_port(port: str) -> Callable[[], None]:
    return open_serial(port, 115200, of="board").close


def open_line(port: str) -> Callable[[], None]:
    return LineLink(port, baudrate=115200, name="line").close


def open_modbus(port: str) -> Callable[[], None]:
    link = modbus_link(port)
    link.open()
    return link.close


def modbus_link(port: str) -> ModbusLink:
    table = {"driver": "modbus-rtu", "port": port, "max_speed": 400.0}
    return ModbusLink(ModbusRtu.model_validate(table, context={"si": True}), model="any")


def open_slcan(port: str) -> Callable[[], None]:
    table = {"driver": "canopen", "interface": "slcan", "channel": f"{port}@115200", "node": 1, "max_speed": 400.0}
    return CanLink(CanOpen.model_validate(table, context={"si": True}), name="CAN").close


def open_daq(port: str) -> Callable[[], None]:
    device = StreamDaq(port, sample_rate=1000.0, channels=1)
    with pytest.raises(LinkLost, match="no DAQ answered"):
        device.open()
    return device.close


@pytest.mark.parametrize("open_it", [open_port, open_line, open_modbus, open_slcan, open_daq])
def test_a_port_keeps_dtr_when_it_is_closed_and_opened_again(
    terminal: Terminal, open_it: Callable[[str], Callable[[], None]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(daq, "ANSWER_SECONDS", 0.5)
    for _ in range(2):
        close = open_it(terminal.port)
        assert not terminal.drops_its_lines
        close()
        assert not terminal.drops_its_lines


def test_a_port_that_does_not_open_is_said_to_be_whose() -> None:
    with pytest.raises(LinkLost, match=r"^/dev/ttyNOSUCH: the board's port cannot be opened \(no such port"):
        open_serial("/dev/ttyNOSUCH", 115200, of="board")


def reused(terminal: Terminal) -> list[Terminal]:
    """Close a terminal and return new ones, the last of which has its number."""
    terminal.close()
    time.sleep(0.02)  # a node's time is as fine as the kernel's tick
    made = [Terminal()]
    while made[-1].port != terminal.port and len(made) < 100:
        made.append(Terminal())
    if made[-1].port != terminal.port:
        for one in made:
            one.close()
        pytest.skip("another program was given the number")
    return made


def test_a_port_that_stays_may_be_opened_again_though_its_settings_change(terminal: Terminal) -> None:
    port = ReopenedPort(terminal.port)
    for _ in range(3):
        port.check()
        open_port(terminal.port)()


def test_a_pseudo_terminal_whose_number_another_program_has_now_is_left_alone() -> None:
    terminal = Terminal()
    port = ReopenedPort(terminal.port)
    port.check()
    made = reused(terminal)
    try:
        for _ in range(2):  # however often it is tried
            with pytest.raises(LinkLost, match=f"^{terminal.port}: this pseudo-terminal was made after the one"):
                port.check()
    finally:
        for one in made:
            one.close()


def test_a_modbus_link_does_not_open_a_number_that_was_given_to_another_program() -> None:
    terminal = Terminal()
    link = modbus_link(terminal.port)
    link.open()
    made = reused(terminal)
    try:
        with pytest.raises(LinkLost, match="this pseudo-terminal was made after the one opened before"):
            link.open()
    finally:
        link.close()
        for one in made:
            one.close()


def test_a_link_that_was_made_anew_is_followed_to_any_number(terminal: Terminal, tmp_path: Path) -> None:
    """As a cable that is plugged in again, and as socat makes them."""
    name = tmp_path / "by-id"
    name.symlink_to(terminal.port)
    port = ReopenedPort(str(name))
    port.check()
    other = Terminal()
    time.sleep(0.02)
    name.unlink()
    name.symlink_to(other.port)
    try:
        port.check()
        port.check()
    finally:
        other.close()


def test_a_link_that_stays_while_its_number_is_given_away_is_left_alone(tmp_path: Path) -> None:
    terminal = Terminal()
    name = tmp_path / "motor"
    name.symlink_to(terminal.port)
    port = ReopenedPort(str(name))
    port.check()
    made = reused(terminal)
    try:
        with pytest.raises(LinkLost, match=f"^{name}: this pseudo-terminal was made after"):
            port.check()
    finally:
        for one in made:
            one.close()


def test_a_device_that_comes_back_under_its_name_is_opened(tmp_path: Path) -> None:
    """A USB adapter gets a new node, and its link by-id may stay."""
    node, name = tmp_path / "ttyUSB0", tmp_path / "by-id"
    node.touch()
    name.symlink_to(node)
    port = ReopenedPort(str(name))
    port.check()
    node.unlink()
    port.check()  # not there: who opens it says so
    time.sleep(0.02)
    node.touch()
    port.check()

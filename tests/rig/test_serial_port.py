"""Serial ports: the terminal settings of one that a driver has opened."""

import os
import sys
from collections.abc import Callable, Iterator

import pytest

from rotorrig.rig.config.devices import CanOpen, ModbusRtu
from rotorrig.rig.errors import LinkLost
from rotorrig.rig.motor.can_link import CanLink
from rotorrig.rig.motor.line_link import LineLink
from rotorrig.rig.motor.modbus_link import ModbusLink
from rotorrig.rig.probes.stream import daq
from rotorrig.rig.probes.stream.daq import StreamDaq
from rotorrig.rig.serial_port import open_serial

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
    table = {"driver": "modbus-rtu", "port": port, "max_speed": 400.0}
    link = ModbusLink(ModbusRtu.model_validate(table, context={"si": True}), model="any")
    link.open()
    return link.close


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

"""A Delta VFD-ED drive as its Modbus master sees it: a few words in front, the plant's motor behind.

Addresses are hexadecimal in the manual and on the wire: 2000H command (bits 1:0 = 01 stop, 10 run; 5:4 direction),
2001H frequency command, 2100H error code, 2102H frequency command, 2103H output frequency, all frequencies in 0.01 Hz,
2119H status (bits 1:0 = 00 stopped, 01 stopping, 11 running; 4:3 = 00 forward: its manual, pages 440 and 441); the
frames are those of pages 4-89 to 4-95 of the VFD-VL manual (VLE1). Emulated is what a rig needs, and no more than the
pages at hand say: its ramp, its stop by ramp and its time-out (Pr.09-02, Pr.09-03) are set by hand, as
docs/motors.md asks for; the output goes off when its master is silent for longer. 2101H, the status of the VFD-VL,
reads 0 and a fault stays until it is reset at the drive (`drive.fault = 0`).

Jog, reverse and a change of direction are refused as illegal values.
"""

import math

from rotorrig.rig import Clock, ConfigError
from rotorrig.rig.config import ModbusRtu, ModbusTcp
from rotorrig.sims.wire.drive import Drive, OnSilence
from rotorrig.sims.wire.plant_port import Plant

COMMAND, FREQUENCY_COMMAND = 0x2000, 0x2001
ERROR_CODE, OLD_STATUS, FREQUENCY_ECHO, OUTPUT_FREQUENCY, STATUS = 0x2100, 0x2101, 0x2102, 0x2103, 0x2119

TIME_OUT = 0  # no fault is known for it
HIGHEST = 400.0  # Hz
_STOP, _RUN, _FORWARD = 0b01, 0b10, 0b01 << 4
_BY_COMMUNICATION = 1 << 8 | 1 << 10  # frequency and command
_UNDERSTOOD = frozenset(command | direction for command in (0, _STOP, _RUN) for direction in (0, _FORWARD))


class VfdEd:
    """The drive's registers, to `read` and `write`; `drive` is the drive behind them."""

    functions = frozenset({3, 6, 16})

    def __init__(
        self, plant: Plant, *, rpm_per_hz: float, max_frequency: float, ramp: float, time_out: float, clock: Clock
    ) -> None:
        """Set up for a rotor that turns `rpm_per_hz`, as commissioned.

        `max_frequency` [Hz], `ramp` [rad/s^2], `time_out` [s] of its master's silence. Raises ConfigError if the drive
        cannot be set to `max_frequency`.
        """
        if not 0 < max_frequency <= HIGHEST:
            raise ConfigError(
                f"motor.max_speed: takes {max_frequency:g} Hz at {rpm_per_hz:g} rpm per Hz, "
                f"want at most the {HIGHEST:g} Hz of a VFD-ED"
            )
        self._speed_per_count = rpm_per_hz * math.pi / 30.0 / 100  # rad/s per 0.01 Hz
        self._highest, self._ramp = round(100 * max_frequency), ramp
        self._command = self._reference = 0
        self.drive = Drive(plant, clock=clock, silence_fault=TIME_OUT)
        self.drive.on_silence, self.drive.patience = OnSilence.COAST, time_out
        self.drive.set_reference(0.0, rising=ramp, falling=ramp)

    def read(self, address: int, count: int) -> list[int]:
        """Return `count` registers from `address`. Raises KeyError for one the drive does not have."""
        self.drive.hear()
        self.drive.tick()
        known = {
            COMMAND: self._command,
            FREQUENCY_COMMAND: self._reference,
            ERROR_CODE: self.drive.fault,
            OLD_STATUS: 0,
            STATUS: self._status(),
            FREQUENCY_ECHO: self._reference,
            OUTPUT_FREQUENCY: round(self.drive.speed / self._speed_per_count),
        }
        return [known[a] for a in range(address, address + count)]

    def write(self, address: int, values: list[int]) -> None:
        """Write consecutive registers, all or none.

        Raises KeyError for a register that is unknown or read-only, ValueError for a value out of range.
        """
        self.drive.hear()
        writes = dict(enumerate(values, start=address))
        for number, value in writes.items():
            self._check(number, value)
        if FREQUENCY_COMMAND in writes:
            self._reference = writes[FREQUENCY_COMMAND]
            self.drive.set_reference(self._reference * self._speed_per_count, rising=self._ramp, falling=self._ramp)
        if COMMAND in writes:
            self._obey(writes[COMMAND])

    def _status(self) -> int:
        return (0b11 if self.drive.running else 0b01 if self.drive.active else 0b00) | _BY_COMMUNICATION

    def _obey(self, command: int) -> None:
        self._command = command
        if command & _STOP:
            self.drive.stop(coast=False)
        elif command & _RUN:
            self.drive.start()

    def _check(self, number: int, value: int) -> None:
        if number not in (COMMAND, FREQUENCY_COMMAND):
            raise KeyError(number)
        if number == COMMAND and value not in _UNDERSTOOD:
            raise ValueError(f"command {value:#06x} asks for what this drive is not set up for")
        if number == FREQUENCY_COMMAND and value > self._highest:
            raise ValueError(f"frequency command: got {value}, want 0 to {self._highest}")


def commission(table: ModbusRtu | ModbusTcp, plant: Plant, *, max_frequency: float, clock: Clock) -> VfdEd:
    """Return the drive with the ramp and the time-out of `table` set by hand."""
    assert table.ramp is not None, "checked with the config"
    by_hand = {"ramp": table.ramp, "time_out": table.watchdog}
    return VfdEd(plant, rpm_per_hz=table.rpm_per_hz, max_frequency=max_frequency, **by_hand, clock=clock)

"""Four drive families on Modbus, each scripted from its manual; 60 rpm of the shaft per Hz.

Addresses stand here as the manual counts them, less the offset it gives.
"""

from dataclasses import dataclass, field

from pymodbus.constants import ExcCodes

from tests.peers.inverter import Inverter

RPM_PER_HZ = 60.0
REFUSED = ExcCodes.ILLEGAL_VALUE
Registers = dict[int, int]


def hundredths(rpm: float) -> int:
    """Frequency of a speed, in 0.01 Hz."""
    return round(rpm / RPM_PER_HZ * 100)


def rate(seconds: float, *, top: float) -> float:
    """Ramp [rpm/s] that takes so long from 0 to `top` rpm; a time of 0 is as steep as can be."""
    return top / max(seconds, 0.05)


@dataclass
class PowerFlex400:
    """Allen-Bradley 22C-UM001J, Appendix E; parameters answer at their number."""

    inverter: Inverter
    address: int = 100
    read_only: frozenset[int] = frozenset({8448, 8449, 8450, 8451})
    initial: Registers = field(
        default_factory=lambda: {
            35: 6000,  # P035 maximum frequency, 0.01 Hz
            36: 5,  # P036 start source: comm port
            37: 0,  # P037 stop mode: ramp
            38: 5,  # P038 speed reference: comm port
            39: 2000,  # P039 acceleration time 1, 0.01 s
            40: 2000,  # P040 deceleration time 1, 0.01 s
            105: 0,  # C105 communication loss action: fault
            106: 50,  # C106 communication loss time, 0.1 s
            8192: 0,
            8193: 0,
            **dict.fromkeys(range(8448, 8452), 0),
        }
    )

    def refresh(self, registers: Registers) -> None:
        """Write logic status, error code and feedback (E-4, pp. 172-173)."""
        said = self.inverter.report()
        self._take_parameters(registers)
        turning_up = said.on and not said.stopping and said.output < said.target - 0.5
        turning_down = said.on and (said.stopping or said.output > said.target + 0.5)
        forward, faulted = not said.backward, bool(said.fault)
        bits = [not faulted, said.on, True, forward, turning_up, turning_down, False, faulted, said.at_target]
        registers[8448] = sum(1 << i for i, bit in enumerate(bits) if bit) | 1 << 9 | 1 << 10
        registers[8449] = said.fault
        registers[8450] = registers[8193]
        registers[8451] = hundredths(said.output)

    def write(self, address: int, value: int, registers: Registers) -> ExcCodes | None:
        """Take a logic command (p. 171), a reference, a parameter."""
        self._take_parameters({**registers, address: value})
        if address == 8192:
            self._command(value, registers)
        elif address == 8193:
            if value > registers[35]:
                return REFUSED
            if self.inverter.on and registers[8192] & 2:
                self.inverter.run(value / 100 * RPM_PER_HZ)
        return None

    def power_up(self) -> None:
        """Everything is in EEPROM."""

    def _command(self, word: int, registers: Registers) -> None:
        if word & 8:
            self.inverter.clear()
        if word & 1:  # stop wins over start
            self.inverter.stop("coast" if registers[37] in (1, 5) else "ramp")
        elif word & 2:
            self.inverter.run(registers[8193] / 100 * RPM_PER_HZ)

    def _take_parameters(self, registers: Registers) -> None:
        inverter, top = self.inverter, registers[35] / 100 * RPM_PER_HZ
        inverter.up, inverter.down = (rate(registers[p] / 100, top=top) for p in (39, 40))
        inverter.watchdog, inverter.watchdog_fault = registers[106] / 10, 81  # F81: communication lost
        inverter.watchdog_stops_by = {0: "trip", 1: "coast", 2: "ramp"}.get(registers[105], "")
        if inverter.watchdog_stops_by != "trip":
            inverter.watchdog_fault = 0
        if registers[105] == 3:  # continues with the last command
            inverter.watchdog = 0.0


@dataclass
class MMax:
    """Eaton MN04020003E, pp. 83, 132-139; an ID is sent less 1."""

    inverter: Inverter
    address: int = 1
    read_only: frozenset[int] = frozenset(range(2100, 2111))
    initial: Registers = field(
        default_factory=lambda: {
            100: 0,  # ID 101, P6.3 minimum frequency, 0.01 Hz
            101: 6000,  # ID 102, P6.4 maximum frequency, 0.01 Hz
            102: 30,  # ID 103, P6.5 acceleration time, 0.1 s
            103: 30,  # ID 104, P6.6 deceleration time, 0.1 s
            116: 2,  # ID 117, P6.2 setpoint source: bus
            124: 3,  # ID 125, P6.1 control place: bus
            813: 0,  # ID 814, S2.7 time-out, s
            **dict.fromkeys(range(2000, 2011), 0),
            **dict.fromkeys(range(2100, 2111), 0),
        }
    )

    def refresh(self, registers: Registers) -> None:
        """Write the output process data (pp. 138-139)."""
        said = self.inverter.report()
        self._take_parameters(registers)
        bits = [not said.fault, said.on, said.backward, bool(said.fault), False, said.at_target, said.output < 1, False]
        registers[2100] = sum(1 << i for i, bit in enumerate(bits) if bit)
        registers[2101] = 1 | 2 | 1 << 15
        registers[2102] = round(hundredths(said.output) / registers[101] * 10000)
        registers[2103] = hundredths(said.output)
        registers[2104] = round(said.output)
        registers[2110] = said.fault

    def write(self, address: int, value: int, registers: Registers) -> ExcCodes | None:
        """Take a control word (p. 137), a setpoint, a parameter (X on p. 132: not while running)."""
        if address in (100, 101, 102, 103, 116, 124, 813) and self.inverter.on and registers[address] != value:
            return REFUSED
        self._take_parameters({**registers, address: value})
        if address == 2000:
            self._command(value, registers)
        elif address == 2002:
            if value > 10000:
                return REFUSED
            if self.inverter.on and registers[2000] & 1:
                self.inverter.run(self._speed(value, registers))
        return None

    def power_up(self) -> None:
        """Parameters are in EEPROM."""

    def _command(self, word: int, registers: Registers) -> None:
        before = registers[2000]
        if word & 4 and not before & 4:
            self.inverter.clear()
        if word & 1 << 12:
            self.inverter.stop("quick")
        elif not word & 1:
            self.inverter.stop("ramp" if word & 16 else "coast")  # P6.8 as delivered: coasting
        elif self.inverter.on or not before & 1:  # after a block or a fault an edge is wanted
            self.inverter.run(self._speed(registers[2002], registers))

    def _speed(self, setpoint: int, registers: Registers) -> float:
        low, high = registers[100] / 100, registers[101] / 100
        return (low + (high - low) * setpoint / 10000) * RPM_PER_HZ

    def _take_parameters(self, registers: Registers) -> None:
        inverter, top = self.inverter, registers[101] / 100 * RPM_PER_HZ
        inverter.up, inverter.down = (rate(registers[p] / 10, top=top) for p in (102, 103))
        inverter.watchdog, inverter.watchdog_fault = float(registers[813]), 53
        inverter.watchdog_stops_by = "trip"


@dataclass
class Acs355:
    """ABB 3AUA0000066143, pp. 303-319, profile ABB DRV FULL; 4xxxx is sent as xxxx less 1."""

    inverter: Inverter
    address: int = 1
    read_only: frozenset[int] = frozenset({3, *range(4, 12), 100, 101, 102, 400})
    initial: Registers = field(
        default_factory=lambda: {
            **dict.fromkeys(range(12), 0),
            100: 0,  # 0101 speed, rpm, negative: reverse
            101: 0,  # 0102 speed, rpm
            102: 0,  # 0103 output frequency, 0.1 Hz
            400: 0,  # 0401 latest fault
            1000: 10,  # 1001 EXT1 commands: COMM
            1102: 8,  # 1103 REF1 select: COMM
            1104: 600,  # 1105 REF1 MAX, 0.1 Hz
            2007: 600,  # 2008 maximum frequency, 0.1 Hz
            2101: 2,  # 2102 stop function: ramp
            2201: 50,  # 2202 acceleration time 1, 0.1 s
            2202: 50,  # 2203 deceleration time 1, 0.1 s
            2207: 10,  # 2208 emergency deceleration time, 0.1 s
            3017: 0,  # 3018 communication fault function: none
            3018: 30,  # 3019 communication fault time, 0.1 s
            5304: 2,  # 5305 control profile: ABB DRV FULL
            5309: 103,  # 5310: what 40005 shows
            5310: 104,
            9801: 1,  # 9802 standard Modbus
            9903: 3,  # 9904 motor control mode: scalar
        }
    )
    inhibited: bool = True  # switching on is

    def refresh(self, registers: Registers) -> None:
        """Write the status word (p. 317) and actual value 1, the output frequency."""
        said, word = self.inverter.report(), registers[0]
        self._take_parameters(registers)
        if not word & 1 and word & 6 == 6 and not said.on and not said.fault:
            self.inhibited = False
        ready = not self.inhibited and not said.fault
        bits = {
            0: ready,
            1: ready and bool(word & 1),
            2: said.on and bool(word & 8),
            3: bool(said.fault),
            4: bool(word & 2),
            5: bool(word & 4),
            6: self.inhibited,
            8: said.at_target,
            9: True,
            12: True,
        }
        registers[3] = sum(1 << i for i, bit in bits.items() if bit)
        registers[100] = round(-said.output if said.backward else said.output) & 0xFFFF
        registers[101], registers[102] = round(said.output), round(said.output / RPM_PER_HZ * 10)
        for actual, mapped in enumerate(range(5309, 5317)):
            registers[4 + actual] = registers.get(registers.get(mapped, 0) - 1, 0)
        registers[400] = said.fault or registers[400]  # the fault's history: a reset does not clear it

    def write(self, address: int, value: int, registers: Registers) -> ExcCodes | None:
        """Take a control word (pp. 315-316), a reference, a parameter."""
        self._take_parameters({**registers, address: value})
        if address == 0:
            self._command(value, registers)
        elif address == 1 and self.inverter.on and registers[0] & 0x7F == 0x7F:
            self.inverter.run(self._speed(value, registers))
        return None

    def power_up(self) -> None:
        """Switching on is inhibited; parameters written over Modbus are volatile."""
        self.inhibited = True

    def _command(self, word: int, registers: Registers) -> None:
        inverter, before = self.inverter, registers[0]
        if not word & 1 << 10:  # REMOTE_CMD = 0: but for OFF1 to OFF3, nothing gets through
            word = word & 7 | before & ~7
        if word & 1 << 7 and not before & 1 << 7:
            inverter.clear()
            self.inhibited = True
        if not word & 2:
            inverter.stop("coast")
            self.inhibited = True
        elif not word & 4:
            inverter.stop("quick")
            self.inhibited = True
        elif not word & 1:
            inverter.stop("ramp")
            self.inhibited = self.inhibited and bool(inverter.fault)
        elif self.inhibited:
            return
        elif not word & 8:  # operation inhibited
            if inverter.on:
                inverter.stop("coast")
        elif word & 0x7F == 0x7F:
            inverter.run(self._speed(registers[1], registers))

    def _speed(self, reference: int, registers: Registers) -> float:
        signed = reference - 65536 if reference > 32767 else reference
        return min(signed / 20000 * registers[1104], registers[2007]) / 10 * RPM_PER_HZ

    def _take_parameters(self, registers: Registers) -> None:
        inverter, top = self.inverter, registers[2007] / 10 * RPM_PER_HZ
        inverter.up, inverter.down, inverter.quick = (rate(registers[p] / 10, top=top) for p in (2201, 2202, 2207))
        inverter.watchdog = registers[3018] / 10 if registers[3017] == 1 else 0.0
        inverter.watchdog_fault, inverter.watchdog_stops_by = 28, "trip"  # SERIAL 1 ERR


@dataclass
class VfdEd:
    """Delta's VFD-ED manual, Appendix B, pp. 440-441: neither ramps nor a watchdog by Modbus."""

    inverter: Inverter
    address: int = 1
    read_only: frozenset[int] = frozenset({*range(0x2100, 0x2108), 0x2119})
    initial: Registers = field(
        default_factory=lambda: {
            **dict.fromkeys(range(0x2000, 0x2003), 0),
            **dict.fromkeys(range(0x2100, 0x2108), 0),
            0x2119: 0,
        }
    )
    ramp: float = 500.0  # rpm/s, set at the drive

    def refresh(self, registers: Registers) -> None:
        """Write fault, status, frequencies; the status stands at 2119H, in the VFD-VL's manual at 2101H."""
        said = self.inverter.report()
        self.inverter.up = self.inverter.down = self.ramp
        registers[0x2100] = said.fault
        state = 0 if not said.on else 1 if said.stopping else 3
        registers[0x2119] = state | 3 * said.backward << 3 | 1 << 8 | 1 << 10
        registers[0x2102] = registers[0x2001]
        registers[0x2103] = hundredths(said.output)

    def write(self, address: int, value: int, registers: Registers) -> ExcCodes | None:
        """Take an operation command, a frequency, an external fault or its reset."""
        inverter = self.inverter
        inverter.up = inverter.down = self.ramp
        if address == 0x2000:
            if value & 3 == 1:
                inverter.stop("ramp")
            elif value & 3 == 2:
                inverter.run(registers[0x2001] / 100 * RPM_PER_HZ)
        elif address == 0x2001 and inverter.on and registers[0x2000] & 3 == 2:
            inverter.run(value / 100 * RPM_PER_HZ)
        elif address == 0x2002:
            if value & 1:
                inverter.trip(49)  # EF
            if value & 2:
                inverter.clear()
        return None

    def power_up(self) -> None:
        """Nothing of what Modbus wrote is of any use then."""


FAMILIES = {"powerflex400": PowerFlex400, "m-max": MMax, "acs355": Acs355, "vfd-ed": VfdEd}

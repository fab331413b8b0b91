"""Eaton M-Max (MMX): manual MN04020003E (October 2013), pages 83-84 (ramps, stop), 132-139 (Modbus).

The manual speaks of IDs: "control word (ID 2001), register 42001". On the wire an ID is one less: its own example of a
frame (page 135) writes ID 2051 as 0802 hex, 2050. The addresses below are those on the wire.

To be set by hand: S2.2 = 1 (Modbus), S2.3 to S2.6 (address, baud rate, parity), P6.3 = 0 Hz if the rotor is to turn
slowly. Control place and setpoint source need not be: bits 8 and 9 of the control word claim both for the bus.

Acceleration and deceleration time are parameters "no change possible" while it runs (column RUN, page 83). The
frequency's step in P6.3 and P6.4 and the time's in P6.5 and P6.6 are the decimals the manual prints them with. What a
fault 53 does to the output, and the names of the other faults, were not found in the pages at hand.
"""

from rotorrig.rig.motor.modbus_profile import Frequency, Profile, Ramps, Span, StopWords, Watchdog

_FROM_BUS = 1 << 8 | 1 << 9  # control level and setpoint input: the fieldbus, whatever P6.1 and P6.2 say
_STOP = _FROM_BUS | 1 << 4  # down the ramp
_MAX_FREQUENCY = Frequency(register=101, step=0.01, range=(1.0, 320.0))  # P6.4, ID 102

PROFILE = Profile(
    model="M-Max",
    hint="S2.2 must be 1 (Modbus), and no terminal may hold it",
    command=2000,  # control word, ID 2001
    # bit 0 run, 1 reverse, 2 reset error, 3 free coasting, 4 ramp, 12 block: it stops as quickly as possible. Run must
    # rise after that, so a start begins with a stop.
    start=(_STOP, _FROM_BUS | 1 << 0),
    stop=StopWords(ramp=_STOP, coast=_FROM_BUS | 1 << 3, fast=_STOP | 1 << 12),
    clear_fault=(_STOP, _STOP | 1 << 2, _STOP),  # bit 2 rises
    state=range(2100, 2104),  # status words and actual speed to the motor frequency (IDs 2101 to 2104); 11 at the most
    status=2100,
    running=1 << 1,
    faulted=1 << 3,
    at_reference=1 << 5,
    backward=1 << 2,
    setpoint=None,  # not among the output process data
    output_frequency=2103,  # motor frequency, ID 2104
    output_step=0.01,
    fault=2110,  # ID 2111
    fault_letter="E",
    faults={53: "fieldbus error"},
    reference=2002,  # speed setpoint, ID 2003: 0 to 10000 from P6.3 to P6.4
    reference_scale=Span(
        counts=10_000, high=_MAX_FREQUENCY, low=Frequency(register=100, step=0.01, range=(0.0, 320.0))
    ),
    max_frequency=_MAX_FREQUENCY,
    ramps=Ramps(accel_time=102, step=0.1, range=(0.1, 3000.0), only_at_rest=True),  # P6.5 and P6.6, IDs 103 and 104
    watchdog=Watchdog(register=813, step=1.0, range=(1.0, 255.0)),  # S2.7, ID 814
)

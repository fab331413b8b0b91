"""ABB ACS355: user's manual 3AUA0000066143, chapter on the embedded fieldbus (pages 312-319; rev. E: 324-331).

The manual speaks of registers 4xxxx, sent as xxxx - 1 (rev. E, page 326); parameter ggnn is register 4ggnn. The
addresses below are those on the wire. What is written to a parameter is lost with the power (page 313).

To be set by hand: 9802 = 1 (standard Modbus), group 53 with 5305 = 2 (ABB DRV FULL), 1001 and 1103 = COMM, 9904 =
scalar, so that references are frequencies, 2208 (time of an emergency stop).

The words are those of the ABB drives profile, which the ACS550 shares (ACS550-02 manual, pages 244-246). Assumed to be
shared as well: the numbers of the faults (page 259 there), 3018 and 3019 with fault 28 (ACH550-UH manual, page 154) and
the steps of parameters, 0.1 s (page 121 there) and 0.1 Hz. Of the signals, 0103 has no sign and 0101 has: a negative
speed is reverse; neither the control nor the status word of the profile tells the sense.
"""

from rotorrig.rig.motor.modbus_profile import Frequency, Profile, Ramps, Setting, Span, StopWords, Watchdog


def _parameter(number: int) -> int:
    """Return the address of a parameter, 2202 for "2202 ACCELER TIME 1"."""
    return number - 1


PROFILE = Profile(
    model="ACS355",
    hint="9802 must be 1, 5305 must be 2, and EXT1 must take commands and reference from COMM (1001, 1103)",
    command=0,  # 40001
    # bits 0 OFF1, 1 OFF2, 2 OFF3, 3 inhibit, 4 to 6 ramp out, hold and in: all active at 0; 7 reset, 10 remote command
    start=(0x476, 0x477, 0x47F),  # ready to switch on, ready to operate, operation enabled
    start_pause=0.1,  # ACS550-02, page 246: "wait at least 100 ms"
    stop=StopWords(ramp=0x47E, coast=0x47D, fast=0x47B),  # OFF1, OFF2, OFF3 (in the time of 2208)
    clear_fault=(0x476, 0x4F6, 0x476),  # bit 7 rises
    state=range(6),  # control word, references 1 and 2, status word (40004), actual values 1 and 2 (40005, 40006)
    status=3,
    running=1 << 2,  # operation enabled
    faulted=1 << 3,
    at_reference=1 << 8,
    setpoint=1,
    output_frequency=4,
    output_step=0.1,
    direction=5,
    fault=_parameter(401),  # last fault
    faults={
        1: "overcurrent",
        2: "DC overvoltage",
        3: "device overtemperature",
        4: "short circuit",
        6: "DC undervoltage",
        7: "analog input 1 loss",
        8: "analog input 2 loss",
        9: "motor overtemperature",
        10: "panel loss",
        11: "identification run failed",
        12: "motor stalled",
        14: "external fault 1",
        15: "external fault 2",
        16: "earth fault",
        18: "thermal measurement failed",
        21: "current measurement",
        22: "supply phase missing",
        23: "encoder error",
        24: "overspeed",
        26: "drive identification",
        28: "communication loss",  # SERIAL 1 ERR
    },
    reference=1,  # 40002: 20000 is 1105 REF1 MAX
    reference_scale=Span(counts=20_000, high=Frequency(register=_parameter(1105), step=0.1, range=(1.0, 600.0))),
    max_frequency=Frequency(register=_parameter(2008), step=0.1, range=(1.0, 600.0)),
    ramps=Ramps(accel_time=_parameter(2202), step=0.1, range=(0.1, 1800.0)),  # 0.0 s is left out: no ramp at all
    settings=(
        Setting(register=_parameter(5310), word=103, what="actual value 1 (5310): output frequency (0103)"),
        Setting(register=_parameter(5311), word=101, what="actual value 2 (5311): speed with its sign (0101)"),
        Setting(register=_parameter(3018), word=1, what="communication loss function (3018): fault"),
    ),
    watchdog=Watchdog(register=_parameter(3019), step=0.1, range=(0.1, 60.0)),
)

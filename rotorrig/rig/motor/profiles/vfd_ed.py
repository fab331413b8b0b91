"""Delta VFD-ED: the address list of its manual's Appendix B, hexadecimal there and on the wire: 2000H is 2000H.

Status 2119H and faults 2100H: its manual, pages 440 and 441. Frames as in the manual of its predecessor VFD-VL (VLE1,
Nov. 2008, pages 4-89 to 4-95), which has the status at 2101H. Between 2107H and 2119H there are addresses the manual
does not name, so the status is a read of its own.

To be set by hand: source of command and of frequency = RS-485, Pr.09-04 to RTU, the acceleration and the deceleration
time so that they make the ramp that motor.ramp of the config names, the stop method to a ramp, and the action on a
communication time-out (Pr.09-02, Pr.09-03).

The pages that say which words ramp times, stop methods, the time-out and the maximum frequency have were not at hand.
None of them is written or guessed.
"""

from rotorrig.rig.motor.modbus_profile import Profile, RunField, StopWords

PROFILE = Profile(
    model="VFD-ED",
    hint="the sources of operation command and of frequency must be RS-485",
    command=0x2000,
    start=(0b01_0010,),  # bits 1:0 = 10 run, 5:4 = 01 forward
    stop=StopWords(ramp=0b01),
    state=range(0x2100, 0x2104),
    status=0x2119,
    run_field=RunField(mask=0b11, running=(0b10, 0b11), stopping=0b01),  # 00 stopped, 10 standby: told to run, at 0 Hz
    backward=0b11 << 3,  # 00 forward, 01 and 10 changing over, 11 reverse
    setpoint=0x2102,
    output_frequency=0x2103,
    output_step=0.01,
    fault=0x2100,
    fault_mask=0xFF,  # above: a warning
    reference=0x2001,
    reference_scale=0.01,
)

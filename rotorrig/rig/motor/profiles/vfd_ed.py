"""Delta VFD-ED: the address list of its manual's group 09, hexadecimal there and on the wire: 2000H is 2000H.

Frames and 2102H as in the manual of its predecessor VFD-VL (VLE1, Nov. 2008, pages 4-89 to 4-95).

To be set by hand: source of command and of frequency = RS-485, Pr.09-04 to RTU, the acceleration and the deceleration
time so that they make the ramp that motor.ramp of the config names, the stop method to a ramp, and the action on a
communication time-out (Pr.09-02, Pr.09-03).

The pages that say which words ramp times, stop methods, the time-out, the status 2101H, a reset and the maximum
frequency have were not at hand. None of them is written or guessed: whether it runs is told from the output frequency.
"""

from rotorrig.rig.motor.modbus_profile import Profile, StopWords

PROFILE = Profile(
    model="VFD-ED",
    hint="the sources of operation command and of frequency must be RS-485",
    command=0x2000,
    start=(0b01_0010,),  # bits 1:0 = 10 run, 5:4 = 01 forward
    stop=StopWords(ramp=0b01),
    state=range(0x2100, 0x2104),
    status=None,
    setpoint=0x2102,
    output_frequency=0x2103,
    output_step=0.01,
    fault=0x2100,
    reference=0x2001,
    reference_scale=0.01,
)

"""Allen-Bradley PowerFlex 400: publication 22C-UM001J (2017), Appendix E; its register addresses are those on the wire.

The drive must be told to listen: P036 [Start Source] and P038 [Speed Reference] = 5 "RS485 (DSI) Port", App. E-2.

Of the parameters, App. E says only that a register's address is the parameter's number. Assumed, not read in a manual:
P035 counts 0.01 Hz, as the frequencies of App. E do, up to 320 Hz; P039 and P040 count 0.01 s up to 600 s; P037 is 0
for a ramp, 1 for coasting; C105 is 2 for a stop as P037 says, C106 counts 0.1 s up to 60 s. The driver refuses a P035
outside 15 to 320 Hz: a wrong step shows before the rotor turns.
"""

from rotorrig.rig.motor.modbus_profile import Frequency, Profile, Ramps, Setting, StopMode, StopWords, Watchdog

PROFILE = Profile(
    model="PowerFlex 400",
    hint="P036 [Start Source] and P038 [Speed Reference] must be 5, the RS485 port",
    command=8192,
    # bit 0 stop, 1 start, 3 clear faults, 5:4 direction, 9:8 acceleration rate, 11:10 deceleration rate
    start=(0b0101_0001_0010,),  # start, forward, acceleration and deceleration rate 1
    stop=StopWords(ramp=0b0001),  # by ramp or coasting, as P037 says
    clear_fault=(0b1000,),
    state=range(8448, 8452),
    status=8448,
    running=1 << 1,
    accelerating=1 << 4,
    decelerating=1 << 5,
    faulted=1 << 7,
    at_reference=1 << 8,
    forward=1 << 3,  # actual direction
    setpoint=8450,  # commanded frequency
    output_frequency=8451,
    output_step=0.01,
    fault=8449,
    faults={
        2: "auxiliary input",
        3: "power loss",
        4: "undervoltage",
        5: "overvoltage",
        6: "motor stalled",
        7: "motor overload",
        8: "heatsink overtemperature",
        12: "hardware overcurrent",
        13: "ground fault",
        15: "load loss",
        29: "analog input loss",
        33: "auto restart tries",
        38: "phase U to ground short",
        39: "phase V to ground short",
        40: "phase W to ground short",
        41: "phase UV short",
        42: "phase UW short",
        43: "phase VW short",
        48: "parameters defaulted",
        63: "software overcurrent",
        64: "drive overload",
        70: "power unit failure",
        71: "network loss",
        81: "communication loss",
        94: "function loss",
        100: "parameter checksum error",
        122: "I/O board failure",
    },
    reference=8193,
    reference_scale=0.01,
    max_frequency=Frequency(register=35, step=0.01, range=(15.0, 320.0)),
    ramps=Ramps(accel_time=39, step=0.01, range=(0.01, 600.0)),
    # our choice: 0.3 N m and 70 J for a rotor kit, which a drive without a brake resistor can be expected to take. Much
    # shorter, and it trips on overvoltage (F5) or is at 0 Hz before the rotor is; either leaves the rotor coasting.
    emergency_time=1.0,
    stop_mode=StopMode(register=37, ramp=0, coast=1),
    settings=(Setting(register=105, word=2, what="communication loss action (C105)"),),  # stop, not a fault: it brakes
    watchdog=Watchdog(register=106, step=0.1, range=(0.1, 60.0)),
)

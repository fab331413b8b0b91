"""`rotor simulate`: a simulated rig on two serial ports, until Ctrl-C."""

import time
from pathlib import Path

from rotorrig.app.console import out
from rotorrig.app.sweeping import StandIn, simulated
from rotorrig.rig.description import RigConfig


def stand_in(rig: RigConfig, *, seed: int, hidden: Path | None, rate: float) -> None:
    """Run the simulated rig and say where it is, in the config's own words. Returns at Ctrl-C."""
    with simulated(rig, StandIn(seed=seed, hidden=hidden, rate=rate)) as ports:
        out.print(f'\\[motor] port = "{ports.motor_port}"', highlight=False)
        out.print(f'\\[daq]   port = "{ports.daq_port}"', highlight=False)
        out.print("Put these into a copy of the config and sweep it from another terminal; Ctrl-C ends the rig.")
        try:
            while True:
                time.sleep(1.0)
        except KeyboardInterrupt:
            out.print("ended")

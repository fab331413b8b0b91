"""A program that turns a rotor through a guardian, for tests that kill it: arguments are port, log and patience."""

import signal
import sys
import time
from pathlib import Path

from rotorrig.rig.config.description import load
from rotorrig.rig.config.devices import LineController
from rotorrig.rig.control import GuardedControl, SetSpeed

CONFIG = Path(__file__).parents[3] / "configs" / "rk4.toml"
TABLE = {"driver": "serial-line", "max_speed": "3000 rpm", "watchdog": "60 s"}
SPEED, RAMP = 60.0, 100.0  # rad/s, rad/s^2


def main() -> None:
    """Send it to speed and process samples for ever."""
    signal.signal(signal.SIGQUIT, signal.SIG_DFL)  # a shell that runs the tests in the background has it ignored
    port, log, patience = sys.argv[1:]
    control = make_control(port, Path(log), patience=float(patience))
    control.open()
    control.start()
    control.send(SetSpeed(speed=SPEED, ramp=RAMP))
    print(control.guardian, flush=True)
    began = time.monotonic()
    while True:
        control.beat(time.monotonic() - began)
        control.take_readings()
        time.sleep(0.02)


def make_control(port: str, log: Path, *, patience: float) -> GuardedControl:
    """Return the control, not yet open."""
    rig = load(CONFIG)
    table = LineController.model_validate({**TABLE, "port": port})
    return GuardedControl(rig.model_copy(update={"motor": table}), log=log, every=0.05, patience=patience)


if __name__ == "__main__":
    main()

"""`rotor stop`: stop the rotor of a rig, whoever started it, and say whether it is at rest."""

import os
import time
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from typing import Any

from rotorrig.acquisition.sweep import bring_to_rest, reading_interval, stop_unseen
from rotorrig.app.terminal import operator_for
from rotorrig.rig import ConfigError, Interlock, LinkLost, NotAtRest, RigError, connect
from rotorrig.rig.config import RigConfig
from rotorrig.rig.control import PATIENCE, GuardedControl, ask_guardian, cut_power, guardian_log
from rotorrig.rig.motor import Stop
from rotorrig.rig.probes import Daq

Say = Callable[[str], object]

END_SECONDS = 5.0  # for a guardian that has let go of the link to end
UNKNOWN = "THE ROTOR MAY STILL BE TURNING"


def stop(rig: RigConfig, *, say: Say) -> str:
    """Stop the rotor; return what became of it. Raises NotAtRest unless it is at rest, or a running sweep stops it.

    The guardian that an ended sweep has left behind lets go of the motor link first.
    """
    table = connect.motor_table(rig)
    if guardian := ask_guardian(table, "stop"):
        if guardian["sweep"]:
            return _left_to_its_sweep(guardian)
        say(f"The guardian of a sweep that is gone ({guardian['reason']}) has let go of the motor link.")
        _wait_for_end(guardian["pid"])
    try:
        return _stop_here(rig, say)
    except KeyboardInterrupt:
        raise NotAtRest(f"{UNKNOWN}, left by the operator; its guardian goes on stopping it") from None


def _left_to_its_sweep(guardian: dict[str, Any]) -> str:
    """Return what a sweep that runs was told. Raises NotAtRest if it hangs."""
    if guardian["reason"]:
        raise NotAtRest(
            f"{UNKNOWN}: the sweep of process {guardian['sweep']} hangs ({guardian['reason']}); its guardian goes on "
            f"stopping the rotor; want that process ended, and 'rotor stop' again"
        )
    return f"told the sweep of process {guardian['sweep']} to stop; it reports what becomes of the rotor"


def _stop_here(rig: RigConfig, say: Say) -> str:
    with ExitStack() as stack:
        control = GuardedControl(
            rig,
            log=guardian_log(connect.motor_table(rig)),
            every=reading_interval(rig),
            patience=rig.motor.guardian if rig.motor and rig.motor.guardian else PATIENCE,
        )
        stack.callback(partial(control.close, at_rest=False))  # whatever goes wrong: its guardian goes on
        watchdog = _open_and_stop(control, rig)
        operator = operator_for((), say=say, yes=False)
        try:
            daq, interlock = _open_daq(rig, stack)
        except RigError as error:
            say(f"No samples ({error}): stopping by the drive alone.")
            stop_unseen(control=control, rig=rig, operator=operator, watchdog=watchdog)
            control.close()  # the drive is off: there is nothing more to be done by it
            raise NotAtRest(
                "the drive has obeyed the stop and says that it is off; whether the rotor turns is unknown, as there "
                f"are no samples: {error}"
            ) from error
        run_down = bring_to_rest(
            control=control, daq=daq, rig=rig, interlock=interlock, operator=operator, watchdog=watchdog
        )
        if not run_down.at_rest:
            raise NotAtRest(run_down.words)
        return run_down.words


def _open_and_stop(control: GuardedControl, rig: RigConfig) -> float | None:
    """Open the motor link and send the stop before anything else is done; return the drive's watchdog time [s]."""
    try:
        drive = control.open()
    except LinkLost as lost:
        cut = f"; {cut_power(rig.power_cut)}" if rig.power_cut else ""
        raise NotAtRest(f"{UNKNOWN}: {lost}{cut}") from lost
    control.start()
    control.stop(Stop.EMERGENCY)
    return drive.watchdog


def _open_daq(rig: RigConfig, stack: ExitStack) -> tuple[Daq, Interlock]:
    """Return the DAQ with its stream started. Raises ConfigError if the config has none or no keyphasor, LinkLost."""
    daq = stack.enter_context(connect.daq(rig))
    interlock = Interlock(rig, daq.open())
    if interlock.keyphasor is None:
        raise ConfigError("keyphasor: missing in the config, want [keyphasor] to see the rotor turn")
    daq.start()
    return daq, interlock


def _wait_for_end(process: int) -> None:
    until = time.monotonic() + END_SECONDS
    while time.monotonic() < until:
        try:
            os.kill(process, 0)
        except OSError:
            return
        time.sleep(0.05)

"""Stop without a sweep: bring to rest a rotor of which this program knows nothing, and record nothing.

`bring_to_rest` has the samples to prove it by. `stop_unseen` has the drive alone: it can be made to obey, but its word
proves no rest.
"""

import math
from functools import partial

from rotorrig.acquisition.recording import Event, MotorSample
from rotorrig.acquisition.sweep.interrupts import Interrupts
from rotorrig.acquisition.sweep.operator import Operator, Steadfast
from rotorrig.acquisition.sweep.run_down import RunDown, follow_run_down
from rotorrig.acquisition.sweep.session import Session
from rotorrig.rig import Clock, Interlock, WallClock
from rotorrig.rig.config import RigConfig
from rotorrig.rig.control import LOOP_STALL, Ladder, Measure, MotorControl, Reading, cut_power
from rotorrig.rig.motor import Stop
from rotorrig.rig.probes import Block, Daq

LOOK = 0.05  # s between looks at a drive that nobody watches by samples
PATIENCE = 15.0  # s without a sign of the rotor, more than a probe needs to show that nothing moves
FRESH = 1.0  # s for which a reading counts


class NoRecording:
    """Writer of a stop that is not recorded."""

    def write_block(self, block: Block) -> None:
        """Leave it."""

    def write_event(self, event: Event) -> None:
        """Leave it."""

    def write_motor(self, sample: MotorSample) -> None:
        """Leave it."""

    def flush(self) -> None:
        """Do nothing."""

    def close(self) -> None:
        """Do nothing."""


def bring_to_rest(
    *,
    control: MotorControl,
    daq: Daq,
    rig: RigConfig,
    interlock: Interlock,
    operator: Operator,
    watchdog: float | None,
    clock: Clock | None = None,
) -> RunDown:
    """Follow a rotor to rest on devices that run, of which `control` was told to stop; stop it harder if need be.

    `watchdog` [s] is the drive's own, None: it has none. Returns when rest is proven, when the operator has left it, or
    when the drive is off and for PATIENCE nothing was seen of the rotor, which in this program was never seen to turn.
    """
    clock = clock or WallClock()
    session = Session(
        control=control,
        daq=daq,
        rig=rig,
        writer=NoRecording(),
        interlock=interlock,
        listeners=(),
        clock=clock,
        speed=math.inf,
    )
    session.limits_armed = False
    no_danger = False
    with Interrupts(
        stop=lambda: session.stop_rotor(Stop.EMERGENCY), loop_hangs=lambda: clock.now() - session.last_beat > LOOP_STALL
    ) as interrupts:
        try:
            run_down = follow_run_down(
                session,
                ladder=_ladder(rig, watchdog),
                limit=math.inf,
                interrupts=interrupts,
                operator=Steadfast(operator),
                cut_power=partial(cut_power, rig.power_cut) if rig.power_cut else None,
                patience=PATIENCE,
            )
            no_danger = run_down.at_rest or run_down.is_off
        finally:
            session.close(at_rest=no_danger)
    return run_down


def stop_unseen(
    *,
    control: MotorControl,
    rig: RigConfig,
    operator: Operator,
    watchdog: float | None,
    clock: Clock | None = None,
) -> None:
    """Stop the rotor, harder and harder, until the drive has obeyed a stop and says that it is off.

    `control` was started and told to stop. Whether the rotor is at rest then, nobody has seen.
    """
    clock, ladder, operator = clock or WallClock(), _ladder(rig, watchdog), Steadfast(operator)
    ladder.begin(Measure.EMERGENCY, None)
    reading: Reading | None = None
    looked = read_at = clock.now()
    while not _drive_is_off(control, reading):
        clock.sleep(LOOK)
        now = clock.now()
        seconds, looked = now - looked, now
        control.beat(0.0)
        control.read_soon()
        if readings := control.take_readings():
            reading, read_at = readings[-1], now
        elif now - read_at > FRESH:
            reading = None
        if measure := ladder.advance(seconds, reading.state.speed if reading else None):
            report = control.report
            trouble = f" ({report.trouble})" if report and report.trouble else ""
            operator.tell(f"The drive does not report that it stops{trouble}: '{measure}' comes next.")
            _take(measure, control, rig, ladder, operator)


def _drive_is_off(control: MotorControl, reading: Reading | None) -> bool:
    report = control.report
    obeyed = report is not None and not math.isnan(report.confirmed)
    return obeyed and reading is not None and not reading.state.running


def _take(measure: Measure, control: MotorControl, rig: RigConfig, ladder: Ladder, operator: Operator) -> None:
    if stop := measure.stop:
        control.stop(stop)
    elif measure is Measure.SILENCE:
        control.fall_silent(ladder.silence)
    elif rig.power_cut:
        operator.tell(cut_power(rig.power_cut))


def _ladder(rig: RigConfig, watchdog: float | None) -> Ladder:
    return Ladder(ramp=1.0, watchdog=watchdog, power_cut=rig.power_cut is not None)

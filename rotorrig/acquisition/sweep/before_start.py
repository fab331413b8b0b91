"""Look at the rig before the first command: sound probes, a drive that answers, a rotor at rest.

All limits apply meanwhile: a dead probe, a drive in fault and samples that do not arrive end the sweep here.
"""

from collections.abc import Iterator

from rotorrig.acquisition.sweep.session import Session
from rotorrig.rig import LimitExceeded

LOOK = 2.5  # s of samples: a turn at 24 rpm and more, two of the seconds in which a probe is found to be not OK
PATIENCE = 10.0  # s of wall time for the drive's first reading; its driver gives up on a silent link much earlier


def look_before_start(session: Session, *, rolling: bool) -> Iterator[None]:
    """Record the rotor before the start; yield after every block. Raises LimitExceeded unless it is fit to start.

    With `rolling` it may be turning.
    """
    began = session.clock.now()
    session.control.read_soon()
    while session.t < LOOK or session.motor_state is None:
        if session.motor_state is None and session.clock.now() - began > PATIENCE:
            raise LimitExceeded(f"drive: gave no reading in {PATIENCE:g} s, want one before the start")
        session.take_block()
        yield
    if not rolling:
        session.check_standstill(session.motor_state)

"""Emergency stop: the operator's Ctrl-C, as the signal that a terminal sends."""

import signal

from rotorrig.acquisition.proof_test.protection import Protection
from rotorrig.acquisition.proof_test.stage import Stage

ANSWER = 0.1  # s: the signal's handler sends the stop, before anything else


def _press_ctrl_c(stage: Stage) -> None:
    signal.raise_signal(signal.SIGINT)


EMERGENCY_STOP = Protection(
    name="emergency stop",
    provocation="Ctrl-C",
    provoke=_press_ctrl_c,
    answers_within=lambda stage: ANSWER,
    reason="interrupted by the operator",
)

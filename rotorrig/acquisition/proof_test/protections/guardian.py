"""Guardian: the program gives it no sign of life, as if it hung."""

from rotorrig.acquisition.proof_test.protection import Protection
from rotorrig.acquisition.proof_test.stage import Stage

ANSWER = 0.5  # s beyond its patience


def _hang(stage: Stage) -> None:
    stage.control.mute = True


def _answers_within(stage: Stage) -> float:
    assert stage.guardian is not None
    return stage.guardian + ANSWER


GUARDIAN = Protection(
    name="guardian",
    provocation="no sign of life from the program",
    provoke=_hang,
    answers_within=_answers_within,
    reason="guardian: no sample was processed",
    missing=lambda stage: "there is no guardian" if stage.guardian is None else "",
)

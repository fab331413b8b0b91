"""Trial of one protection: it is provoked, the rotor is watched, and what the samples show is judged."""

import math
from dataclasses import replace

from rotorrig.acquisition.proof_test.certificate import Proof, Verdict
from rotorrig.acquisition.proof_test.plan import steady_seconds
from rotorrig.acquisition.proof_test.protection import Protection
from rotorrig.acquisition.proof_test.stage import Stage
from rotorrig.acquisition.proof_test.turns import SLOWER
from rotorrig.acquisition.recording import Event
from rotorrig.acquisition.sweep import RUN_DOWN_LIMIT, Provoke
from rotorrig.rig import LimitExceeded
from rotorrig.rig.config import RPM
from rotorrig.rig.control import Ladder, Measure

SHOWS = 1.0  # s for a stop that was decided to show, and two turns, and twice what the ramp needs for it
QUIET = 2.5  # s without a pulse, after which the drive may be spoken to again
FINISHED = "plan finished"  # what a sweep says of itself


class Trial:
    """One protection on its stage: when it was provoked, what is asked of it, and what was seen."""

    def __init__(self, protection: Protection, stage: Stage, *, ramp: float) -> None:
        self._protection, self._stage, self._ramp = protection, stage, ramp
        self._provoked_at = self._looked_at = math.nan  # s of the sample clock
        self._decided_within = self._slowing_within = math.nan  # s
        self._rest_within = stage.rig.limits.run_down if stage.rig.limits else RUN_DOWN_LIMIT
        self._ladder: Ladder | None = None  # once the rotor slows down by the drive alone

    @property
    def step(self) -> Provoke:
        """The last step of the part's plan."""
        return Provoke(
            what=f"{self._protection.name}, {self._protection.provocation}",
            act=self._provoke,
            has_stopped=self._has_stopped,
            limits=not self._protection.is_the_drives,
        )

    def _provoke(self) -> None:
        turns, speed = self._stage.turns, self._stage.speed
        turns.settle(seconds=steady_seconds(speed))
        self._provoked_at = self._looked_at = turns.time
        self._decided_within = self._protection.answers_within(self._stage)
        self._slowing_within = self._decided_within + SHOWS + 2 * turns.turn + 2 * SLOWER * speed / self._ramp
        self._protection.provoke(self._stage)

    def _has_stopped(self) -> bool:
        """Whether the drive has stopped the rotor by itself. Raises LimitExceeded if the protection does not act."""
        turns, now = self._stage.turns, self._stage.turns.time - self._provoked_at
        if not self._protection.is_the_drives:
            if now > self._decided_within:
                raise LimitExceeded(f"{self._protection.name}: no stop within {self._decided_within:.2f} s")
            return False
        if math.isnan(turns.slowing_at()):
            if now > self._slowing_within:
                raise LimitExceeded(
                    f"{self._protection.name}: the rotor turns at {turns.speed * RPM:.0f} rpm as before after "
                    f"{now:.1f} s, want it slower after {self._slowing_within:.1f} s"
                )
            return False
        if turns.silence > QUIET:
            return True
        if now > self._rest_within or self._lags():
            raise LimitExceeded(
                f"{self._protection.name}: the rotor still turns at {turns.speed * RPM:.0f} rpm after {now:.1f} s"
            )
        return False

    def _lags(self) -> bool:
        """Whether the rotor no longer becomes slower, as it does by friction alone."""
        turns = self._stage.turns
        seconds, self._looked_at = turns.time - self._looked_at, turns.time
        if self._ladder is None:
            self._ladder = Ladder(ramp=self._ramp, watchdog=None, power_cut=False)
            self._ladder.begin(Measure.COAST, turns.speed)
            return False
        return self._ladder.advance(seconds, turns.speed) is not None

    def is_answered(self, ending: Event) -> bool:
        """Return whether the part ended by its protection."""
        if math.isnan(self._provoked_at):
            return False
        if self._protection.is_the_drives:
            return ending.text == FINISHED
        return ending.kind in ("trip", "abort") and ending.text.startswith(self._protection.reason)

    def proof(self, ending: Event) -> Proof:
        """Return what was seen, and the verdict."""
        stage, began = self._stage, self._provoked_at
        rest_at = slowing_at = decided_at = math.nan
        if not math.isnan(began):
            slowing_at, rest_at = stage.turns.slowing_at(), stage.turns.rest_at()
        if not self._protection.is_the_drives:
            decided_at = stage.control.stopped_at
        proof = Proof(
            name=self._protection.name,
            provocation=self._protection.provocation,
            verdict=Verdict.PASSED,
            decided_after=decided_at - began,
            slowing_after=slowing_at - began,
            rest_after=rest_at - began,
            decided_within=math.nan if self._protection.is_the_drives else self._decided_within,
            slowing_within=self._slowing_within,
            rest_within=self._rest_within,
            resolution=stage.turns.turn,
        )
        if why := self._objection(proof, ending):
            return replace(proof, verdict=Verdict.FAILED, why=why)
        return proof

    def _objection(self, proof: Proof, ending: Event) -> str:
        """Return why the protection failed; empty: it did not."""
        if math.isnan(self._provoked_at):
            return f"ended before it was provoked: {ending.text}"
        if not self.is_answered(ending):
            return f"the rotor was stopped by something else: {ending.text}"
        if proof.decided_after > proof.decided_within:
            return f"stop decided after {proof.decided_after:.2f} s, want {proof.decided_within:.2f} s"
        if self._stage.control.harder:
            return f"the drive did not obey the stop; it took '{self._stage.control.harder[-1]}' to stop the rotor"
        if not proof.slowing_after <= proof.slowing_within:
            return f"slower after {proof.slowing_after:.1f} s, want {proof.slowing_within:.1f} s"
        if not proof.rest_after <= proof.rest_within:
            return f"at rest after {proof.rest_after:.1f} s, want {proof.rest_within:.1f} s"
        return ""

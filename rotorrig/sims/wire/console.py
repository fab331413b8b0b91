"""What a running bench says on its standard output after its first line, and hears on its standard input."""

import json
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import IO, Any

from rotorrig.rig import RigError

Said = dict[str, Any]
_ANSWER = 10.0  # s for the answer to a script: a loaded machine's bench may be in the middle of a step


class Console:
    """A bench's console: a thread of it keeps all that is said, for `said`; may be used from one thread.

    Lines are those of `fault_player.Player` and `emulation.emulating`.
    """

    def __init__(self, *, stdin: IO[bytes], stdout: IO[bytes]) -> None:
        self._stdin = stdin
        self._said: list[Said] = []
        self._more = threading.Condition()
        self._ended = False
        threading.Thread(target=self._listen, args=(stdout,), name="bench console", daemon=True).start()

    @property
    def said(self) -> tuple[Said, ...]:
        """All that the bench has said so far, answers left out."""
        with self._more:
            return tuple(line for line in self._said if "played" not in line and "refused" not in line)

    def play(self, faults: Sequence[Said], *, calm: bool = False) -> Said:
        """Play a script of faults from now on; return the moment: `t` [s, simulated], `wall` [s], `speed` [rad/s].

        With `calm`, faults of scripts before end first.

        Raises RigError, in the bench's own sentence, for a script that it refuses, or if the bench is gone.
        """
        with self._more:
            heard = len(self._said)
        try:
            self._stdin.write(json.dumps({"calm": calm, "faults": list(faults)}).encode() + b"\n")
            self._stdin.flush()
        except OSError as error:
            raise RigError(f"the simulated bench is gone ({error.strerror})") from error
        answer = self.wait_for(lambda line: "played" in line or "refused" in line, since=heard, timeout=_ANSWER)
        if "refused" in answer:
            raise RigError(answer["refused"])
        return answer

    def speed(self) -> float:
        """Return the rotor's true speed [rad/s]. Raises RigError if the bench is gone."""
        return self.play([])["speed"]

    def wait_for(self, wanted: Callable[[Said], bool], *, timeout: float, since: int = 0) -> Said:
        """Return the first line that is `wanted`, of those from number `since` on, waiting for it if need be.

        Raises RigError if it has not been said after `timeout` seconds, or the bench ended without saying it.
        """
        deadline = time.monotonic() + timeout
        with self._more:
            while True:
                found = next((line for line in self._said[since:] if wanted(line)), None)
                if found:
                    return found
                left = deadline - time.monotonic()
                if self._ended or left <= 0:
                    why = "it ended" if self._ended else f"{timeout:g} s have passed"
                    raise RigError(f"the simulated bench did not say what it was expected to: {why}")
                self._more.wait(left)

    def _listen(self, stdout: IO[bytes]) -> None:
        with suppress(ValueError):  # closed at this end
            for line in stdout:
                with self._more:
                    self._said.append(json.loads(line))
                    self._more.notify_all()
        with self._more:
            self._ended = True
            self._more.notify_all()

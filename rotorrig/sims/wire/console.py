"""Console of a running bench: its messages on standard output, scripts of faults on its standard input."""

import json
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import IO, Any

from rotorrig.rig import RigError

Message = dict[str, Any]
_ANSWER = 10.0  # s for the answer to a script: a loaded machine's bench may be in the middle of a step


class Console:
    """A bench's console: a thread keeps its messages; may be used from one thread.

    Lines are those of `fault_player.Player` and `emulation.emulate`.
    """

    def __init__(self, *, stdin: IO[bytes], stdout: IO[bytes]) -> None:
        self._stdin = stdin
        self._messages: list[Message] = []
        self._more = threading.Condition()
        self._ended = False
        threading.Thread(target=self._listen, args=(stdout,), name="bench console", daemon=True).start()

    @property
    def messages(self) -> tuple[Message, ...]:
        """Messages of the bench so far, answers left out."""
        with self._more:
            return tuple(line for line in self._messages if "played" not in line and "refused" not in line)

    def play(self, faults: Sequence[Message], *, calm: bool = False) -> Message:
        """Play a script of faults from now on; return the moment: `t` [s, simulated], `wall` [s], `speed` [rad/s].

        With `calm`, faults of scripts before end first.

        Raises RigError, in the bench's own sentence, for a script that it refuses, or if the bench is gone.
        """
        with self._more:
            since = len(self._messages)
        try:
            self._stdin.write(json.dumps({"calm": calm, "faults": list(faults)}).encode() + b"\n")
            self._stdin.flush()
        except OSError as error:
            raise RigError(f"the simulated bench is gone ({error.strerror})") from error
        answer = self.wait_for(lambda line: "played" in line or "refused" in line, since=since, timeout=_ANSWER)
        if "refused" in answer:
            raise RigError(answer["refused"])
        return answer

    def speed(self) -> float:
        """Return the rotor's true speed [rad/s]. Raises RigError if the bench is gone."""
        return self.play([])["speed"]

    def wait_for(self, wanted: Callable[[Message], bool], *, timeout: float, since: int = 0) -> Message:
        """Return the first line that is `wanted`, of those from number `since` on, waiting for it if need be.

        Raises RigError if it does not come within `timeout` seconds, or the bench ends without it.
        """
        deadline = time.monotonic() + timeout
        with self._more:
            while True:
                match = next((line for line in self._messages[since:] if wanted(line)), None)
                if match:
                    return match
                left = deadline - time.monotonic()
                if self._ended or left <= 0:
                    why = "it ended" if self._ended else f"{timeout:g} s have passed"
                    raise RigError(f"the simulated bench did not say what it was expected to: {why}")
                self._more.wait(left)

    def _listen(self, stdout: IO[bytes]) -> None:
        with suppress(ValueError):  # closed at this end
            for line in stdout:
                with self._more:
                    self._messages.append(json.loads(line))
                    self._more.notify_all()
        with self._more:
            self._ended = True
            self._more.notify_all()

"""Line between a sweep's process and its guardian: JSON, one message a line, over a pair of sockets.

Sending never waits: a peer that does not read for so long that the line is full has hung.
"""

import json
import select
import socket
import time
from typing import Any

Message = dict[str, Any]

CHUNK = 65536  # bytes of one read


class Line:
    """One end. `tell` may be called from a signal handler: a message goes out in one piece or not at all."""

    def __init__(self, end: socket.socket) -> None:
        self.full = False  # the peer does not read any more
        self.ended = False  # the peer is gone
        self._end = end
        self._rest = b""
        end.setblocking(False)

    def fileno(self) -> int:
        """Return the descriptor, for `select`."""
        return self._end.fileno()

    def tell(self, **message: Any) -> None:
        """Send a message; what cannot be sent is given up."""
        line = json.dumps(message).encode() + b"\n"
        try:
            if self._end.send(line) < len(line):
                self.full = True
        except BlockingIOError:
            self.full = True
        except OSError:
            pass  # the peer is gone: `hear` will say so, once it has returned what the peer said before

    def hear(self, timeout: float) -> list[Message]:
        """Return the messages that have come, after `timeout` seconds at most; what is no message is left out."""
        if self.ended:
            time.sleep(timeout)  # so that who goes on without the peer does so at the same pace
            return []
        try:
            if not select.select([self._end], [], [], timeout)[0]:
                return []
            chunk = self._end.recv(CHUNK)
        except BlockingIOError:
            return []
        except (OSError, ValueError):  # closed
            chunk = b""
        if not chunk:
            self.ended = True
        *lines, self._rest = (self._rest + chunk).split(b"\n")
        return [message for line in lines if (message := _decode(line)) is not None]

    def close(self) -> None:
        """Close this end."""
        self.ended = True
        self._end.close()


def _decode(line: bytes) -> Message | None:
    """Return the message of a line; None: it is none, as when the peer could not write all of it."""
    try:
        message = json.loads(line)
    except ValueError:
        return None
    return message if isinstance(message, dict) else None

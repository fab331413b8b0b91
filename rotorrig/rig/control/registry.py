"""Where the guardian of a motor link can be asked: a local socket named after the link.

It answers one JSON line with another: `{"ask": "state"}`, or `{"ask": "stop"}`, by which it lets go of the link if the
sweep's process is gone, and stops the rotor if it is not.
"""

import contextlib
import hashlib
import json
import os
import socket
from pathlib import Path
from typing import Any

from rotorrig.rig.config import Motor
from rotorrig.rig.errors import LinkLost

FOLDER = Path("/tmp")  # whatever the environment says: a shell, a service and a cron job have to find the same socket
PATIENCE = 5.0  # s for an answer
PSEUDO_TERMINALS = "/dev/pts/"
PLACE = ("driver", "port", "host", "tcp_port", "address", "interface", "channel", "node")  # keys that name a link


def address_of(table: Motor) -> Path:
    """Return the socket's path for this [motor] table; its folder is made, for this user alone.

    Raises LinkLost if it is another user's.
    """
    folder = FOLDER / f"rotorrig-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    if folder.is_symlink() or folder.stat().st_uid != os.getuid():
        raise LinkLost(f"motor: {folder} is not this user's own folder, want it away: guardians are asked there")
    names = {key: str(value) for key, value in table.model_dump().items() if key in PLACE}
    for key in ("port", "channel"):
        if _is_path(names.get(key, "")):
            names[key] = _port_of(names[key])
    return folder / (hashlib.sha256(json.dumps(names, sort_keys=True).encode()).hexdigest()[:16] + ".sock")


def _port_of(name: str) -> str:
    """Return one port's one name, from whichever folder and by whichever link it is called.

    A pseudo-terminal keeps the name it is given: the next one that is opened gets the number of one that has gone,
    whose guardian may still be there.
    """
    port = os.path.realpath(name)
    return str(Path(name).absolute()) if port.startswith(PSEUDO_TERMINALS) else port


def _is_path(name: str) -> bool:
    return "/" in name and "://" not in name


def guardian_log(table: Motor) -> Path:
    """Return where the guardian of this link writes if there is no recording to write beside."""
    return address_of(table).with_suffix(".log")


def ask_guardian(table: Motor, ask: str) -> dict[str, Any] | None:
    """Ask the guardian of this link; None: there is none."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as line:
        line.settimeout(PATIENCE)
        try:
            line.connect(str(address_of(table)))
            line.sendall(json.dumps({"ask": ask}).encode() + b"\n")
            answer: dict[str, Any] = json.loads(line.makefile().readline())
        except (OSError, ValueError):
            return None
    return answer


def serve(table: Motor) -> socket.socket:
    """Return a socket that listens for who asks about this link; a dead guardian's is replaced."""
    path = address_of(table)
    with contextlib.suppress(FileNotFoundError):
        path.unlink()
    server = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    server.bind(str(path))
    server.listen()
    server.setblocking(False)
    return server


def end_service(server: socket.socket) -> None:
    """Close the socket and remove it by the name it was given: an unplugged port may go by another since."""
    path = Path(server.getsockname())
    server.close()
    with contextlib.suppress(OSError):
        path.unlink()

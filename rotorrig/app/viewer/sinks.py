"""Outputs of the plots: a Rerun viewer on this machine, a file, or both.

Only 127.0.0.1 is listened on: Rerun's own helpers open a port to the whole network. The viewer's usage reports are off.
"""

import atexit
import contextlib
import importlib.util
import os
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, Self

from rotorrig.app.terminal import err
from rotorrig.rig import RigError

LOOPBACK = "127.0.0.1"
START_SECONDS = 20.0  # a cold start on a slow disk
MEMORY = "1GB"  # of old data a viewer may keep


@dataclass(slots=True, kw_only=True)
class Sink:
    """Targets for a recording stream, and the viewer that was started for them.

    A viewer's window outlives the program, its owner closes it; a viewer served as a web page ends with the program.
    """

    targets: tuple[str | Path, ...]  # a viewer's address, the name of a file
    address: str = ""  # what a person opens in a browser; empty where a window opens by itself, or for a file
    viewer: subprocess.Popen[bytes] | None = None

    def open_targets(self) -> tuple[Any, ...]:
        """Return the targets as a stream takes them."""
        import rerun as rr  # takes a second, and only the process that draws needs it

        return tuple(rr.FileSink(str(t)) if isinstance(t, Path) else rr.GrpcSink(t) for t in self.targets)

    def close(self) -> None:
        """End the viewer, if there is one; may be called twice."""
        if self.viewer is not None:
            _end(self.viewer)

    def wait(self) -> None:
        """Return when the viewer has been closed."""
        if self.viewer is not None:
            self.viewer.wait()

    def linger(self) -> None:
        """Keep a web page, which would end with the program, until Ctrl-C; where nobody can press that, return."""
        if self.address and err.is_terminal:
            err.print("The view stays open until Ctrl-C.")
            with contextlib.suppress(KeyboardInterrupt):
                self.wait()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def to_file(path: Path) -> Sink:
    """Return a sink that writes an .rrd file. Raises RigError if its folder is missing."""
    if not path.parent.is_dir():
        raise RigError(f"{path}: there is no folder {path.parent}, want an existing one for the .rrd file")
    return Sink(targets=(path,))


def serve(*, save: Path | None = None, headless: bool | None = None) -> Sink:
    """Start a viewer on this machine and return the sink that feeds it, and a file as well if `save` is given.

    With a display it is a window; without one (`headless`, found out if None) a web page at `Sink.address`.
    Raises RigError if the viewer does not start.
    """
    file = to_file(save).targets if save else ()
    process, port, address = _start(headless=not has_display() if headless is None else headless)
    if address:
        err.print(f"no display here; the live view is at {address}", highlight=False, soft_wrap=True)
    return Sink(targets=(proxy(port), *file), address=address, viewer=process)


def show_files(paths: Sequence[Path], *, cursor: tuple[str, int] | None = None, headless: bool | None = None) -> Sink:
    """Open .rrd files in a viewer on this machine; `Sink.wait` returns when it is closed. Raises RigError.

    `cursor` is a timeline and the place on it a window opens at; without it, and in a web page, it plays to its end.
    """
    dark = not has_display() if headless is None else headless
    process, port, address = _start(headless=dark, files=paths)
    if cursor and not dark:
        move_cursor(port, *cursor, alive=lambda: process.poll() is None)
    if address:
        err.print(f"no display here; open {address} in a browser, Ctrl-C ends it", highlight=False, soft_wrap=True)
    return Sink(targets=(), address=address, viewer=process)


def move_cursor(port: int, timeline: str, place: int, *, alive: Callable[[], bool] = lambda: True) -> bool:
    """Move the cursor of the viewer at `port` once it has that timeline; return whether it could, while it is `alive`.

    What goes wrong is let go: the picture is there, at the end of its timeline.
    """
    from rerun.experimental import ViewerClient

    deadline = time.monotonic() + START_SECONDS
    while alive() and time.monotonic() < deadline:
        with contextlib.suppress(Exception):  # the viewer is still starting, has been closed, or is of another version
            viewer = ViewerClient.connect(proxy(port))
            if any(line.name == timeline for shown in viewer.get_state().recordings for line in shown.timelines):
                viewer.set_time(timeline, sequence=place, play_state="paused")
                return True
        time.sleep(0.1)
    return False


def has_display() -> bool:
    """Return whether a window can be opened here."""
    return sys.platform in ("win32", "darwin") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def proxy(port: int) -> str:
    """Return the address Rerun clients use for a viewer's port."""
    return f"rerun+http://{LOOPBACK}:{port}/proxy"


def viewer_program() -> str:
    """Return the viewer's own program; the `rerun` on the path is a wrapper whose end would leave it running."""
    spec = importlib.util.find_spec("rerun_cli")
    folder = Path(spec.origin).parent if spec and spec.origin else Path()
    program = folder / ("rerun.exe" if sys.platform == "win32" else "rerun")
    if not program.is_file():
        raise RigError(f"{program}: the Rerun viewer is missing, want the package rerun-sdk with its viewer")
    return str(program)


def quiet_environment() -> dict[str, str]:
    """Return the environment of a viewer that reports nothing: Rerun sends no usage data where CI is set."""
    return {**os.environ, "CI": "1", "RUST_LOG": "error"}


def free_port() -> int:
    """Return a port of this machine nobody listens on at the moment."""
    with socket.socket() as probe:
        probe.bind((LOOPBACK, 0))
        return int(probe.getsockname()[1])


def _start(*, headless: bool, files: Sequence[Path] = ()) -> tuple[subprocess.Popen[bytes], int, str]:
    port, address = free_port(), ""
    words = [viewer_program(), "--bind", LOOPBACK, "--port", str(port), "--memory-limit", MEMORY]
    words += ["--server-memory-limit", MEMORY, *map(str, files)]
    ready = port
    if headless:
        ready = free_port()
        words += ["--serve-web", "--web-viewer-port", str(ready)]
        address = f"http://{LOOPBACK}:{ready}/?url={proxy(port).replace('+', '%2B')}"
    with tempfile.TemporaryFile() as output:  # not a pipe: nobody would empty it
        process = subprocess.Popen(
            words,
            env=quiet_environment(),
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=output,
            start_new_session=not headless,  # Ctrl-C ends the sweep, not the window one wants to look at
        )
        if headless:
            atexit.register(_end, process)
        _wait_until_listening(process, ready, output)
    return process, port, address


def _end(process: subprocess.Popen[bytes]) -> None:
    if process.poll() is None:
        process.terminate()
        process.wait(timeout=10)


def _wait_until_listening(process: subprocess.Popen[bytes], port: int, output: IO[bytes]) -> None:
    deadline = time.monotonic() + START_SECONDS
    while time.monotonic() < deadline:
        if process.poll() is not None:
            output.seek(0)
            message = output.read().decode(errors="replace").strip()
            raise RigError(
                f"the Rerun viewer ended at once: {message.splitlines()[-1] if message else 'it said nothing'}"
            )
        with socket.socket() as probe:
            probe.settimeout(0.2)
            if probe.connect_ex((LOOPBACK, port)) == 0:
                return
        time.sleep(0.05)
    process.kill()
    raise RigError(f"the Rerun viewer did not answer on {LOOPBACK}:{port} within {START_SECONDS:g} s")

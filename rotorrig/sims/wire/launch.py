"""Start a simulated bench in a process of its own and hand over its two ports.

with simulated_bench(Path("configs/rk4.toml"), seed=1) as ports:
    ...  # connect.motor(rig, at=ports.motor), connect.daq(rig, at=ports.daq)
"""

import contextlib
import json
import select
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from rotorrig.rig import RigError
from rotorrig.sims.wire.console import Console
from rotorrig.sims.wire.simulated_time import DEFAULT_RATE

START_TIMEOUT = 180.0  # s: the first start on a machine compiles the plant, half a minute on a slow one
_END_TIMEOUT = 5.0  # s


@dataclass(frozen=True, slots=True, kw_only=True)
class BenchPorts:
    """Ports of a running bench: keys of [motor] and of [daq] in place of the config's, and its console."""

    motor: dict[str, Any]
    daq: dict[str, Any]
    console: Console


@contextmanager
def simulated_bench(
    config: Path | str,
    *,
    seed: int,
    hidden: Path | None = None,
    rate: float = DEFAULT_RATE,
    faults: Path | None = None,
    wire: Path | None = None,
    timeout: float = START_TIMEOUT,
) -> Iterator[BenchPorts]:
    """Run a simulated bench for the length of a `with` block.

    `config` is a path, or a config's text (a str). The truth is drawn from `seed`, or unsealed from `hidden`. `rate`
    is the ceiling of simulated over wall time; at 1 and below the bench is paced as a real one. `faults` is a script to
    play from the start; others can be played at any time, see `Console.play`. `wire` is a file for a copy of all that
    the DAQ's client is sent.
    Raises RigError with the bench's own sentence when it does not start within `timeout` seconds, or when it ended
    by itself before the block did.
    """
    with tempfile.TemporaryDirectory(prefix="rotorrig-bench-") as scratch:
        if isinstance(config, str):
            text, config = config, Path(scratch) / "config.toml"
            config.write_text(text, encoding="utf-8")
        command = [sys.executable, "-m", "rotorrig.sims.wire.bench", str(config), "--seed", str(seed)]
        command += ["--rate", repr(float(rate))] + (["--hidden", str(hidden)] if hidden else [])
        command += (["--faults", str(faults)] if faults else []) + (["--wire", str(wire)] if wire else [])
        with (Path(scratch) / "stderr").open("w+b") as complaints, _run_child(command, complaints) as process:
            ports = _wait_for_ports(process, complaints, timeout)
            yield ports
            if process.poll() is not None:
                raise RigError(f"the simulated bench ended by itself: {_sentence(complaints, process)}")


@contextmanager
def _run_child(command: list[str], complaints: IO[bytes]) -> Iterator[subprocess.Popen[bytes]]:
    """Run `command` until the block ends; its standard input is the line it lives on."""
    # a session of its own: Ctrl-C is for us, who then stop the rotor over the wire before the wire goes
    process = subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=complaints, start_new_session=True
    )
    with process:
        try:
            yield process
        finally:
            assert process.stdin
            with contextlib.suppress(BrokenPipeError):
                process.stdin.close()
            try:
                process.wait(_END_TIMEOUT)
            except subprocess.TimeoutExpired:
                process.kill()


def _wait_for_ports(process: subprocess.Popen[bytes], complaints: IO[bytes], timeout: float) -> BenchPorts:
    assert process.stdout
    if not select.select([process.stdout], [], [], timeout)[0]:
        process.kill()  # it watches its standard input only once it runs
        raise RigError(f"the simulated bench did not start within {timeout:g} s")
    line = process.stdout.readline()
    if not line:
        process.wait(_END_TIMEOUT)
        raise RigError(f"the simulated bench did not start: {_sentence(complaints, process)}")
    ports = json.loads(line)
    assert process.stdin
    console = Console(stdin=process.stdin, stdout=process.stdout)
    return BenchPorts(motor=ports["motor"], daq=ports["daq"], console=console)


def _sentence(complaints: IO[bytes], process: subprocess.Popen[bytes]) -> str:
    """Return the last line the bench wrote to stderr."""
    complaints.seek(0)
    lines = complaints.read().decode("utf-8", errors="replace").strip().splitlines()
    return lines[-1] if lines else f"it said nothing and returned {process.returncode}"

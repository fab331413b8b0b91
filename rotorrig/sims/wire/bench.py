"""Program that simulates a rig behind real wires.

`python -m rotorrig.sims.wire.bench CONFIG.toml [--seed N] [--hidden SEALED.json] [--rate X] [--faults SCRIPT.json]
[--wire FILE]`

Emulates the config's motor controller and a framed serial DAQ in front of one plant. When both are ready it prints one
JSON line that says where they are; after that, in JSON lines, the rotor's true speed and what became of scripted faults
(docs/simulated-rig.md). It runs until SIGINT, SIGTERM or the end of its standard input: holding the other end of that
pipe is what keeps it alive, so it cannot outlive its parent. Each line of that input is a script of faults to play from
then on, answered by the speed, or by why it was refused. What else the truth behind the wires is, is never printed.
"""

import argparse
import asyncio
import contextlib
import json
import math
import os
import secrets
import select
import signal
import sys
from collections.abc import Callable
from contextlib import AbstractAsyncContextManager
from pathlib import Path
from typing import Any

from rotorrig.rig import ConfigError, RigError
from rotorrig.rig.config import Motor, RigConfig, load
from rotorrig.sims.plant import Plant, draw, unseal
from rotorrig.sims.wire.emulation import Emulation, emulate
from rotorrig.sims.wire.fault_script import Script, parse_script, read_script
from rotorrig.sims.wire.simulated_time import DEFAULT_RATE

_LONGEST_SENTENCE = 500  # characters


def main(argv: list[str] | None = None) -> int:
    """Run the bench; return 0 when asked to end, 2 with one sentence on stderr when it cannot run."""
    given = _parser().parse_args(argv)
    code = 0
    try:
        script = read_script(given.faults) if given.faults else Script()
        rig = load(given.config)
        motor = _require_motor(rig, given.config)
        plant, seed = _plant(rig, given)
        emulation = emulate(
            motor,
            plant,
            serial=f"SIM-{rig.hash[:8]}",
            rate=given.rate,
            keyphasor=rig.keyphasor.channel if rig.keyphasor else None,
            report=_print_line,
            wire=given.wire,
        )
        asyncio.run(_run(emulation, script, seed))
    except* RigError as faults:
        print(_first_error(faults), file=sys.stderr)
        code = 2
    return code


async def _run(emulation: AbstractAsyncContextManager[Emulation], script: Script, seed: int | None) -> None:
    """Serve until told to end."""
    async with emulation as wires:
        wires.player.check(script)
        _print_line({"motor": wires.motor, "daq": wires.daq, "seed": seed})
        wires.player.play(script)
        await _wait_for_end(lambda line: _print_line(_answer(line, wires)))
        _print_line(wires.moment())


def _answer(line: bytes, wires: Emulation) -> dict[str, Any]:
    """Play the script on a line of standard input."""
    try:
        script = parse_script(line.decode("utf-8", errors="replace"), where="script")
        wires.player.check(script)
    except ConfigError as error:
        return {"refused": str(error)[:_LONGEST_SENTENCE]}  # it may quote a whole script
    wires.player.play(script)
    return wires.moment() | {"played": len(script.faults)}


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="rotorrig.sims.wire.bench", description="A simulated rig behind two ttys.")
    parser.add_argument("config", type=Path, help="the rig's TOML file")
    parser.add_argument("--seed", type=int, help="draws the truth behind the wires (default: a random one)")
    parser.add_argument("--hidden", type=Path, help="a sealed truth to use instead of a drawn one")
    parser.add_argument("--faults", type=Path, help="a script of faults to play from the start")
    parser.add_argument(
        "--wire", type=argparse.FileType("wb", 0), help="a file for a copy of all that the DAQ's client is sent"
    )
    parser.add_argument("--rate", type=_rate, default=DEFAULT_RATE, help="simulated over wall time (default: 20)")
    return parser


def _rate(text: str) -> float:
    try:
        rate = float(text)
    except ValueError:
        rate = math.nan
    if not 0.0 < rate < math.inf:
        raise argparse.ArgumentTypeError(f"got '{text}', want a number above 0")
    return rate


def _require_motor(rig: RigConfig, path: Path) -> Motor:
    if rig.motor is None or rig.daq is None:
        missing = "[motor]" if rig.motor is None else "[daq]"
        raise ConfigError(f"{path}: has no {missing}, want one: the bench emulates what it names")
    return rig.motor


def _plant(rig: RigConfig, given: argparse.Namespace) -> tuple[Plant, int | None]:
    """Return the plant, at rest, and the seed its truth was drawn from (None: it was unsealed)."""
    if given.hidden:
        actual, seed = unseal(given.hidden), None
    else:
        seed = secrets.randbelow(2**31) if given.seed is None else given.seed
        actual = draw(rig, seed=seed)
    return Plant(rig, actual), seed  # compiles on first use, before anybody waits for a sample


def _print_line(message: dict[str, Any]) -> None:
    """Print a line, unless whoever reads them has stopped doing so: the emulators must not wait for that."""
    line = (json.dumps(message) + "\n").encode()
    assert len(line) <= select.PIPE_BUF  # what a pipe that can be written to takes whole
    with contextlib.suppress(BrokenPipeError):  # nobody left to read it: the end of stdin follows
        if select.select([], [sys.stdout.fileno()], [], 0)[1]:
            os.write(sys.stdout.fileno(), line)


async def _wait_for_end(take_line: Callable[[bytes], None]) -> None:
    """Wait for SIGINT, SIGTERM or the end of standard input, whose lines are handed to `take_line`."""
    loop, end = asyncio.get_running_loop(), asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, end.set)
    pending = b""

    def listen() -> None:
        nonlocal pending
        data = os.read(0, 65536)
        *lines, pending = (pending + data).split(b"\n")
        for line in lines:
            take_line(line)
        if not data:
            loop.remove_reader(0)
            end.set()

    # a closed stdin or one that cannot be waited for (/dev/null, a file) has no end to notice
    with contextlib.suppress(OSError):
        loop.add_reader(0, listen)
    await end.wait()


def _first_error(faults: BaseExceptionGroup[RigError]) -> BaseException:
    inner = faults.exceptions[0]
    return _first_error(inner) if isinstance(inner, BaseExceptionGroup) else inner


if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C while still compiling ends without a traceback
    sys.exit(main())

"""A simulated rig behind real wires, as a program of its own.

`python -m rotorrig.sims.wire.bench CONFIG.toml [--seed N] [--hidden SEALED.json] [--rate X]`

Opens two ttys, a Modbus RTU drive and a framed serial DAQ in front of one plant, prints one JSON line with their
paths when both are ready, and runs until SIGINT, SIGTERM or the end of its standard input: holding the other end of
that pipe is what keeps it alive, so it cannot outlive its parent. The truth behind the wires is never printed.
"""

import argparse
import asyncio
import contextlib
import json
import math
import os
import secrets
import signal
import sys
from pathlib import Path

from rotorrig.rig.description import Motor, RigConfig, load
from rotorrig.rig.errors import ConfigError, RigError
from rotorrig.sims.plant import truth
from rotorrig.sims.plant.plant import Plant
from rotorrig.sims.wire.emulation import emulate
from rotorrig.sims.wire.simulated_time import DEFAULT_RATE


def main(argv: list[str] | None = None) -> int:
    """Run the bench; return 0 when asked to end, 2 with one sentence on stderr when it cannot run."""
    given = _parser().parse_args(argv)
    code = 0
    try:
        rig = load(given.config)
        motor = _motor(rig, given.config)
        plant, seed = _plant(rig, given)

        def announce(motor_port: str, daq_port: str) -> None:
            _say({"motor_port": motor_port, "daq_port": daq_port, "seed": seed})

        async def run() -> None:
            end = _end_of_run()
            await emulate(motor, plant, serial=f"SIM-{rig.hash[:8]}", rate=given.rate, announce=announce, end=end)

        asyncio.run(run())
    except* RigError as faults:
        print(_first(faults), file=sys.stderr)
        code = 2
    return code


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="rotorrig.sims.wire.bench", description="A simulated rig behind two ttys.")
    parser.add_argument("config", type=Path, help="the rig's TOML file")
    parser.add_argument("--seed", type=int, help="draws the truth behind the wires (default: a random one)")
    parser.add_argument("--hidden", type=Path, help="a sealed truth to use instead of a drawn one")
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


def _motor(rig: RigConfig, path: Path) -> Motor:
    if rig.motor is None or rig.daq is None:
        missing = "[motor]" if rig.motor is None else "[daq]"
        raise ConfigError(f"{path}: has no {missing}, want one: the bench emulates what it names")
    return rig.motor


def _plant(rig: RigConfig, given: argparse.Namespace) -> tuple[Plant, int | None]:
    """Return the plant, at rest, and the seed its truth was drawn from (None: it was unsealed)."""
    if given.hidden:
        actual, seed = truth.unseal(given.hidden), None
    else:
        seed = secrets.randbelow(2**31) if given.seed is None else given.seed
        actual = truth.draw(rig, seed=seed)
    return Plant(rig, actual), seed  # compiles on first use, before anybody waits for a sample


def _say(ports: dict[str, str | int | None]) -> None:
    with contextlib.suppress(BrokenPipeError):  # nobody left to read it: the end of stdin follows
        os.write(sys.stdout.fileno(), (json.dumps(ports) + "\n").encode())


def _end_of_run() -> asyncio.Event:
    """Return an event that is set by SIGINT, SIGTERM or the end of standard input."""
    loop, end = asyncio.get_running_loop(), asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, end.set)

    def listen() -> None:
        if not os.read(0, 4096):
            loop.remove_reader(0)
            end.set()

    # a closed stdin or one that cannot be waited for (/dev/null, a file) has no end to notice
    with contextlib.suppress(OSError):
        loop.add_reader(0, listen)
    return end


def _first(faults: BaseExceptionGroup[RigError]) -> BaseException:
    inner = faults.exceptions[0]
    return _first(inner) if isinstance(inner, BaseExceptionGroup) else inner


if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C while still compiling ends without a traceback
    sys.exit(main())

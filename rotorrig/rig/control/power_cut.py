"""Power cut: the command of [power_cut] that switches the drive's supply off, by a relay, a smart plug, a contactor."""

import subprocess
import threading

from rotorrig.rig.config import PowerCut

_running = threading.Lock()


def cut_power(table: PowerCut) -> str:
    """Run the command and wait for it; return a sentence that says what came of it. Never raises."""
    with _running:
        try:
            done = subprocess.run(
                table.command, timeout=table.timeout, stdin=subprocess.DEVNULL, capture_output=True, check=False
            )
        except subprocess.TimeoutExpired:
            return f"power cut: '{table.command[0]}' did not end within {table.timeout:g} s"
        except (OSError, ValueError) as error:  # ValueError: of arguments no program can have
            why = getattr(error, "strerror", None) or error
            return f"power cut: '{table.command[0]}' cannot be run ({why})"
    if done.returncode:
        words = done.stderr.decode(errors="replace").strip().splitlines()
        return f"power cut: '{table.command[0]}' ended with {done.returncode}" + (f" ({words[-1]})" if words else "")
    return f"power cut: '{table.command[0]}' was run"

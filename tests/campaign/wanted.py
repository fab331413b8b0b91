"""What a run of the fault campaign is wanted to end with, besides nothing said or done that is wrong."""

from collections.abc import Callable

from benchmarks.parts.soak.judge import Verdict

Wanted = Callable[[Verdict], bool]


def stopped(verdict: Verdict) -> bool:
    """The sweep ended for the fault, with the rotor at rest, without the operator's help."""
    return verdict.status not in (0, None) and not verdict.left and verdict.stop_s is not None


def got_stop(verdict: Verdict, *, within: float) -> bool:
    """The drive got a stop so soon [s] after the last fault, and none before the first."""
    moments = verdict.faults.values()
    return verdict.first_stop_s is not None and verdict.first_stop_s + min(moments) - max(moments) <= within


def within(seconds: float) -> Wanted:
    """It was stopped so soon."""
    return lambda verdict: stopped(verdict) and got_stop(verdict, within=seconds)


def obeyed_within(seconds: float) -> Wanted:
    """Likewise; within its first turn, the rotor gave no pulse by which it could be proven at rest."""
    return lambda verdict: (
        got_stop(verdict, within=seconds) and verdict.rpm_at_end == 0.0 and (stopped(verdict) or left(verdict))
    )


def ended_at_rest(verdict: Verdict) -> bool:
    """The drive's watchdog has stopped the rotor, and the program says so, whether or not the operator wanted to go."""
    return verdict.claims.get("line") == "rest" and verdict.rpm_at_end == 0.0


def left(verdict: Verdict) -> bool:
    """The program went on until the operator left it, and did not call the rotor stopped."""
    return verdict.left and verdict.claims.get("line") == "turning"

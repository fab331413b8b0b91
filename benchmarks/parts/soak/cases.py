"""Named cases: what was found once, to be run again by name."""

from typing import Any

from benchmarks.parts.soak.faults import AT_TOP, TURNS, Case, Moment

ON_TOP = Moment(0.3, above=AT_TOP)
TURNING = Moment(1.0, above=TURNS)
DWELLS = Moment(2.0, above=290.0)  # in the dwell at 300 rpm


def upon(fault: str, seconds: float) -> Moment:
    """Return the moment so long after another fault."""
    return Moment(seconds, after=fault)


def _case(name: str, controller: str, *faults: str, **more: Any) -> Case:
    return Case(set="cases", name=name, controller=controller, faults=faults, **more)


CASES = {
    case.name: case
    for case in (
        _case("one supply", "acs355-tcp", "one supply", at=(ON_TOP,)),
        _case("one supply, no watchdog", "vfd-ed-rtu", "one supply", at=(ON_TOP,)),
        _case(
            "terminal and link for 4 s",
            "vfd-ed-rtu",
            "link dead for 4 s",
            "terminal closed",
            at=(ON_TOP, upon("link dead for 4 s", 0.05)),
        ),
        _case(
            "pipe and link for 4 s",
            "vfd-ed-rtu",
            "link dead for 4 s",
            "stdout closed",
            at=(ON_TOP, upon("link dead for 4 s", 0.05)),
        ),
        _case(
            "lost frames and keyphasor",
            "acs355-tcp",
            "DAQ loses a few frames",
            "keyphasor dead",
            at=(Moment(0.5), DWELLS),
            dwell=True,
        ),
        _case("lost frames", "acs355-tcp", "DAQ loses frames", at=(Moment(0.5),), dwell=True),
        _case("late samples", "acs355-tcp", "DAQ late", at=(TURNING,), dwell=True),
        _case("ignored stop", "acs355-tcp", "ignores stop", at=(ON_TOP,)),
        _case(
            "ignored stop, interrupted", "acs355-tcp", "ignores stop", "SIGINT", at=(ON_TOP, upon("ignores stop", 0.5))
        ),
        _case(
            "ignored stop, tripped",
            "powerflex400-tcp",
            "ignores stop",
            "probe at 0 V",
            at=(ON_TOP, upon("ignores stop", 0.5)),
            run_down="8 s",
        ),
        _case("only coast", "acs355-tcp", "only coast", "SIGINT", at=(ON_TOP, upon("only coast", 0.5))),
        _case("only coast, plan's end", "acs355-rtu", "only coast", at=(ON_TOP,)),
        _case("one busy", "acs355-tcp", "busy", at=(TURNING,)),
        _case("SIGQUIT", "vfd-ed-rtu", "SIGQUIT", at=(ON_TOP,)),
        _case("kill -9", "vfd-ed-rtu", "kill -9", at=(ON_TOP,)),
        _case("dwell at 3500 rpm", "acs355-tcp", "runs away", at=(DWELLS,), dwell=True, limits=False),
        _case("dwell at 60 rpm", "acs355-tcp", "runs slow", at=(DWELLS,), dwell=True, limits=False),
        _case("wrong pole pairs", "acs355-tcp", extra=(("speed factor", 2.0),), limits=False),
        _case("wrong pole pairs, dwell", "acs355-tcp", extra=(("speed factor", 2.0),), limits=False, dwell=True),
        _case("rolling start", "acs355-tcp", rolling=1800.0, limits=False),
        _case("dead probe, 0 V", "acs355-tcp", "probe at 0 V", at=(TURNING,), limits=False),
        _case("dead probe, -19.9 V", "acs355-tcp", "probe at -19.9 V", at=(TURNING,), limits=False),
        _case(
            "reports 0 and keyphasor",
            "acs355-tcp",
            "reports 0",
            "keyphasor dead",
            at=(DWELLS, upon("reports 0", 0.5)),
            dwell=True,
        ),
    )
}

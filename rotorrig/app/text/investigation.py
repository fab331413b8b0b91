"""Rounds of an investigation in words."""

from collections.abc import Sequence

from rotorrig.investigation import Belief, Round
from rotorrig.rig.config import RPM


def run_text(made: Round) -> str:
    """Return what a run was: "2: plan 'default-faster', 48 s"."""
    held = f" at {', '.join(f'{speed * RPM:.0f}' for speed in made.speeds)} rpm" if made.speeds else ""
    masses = f" with {'; '.join(made.trial)}" if made.trial else ""
    unseen = ", seen by no fit" if made.unseen and not made.joined else ""
    if made.joined:
        unseen = ", first held back, then fitted with the others"
    return f"{made.number}: plan '{made.plan}'{held}{masses}, {made.seconds:.0f} s{unseen}"


def belief_text(held: Sequence[Belief]) -> str:
    """Return causes with their probabilities: "bow 62 %, runout, plane 1 38 %".

    >>> belief_text([Belief("bow", 0.9996)]), belief_text([Belief("bow", 0.62), Belief("couple, disk", 0.38)])
    ('bow: > 99 %', 'bow: 62 %; couple, disk: 38 %')
    """
    return "; ".join(f"{each.label}: {_format_share(each.probability)}" for each in held)


def _format_share(share: float) -> str:
    if share > 0.99:
        return "> 99 %"
    return "< 1 %" if share < 0.01 else f"{100 * share:.0f} %"

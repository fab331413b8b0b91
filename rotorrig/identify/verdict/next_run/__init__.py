"""The next run: plans one could make, what each would show, how loud it would be, and which tells most."""

from rotorrig.identify.verdict.next_run.choice import NextRun, find_next_run, find_other_run
from rotorrig.identify.verdict.next_run.plans import higher_tops

__all__ = ["NextRun", "find_next_run", "find_other_run", "higher_tops"]

"""The runs to choose from, as plans of the config: the one given, slower, faster, to higher speeds, and at dwells.

They stand in the config before the first run, so that all recordings are of one config and each can be made again by
hand with `rotor sweep CONFIG --plan NAME`.
"""

from dataclasses import dataclass, replace

from rotorrig.identify.verdict import VERDICT, NextRun, higher_tops
from rotorrig.rig import ConfigError
from rotorrig.rig.config import RPM, RigConfig, RunUpCoastDown, RunUpRampDown, Stepped, extend, parse

FACTOR = 3.0  # faster, and slower


@dataclass(frozen=True, slots=True, kw_only=True)
class Menu:
    """Names of plans of a config, by what they are for; empty: there is no such run."""

    base: str
    slower: str = ""
    faster: str = ""
    held: str = ""  # at speeds that are chosen when it is run
    higher: tuple[tuple[str, float], ...] = ()  # with their highest speeds [rad/s]

    @property
    def names(self) -> tuple[str, ...]:
        """All of them but the base."""
        return (*filter(None, (self.slower, self.faster, self.held)), *(name for name, _ in self.higher))

    def without(self, name: str) -> "Menu":
        """Return the menu less one plan."""
        plain = {key: "" for key in ("slower", "faster", "held") if getattr(self, key) == name}
        return replace(self, higher=tuple(each for each in self.higher if each[0] != name), **plain)

    def plan_of(self, run: NextRun, ramp: float) -> str:
        """Return the plan that makes a proposed run; `ramp` [rad/s^2] is the base's. Empty: none does."""
        if run.kind == "ramp rate":
            return self.faster if run.ramp > ramp else self.slower
        if run.kind == "dwells":
            return self.held
        if run.kind == "through critical":
            return min(self.higher, key=lambda each: abs(each[1] - run.top), default=("", 0.0))[0]
        return self.base if run.kind == "trial mass" else ""


def add_runs(rig: RigConfig, base: str) -> tuple[RigConfig, Menu]:
    """Return the config with the plans of a menu, and the menu.

    Of another kind of plan than a run-up there is the base alone. Raises ConfigError without the plan `base`, and where
    a plan of the menu's has its name already.
    """
    if base not in rig.plans:
        raise ConfigError(f"plan '{base}': the config has none of that name, want one of {sorted(rig.plans)}")
    plan = rig.plans[base]
    if not isinstance(plan, RunUpCoastDown | RunUpRampDown):
        return rig, Menu(base=base)
    tops = {f"{base}-to-{top * RPM:.0f}": top for top in higher_tops(rig, plan.end)}
    made = {
        f"{base}-slower": plan.model_copy(update={"ramp": plan.ramp / FACTOR}),
        f"{base}-faster": plan.model_copy(update={"ramp": plan.ramp * FACTOR}),
        f"{base}-held": _plan_dwells(plan),
        **{name: plan.model_copy(update={"end": top}) for name, top in tops.items()},
    }
    if taken := sorted(made.keys() & rig.plans.keys()):
        raise ConfigError(f"plans.{taken[0]}: an investigation adds a plan of that name, want another name for it")
    named = {key: f"{base}-{key}" for key in ("slower", "faster", "held")}
    menu = Menu(base=base, higher=tuple(tops.items()), **named)
    if not rig.text:  # made in code
        return extend(rig.model_copy(update={"plans": {**rig.plans, **made}}), rig.effects), menu
    tables = "\n".join(_table(name, each) for name, each in made.items())
    text = f"{rig.text.rstrip()}\n\n# Runs that an investigation may choose, made from plan '{base}'.\n{tables}"
    return parse(text, where=rig.name), menu


def _plan_dwells(plan: RunUpCoastDown | RunUpRampDown) -> Stepped:
    """Return a plan that holds speeds; those it has stand for the ones that are chosen when it is run."""
    speeds = {"slow_roll": plan.slow_roll, "start": plan.start, "end": plan.end}
    speeds["step"] = (plan.end - plan.start) / (VERDICT.dwells - 1)
    times = {"slow_roll_time": plan.slow_roll_time, "settle": VERDICT.settle, "dwell": VERDICT.dwell}
    stated = {
        "kind": "stepped",
        **{key: f"{speed * RPM:.9g} rpm" for key, speed in speeds.items()},
        **{key: f"{seconds:.9g} s" for key, seconds in times.items()},
        "ramp": f"{plan.ramp * RPM:.9g} rpm/s",
    }
    return Stepped.model_validate(stated)


def _table(name: str, plan: RunUpCoastDown | RunUpRampDown | Stepped) -> str:
    lines = [f'[plans."{name}"]', f'kind = "{plan.kind}"']
    speeds, times = ("slow_roll", "start", "end", "step"), ("slow_roll_time", "settle", "dwell")
    lines += [f'{key} = "{getattr(plan, key) * RPM:.9g} rpm"' for key in speeds if hasattr(plan, key)]
    lines += [f'{key} = "{getattr(plan, key):.9g} s"' for key in times if hasattr(plan, key)]
    lines.append(f'ramp = "{plan.ramp * RPM:.9g} rpm/s"')
    return "\n".join([*lines, ""])

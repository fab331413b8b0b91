"""The runs to choose from, as plans of the config: the one that was given, slower, faster, and as high as is allowed.

They stand in the config before the first run, so that all recordings are of one config and each can be made again by
hand with `rotor sweep CONFIG --plan NAME`.
"""

from dataclasses import dataclass

from rotorrig.identify.verdict import NextRun
from rotorrig.rig import ConfigError
from rotorrig.rig.config import RPM, RigConfig, RunUpCoastDown, RunUpRampDown, parse

BELOW_OVERSPEED = 0.95
WORTH = 1.05  # times the top of the plan: what goes no higher than that is no other run
FACTOR = 3.0  # faster, and slower


@dataclass(frozen=True, slots=True, kw_only=True)
class Menu:
    """Names of plans of a config, by what they are for; empty: there is no such run."""

    base: str
    slower: str = ""
    faster: str = ""
    highest: str = ""

    def plan_of(self, run: NextRun, ramp: float) -> str:
        """Return the plan that makes a proposed run; `ramp` [rad/s^2] is the base's. Empty: none does."""
        if run.kind == "ramp rate":
            return self.faster if run.ramp > ramp else self.slower
        return {"through critical": self.highest, "trial mass": self.base}.get(run.kind, "")


def add_runs(rig: RigConfig, base: str) -> tuple[RigConfig, Menu]:
    """Return the config with the plans of a menu, and the menu. Raises ConfigError without the plan `base`.

    Of another kind of plan than a run-up there is the base alone.
    """
    if base not in rig.plans:
        raise ConfigError(f"plan '{base}': the config has none of that name, want one of {sorted(rig.plans)}")
    plan = rig.plans[base]
    if not isinstance(plan, RunUpCoastDown | RunUpRampDown):
        return rig, Menu(base=base)
    made = {
        "slower": plan.model_copy(update={"ramp": plan.ramp / FACTOR}),
        "faster": plan.model_copy(update={"ramp": plan.ramp * FACTOR}),
    }
    if (top := _highest(rig, plan.end)) > WORTH * plan.end:
        made["highest"] = plan.model_copy(update={"end": top})
    names = {key: f"{base}-{key}" for key in made}
    taken = [name for name in names.values() if name in rig.plans]
    if taken:
        raise ConfigError(f"plans.{taken[0]}: an investigation adds a plan of that name, want another name for it")
    tables = "\n".join(_table(names[key], plan) for key, plan in made.items())
    if not rig.text:
        raise ConfigError(f"{rig.name}: was made in code, want a config that was read from TOML")
    text = f"{rig.text.rstrip()}\n\n# Runs that an investigation may choose, made from plan '{base}'.\n{tables}"
    return parse(text, where=rig.name), Menu(base=base, **names)


def _highest(rig: RigConfig, fallback: float) -> float:
    ceilings = [rig.motor.max_speed] if rig.motor else []
    ceilings += [BELOW_OVERSPEED * rig.limits.overspeed] if rig.limits else []
    return min(ceilings, default=fallback)


def _table(name: str, plan: RunUpCoastDown | RunUpRampDown) -> str:
    lines = [f'[plans."{name}"]', f'kind = "{plan.kind}"']
    lines += [f'{key} = "{getattr(plan, key) * RPM:.9g} rpm"' for key in ("slow_roll", "start", "end")]
    lines += [f'slow_roll_time = "{plan.slow_roll_time:.9g} s"', f'ramp = "{plan.ramp * RPM:.9g} rpm/s"']
    return "\n".join([*lines, ""])

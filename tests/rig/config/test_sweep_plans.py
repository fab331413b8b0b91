"""What a config may ask of a sweep is checked when the config is read."""

import re
import tomllib
from pathlib import Path
from typing import get_args

import pytest

from rotorrig.rig.config.description import RigConfig, from_si, parse
from rotorrig.rig.config.sweep_plans import Plan
from rotorrig.rig.config.units import RPM
from rotorrig.rig.config.validation import validate_table
from rotorrig.rig.errors import ConfigError

RK4 = (Path(__file__).parents[3] / "configs/rk4.toml").read_text()
STEPPED = 'kind = "stepped"\nslow_roll = "240 rpm"\nslow_roll_time = "5 s"\nramp = "60 rpm/s"\ndwell = "4 s"\n'
BAND = 'low = "2000 rpm"\nhigh = "2400 rpm"\nvibration = "1 mm"\n'


@pytest.mark.parametrize(
    ("plan", "said"),
    [
        ('kind = "stepp"', "plans.test.kind: got 'stepp', did you mean 'stepped'"),
        (
            "",
            "plans.test.kind: is missing, want one of run-up-coast-down, run-up-ramp-down, stepped, dwell, trial-mass",
        ),
        (STEPPED, "plans.test: want speeds, or start, end and step"),
        (STEPPED + 'speeds = ["900 rpm"]\nstep = "10 rpm"', "plans.test: speeds stands beside start, end and step"),
        (STEPPED + 'speeds = ["900 rpm", "900 rpm"]', "plans.test: speeds: one stands there twice"),
        (STEPPED + 'start = "900 rpm"\nend = "600 rpm"\nstep = "10 rpm"', "plans.test: want start < end"),
        (STEPPED + 'start = "9 rpm"\nend = "3000 rpm"\nstep = "1 rpm"', "plans.test: want at most 1000 steps"),
        ('kind = "trial-mass"\nmasses = []', "plans.test.masses: got []"),
        ('kind = "trial-mass"\nmasses = ["disk: 12 g mm"]', "plans.test.masses: trial mass: got 'disk: 12 g mm'"),
        ('kind = "trial-mass"\nplan = "x"\nmasses = ["disk: 1 g mm at 0 deg"]', "plans.test.plan: got 'x', want"),
        ('kind = "trial-mass"\nplan = "test"\nmasses = ["disk: 1 g mm at 0 deg"]', "got 'test', want another plan"),
    ],
)
def test_a_wrong_plan_is_one_sentence(plan: str, said: str) -> None:
    with pytest.raises(ConfigError) as error:
        parse(f"{RK4}\n[plans.test]\n{plan}", where="rig.toml")
    assert said in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("limits", "said"),
    [
        ('[limits.probes]\n3x = "1 mm"', "limits.probes: no probe '3x', want one of ['1x', '1y', '2x', '2y']"),
        (
            f"[[limits.critical_bands]]\n{BAND}probes = {{ 3x = '1 mm' }}",
            "limits.critical_bands[0].probes: no probe '3x'",
        ),
        (
            f"[[limits.critical_bands]]\n{BAND.replace('2400', '1900')}",
            "limits.critical_bands[0]: want low < high",
        ),
        (
            f"[[limits.critical_bands]]\n{BAND}\n[[limits.critical_bands]]\n{BAND}",
            "limits: critical_bands: two overlap at 2000 rpm, want them apart",
        ),
    ],
)
def test_wrong_limits_are_one_sentence(limits: str, said: str) -> None:
    with pytest.raises(ConfigError) as error:
        parse(f"{RK4}\n{limits}", where="rig.toml")
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_every_kind_of_plan_survives_its_way_through_a_file() -> None:
    kinds = f"""
        [plans.a]
        {STEPPED}
        speeds = ["900 rpm", "600 rpm"]
        [plans.b]
        {STEPPED}
        start = "600 rpm"
        end = "900 rpm"
        step = "100 rpm"
        [plans.c]
        kind = "dwell"
        speed = "900 rpm"
        time = "1 min"
        ramp = "60 rpm/s"
        [plans.d]
        kind = "trial-mass"
        plan = "a"
        masses = ["disk: 1 g mm at 0 deg"]
        [[limits.critical_bands]]
        {BAND}
    """
    rig = parse(RK4 + kinds, where="rig.toml")
    again = from_si(rig.model_dump(mode="json"))
    assert again.hash == rig.hash
    assert again.plans == rig.plans


DOCUMENT = (Path(__file__).parents[3] / "docs/sweeps.md").read_text()


def test_the_document_names_every_kind_of_plan_with_its_keys() -> None:
    for table in get_args(get_args(Plan)[0]):
        (kind,) = get_args(table.model_fields["kind"].annotation)
        row = next((line for line in DOCUMENT.splitlines() if line.startswith(f"| `{kind}` |")), "")
        assert row, f"{kind} stands in no row"
        keys = set(table.model_fields) - {"kind"}
        assert "the same" in row or keys <= set(re.findall(r"\w+", row)), f"{kind}: {keys} are not all there"


def test_the_limits_the_document_shows_are_read() -> None:
    limits_shown, power_cut_shown = re.findall(r"```toml\n(.*?)```", DOCUMENT, re.DOTALL)
    table = tomllib.loads(RK4) | tomllib.loads(power_cut_shown)
    table["limits"] |= tomllib.loads(limits_shown)["limits"]
    rig = validate_table(RigConfig, table, where="docs/sweeps.md", context={})
    limits = rig.limits
    assert limits and rig.power_cut
    assert limits.critical_ramp == pytest.approx(200 / RPM)
    assert limits.critical_bands[0].probes == {"1y": pytest.approx(900e-6)}

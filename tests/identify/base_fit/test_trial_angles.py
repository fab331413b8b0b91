"""Trial masses whose angles were told wrongly: against the rotation, from another zero."""

import csv
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rotorrig.balancing import Task, balance
from rotorrig.identify import Identification, identify
from rotorrig.identify.base_fit.trial_angles import recount
from rotorrig.identify.identification import TrialAngles
from rotorrig.identify.result_files import read_identification, write_identification
from rotorrig.processing.files.bode_table import read_table
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig, parse
from rotorrig.rig.errors import DataError
from rotorrig.sims.effects.base import find
from tests.conftest import CONFIGS
from tests.identify.swept import U, swept_response

TRIALS = (0j, 12e-6j, 12e-6 * np.exp(0.5j))
DWELLS = CONFIGS.parent / "tests/data/kfupm-rk4/vectors_1x_dwells.csv"
PROBES = (("p1x", 180, 0), ("p1y", 180, 90), ("p2x", 340, 0), ("p2y", 340, 90))  # mm, deg: places assumed


@pytest.fixture(scope="module")
def runs(rig: RigConfig) -> list[OrderTrackedResponse]:
    """As it is, and with a mass at two angles."""
    rng = np.random.default_rng(3)
    made = [swept_response(rig, rng=rng, orders=(1,), trial=u, speeds=(900, 2600), ramp=600) for u in TRIALS]
    return [replace(r, source=replace(r.source, source_hash=f"{i:016x}")) for i, r in enumerate(made)]


def tell(response: OrderTrackedResponse, how: Callable[[complex], complex]) -> OrderTrackedResponse:
    """Return a response whose masses are told at other angles."""
    told = [{plane: complex(how(u)) for plane, u in run.trial_unbalance.items()} for run in response.runs]
    return replace(
        response, runs=tuple(replace(run, trial_unbalance=u) for run, u in zip(response.runs, told, strict=True))
    )


@pytest.fixture(scope="module")
def mistold(runs: list[OrderTrackedResponse]) -> Identification:
    """By a scale that runs against the rotation, its zero 78 degrees from the mark."""
    return identify([tell(r, lambda u: (u * np.exp(-1j * math.radians(78))).conjugate()) for r in runs])


def test_angles_that_are_told_rightly_are_left_alone(runs: list[OrderTrackedResponse]) -> None:
    found = identify(runs)
    assert found.trial_angles is None
    assert not any("ANGLES" in words for words in found.fits[0].words)


def test_angles_counted_anew_point_where_the_masses_are(runs: list[OrderTrackedResponse]) -> None:
    """A mass at 30 degrees of a scale that runs against the rotation, its zero at 78, is at 48."""
    told = tell(runs[1], lambda u: 2e-6 * np.exp(1j * math.radians(30)))
    (mass,) = recount(told, reversed_=True, offset=math.radians(78)).runs[1].trial_unbalance.values()
    assert math.degrees(np.angle(mass)) == pytest.approx(48)


@pytest.mark.campaign
def test_a_scale_that_runs_against_the_rotation_is_found_with_its_zero(mistold: Identification) -> None:
    angles = mistold.trial_angles
    assert angles is not None
    assert angles.reversed and angles.or_offset is None
    assert math.degrees(angles.offset) == pytest.approx(78, abs=0.5)
    assert angles.chi2 < 0.1 * angles.chi2_told
    fit = mistold.fits[0]
    assert fit.adequate
    assert fit.estimate("u").value == pytest.approx(abs(U), rel=0.01)
    assert "counted against the rotation, from a zero 78 ±" in fit.words[-1]


@pytest.mark.campaign
@pytest.mark.parametrize(("fault", "theta"), [("delay", {"delay": 6e-4}), ("skew_stiffness", {"k": 3000.0})])
def test_another_fault_is_not_laid_on_the_angles(rig: RigConfig, fault: str, theta: dict[str, float]) -> None:
    """The masses were told rightly; what the model lacks is something else."""
    rng, hidden = np.random.default_rng(4), [(find(rig, fault), theta)]
    faulty = [
        swept_response(rig, rng=rng, orders=(1,), trial=u, speeds=(900, 2600), ramp=600, hidden=hidden)
        for u in TRIALS[:2]
    ]
    found = identify([replace(r, source=replace(r.source, source_hash=f"{i:016x}")) for i, r in enumerate(faulty)])
    assert not found.fits[0].adequate
    assert found.trial_angles is None


@pytest.mark.campaign
def test_with_one_mass_both_senses_are_told(runs: list[OrderTrackedResponse]) -> None:
    angles = identify([tell(r, lambda u: u.conjugate()) for r in runs[:2]]).trial_angles
    assert angles is not None
    assert angles.reversed, "the mark is more likely right than off by half a turn"
    assert abs(math.degrees(angles.offset)) < 1
    assert angles.or_offset is not None and abs(math.degrees(angles.or_offset)) == pytest.approx(180, abs=1)
    assert "Counted in the sense of rotation, with " in angles.words


@pytest.mark.campaign
def test_it_is_in_fit_json_and_no_correction_is_told_by_such_a_fit(
    mistold: Identification, runs: list[OrderTrackedResponse], tmp_path: Path
) -> None:
    write_identification(tmp_path / "fit.json", mistold)
    again = read_identification(tmp_path / "fit.json")
    assert isinstance(again.trial_angles, TrialAngles)
    assert again.trial_angles == mistold.trial_angles
    with pytest.raises(DataError, match="counts the angles of the trial masses otherwise than they were told"):
        balance(runs[:1], Task(), identification=again)


@pytest.mark.campaign
def test_a_real_rigs_author_counted_against_the_rotation(tmp_path: Path) -> None:
    """Angles as its author has them; by hand they were read as against the rotation, 78 degrees from the mark."""
    (tmp_path / "mapping.toml").write_text(mapping_of_dwells())
    response = read_table(DWELLS, tmp_path / "mapping.toml", four_probes())
    angles = identify([response]).trial_angles
    assert angles is not None
    assert angles.reversed and angles.or_offset is None
    assert math.degrees(angles.offset) == pytest.approx(78, abs=12)
    assert angles.chi2 < 0.1 * angles.chi2_told


def four_probes() -> RigConfig:
    """Return the rig with both planes of probes, which the published run-up has one of."""
    text = (CONFIGS / "kfupm-rk4.toml").read_text()
    head, _, rest = text.partition("[[probes]]")
    probes = "".join(
        f'[[probes]]\nname = "{name}"\nposition = "{z} mm"\nangle = "{angle} deg"\nchannel = {i}\n'
        'sensitivity = "7.874 mV/um"\n\n'
        for i, (name, z, angle) in enumerate(PROBES)
    )
    keyphasor = rest[rest.index("[keyphasor]") :].replace("channel = 1", "channel = 4")
    return parse(head + probes + keyphasor.replace('"disk 1"', '["disk 1", "disk 2"]'), where="kfupm-rk4.toml")


def mapping_of_dwells() -> str:
    """Return the mapping of the dwells: a run per condition, its masses at their author's angles."""
    with DWELLS.open() as file:
        rows = {row["condition"]: row for row in csv.DictReader(file)}
    text = 'run_column = "condition"\ncompensated = true\n[speed]\ncolumn = "rpm"\nunit = "1 rpm"\n'
    for name, _, _ in PROBES:
        text += f'[[vectors]]\nprobe = "{name}"\norder = 1.0\nreal = "{name}_re"\nimaginary = "{name}_im"\n'
        text += 'unit = "25.4 um"\namplitude_is = "0-peak"\nconjugated = true\n'
    for name, row in rows.items():
        masses = [
            f'{{ disk = "disk {k}", amount = "{row[f"U{k}_gmm"]} g mm", angle = "{row[f"U{k}_deg"]} deg" }}'
            for k in (1, 2)
            if float(row[f"U{k}_gmm"])
        ]
        text += f'[[runs]]\nname = "{name}"\nvalue = "{name}"\ndirection = "dwell"\ntrial = [{", ".join(masses)}]\n'
    return text + '[slow_roll]\nspeed = "251 rpm"\n[uncertainty]\nabsolute = "0.05 um"\nrelative = 0.01\n'

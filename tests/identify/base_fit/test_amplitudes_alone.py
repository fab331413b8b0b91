"""Identification from amplitudes without phases, of the numpy rotor's tables."""

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rotorrig.app.commands.other_programs import write_foxglove_layout
from rotorrig.balancing import Task, balance, influence_of_fit
from rotorrig.identify.base_fit.amplitudes_alone import take_amplitudes
from rotorrig.identify.base_fit.base_fit import BaseProblem
from rotorrig.identify.base_fit.fit import identify
from rotorrig.identify.diagnosis import diagnose
from rotorrig.identify.extended_model import recordings_of
from rotorrig.identify.identification import Identification
from rotorrig.identify.uncertainty import Resampling
from rotorrig.processing.files.bode_table import read_table
from rotorrig.processing.files.response_csv import write_csv
from rotorrig.processing.files.response_topics import messages
from rotorrig.processing.files.response_uff import write_uff
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig, load
from rotorrig.rig.errors import DataError
from tests.conftest import CONFIGS
from tests.end_to_end.numpy_rotor import Hidden, vectors, with_noise, write

PLAIN = Hidden()
RPM = np.linspace(600, 3600, 80)
TRUTH = {"kxx": 33.9e3, "kyy": 34.6e3, "cxx": 15.0, "cyy": 15.0, "u": 15e-6}
SPEED = 'run_column = "run"\n{top}\n[speed]\ncolumn = "rpm"\nunit = "1 rpm"\n[uncertainty]\nabsolute = "0.3 um"\n'
TRIAL = 'trial = [{ disk = "disk", amount = "12 g mm", angle = "90 deg" }]\n'


@pytest.fixture
def rig() -> RigConfig:
    """The rk4 without bands: one fit is enough."""
    rk4 = load(CONFIGS / "rk4.toml")
    assert rk4.identify is not None
    return rk4.model_copy(update={"identify": rk4.identify.model_copy(update={"bands": {}})})


def amplitudes(
    folder: Path, rig: RigConfig, runs: dict[str, dict[str, np.ndarray]], *, trial: str = "", top: str = ""
) -> OrderTrackedResponse:
    """Import the amplitudes of runs of speeds RPM, one with a `trial` mass; `top` are more lines of the mapping."""
    names = list(next(iter(runs.values())))
    lines = ["run,rpm," + ",".join(names)]
    for run, read in runs.items():
        cells = np.abs(np.stack([read[name] for name in names], axis=1)) * 1e6
        lines += [f"{run},{rpm:.4f}," + ",".join(f"{a:.6f}" for a in row) for rpm, row in zip(RPM, cells, strict=True)]
    toml = SPEED.format(top=top)
    toml += "".join(f'[[vectors]]\nprobe = "{name}"\namplitude = "{name}"\nunit = "1 um"\n' for name in names)
    toml += "".join(
        f'[[runs]]\nname = "{n}"\nvalue = "{n}"\ndirection = "up"\n{TRIAL if n == trial else ""}' for n in runs
    )
    return read_table(*write(folder, "\n".join(lines) + "\n", toml), rig)


def noisy(hidden: Hidden = PLAIN, *, trial: complex = 0.0, seed: int = 1) -> dict[str, np.ndarray]:
    return with_noise(vectors(RPM, hidden, planes=("1", "2"), trial=trial), np.random.default_rng(seed))


def off(fit, name: str) -> float:
    """Return by how many of its standard deviations an estimate is off the truth."""
    return abs(fit.estimate(name).value - TRUTH[name]) / fit.estimate(name).sigma


def test_stiffness_damping_and_amount_are_found_without_a_phase(tmp_path: Path, rig: RigConfig) -> None:
    fit = identify([amplitudes(tmp_path, rig, {"up": noisy()})], objective="f1").fits[0]
    assert [estimate.name for estimate in fit.estimates] == list(TRUTH), "and no phase"
    for name, truth in TRUTH.items():
        assert off(fit, name) < 3, name
        assert fit.estimate(name).value == pytest.approx(truth, rel=0.1 if name[0] == "c" else 0.03)
        low, high = fit.estimate(name).interval or (0.0, 0.0)
        assert low < fit.estimate(name).value < high
    assert fit.dof == 80 * 4 - 5
    assert 0.75 < fit.chi2 / fit.dof < 1.2
    assert fit.adequate
    assert "They do not tell the phase of the unbalance" in " ".join(fit.words)


@pytest.mark.campaign
@pytest.mark.parametrize("objective", ["f2", "f3"])
def test_the_other_objectives_lead_to_the_same_fit(tmp_path: Path, rig: RigConfig, objective: str) -> None:
    response = amplitudes(tmp_path, rig, {"up": noisy()})
    first, other = (identify([response], objective=name).fits[0] for name in ("f1", objective))
    for name in TRUTH:
        assert other.estimate(name).value == pytest.approx(
            first.estimate(name).value, abs=0.2 * first.estimate(name).sigma
        )


@pytest.mark.campaign  # its intervals are profiled
def test_a_resonance_that_the_model_has_not_is_found_inadequate(tmp_path: Path, rig: RigConfig) -> None:
    bump = 20e-6 * np.exp(-(((RPM - 3000) / 150) ** 2))
    read = {name: z * (1 + bump / np.abs(z)) for name, z in noisy().items()}
    fit = identify([amplitudes(tmp_path, rig, {"up": read})], objective="f1").fits[0]
    assert not fit.adequate
    assert fit.p < 1e-3


def test_compensated_amplitudes_are_compared_with_compensated_predictions(tmp_path: Path, rig: RigConfig) -> None:
    """At 1300 rpm, 0.6 of the critical speed, what was subtracted is a good part of the motion."""
    taken = vectors(np.array([1300.0]), planes=("1", "2"))
    read = {name: z - taken[name][0] for name, z in noisy().items()}
    top = 'compensated = true\n[slow_roll]\nspeed = "1300 rpm"\n'
    fit = identify([amplitudes(tmp_path, rig, {"up": read}, top=top)], objective="f1").fits[0]
    for name in TRUTH:
        assert off(fit, name) < 3, name
    assert fit.adequate


def test_runs_with_a_trial_mass_are_left_out_and_that_is_said(tmp_path: Path, rig: RigConfig) -> None:
    runs = {"bare": noisy(), "trial": noisy(trial=12e-6j, seed=2)}
    both = amplitudes(tmp_path, rig, runs, trial="trial")
    (taken,), words = take_amplitudes([both], objective="f1", bootstrap=False)
    assert taken.usable[taken.run == 0].all()
    assert not taken.usable[taken.run == 1].any()
    assert words[-1].startswith("Runs with a trial mass were left out")
    _, words = take_amplitudes([amplitudes(tmp_path, rig, {"bare": runs["bare"]})], objective="f1", bootstrap=False)
    assert len(words) == 1
    with pytest.raises(DataError, match="every run carries a trial mass, want one without"):
        identify([amplitudes(tmp_path, rig, {"t": runs["trial"]}, trial="t")], objective="f1")


def test_its_derivatives_are_those_of_differences(tmp_path: Path, rig: RigConfig) -> None:
    top = 'compensated = true\n[slow_roll]\nspeed = "1300 rpm"\n'
    problem = BaseProblem.of(recordings_of([amplitudes(tmp_path, rig, {"up": noisy()}, top=top)], orders=(1,))).problem
    p = problem.begin(np.array([30e3, 36e3, 12.0, 18.0]))
    names = problem.parameters.names
    for name in ("kxx", "cyy", "gain 1x", "angle 1y", "E", "position disk disk"):
        i, h = names.index(name), 1e-5
        there, back = p.copy(), p.copy()
        there[i] += h
        back[i] -= h
        difference = (problem.residual(there) - problem.residual(back)) / (2 * h)
        exact = problem.jacobian(p, np.array([i]))[:, 0]
        assert np.abs(exact).max() > 1e-3, name
        np.testing.assert_allclose(difference, exact, rtol=1e-3, atol=1e-4 * np.abs(exact).max(), err_msg=name)


def test_what_wants_phases_is_refused_in_a_sentence(tmp_path: Path, rig: RigConfig) -> None:
    response = amplitudes(tmp_path, rig, {"up": noisy()})
    whole = "table.csv: was imported as amplitudes without phases, and {} wants phases too"
    with pytest.raises(DataError, match=r"table.csv: holds amplitudes without phases, want .* --objective f1"):
        identify([response])
    with pytest.raises(DataError, match="a bootstrap draws vectors; want it left out"):
        identify([response], objective="f1", resampling=Resampling(draws=5))
    with pytest.raises(DataError, match=whole.format("a diagnosis")):
        diagnose([response])
    with pytest.raises(DataError, match=whole.format("balancing")):
        balance([response], Task(planes=("disk",)))
    nothing = Identification(fits=(), effects=(), wall_s=0.0, source=response.source)
    with pytest.raises(DataError, match=whole.format("a prediction")):
        influence_of_fit(nothing, [response], planes=("disk",))
    with pytest.raises(DataError, match=whole.format("a universal file")):
        write_uff(tmp_path / "r.uff", response)
    with pytest.raises(DataError, match=whole.format("the layout")):
        write_foxglove_layout(tmp_path / "r.json", response)
    assert not list(tmp_path.glob("r.*"))


def test_no_file_states_a_phase(tmp_path: Path, rig: RigConfig) -> None:
    response = amplitudes(tmp_path, rig, {"up": noisy()})
    write_csv(tmp_path / "r.csv", response)
    lines = [line for line in (tmp_path / "r.csv").read_text().splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    assert {row["1x 1X phase lag [deg]"] for row in rows} == {""}
    assert float(rows[0]["1x 1X amplitude [um]"]) == pytest.approx(abs(response.z[0, 0, 0]) * 1e6)
    assert not any("+1X" in column for column in rows[0])
    topics = [(topic, values) for topic, _, _, values in messages(response)]
    assert {topic.split("/")[1] for topic, _ in topics} == {"bode"}
    assert all(math.isnan(values["phase_lag_deg"]) for _, values in topics)


def test_amplitudes_beside_vectors_are_refused(tmp_path: Path, rig: RigConfig) -> None:
    alone = amplitudes(tmp_path, rig, {"up": noisy()})
    with pytest.raises(DataError, match="and another response has phases, want all of a kind"):
        identify([alone, replace(alone, amplitudes_alone=False)], objective="f1")

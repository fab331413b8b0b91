import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig, from_si
from rotorrig.rig.errors import ConfigError, DataError
from rotorrig.sims.plant.draw import draw, expected_estimates, nameplate
from rotorrig.sims.plant.sealed_truth import seal, unseal
from rotorrig.sims.plant.truth import FaultSpec

SEEDS = range(200)


def test_every_draw_stays_within_the_tolerances(rk4: RigConfig) -> None:
    for truth in (draw(rk4, seed=seed) for seed in SEEDS):
        for plate, drawn in zip(rk4.bearings, truth.bearings, strict=True):
            assert abs(drawn.kxx / plate.kxx - 1) <= 0.05
            assert abs(drawn.kyy / plate.kyy - 1) <= 0.05
            assert abs(drawn.cxx - plate.cxx) <= 0.2 * plate.cxx
        assert abs(truth.unbalances[0].amount / 15e-6 - 1) <= 0.1
        # ten sigma at most, whatever the tails
        assert abs(truth.modulus_factor - 1) < 0.1001
        assert abs(truth.disk_mass_factors[0] - 1) < 0.0501
        assert np.abs(np.array(truth.probe_gain_factors) - 1).max() < 0.1001
        assert np.abs(truth.probe_angle_errors).max() < math.radians(10.01)
        assert abs(truth.keyphasor_offset) < math.radians(20.01)
        assert np.abs(truth.probe_curvatures).sum(axis=1).max() < 0.005


def test_the_draws_fill_their_ranges_without_bias(rk4: RigConfig) -> None:
    truths = [draw(rk4, seed=seed) for seed in SEEDS]
    k = np.array([t.bearings[2].kxx / 33.9e3 - 1 for t in truths])
    assert abs(k.mean()) < 0.006  # 2.9 % / sqrt(200), three sigma
    assert k.std() == pytest.approx(0.05 / math.sqrt(3), rel=0.15)
    modulus = np.array([t.modulus_factor - 1 for t in truths])
    assert np.mean(np.abs(modulus) < 0.01) == pytest.approx(0.683, abs=0.11)  # 0.033 of 200, three sigma and more
    heavy = np.exp(1j * np.array([t.unbalances[0].angle for t in truths]))
    assert abs(heavy.mean()) < 0.2  # any phase


def test_a_seed_is_one_rig_and_another_seed_another(rk4: RigConfig) -> None:
    assert draw(rk4, seed=7) == draw(rk4, seed=7)
    assert draw(rk4, seed=7).bearings != draw(rk4, seed=8).bearings


def test_the_truth_is_named_as_the_estimates_are(rk4: RigConfig) -> None:
    update = {"bearings": (("left A",), ("spring",)), "coefficients": "all", "also": ("density", "youngs_modulus")}
    assert rk4.identify is not None
    rig = rk4.model_copy(update={"identify": rk4.identify.model_copy(update=update)})
    truth = draw(rig, seed=3)
    found = expected_estimates(rig, truth)
    assert list(found)[:2] == ["left A kxx", "left A kxy"]
    assert found["spring kyy"] == truth.bearings[2].kyy
    assert found["E"] == pytest.approx(truth.modulus_factor * 208.11e9)
    assert found["density"] == pytest.approx(truth.density_factor * 7801)
    assert list(found)[-2:] == ["u", "phase"]


def test_what_a_fault_makes_of_a_bearing_s_coefficients_is_to_be_found_too(rk4: RigConfig) -> None:
    assert rk4.identify is not None
    rig = rk4.model_copy(update={"identify": rk4.identify.model_copy(update={"coefficients": "all"})})
    turned = FaultSpec(name="cross_stiffness", parameters={"stiffness": 700.0})
    found = expected_estimates(rig, draw(rig, seed=3, faults=[turned]))
    healthy = expected_estimates(rig, draw(rig, seed=3))
    assert (found["kxy"], found["kyx"]) == (700.0, 700.0)
    assert found["kxx"] == pytest.approx(healthy["kxx"] + 700.0 * 1.4 / 0.6)  # the spring is too stiff, not only askew


def test_identified_bearings_share_their_deviation_and_others_do_not(rk4: RigConfig) -> None:
    both = rk4.identify.model_copy(update={"bearings": (("left A", "left B"),)})
    a, b, _ = draw(rk4.model_copy(update={"identify": both}), seed=1).bearings
    assert a.kxx == b.kxx
    a, b, _ = draw(rk4, seed=1).bearings
    assert a.kxx != b.kxx


def test_a_disk_without_a_nameplate_unbalance_is_balanced_to_g_6_3(rk4: RigConfig) -> None:
    silent = rk4.model_copy(update={"disks": (rk4.disks[0].model_copy(update={"unbalance": None}),)})
    expected = 0.809 * 6.3e-3 / (4200 * math.pi / 30)  # kg * mm/s at the drive's top speed: 11.6 g mm
    assert draw(silent, seed=3).unbalances[0].amount == pytest.approx(expected, rel=0.1)
    assert nameplate(silent).unbalances[0].amount == 0.0


def test_the_phase_to_be_found_counts_from_the_emitted_edge(rk4: RigConfig) -> None:
    truth = draw(rk4, seed=4)
    heavy = replace(truth.unbalances[0], angle=3.1)
    found = expected_estimates(rk4, replace(truth, unbalances=(heavy,), keyphasor_offset=0.1))
    assert found["phase"] == pytest.approx(3.2 - 2 * math.pi)
    assert found["u"] == heavy.amount
    assert [found[k] for k in ("kxx", "kyy", "cxx", "cyy")] == [
        getattr(truth.bearings[2], k) for k in ("kxx", "kyy", "cxx", "cyy")
    ]


def test_a_config_that_looks_for_nothing_has_nothing_to_score(rk4: RigConfig) -> None:
    with pytest.raises(DataError, match=r"no \[identify\] table"):
        expected_estimates(rk4.model_copy(update={"identify": None}), nameplate(rk4))


def test_a_sealed_truth_comes_back_as_it_was(rk4: RigConfig, tmp_path: Path) -> None:
    for truth in (
        draw(rk4, seed=2, faults=[FaultSpec(name="coupling", parameters={"bore_force": 0.5})]),
        nameplate(rk4),
    ):
        seal(truth, tmp_path / "sealed.json")
        assert unseal(tmp_path / "sealed.json") == truth
    table = json.loads((tmp_path / "sealed.json").read_text())
    assert table["config_hash"] == rk4.hash
    assert table["schema"] == "rotorrig.plant.truth/2"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("not json", "is no JSON"),
        ("[1, 2]", "holds a JSON list, want a sealed truth of schema"),
        ('{"schema": "rotorrig.fit/1"}', "holds rotorrig.fit/1, want a sealed truth of schema"),
        ("{}", "holds no schema, want"),
        ('{"schema": "rotorrig.plant.truth/2"}', "is missing"),
    ],
)
def test_a_file_that_holds_no_truth_is_refused_in_one_sentence(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "sealed.json"
    path.write_text(text)
    with pytest.raises(DataError, match=said) as caught:
        unseal(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("modulus_factor", "1.0", 'truth.modulus_factor is "1.0", want float'),
        ("modulus_factor", float("nan"), "truth.modulus_factor is NaN, want float"),
        ("seed", True, "truth.seed is true, want int"),
        ("probe_curvatures", [[1.0]], r"truth.probe_curvatures\[0\] is \[1.0\], want"),
        ("noise", {"probe": 0.0}, "truth.noise.bearing_force is missing"),
        ("bearings", [3], r"truth.bearings\[0\] is a int, want a table"),
        ("faults", [{"name": "gremlin", "parameters": {}}], "fault 'gremlin': the plant has none of that name"),
        ("faults", [{"name": "coupling", "parameters": ["x"]}], r"truth.faults\[0\].parameters is"),
        ("extra", 1, "truth.extra is none of its keys"),
    ],
)
def test_a_spoilt_truth_is_refused_with_its_place(
    rk4: RigConfig, tmp_path: Path, key: str, value: object, said: str
) -> None:
    path = tmp_path / "sealed.json"
    seal(draw(rk4, seed=1), path)
    path.write_text(json.dumps(json.loads(path.read_text()) | {key: value}))
    with pytest.raises(DataError, match=said):
        unseal(path)


def test_a_file_that_is_not_there_or_cannot_be_written_is_told(rk4: RigConfig, tmp_path: Path) -> None:
    with pytest.raises(DataError, match="cannot be read"):
        unseal(tmp_path / "none.json")
    with pytest.raises(DataError, match="cannot be written"):
        seal(nameplate(rk4), tmp_path / "none" / "sealed.json")


def test_a_run_with_a_trial_mass_is_the_same_rig(rk4: RigConfig, tmp_path: Path) -> None:
    bare, loaded = draw(rk4, seed=6), draw(rk4, seed=6, trial={"disk": (12e-6, 0.5)}, run=2)
    assert replace(loaded, trial=(), run=0) == bare
    (mass,) = loaded.trial
    assert (mass.disk, mass.amount, mass.angle) == ("disk", 12e-6, 0.5)
    seal(loaded, tmp_path / "sealed.json")
    assert unseal(tmp_path / "sealed.json") == loaded


def test_a_trial_mass_on_no_disk_or_a_run_before_the_first_is_refused(rk4: RigConfig) -> None:
    with pytest.raises(DataError, match=r"trial mass on 'rim': .* has no such disk, want one of \['disk'\]"):
        draw(rk4, seed=1, trial={"rim": (1e-6, 0.0)})
    with pytest.raises(DataError, match="run -1: want a number from 0 on"):
        draw(rk4, seed=1, run=-1)


def test_an_unknown_fault_or_parameter_is_refused_with_a_hint(rk4: RigConfig) -> None:
    with pytest.raises(DataError, match="did you mean 'coupling'"):
        draw(rk4, seed=1, faults=[FaultSpec(name="couplin")])
    with pytest.raises(DataError, match="did you mean 'bore_force'"):
        draw(rk4, seed=1, faults=[FaultSpec(name="coupling", parameters={"boreforce": 1.0})])


@pytest.mark.parametrize(
    ("update", "said"),
    [
        ({"rigid": True, "kxx": None, "kyy": None}, "bearing 'left A' is rigid, want constants to simulate the rig"),
        (
            {"kxx": {"speed": [0.0, 300.0], "value": [1e6, 2e6]}},
            "bearing 'left A' is given over speed, want constants to simulate the rig",
        ),
    ],
)
def test_a_bearing_the_simulated_rig_cannot_have_is_refused(rk4: RigConfig, update: dict, said: str) -> None:
    table = rk4.model_dump(mode="json")
    table["bearings"][0] |= update
    for make in (nameplate, lambda rig: draw(rig, seed=1)):
        with pytest.raises(ConfigError, match=said):
            make(from_si(table))


@pytest.mark.parametrize("damping", [{"structural_damping": 0.01}, {"rayleigh": {"mass": 1.0}}])
def test_the_simulated_rig_brings_its_own_damping(rk4: RigConfig, damping: dict) -> None:
    table = rk4.model_dump(mode="json")
    table["shaft"] |= damping
    with pytest.raises(ConfigError, match="the shaft has damping, want none to simulate the rig"):
        nameplate(from_si(table))

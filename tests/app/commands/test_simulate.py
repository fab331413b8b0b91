"""What the simulated rig is told of the config's effects and of trial masses."""

from dataclasses import replace
from pathlib import Path

import pytest

from rotorrig.app.commands.simulate import SimulatedRig, faults_of, run_simulated_rig, truth_of
from rotorrig.rig.config.description import RigConfig, parse
from rotorrig.rig.config.extended_config import extend
from rotorrig.rig.config.extension import Extension
from rotorrig.rig.errors import ConfigError, DataError
from rotorrig.sims.plant.draw import draw
from rotorrig.sims.plant.sealed_truth import seal

MASS = "disk: 12 g mm at 90 deg"


def test_an_effect_the_plant_has_a_fault_for_is_that_fault(rig: RigConfig) -> None:
    extended = extend(rig, [Extension(name="coupling", parameters={"bore_force": 0.5})])
    (fault,) = faults_of(extended)
    assert fault.name == "coupling"
    assert fault.parameters == {"bore_force": 0.5}
    assert truth_of(extended, SimulatedRig(seed=3)).faults == (fault,)


@pytest.mark.parametrize(
    ("effect", "said"),
    [
        (Extension(name="levitation", parameters={"height": 1e-3}), "fault 'levitation': the plant has none"),
        (Extension(name="coupling", where="left", parameters={"force": 1.0}), "fault 'coupling': has no parameter"),
    ],
)
def test_an_effect_the_plant_has_no_fault_for_is_refused_in_one_sentence(
    rig: RigConfig, effect: Extension, said: str
) -> None:
    with pytest.raises(ConfigError, match=f"cannot show '{effect.label}': {said}") as caught:
        truth_of(extend(rig, [effect]), SimulatedRig(seed=3))
    assert "\n" not in str(caught.value)


def test_a_sealed_truth_says_what_the_rig_has_whatever_the_config(rig: RigConfig, tmp_path: Path) -> None:
    seal(draw(rig, seed=5), tmp_path / "sealed.json")
    extended = extend(rig, [Extension(name="levitation", parameters={"height": 1e-3})])
    assert truth_of(extended, SimulatedRig(seed=3, hidden=tmp_path / "sealed.json")) == draw(rig, seed=5)


def test_a_trial_mass_is_on_the_same_rig_in_another_run(rig: RigConfig, tmp_path: Path) -> None:
    seal(draw(rig, seed=5), tmp_path / "sealed.json")
    for simulation in (SimulatedRig(seed=5), SimulatedRig(seed=3, hidden=tmp_path / "sealed.json")):
        bare, heavy = truth_of(rig, simulation), truth_of(rig, simulation, trial=[MASS])
        assert heavy.trial[0].amount == pytest.approx(12e-6)
        assert heavy.trial[0].angle == pytest.approx(1.5707963)
        assert (heavy.unbalances, heavy.bearings, heavy.run) == (bare.unbalances, bare.bearings, bare.run + 1)


def test_a_trial_mass_on_a_plane_is_refused_by_the_plant_in_one_sentence(rig: RigConfig) -> None:
    ringed = parse(rig.text + '\n[[planes]]\nname = "ring"\nposition = "400 mm"\n', where="ringed")
    with pytest.raises(DataError, match="trial mass on 'ring'"):
        truth_of(ringed, SimulatedRig(seed=5), trial=["ring: 12 g mm at 90 deg"])


def test_a_script_of_faults_that_is_none_is_said_before_anything_starts(rig: RigConfig, tmp_path: Path) -> None:
    script = tmp_path / "script.json"
    script.write_text('[{"kind": "disconect", "on": "daq"}]')
    said = rf"^{script}: faults\[0\]\.kind: got 'disconect', did you mean 'disconnect'$"
    with pytest.raises(ConfigError, match=said), run_simulated_rig(rig, SimulatedRig(seed=5, faults=script)):
        pass


@pytest.mark.campaign
def test_a_script_of_faults_is_played_on_the_simulated_rig(rig: RigConfig, tmp_path: Path) -> None:
    script = tmp_path / "script.json"
    script.write_text('[{"kind": "silent", "on": "motor"}]')
    with run_simulated_rig(rig, SimulatedRig(seed=5, faults=script)) as ports:
        assert ports.console.wait_for(lambda line: "fault" in line, timeout=10)["kind"] == "silent"


def test_a_later_run_of_a_rig_is_the_same_rig_in_another_run(rig: RigConfig) -> None:
    first, third = (truth_of(rig, SimulatedRig(seed=3, before=before)) for before in (0, 2))
    assert (first.run, third.run) == (0, 2)
    assert replace(third, run=0) == first
    with_mass = truth_of(rig, SimulatedRig(seed=3, before=2), trial=[MASS])
    assert with_mass.run == 2

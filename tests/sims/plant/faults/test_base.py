"""What every fault of the plant owes, whatever it is."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import DataError
from rotorrig.sims.plant.draw import draw, draw_fault, nameplate
from rotorrig.sims.plant.faults.base import fault_names, load_fault
from rotorrig.sims.plant.plant import Plant
from rotorrig.sims.plant.truth import FaultSpec, Truth
from tests.parameters import defer_rest

#: parameters that stand in axes fixed to the ground: y up makes them change sign in a mirror
FIXED_IN_SPACE = {
    "coupling": "offset_angle",
    "cross_stiffness": "stiffness",
    "magnetic_pull": "angle",
    "probe_angle": "turn",
    "snubber": "angle",
    "twice_line_pull": "angle",
}
HOOKS = ("deviations", "forces", "structure", "sensors")


def short_run(rig: RigConfig, truth: Truth, pieces: tuple[float, ...] = (0.6,)) -> NDArray[np.int32]:
    """Return the counts of half a second up through the critical speed, taken in `pieces` [s]."""
    plant = Plant(rig, truth)
    plant.command(370.0, 1000.0, True)
    return np.concatenate([plant.advance(t) for t in (*pieces, 0.6)])


def test_the_folder_is_the_list_of_faults() -> None:
    assert {"bow", "crack", "loose_disk"} <= set(fault_names())
    assert "base" not in fault_names()


@pytest.mark.parametrize("name", fault_names())
def test_every_fault_says_what_it_takes_and_has_something_to_do(name: str) -> None:
    module: Any = load_fault(name)
    assert module.SIZE
    assert set(module.SIZE) <= set(module.RANGE) <= set(module.PARAMETERS)
    assert any(hasattr(module, hook) for hook in HOOKS)
    assert module.__doc__


@pytest.mark.parametrize("name", defer_rest(fault_names(), now=6))
def test_a_fault_of_no_size_leaves_the_counts_as_they_were_and_one_of_some_size_does_not(
    rk4: RigConfig, name: str
) -> None:
    off = FaultSpec(name=name, parameters=dict.fromkeys(load_fault(name).SIZE, 0.0))
    early = {"speed": 200.0} if name == "unbalance_step" else {}
    healthy = short_run(rk4, draw(rk4, seed=5))
    assert np.array_equal(short_run(rk4, draw(rk4, seed=5, faults=[off])), healthy)
    there = [FaultSpec(name=name, parameters=early)]
    assert not np.array_equal(short_run(rk4, draw(rk4, seed=5, faults=there)), healthy)


@pytest.mark.parametrize("name", fault_names())
def test_a_very_small_fault_moves_the_shaft_very_little(rk4: RigConfig, name: str) -> None:
    """It grows out of the healthy rig: a hundred-thousandth of its usual size moves no probe by 0.2 um."""
    module = load_fault(name)
    small = FaultSpec(name=name, parameters={size: 1e-5 * module.PARAMETERS[size] for size in module.SIZE})
    change = short_run(rk4, nameplate(rk4, faults=[small])) - short_run(rk4, nameplate(rk4))
    assert np.abs(change).max() <= 2  # counts of 0.09 um


@pytest.mark.parametrize("name", fault_names())
def test_counts_with_a_fault_do_not_depend_on_the_size_of_the_blocks(rk4: RigConfig, name: str) -> None:
    truth = draw(rk4, seed=3, faults=[draw_fault(rk4, name, seed=3)])
    pieces = (0.0, 0.0001, 0.0123, 0.3, 0.3456, 0.5)
    assert np.array_equal(short_run(rk4, truth, pieces), short_run(rk4, truth))


@pytest.mark.parametrize("name", sorted(set(fault_names()) - {"loose_pedestal"}))  # which knows up from down
def test_a_rig_and_its_mirror_image_turning_the_other_way_read_the_same(rk4: RigConfig, name: str) -> None:
    """y becomes -y, the rotation y to x; angles on the shaft count in the sense of rotation and stay."""
    sideways = rk4.model_copy(update={"gravity": "-x"})
    probes = tuple(p.model_copy(update={"angle": -p.angle}) for p in rk4.probes)
    mirror = sideways.model_copy(update={"probes": probes, "rotation": "y-to-x"})
    values = dict(load_fault(name).PARAMETERS)
    if name == "unbalance_step":
        values["speed"] = 200.0
    fixed = FIXED_IN_SPACE.get(name)
    turned = values | ({fixed: -values[fixed]} if fixed else {})
    here, there = (
        short_run(rig, nameplate(rig, faults=[FaultSpec(name=name, parameters=v)]))
        for rig, v in ((sideways, values), (mirror, turned))
    )
    assert np.abs(here - there).max() <= 1


@pytest.mark.parametrize("name", fault_names())
def test_blind_sizes_are_drawn_within_their_range_and_repeat(rk4: RigConfig, name: str) -> None:
    module = load_fault(name)
    drawn = [draw_fault(rk4, name, seed=seed, runs=2).parameters for seed in range(40)]
    for parameter, span in module.RANGE.items():
        low, high = getattr(span, "low", 0.0), getattr(span, "high", len(rk4.probes) - 1)
        values = np.array([d[parameter] for d in drawn])
        sizes = np.abs(values) if getattr(span, "either_sign", False) else values
        assert low <= sizes.min() < sizes.max() <= high
        assert len(set(values)) > {"probe": 3, "run": 2}.get(parameter, 30)
    assert draw_fault(rk4, name, seed=7) == draw_fault(rk4, name, seed=7)


def test_an_unknown_fault_or_parameter_is_refused(rk4: RigConfig) -> None:
    with pytest.raises(DataError, match="has no parameter 'stifness_variation', did you mean 'stiffness_variation'"):
        nameplate(rk4, faults=[FaultSpec(name="coupling", parameters={"stifness_variation": 1.0})])
    with pytest.raises(DataError, match="the plant has none of that name, did you mean 'crack'"):
        draw_fault(rk4, "krack", seed=1)


@pytest.mark.parametrize(
    ("name", "values", "said"),
    [
        ("unbalance_plane", {"position": 0.7}, "'unbalance_plane': acts at 700 mm, want it on the shaft, 0 to 560 mm"),
        ("crack", {"position": 0.001}, "'crack': acts at -4 mm, want it on the shaft"),
        ("probe_gain", {"probe": 4.0}, "number 4: is no probe of .* want a whole number from 0 to 3"),
        ("cross_talk", {"probe": 0.5}, "number 0.5: is no probe"),
        ("drag", {"disk": -1.0}, "number -1: is no disk"),
    ],
)
def test_a_place_that_is_not_there_is_refused(rk4: RigConfig, name: str, values: dict[str, float], said: str) -> None:
    with pytest.raises(DataError, match=said):
        Plant(rk4, nameplate(rk4, faults=[FaultSpec(name=name, parameters=values)]))


def test_several_faults_add_up(rk4: RigConfig) -> None:
    """Two unbalances of one disk, each a fault, are as good as their sum, which weighs as much as both."""
    at_disk = {"position": 0.2805, "radius": 0.01}
    one = FaultSpec(name="unbalance_plane", parameters=at_disk | {"amount": 3e-6, "angle": 0.0})
    two = FaultSpec(name="unbalance_plane", parameters=at_disk | {"amount": 4e-6, "angle": math.pi / 2})
    sum_ = {"amount": 5e-6, "angle": math.atan2(4, 3), "position": 0.2805, "radius": 0.01 * 5 / 7}
    both = short_run(rk4, nameplate(rk4, faults=[one, two]))
    together = short_run(rk4, nameplate(rk4, faults=[FaultSpec(name="unbalance_plane", parameters=sum_)]))
    assert np.abs(both - together).max() <= 1

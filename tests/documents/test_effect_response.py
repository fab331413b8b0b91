"""What the pictures of effects.md are drawn from: a sweep known in closed form, and responses known without it."""

import numpy as np
import pytest

from docs.effect_pictures import DRAWN, signatures
from docs.effect_response import HIGHEST, HOLD, LOWEST, RAMP, Sweep, vectors
from rotorrig.rig.config.description import RigConfig, load
from rotorrig.sims.effects.base import catalogue, find
from rotorrig.sims.rotor.model.assembly import assemble
from rotorrig.sims.rotor.steady.harmonic_response import probe_response
from tests.conftest import CONFIGS

SWEEP = Sweep.even()
EFFECTS = sorted({effect.name for effect in catalogue(load(CONFIGS / "rk4.toml"))})


def turns(t: np.ndarray) -> np.ndarray:
    """Turns of a shaft that is brought up at RAMP, held for HOLD and brought down again."""
    top = (HIGHEST - LOWEST) / RAMP
    up, held, down = np.clip(t, 0, top), np.clip(t - top, 0, HOLD), np.clip(t - top - HOLD, 0, top)
    return (LOWEST * up + RAMP * up**2 / 2 + HIGHEST * held + HIGHEST * down - RAMP * down**2 / 2) / 60


def test_the_keyphasor_pulses_once_per_turn() -> None:
    assert turns(SWEEP.keyphasor_t) == pytest.approx(np.arange(len(SWEEP.keyphasor_t)), abs=1e-9)


def test_rows_stand_at_their_speeds() -> None:
    speed = np.gradient(turns(SWEEP.t[:, None] + np.array([-1e-3, 1e-3])), 2e-3, axis=1)[1:-1, 0] * 60
    inside = np.arange(1, len(SWEEP.t) - 1) % len(SWEEP.rpm) % (len(SWEEP.rpm) - 1) > 0  # not where the ramp ends
    rpm = np.concatenate([SWEEP.rpm, SWEEP.rpm[::-1]])[1:-1]
    assert speed[inside] == pytest.approx(rpm[inside], abs=0.1)


def test_without_an_effect_the_unbalance_alone_is_seen(rig_config: RigConfig) -> None:
    effect = find(rig_config, "runout, plane 1")
    seen = vectors(rig_config, effect, effect.at_zero, SWEEP)
    want = probe_response(assemble(rig_config), SWEEP.omega[: len(SWEEP.rpm)], unbalance={"disk": 15e-6})
    assert np.abs(seen.up[1] - want).max() < 1e-5 * np.abs(want).max()
    assert np.abs(seen.up[1] - seen.down[1]).max() < 1e-12
    assert not seen.up[2].any() and not seen.up[3].any()


def test_runout_is_added_as_it_is(rig_config: RigConfig) -> None:
    effect = find(rig_config, "runout, plane 1")
    without = vectors(rig_config, effect, effect.at_zero, SWEEP).up[1]
    with_it = vectors(rig_config, effect, {"runout re": 3e-6, "runout im": 4e-6}, SWEEP).up[1]
    want = np.array([3e-6 + 4e-6j, (3e-6 + 4e-6j) * -1j, 0, 0])  # y sees the high spot a quarter of a turn later
    assert with_it - without == pytest.approx(np.broadcast_to(want, with_it.shape), abs=1e-15)


def test_what_comes_off_at_the_top_shows_on_the_way_down(rig_config: RigConfig) -> None:
    effect = find(rig_config, "unbalance_step")
    theta = {"step re": 15e-6, "step im": 0.0, "time": (HIGHEST - LOWEST) / RAMP + HOLD / 2}
    seen = vectors(rig_config, effect, theta, SWEEP)
    assert seen.down[1] == pytest.approx(2 * seen.up[1], rel=1e-9)  # twice the nameplate's 15 g mm at 0 degrees


def test_every_effect_is_drawn() -> None:
    assert list(signatures()) == EFFECTS


def test_what_is_drawn_otherwise_than_by_default_is_an_effect() -> None:
    assert set(DRAWN) <= set(signatures())


@pytest.mark.parametrize("name", EFFECTS)
def test_a_picture_shows_its_effect(name: str) -> None:
    signature = signatures()[name]
    pairs = [(signature.without.up, signature.with_it.up), (signature.without.down, signature.with_it.down)]
    assert max(float(np.abs(b[n] - a[n]).max()) for a, b in pairs for n in a) > 0.5e-6  # m

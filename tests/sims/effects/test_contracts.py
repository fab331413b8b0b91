"""What every effect of the folder promises, whatever it is about."""

from pathlib import Path

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig, load
from rotorrig.sims import effects as folder
from rotorrig.sims.effects.base import Effect, catalogue, find, magnitudes, phasor
from rotorrig.sims.rotor.model.assembly import RotorModel, assemble, matrices, speed_stiffness
from rotorrig.sims.rotor.modes import modes
from rotorrig.sims.rotor.nonlinear.force_law import ForceLaw
from tests.sims.effects.predicted import OMEGA, ORDERS, motion, pair_at, predicted, simple_rig, typical, view

ROOT = Path(__file__).parents[3]
RIG = load(ROOT / "configs" / "rk4.toml")
CATALOGUE = catalogue(RIG)
HELPERS = {"__init__", "base", "places", "rig_scale", "shaft_motion", "bearing_terms", "found_laws"}
FOUND = {"found_force", "found_reading"}  # not in the catalogue: a diagnosis makes them where nothing known explains
FILES = sorted(p.stem for p in Path(folder.__path__[0]).glob("*.py") if p.stem not in HELPERS)
G = 9.80665  # m/s^2
MEASURABLE = 0.1e-6  # m, the noise of a vector

each = pytest.mark.parametrize("effect", CATALOGUE, ids=lambda e: e.label)


def test_every_file_of_the_folder_is_discovered() -> None:
    assert sorted({e.name for e in CATALOGUE} | FOUND) == FILES


def test_every_label_is_one_of_a_kind() -> None:
    labels = [e.label for e in CATALOGUE]
    assert len(set(labels)) == len(labels)


def test_an_effect_is_found_by_its_label_and_an_unknown_one_is_named() -> None:
    assert find(RIG, "runout, plane 2").label == "runout, plane 2"
    with pytest.raises(ValueError, match=r"effect 'rust': there is none, want one of .*bow, "):
        find(RIG, "rust")


def test_the_reference_has_a_paragraph_on_every_effect() -> None:
    text = (ROOT / "docs" / "effects.md").read_text(encoding="utf-8")
    assert [name for name in FILES if f"**{name}**" not in text] == []


@pytest.mark.parametrize("name", FILES)
def test_every_file_names_its_source(name: str) -> None:
    assert "Source:" in (Path(folder.__path__[0]) / f"{name}.py").read_text(encoding="utf-8")


@each
def test_parameters_have_bounds_about_nothing_and_starts_within(effect: Effect) -> None:
    assert effect.parameters
    for p in effect.parameters:
        assert p.low <= p.at_zero <= p.high
        assert 0 < p.size <= p.high - p.low
        assert all(p.low <= start <= p.high for start in p.starts)
    assert set(effect.orders) <= set(ORDERS)
    assert all(p.order in (0, *effect.orders) for p in effect.parameters)


@each
def test_at_every_beginning_there_is_nothing_yet(effect: Effect, small: RotorModel) -> None:
    for begun in effect.at_initial_guesses():
        assert begun.label == effect.label
        assert all(p.low <= p.at_zero <= p.high for p in begun.parameters)
        assert not any(load.pattern.any() for load in begun.loads(small, begun.at_zero))
        assert begun.change_matrices(small, begun.at_zero) is small or not effect.initial_guesses


@each
def test_words_are_a_sentence_with_the_size(effect: Effect) -> None:
    words = effect.words(typical(effect))
    assert any(c.isdigit() for c in words)
    assert "\n" not in words and "None" not in words and not words.endswith(".")
    assert words != Effect.words(effect, typical(effect))


@each
def test_at_nothing_there_is_nothing_to_the_bit(effect: Effect, small: RotorModel) -> None:
    theta = effect.at_zero
    changed = effect.change_matrices(small, theta)
    for got, want in zip(matrices(changed, 200.0), matrices(small, 200.0), strict=True):
        assert np.array_equal(got, want)
    assert not any(A.any() for A in speed_stiffness(changed))
    assert not any(load.pattern.any() for load in effect.loads(changed, theta))
    assert not any(np.any(pushed(law)) for law in effect.force_laws(changed, theta))
    z = motion(small, (), 1) + np.linspace(1e-6, 2e-5, 7)[:, None] * np.exp(1j * np.arange(4))
    for order in ORDERS:
        assert np.array_equal(effect.change_readings(z, view(RIG, order), theta), z)


def test_an_effect_without_its_parameters_set_is_nothing() -> None:
    class Still(Effect):
        name = "still"
        title = "nothing at all"

    effect = Still()
    assert (effect.label, effect.at_zero, effect.loads(None, {}), effect.force_laws(None, {})) == ("still", {}, (), ())
    assert effect.change_matrices("model", {}) == "model"


@each
def test_what_it_acts_on_is_what_it_changes(effect: Effect, small: RotorModel) -> None:
    theta = typical(effect)
    at = effect.change_matrices(small, theta)
    z = np.full((len(OMEGA), len(RIG.probes)), 1e-5 + 0j)
    changed = {
        "matrices": at is not small,
        "loads": any(load.pattern.any() for load in effect.loads(at, theta)),
        "force laws": bool(effect.force_laws(at, theta)),
        "probes": any(
            not np.array_equal(effect.change_readings(z, view(RIG, order), theta), z) for order in effect.orders
        ),
    }
    assert effect.acts_on == {target for target, does in changed.items() if does}


def test_what_an_effect_acts_on_is_told_by_its_class() -> None:
    assert find(RIG, "clearance").acts_on == {"force laws"}
    assert find(RIG, "coupling").acts_on == {"matrices", "loads"}
    assert find(RIG, "delay, probe 2y").acts_on == {"probes"}
    assert Effect.acts_on == frozenset()


@each
def test_only_the_orders_declared_change(effect: Effect, small: RotorModel) -> None:
    with_it = predicted(effect, typical(effect), rig=RIG, model=small)
    without = predicted(effect, effect.at_zero, rig=RIG, model=small)
    for order in set(ORDERS) - set(effect.orders):
        assert np.array_equal(with_it[order], without[order])


@each
def test_a_parameter_of_one_order_changes_that_alone(effect: Effect, small: RotorModel) -> None:
    without = predicted(effect, effect.at_zero, rig=RIG, model=small)
    for p in effect.parameters:
        if p.order:
            got = predicted(effect, {**effect.at_zero, p.name: p.size}, rig=RIG, model=small)
            assert [n for n in ORDERS if not np.array_equal(got[n], without[n])] == [p.order]


def test_what_no_vector_can_show_is_left_out() -> None:
    coupling = find(RIG, "coupling")
    once = coupling.within((1, 2.5))
    assert [p.name for p in once.parameters] == ["force 1X re", "force 1X im", "stiffness re", "stiffness im"]
    assert phasor(once.at_zero, "force 2X") == 0
    assert coupling.within((1, 2)).parameters == coupling.parameters


@each
def test_linear_ones_are_linear(effect: Effect, small: RotorModel, rng: np.random.Generator) -> None:
    if not effect.linear or "matrices" in effect.acts_on:
        return
    for _ in range(3):
        weights = rng.uniform(-1, 1, 2)
        some = [{p.name: p.at_zero + rng.uniform(-1, 1) * p.size for p in effect.parameters} for _ in weights]
        sum_of_both = {
            p.name: p.at_zero + sum(w * (t[p.name] - p.at_zero) for w, t in zip(weights, some, strict=True))
            for p in effect.parameters
        }
        none = predicted(effect, effect.at_zero, rig=RIG, model=small)
        got = predicted(effect, sum_of_both, rig=RIG, model=small)
        parts = [predicted(effect, t, rig=RIG, model=small) for t in some]
        for n in effect.orders:
            want = none[n] + sum(w * (part[n] - none[n]) for w, part in zip(weights, parts, strict=True))
            assert got[n] == pytest.approx(want, rel=1e-9, abs=1e-15)


@each
def test_the_loads_of_linear_ones_are_linear_whatever_else_they_change(effect: Effect, small: RotorModel) -> None:
    if not effect.linear:
        return
    whole = {p.name: p.at_zero + p.size for p in effect.parameters}
    twice = {p.name: p.at_zero + 2 * p.size for p in effect.parameters}
    got = [[load.pattern for load in effect.loads(effect.change_matrices(small, t), t)] for t in (whole, twice)]
    assert all(np.array_equal(2 * a, b) for a, b in zip(*got, strict=True))


@each
def test_it_is_finite_at_every_bound(effect: Effect, small: RotorModel) -> None:
    for p in effect.parameters:
        for bound in (p.low, p.high):
            theta = {**typical(effect), p.name: bound}
            for z in predicted(effect, theta, rig=RIG, model=small).values():
                assert np.isfinite(z).all()
            assert all(
                np.isfinite(pushed(law)).all() for law in effect.force_laws(effect.change_matrices(small, theta), theta)
            )
            assert effect.words(theta)


@each
def test_it_is_measurable_at_its_size(effect: Effect, small: RotorModel) -> None:
    theta = typical(effect)
    laws = effect.force_laws(small, theta)
    if laws and "loads" not in effect.acts_on:  # a newton moves this shaft by 20 um and more
        assert max(float(np.abs(pushed(law) - pushed(nil)).max()) for law, nil in _with_nothing(effect, small)) > 0.01
        return
    with_it = predicted(effect, theta, rig=RIG, model=small)
    without = predicted(effect, effect.at_zero, rig=RIG, model=small)
    assert max(float(np.abs(with_it[n] - without[n]).max()) for n in effect.orders) > MEASURABLE


#: of the largest vector, at up to 3600 rpm: a reduced model of three modes in each plane has no more at 180 Hz
REDUCED = {1: 2e-4, 2: 2e-3, 3: 4e-3}


@each
def test_a_reduced_model_and_the_whole_one_agree(effect: Effect, full: RotorModel, small: RotorModel) -> None:
    theta = typical(effect)
    a, b = (predicted(effect, theta, rig=RIG, model=model) for model in (full, small))
    for n in effect.orders:
        assert np.abs(a[n] - b[n]).max() <= REDUCED[n] * max(np.abs(a[n]).max(), 1e-6)


#: how the phasors of an effect turn with the axes, in turns of the axes; others' are 1, or they have none
TURNS = {"runout, plane 1, twice per turn": 2, "runout, plane 2, twice per turn": 2, "shaft_asymmetry": 2}
TWICE = {"stiffness"}  # phasors of the others that turn twice as far
FIXED = {"pedestal, x", "pedestal, y", "cross_stiffness"}  # along axes of the config, which stay


@pytest.mark.parametrize("rotation", ["x-to-y", "y-to-x"])
def test_turning_all_axes_turns_the_result(rotation: str, monkeypatch: pytest.MonkeyPatch) -> None:
    alpha = np.radians(30.0)
    sense = 1 if rotation == "x-to-y" else -1
    rig, model, down = turned_rig(0.0, rotation)
    there, model_there, _ = turned_rig(alpha, rotation)
    found = {e.label: e for e in catalogue(there)}
    for effect in catalogue(rig):
        if effect.label in FIXED:
            continue
        turns = TURNS.get(effect.label, TURNS.get(effect.name, 1)) * sense
        theta = typical(effect)
        want = predicted(effect, theta, rig=rig, model=model, base=False)
        monkeypatch.setitem(down, "-y", (G * np.sin(alpha), -G * np.cos(alpha)))
        other = turned_by(effect, theta, alpha * turns)
        got = predicted(found[effect.label], other, rig=there, model=model_there, base=False)
        monkeypatch.undo()
        for n in ORDERS:
            assert got[n] == pytest.approx(want[n], rel=1e-6, abs=1e-12), effect.label


def turned_rig(alpha: float, rotation: str) -> tuple[RigConfig, RotorModel, dict]:
    first, second = (pair_at(z, turned=alpha, names=(f"{i}x", f"{i}y")) for i, z in ((1, 0.15), (2, 0.25)))
    rig = simple_rig(first + second, rotation=rotation, planes=[{"name": "hub", "position": 0.08}])
    return rig, assemble(rig), modes.DOWN


def turned_by(effect: Effect, theta: dict[str, float], angle: float) -> dict[str, float]:
    """The unknowns with every phasor turned, and a crack's mouth."""
    turned = dict(theta)
    if effect.name == "crack":
        turned["mouth"] += angle
    for p in effect.parameters:
        stem = p.name.removesuffix(" re")
        if stem != p.name and effect.name != "line_hum":
            z = phasor(theta, stem) * np.exp((2j if stem in TWICE else 1j) * angle)
            turned |= {f"{stem} re": z.real, f"{stem} im": z.imag}
    return turned


@pytest.mark.parametrize("name", ["cubic_spring", "friction", "drag", "rub, at disk"])
def test_a_force_law_turns_with_the_axes(name: str, small: RotorModel) -> None:
    effect = find(RIG, name)
    (law,) = effect.force_laws(small, typical(effect))
    turn = np.exp(0.7j)
    for r, v in ((3e-4 + 1e-4j, 0.02 - 0.05j), (-1e-4 + 5e-4j, -0.01j)):
        got = _force(law, r * turn, v * turn)
        assert got == pytest.approx(_force(law, r, v) * turn, rel=1e-12)


def test_phasors_are_told_by_magnitude_and_angle() -> None:
    bow = find(RIG, "bow")
    assert list(magnitudes(bow.parameters, {"bow re": 0.0, "bow im": 2e-5})) == [
        ("bow", 2e-5, "m"),
        ("bow angle", pytest.approx(np.pi / 2), "rad"),
    ]


def test_a_rig_without_gravity_has_no_effect_that_needs_it() -> None:
    names = {e.name for e in catalogue(RIG.model_copy(update={"gravity": "none"}))}
    assert set(FILES) - FOUND - names == {"crack", "shaft_asymmetry"}


def test_one_probe_alone_cannot_be_asked_for_its_angle() -> None:
    names = {e.name for e in catalogue(RIG.model_copy(update={"probes": RIG.probes[:1]}))}
    assert set(FILES) - FOUND - names == {"probe_angle", "cross_talk"}


def pushed(law: ForceLaw) -> np.ndarray:
    """The law's force on a place that rests, stands off or moves, (case, 2)."""
    cases = [(0.0, 0.0, 0.0, 0.0), (6e-4, 0.0, 0.0, 0.1), (-1e-4, 3e-4, -0.05, -0.02), (0.0, 1e-6, 1e-6, 0.0)]
    return np.array([law.force(x + law.static[0], y + law.static[1], vx, vy, law.constants) for x, y, vx, vy in cases])


def _with_nothing(effect: Effect, model: RotorModel) -> list[tuple[ForceLaw, ForceLaw]]:
    there, nowhere = (effect.force_laws(model, theta) for theta in (typical(effect), effect.at_zero))
    return list(zip(there, nowhere, strict=True))


def _force(law: ForceLaw, r: complex, v: complex) -> complex:
    return complex(*law.force(r.real, r.imag, v.real, v.imag, law.constants))

"""A config keeps its text when its model is extended, and comes back as it went."""

from pathlib import Path

import pytest

from rotorrig.rig.config.description import RigConfig, from_si, load, parse
from rotorrig.rig.config.extended_config import extend
from rotorrig.rig.config.extension import Extension
from rotorrig.rig.errors import ConfigError

CONFIGS = sorted((Path(__file__).parents[3] / "configs").glob("*.toml"))
BOW = Extension(
    name="bow", parameters={"bow re": 1.8000000000000001e-05, "bow im": -2e-06}, sigmas={"bow re": 1e-7, "bow im": 2e-7}
)
RUNOUT = Extension(name="runout", where="plane 2", parameters={"runout re": 3e-6})


@pytest.mark.parametrize("path", CONFIGS, ids=lambda p: p.stem)
def test_an_extended_config_is_the_text_as_it_was_and_the_effects_after_it(path: Path) -> None:
    rig = load(path)
    extended = extend(rig, [BOW, RUNOUT])
    assert extended.text.startswith(rig.text.rstrip())
    assert extended.effects == (BOW, RUNOUT)
    assert parse(extended.text, where="extended.toml").hash == extended.hash


def test_an_effect_changes_the_hash_of_a_rig_and_not_that_of_its_nameplate(rig_config: RigConfig) -> None:
    extended = extend(rig_config, [BOW])
    assert extended.hash != rig_config.hash
    assert extended.nameplate_hash == rig_config.nameplate_hash == rig_config.hash


def test_extending_again_replaces_the_effects(rig_config: RigConfig) -> None:
    once = extend(rig_config, [BOW])
    assert extend(once, [RUNOUT]).text == extend(rig_config, [RUNOUT]).text
    assert extend(once, []).text == rig_config.text


def test_an_effect_written_by_hand_among_other_tables_is_replaced_too(rig_config: RigConfig) -> None:
    by_hand = '[[effects]]\nname = "bow"\n# as measured on the lathe\n[effects.parameters]\n"bow re" = 1e-5\n\n'
    text = rig_config.text.replace("[keyphasor]", by_hand + "[keyphasor]")
    extended = extend(parse(text, where="by hand"), [RUNOUT])
    assert extended.effects == (RUNOUT,)
    assert "# as measured on the lathe" in extended.text
    assert extended.keyphasor == rig_config.keyphasor


def test_a_config_without_a_text_is_written_in_si(rig_config: RigConfig) -> None:
    made_in_code = from_si(rig_config.model_dump(mode="json"))
    extended = extend(made_in_code, [BOW])
    assert extended.text.startswith('units = "SI"\n')
    assert extended.hash == extend(rig_config, [BOW]).hash


def test_a_text_that_says_something_else_is_not_kept(rig_config: RigConfig) -> None:
    weightless = rig_config.model_copy(update={"gravity": "none"})
    assert weightless.hash != rig_config.hash
    assert extend(weightless, [BOW]).gravity == "none"


def test_bare_numbers_need_the_word_si(rig_config: RigConfig) -> None:
    with pytest.raises(ConfigError, match="units: got 'mm', want 'SI' for bare numbers"):
        parse('units = "mm"\n' + rig_config.text, where="x")
    with pytest.raises(ConfigError, match="want a length with its unit"):
        parse(rig_config.text.replace('"560 mm"', "0.56"), where="x")


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ('name = "bow"', "effects[0].parameters: is missing"),
        ('name = "bow"\nparameters = { a = "5 um" }', "effects[0].parameters.a: got '5 um', input should be a valid"),
        ('name = "bow"\nparameters = { a = nan }', "effects[0].parameters.a: got nan"),
        ('name = "bow"\nparameters = { a = 1.0 }\nsigmas = { b = 1.0 }', "'b' is none of the parameters"),
        ('name = "bow"\nparameters = { a = 1.0 }\nsigmas = { a = -1.0 }', "effects[0].sigmas.a: got -1.0"),
        ('name = "bow"\nplace = "x"\nparameters = { a = 1.0 }', "effects[0].place: unknown key"),
        (
            'name = "bow"\nparameters = { a = 1 }\n[[effects]]\nname = "bow"\nparameters = { a = 2 }',
            "effects: two are named 'bow', want different names",
        ),
    ],
)
def test_a_mistaken_effect_is_one_sentence(rig_config: RigConfig, table: str, said: str) -> None:
    with pytest.raises(ConfigError) as caught:
        parse(f"{rig_config.text}\n[[effects]]\n{table}\n", where="rk4.toml")
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)

"""The mapping of channels: what it may say, and what it may not."""

from collections.abc import Callable

import pytest

from rotorrig.acquisition.importers.channel_mapping import ChannelMapping
from rotorrig.acquisition.importers.signal_units import signal_factor
from rotorrig.rig.errors import ConfigError

Mapping = Callable[[str], ChannelMapping]
ONE = '[[channels]]\nprobe = "1x"\nchannel = "AI0"\nunit = "1 V"\n'


def test_all_it_may_say(mapping: Mapping) -> None:
    made = mapping('rate = "25.6 kHz"\n[time]\ncolumn = "t"\nunit = "1 ms"\n' + ONE + "override = true\n")
    assert (made.rate, made.time and made.time.unit) == (25_600.0, 1e-3)
    channel = made.of("1x")
    assert channel and (channel.channel, channel.unit, channel.override) == ("AI0", "1 V", True)
    assert made.of("1y") is None


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "channels: is missing"),
        ("channels = 3", "channels: got 3"),
        (ONE.replace("probe", "prob"), r"channels\[0\].prob: unknown key, did you mean 'probe'"),
        (ONE.replace("1x", "3x"), r"channels\[0\].probe: the config has no '3x', want one of \['keyphasor', '1x'"),
        (ONE + ONE, r"channels\[1\].probe: '1x' is there twice"),
        (ONE.replace("1 V", "1 kg"), r"channels\[0\].unit: got '1 kg', want what a 1 in the file stands for"),
        (ONE.replace("1 V", "9**9**9 V"), r"channels\[0\].unit: got '9\*\*9\*\*9 V'"),
        (ONE.replace("1x", "keyphasor").replace("1 V", "1 um"), r"channels\[0\].unit: got '1 um', want .* '1 V'"),
        (ONE.replace('unit = "1 V"', "override = true"), r"channels\[0\].override: is there without a unit"),
        ("rate = 25600\n" + ONE, "rate: got 25600, want a rate with its unit"),
        ("a = " + "[" * 20_000, "is no valid TOML: its tables or lists are nested too deep"),
        ("a = " + "9" * 20_000, "is no valid TOML: Exceeds the limit"),
    ],
    ids=lambda v: v[:30],
)
def test_what_is_wrong_with_it_is_one_sentence(mapping: Mapping, text: str, said: str) -> None:
    with pytest.raises(ConfigError, match=said) as caught:
        mapping(text)
    assert "mapping.toml" in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "factor", "is_length"),
    [("1 V", 1.0, False), ("1 Volts", 1.0, False), ("1 mV", 1e-3, False), ("1 µm", 1e-6, True),
     ("127 um", 127e-6, True), ("1 MIL", 25.4e-6, True),
     ("1 mils", 25.4e-6, True), ("1 in", 0.0254, True)],
)  # fmt: skip
def test_units_are_taken_as_programs_write_them(text: str, factor: float, is_length: bool) -> None:
    found = signal_factor(text, length=True)
    assert found and found == (pytest.approx(factor), is_length)
    assert (signal_factor(text, length=False) is None) == is_length


def test_megametres_are_not_taken_for_millimetres() -> None:
    assert signal_factor("1 Mm", length=True) is None
    assert signal_factor("1 mm", length=True) == (pytest.approx(1e-3), True)

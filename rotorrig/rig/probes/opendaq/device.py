"""A device of the openDAQ SDK: connection, settings and channels.

The SDK looks for devices with mDNS queries whenever its instance is asked to add one, whatever the connection string.
A device on this machine is therefore asked of its own module, which sends nothing. A networked one (`daq.nd://` and the
like) is added by the instance: the queries go out once, when it is opened.
"""

import importlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from rotorrig.rig.config import OpenDaq
from rotorrig.rig.errors import ConfigError, LinkLost
from rotorrig.rig.probes.opendaq.counts import CountScale, raw_scale, rounded_scale

NETWORK = "daq."  # connection strings that begin like this name devices on the network
RATE_SETTINGS = ("SampleRate", "GlobalSampleRate")  # what devices call theirs
DEFAULT_RANGE = (-10.0, 10.0)  # V, of a signal that does not say


@dataclass(frozen=True, slots=True)
class TimeAxis:
    """The sample clock: tick of sample n = delta * n + a start that each packet gives."""

    delta: int  # ticks from sample to sample
    tick: Fraction  # s

    @property
    def sample_rate(self) -> float:
        """Hz."""
        return float(1 / (self.delta * self.tick))


@dataclass(frozen=True, slots=True)
class Channel:
    """One analog input: the SDK's signal and how its packets become counts."""

    name: str
    signal: Any  # opendaq.ISignal
    scale: CountScale
    raw: np.dtype[Any]  # of a packet's values
    is_raw: bool  # of its raw values, else of its scaled ones
    time: TimeAxis

    @property
    def sampling(self) -> tuple[object, ...]:
        """Sampling and scaling, to be compared with what they were."""
        return self.scale, self.raw, self.is_raw, self.time


def sdk() -> Any:
    """Import the SDK. Raises ConfigError where it is not installed."""
    try:
        return importlib.import_module("opendaq")
    except ImportError as error:
        raise ConfigError(
            f"daq.driver: 'opendaq' needs the openDAQ SDK, which does not load ({error}); "
            "want it installed: pip install 'rotorrig[opendaq]'"
        ) from error


class OpenDaqDevice:
    """A connected device; it is released when this object is."""

    def __init__(self, table: OpenDaq, *, inputs: int) -> None:
        """Connect, and set it and its first so many inputs.

        Raises LinkLost if it does not answer, ConfigError if it has no such settings or the SDK is not installed.
        """
        self._sdk = sdk()
        builder = self._sdk.InstanceBuilder()
        builder.global_log_level = self._sdk.LogLevel.Off
        self._instance = builder.build()
        self._device = self._connect(table.connection)
        _set(self._device, table.device_settings, where="daq.device_settings")
        self._inputs = [c for c in self._device.channels_recursive if _waveform(c)][:inputs]
        for channel in self._inputs:
            _set(channel, table.channel_settings, where="daq.channel_settings")
        self._set_rate(table.sample_rate)

    @property
    def model(self) -> str:
        """Manufacturer and model, or the name it has."""
        info = self._device.info
        return f"{info.manufacturer} {info.model}".strip() or info.name

    @property
    def serial(self) -> str:
        """Its serial number."""
        return str(self._device.info.serial_number)

    def channels(self) -> list[Channel]:
        """Return the inputs asked for, or as many as there are. Raises ConfigError for what cannot be used."""
        return [self._describe(f"channel {n} ({c.name})", _waveform(c)) for n, c in enumerate(self._inputs)]

    def reader(self, channel: Channel) -> Any:
        """Return a packet reader that has what the channel sends from now on."""
        return self._sdk.PacketReader(channel.signal)

    def is_unchanged(self, channel: Channel) -> bool:
        """Return whether the channel still samples and scales as it did."""
        try:
            return self._describe(channel.name, channel.signal).sampling == channel.sampling
        except ConfigError:
            return False

    def data_packet(self, packet: Any) -> Any | None:
        """Return the packet as a data packet; None for an event."""
        return self._sdk.IDataPacket.cast_from(packet) if packet.type == self._sdk.PacketType.Data else None

    def _connect(self, connection: str) -> Any:
        prefix = connection.split("://")[0]
        modules = self._by_prefix()
        if prefix not in modules:
            raise ConfigError(f"daq.connection: got '{connection}', want one of {', '.join(sorted(modules))} and ://")
        try:
            if prefix.startswith(NETWORK):
                return self._instance.add_device(connection)
            return modules[prefix].create_device(connection, self._instance.root_device, None)
        except RuntimeError as error:
            raise LinkLost(f"{connection}: no openDAQ device answers there ({error})") from error

    def _by_prefix(self) -> dict[str, Any]:
        return {
            self._sdk.IDeviceType.cast_from(kind).connection_string_prefix: module
            for module in self._instance.module_manager.modules
            for kind in module.available_device_types.values()
        }

    def _set_rate(self, sample_rate: float) -> None:
        """Ask for the rate where the device can be asked; whether it took it, its time axis tells."""
        for component in (self._device, *self._inputs):
            for name in RATE_SETTINGS:
                if component.has_property(name) and not component.get_property(name).read_only:
                    _set(component, {name: sample_rate}, where="daq.sample_rate")

    def _describe(self, name: str, signal: Any) -> Channel:
        descriptor, kinds = signal.descriptor, self._sdk.SampleType
        unit = descriptor.unit.symbol if descriptor.unit else "V"
        if unit != "V":
            raise ConfigError(f"daq.connection: {name} measures in '{unit}', want V")
        limits = descriptor.value_range
        volts = (float(limits.low_value), float(limits.high_value)) if limits else None
        scaling = descriptor.post_scaling
        is_raw = scaling is not None and scaling.type == self._sdk.ScalingType.Linear
        raw = _dtype(scaling.input_sample_type if is_raw else descriptor.sample_type, kinds, name)
        if np.issubdtype(raw, np.integer):
            by = scaling.parameters if is_raw else {"scale": 1.0, "offset": 0.0}
            scale = raw_scale(raw, scale=float(by["scale"]), offset=float(by["offset"]), volts=volts)
        else:  # a linear scaling of floating point is left to the SDK
            is_raw, raw = False, _dtype(descriptor.sample_type, kinds, name)
            scale = rounded_scale(volts=volts or DEFAULT_RANGE)
            if volts is None:
                scale = replace(
                    scale, remark=f"{scale.remark} and cut at +-{DEFAULT_RANGE[1]:g} V, as it says no range"
                )
        return Channel(name, signal, scale, raw, is_raw, self._time_axis(name, signal.domain_signal.descriptor))

    def _time_axis(self, name: str, descriptor: Any) -> TimeAxis:
        if descriptor.rule.type != self._sdk.DataRuleType.Linear:
            raise ConfigError(f"daq.connection: {name} has no fixed sample rate but a time for each sample")
        resolution = descriptor.tick_resolution
        tick = Fraction(int(resolution.numerator), int(resolution.denominator))
        return TimeAxis(int(descriptor.rule.parameters["delta"]), tick)


def _waveform(channel: Any) -> Any | None:
    """Return the channel's signal of single values over time, if it has one."""
    signals = (s for s in channel.signals if s.domain_signal is not None and s.descriptor is not None)
    return next((s for s in signals if not len(s.descriptor.dimensions or ())), None)


def _dtype(kind: Any, kinds: Any, name: str) -> np.dtype[Any]:
    """Return numpy's type for one of the SDK's sample types."""
    names = ("Float32", "Float64", "Int8", "Int16", "Int32", "Int64", "UInt8", "UInt16", "UInt32", "UInt64")
    known = {getattr(kinds, n): np.dtype(n.lower()) for n in names}
    if kind not in known:
        raise ConfigError(f"daq.connection: {name} sends {kind.name} samples, want integers or floating point")
    return known[kind]


def _set(component: Any, settings: Mapping[str, Any], *, where: str) -> None:
    """Set properties by name. Raises ConfigError naming the one that is not there or does not take the value."""
    for name, value in settings.items():
        if not component.has_property(name):
            known = ", ".join(sorted(p.name for p in component.visible_properties))
            raise ConfigError(f"{where}.{name}: '{component.name}' has no such property, want one of {known}")
        try:
            component.set_property_value(name, value)
        except (RuntimeError, TypeError) as error:
            raise ConfigError(f"{where}.{name}: '{component.name}' does not take {value!r} ({error})") from error

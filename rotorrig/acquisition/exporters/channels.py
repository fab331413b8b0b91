"""Channels of a recording that an export holds."""

from rotorrig.acquisition.recording import RawRecording


def named_channels(recording: RawRecording) -> list[tuple[str, int]]:
    """Return names and columns in the counts of the config's channels: keyphasor first, probes in its order."""
    rig = recording.rig
    keyphasor = [("keyphasor", rig.keyphasor.channel)] if rig.keyphasor else []
    return keyphasor + [(probe.name, probe.channel) for probe in rig.probes]

"""Provenance and conventions."""

from rotorrig.app.report.html import Section, pairs, section
from rotorrig.app.text import UNDETERMINED
from rotorrig.identify import Diagnosis, Identification
from rotorrig.processing import OrderTrackedResponse


def provenance_section(
    response: OrderTrackedResponse, identification: Identification | None, diagnosis: Diagnosis | None
) -> Section:
    """Return recording, config, code versions and search settings of this report."""
    source = response.source
    values = {
        "recording": source.source or "unknown",
        "sha256 of the recording (16 digits)": source.source_hash or "none: live rig",
        "config hash": source.config_hash,
        "tracked by code version": source.code_version,
    }
    if identification:
        values["identified by code version"] = identification.source.code_version
        values["effects in the model"] = ", ".join(identification.effects) or "none: the base model"
        values["wall time of the fits"] = f"{identification.wall_s:.1f} s"
        for fit in identification.fits:
            values[f"search, {fit.name}"] = (
                f"objective {fit.objective}, {fit.evaluations} evaluations, seed {fit.seed}, stopped: {fit.stop}, "
                f"{len(fit.optima)} optima found"
            )
    if diagnosis:
        values["diagnosed by code version"] = diagnosis.source.code_version
        values["base model of the diagnosis"] = f"{diagnosis.model}, {len(diagnosis.responses) or 1} recording(s)"
    return section("provenance", "Provenance", pairs("Provenance", values))


def conventions_section(response: OrderTrackedResponse) -> Section:
    """Return the conventions of the values in the report."""
    rig = response.rig
    edge = f"the {rig.keyphasor.edge} keyphasor edge" if rig.keyphasor else "the keyphasor edge"
    first, second = rig.rotation.split("-to-")
    words = {
        "amplitude": "0-peak in µm, or as chosen at the top: pp, peak-to-peak, is twice as much; 1 mil is 25.4 µm. "
        "Lengths and the colours of spectra stay in µm",
        "phase": f"phase lag in degrees after {edge}: z = 2 mean(x e^(−jθ)), lag = −arg z, θ = 0 at that edge",
        "axes": "z along the shaft from the coupling; x and y across it; angles from +x towards +y",
        "sense of rotation": f"from {first} to {second}",
        "probe": "reads x cos a + y sin a at its angle a, positive towards the probe",
        "+nX, −nX": "forward and backward whirl: with the rotation and against it",
        "unbalance angle": "from the keyphasor mark, in the sense of rotation",
        "gravity": {"none": "not considered"}.get(rig.gravity, f"along {rig.gravity}"),
        "±": f"one standard deviation; an infinite one shows as “{UNDETERMINED}”",
        "95 %": "confidence interval, if the model is right",
    }
    return section("conventions", "Conventions", pairs("Conventions of this report", words))

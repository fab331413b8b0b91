"""Markdown panels of the result view: verdict, causes, values, colours, provenance."""

from rotorrig.app.text import (
    AmplitudeUnit,
    cause_evidence,
    cause_prediction_error,
    cause_size,
    causes_to_list,
    estimate_text,
    gain_sentence,
    next_run_sentence,
    quantity_text,
    tie_sentences,
)
from rotorrig.app.viewer.result.data import Result
from rotorrig.identify import Diagnosis


def verdict_words(result: Result) -> str:
    """Return verdict, causes and identified values, and what they were made of."""
    paragraphs = [f"# {result.response.rig.name}"]
    if diagnosis := result.diagnosis:
        paragraphs += [f"**{str(diagnosis.verdict).upper()}**: {diagnosis.sentence}", *_causes(diagnosis, result.unit)]
    if fit := result.fit:
        rows = [f"| {e.name} | {estimate_text(e)} | {quantity_text(e.nameplate, e.unit)} |" for e in fit.estimates]
        paragraphs.append("\n".join(["| | identified | nameplate |\n|---|---|---|", *rows]))
    made = result.response.source
    paragraphs.append(f"Config {made.config_hash}, data {made.source} {made.source_hash}, code {made.code_version}.")
    return "\n\n".join(paragraphs)


def colour_words(result: Result) -> str:
    """Return what the colours mean, and the conventions."""
    lines = [
        "blue: speed rises; orange: it falls",
        "white dot: the keyphasor edge, or the vector at the cursor's speed",
    ]
    if result.extended is not None:
        lines.append("pale lines: the extended model; violet ones: the model before")
    elif result.model is not None:
        lines.append("pale lines: the model")
    if result.critical_speeds:
        lines.append("upright lines: critical speeds as measured, pale ones the model's")
        lines.append("AF: amplification factor; ζ: damping by half power")
    lines.append(f"orbits: blue 1X, {result.word}")
    lines[-1] += "; grey-blue 1X as it was" if result.compensated else ""
    lines[-1] += "; grey two turns of all that was recorded" if result.recording is not None else ""
    lines += [
        "green: forward whirl, with the rotation; pink: backward; pale over speed: it falls",
        f"{result.unit.name}, phase lag in degrees from the keyphasor edge",
        "polar plots: 0° at the probe, lag against rotation",
        "the line at the bottom moves the speed; on `phase_deg` it turns the rotor",
    ]
    return "\n".join(f"- {words}" for words in lines)


def _causes(diagnosis: Diagnosis, unit: AmplitudeUnit) -> list[str]:
    """Return the causes in the model and the best others as a table, what the model gains, and the next run."""
    paragraphs = [cause.words for cause in diagnosis.causes if cause.chosen and cause.words not in diagnosis.sentence]
    if diagnosis.causes:
        rows = [
            f"| {c.label} | {cause_size(c)} | {cause_evidence(c)} | {cause_prediction_error(c, unit)} |"
            for c in causes_to_list(diagnosis)
        ]
        heading = f"| cause | size | evidence | error on unseen data, {unit.name} |"
        paragraphs.append("\n".join([heading, "|---|---|---|---|", *rows]))
    return [
        *paragraphs,
        *(
            words
            for words in (gain_sentence(diagnosis), *tie_sentences(diagnosis), next_run_sentence(diagnosis))
            if words
        ),
    ]

"""A diagnosis in a headline: what is wrong, how large and where, as one would say it across the bench."""

from rotorrig.app.text.causes import cause_size
from rotorrig.app.text.quantities import quantity_text, without_sigma
from rotorrig.identify import Diagnosis, Verdict
from rotorrig.identify.verdict import NOT_YET_ALL, Cause

#: an effect's name in a workshop, where its title is another
SAID = {"bow": "bent shaft", "unbalance_plane": "unbalance", "line_hum": "mains hum in the readings"}
PLACELESS = ("even", "odd")  # shapes of a bow: no place
PLAIN = {
    Verdict.ADEQUATE: "The model describes this run.",
    Verdict.UNEXPLAINED: "The model does NOT describe this run",
    Verdict.CANNOT_TELL: "This data cannot decide whether the model is right.",
}


def headline(diagnosis: Diagnosis) -> str:
    """Return what a diagnosis concluded, in one or two short sentences."""
    chosen = [cause for cause in diagnosis.causes if cause.chosen]
    if diagnosis.verdict is Verdict.DESCRIBED:
        words = _missing(diagnosis)
    elif diagnosis.verdict is Verdict.UNEXPLAINED:
        tried = diagnosis.causes and not diagnosis.cut_short
        words = PLAIN[diagnosis.verdict] + (", and none of the causes tried explains it." if tried else ".")
    elif diagnosis.verdict in (Verdict.NAMED, Verdict.TIED) and chosen:
        wrong_config = all(cause.nameplate for cause in chosen)
        words = _wrong_config(diagnosis) if wrong_config else _say_causes(diagnosis, chosen)
    elif diagnosis.verdict in PLAIN:
        words = PLAIN[diagnosis.verdict]
    else:
        words = f"{PLAIN[Verdict.UNEXPLAINED]}."
    return f"{words} The search for causes was cut short." if diagnosis.cut_short else words


def _say_causes(diagnosis: Diagnosis, chosen: list[Cause]) -> str:
    causes = "; ".join(_cause(cause) for cause in chosen)
    words = f"{causes[:1].upper()}{causes[1:]}"
    if diagnosis.verdict is Verdict.TIED:
        others = [label for group in diagnosis.tied for label in group if label not in {c.label for c in chosen}]
        return f"{words}; or as likely {' or '.join(others)}. This data cannot tell which."
    subject = "It explains" if len(chosen) == 1 else "Together they explain"
    share = "most of what" if NOT_YET_ALL in diagnosis.sentence else "what"
    return f"{words}. {subject} {share} the model got wrong."


def cause_name(cause: Cause) -> str:
    """Return the plain name of a cause with its place: "bent shaft", "probe gain, probe 1x"."""
    where = "" if cause.where in PLACELESS else cause.where
    return f"{SAID.get(cause.effect, cause.title)}{', ' if where else ''}{where}"


def _cause(cause: Cause) -> str:
    """Return "bent shaft: 16 µm at 104°"; of a cause with more than a size and an angle the name alone."""
    size = cause_size(cause, coarse=True) if len(cause.parameters) <= 2 else "–"
    return cause_name(cause) if size == "–" else f"{cause_name(cause)}: {size}"


def _wrong_config(diagnosis: Diagnosis) -> str:
    findings = [finding.deviation.words for finding in diagnosis.nameplate.findings]
    told = f": {without_sigma('; '.join(findings))}" if findings else ""
    return f"The config is wrong about this rig{told}. With what it should say, the model describes this run."


def _missing(diagnosis: Diagnosis) -> str:
    missing = diagnosis.missing
    if missing is None or missing.kind == "reading":
        return "A probe reads something besides the shaft that no known cause explains."
    place = f" at {quantity_text(missing.place, 'm')} from the coupling"
    return f"A {missing.kind} that the model lacks acts{place}; no known cause is like it."

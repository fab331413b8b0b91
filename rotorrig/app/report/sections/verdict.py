"""Verdict banner: whether the model describes this run, and where it does not."""

import math
import re
from collections.abc import Sequence
from html import escape

from rotorrig.app.report.html import AMPLITUDE, Section, details, items, paragraph
from rotorrig.app.text import headline, misfit_sentence, next_run_sentence, p_value_text
from rotorrig.identify import Diagnosis, Identification, Verdict
from rotorrig.identify.adequacy import Misfit
from rotorrig.rig.config import UM

POOR = 2.0  # chi2 per degree of freedom above which a fit without a diagnosis is called poor
SHOWN_MISFITS = 3
TONES = {Verdict.ADEQUATE: "good", Verdict.CANNOT_TELL: "unsure"}  # of all others: bad


def banner(
    identification: Identification | None, diagnosis: Diagnosis | None, *, amplitudes_alone: bool = False
) -> Section:
    """Return the verdict as HTML: a headline, a sentence, and the values behind them."""
    if diagnosis is not None:
        tone = TONES.get(diagnosis.verdict, "bad")
        return _banner(
            tone, headline(diagnosis), diagnosis.sentence, _evidence(diagnosis), _worst(diagnosis), _next(diagnosis)
        )
    if identification is not None and identification.fits:
        fit = identification.fits[0]
        ratio = fit.chi2 / fit.dof if fit.dof > 0 else float("nan")
        values = f"χ² per degree of freedom {ratio:.3g} ({fit.chi2:.4g} over {fit.dof})"
        if ratio > POOR or not fit.adequate:
            title = "Poor fit: the model does NOT describe this run"
            if math.isfinite(fit.p):
                return _banner("bad", title, misfit_sentence(fit))  # which has chi2
            return _banner(
                "bad", title, f"Its RMS residual is {ratio**0.5:.1f} times the noise; 1 is expected.", [values]
            )
        sentence = "There is a fit but no diagnosis of where it fails: run rotor diagnose."
        if amplitudes_alone:
            sentence = "There is a fit of amplitudes; a diagnosis of where it fails wants phases, and none is known."
        return _banner("unsure", "Fitted, not diagnosed", sentence, [values])
    return _banner("plain", "Measurement only", "No model was fitted to this run.")


def _banner(
    tone: str,
    title: str,
    sentence: str,
    values: Sequence[str] = (),
    misfits: Sequence[str] = (),
    following: Sequence[str] = (),
) -> Section:
    figures = paragraph(" · ".join(values), kind="figures")
    evidence = details("Misfits and figures", items(misfits), figures) if misfits else figures
    lines = [paragraph(sentence), *map(paragraph, following), evidence]
    head = f'<h2 id="h-verdict">{escape(title)}</h2>'
    html = f'<section id="verdict" class="banner {tone}" aria-labelledby="h-verdict">{head}{"".join(lines)}</section>'
    return Section("verdict", "Verdict", html)


def _evidence(diagnosis: Diagnosis) -> list[str]:
    evidence = []
    if diagnosis.verdict is not Verdict.ADEQUATE and diagnosis.worst:
        evidence.append(f"largest misfit {size(diagnosis.worst)}")
    if diagnosis.dof > 0:
        evidence.append(f"χ² per degree of freedom {diagnosis.chi2 / diagnosis.dof:.3g}")
    if math.isfinite(diagnosis.p) and not re.search(r"\bp [=<>]", diagnosis.sentence):
        evidence.append(p_value_text(diagnosis.p))
    if math.isfinite(diagnosis.noise_floor):
        evidence.append(f"noise floor {diagnosis.noise_floor * UM:.2g} {AMPLITUDE}")
    if math.isfinite(diagnosis.false_alarm_rate):
        evidence.append(f"tested at {100 * diagnosis.false_alarm_rate:.2g} %")
    return evidence


def size(misfits: Sequence[Misfit]) -> str:
    """Return the largest residual and significance among `misfits`, of 0X only if alone: "12.3 µm 0-peak, 45 σ"."""
    moving = [m for m in misfits if m.order]
    unit, told = (AMPLITUDE, moving) if moving else ("µm of shift", misfits)
    return f"{max(m.residual for m in told) * UM:.3g} {unit}, {max(m.sigma for m in told):.3g} σ"


def _worst(diagnosis: Diagnosis) -> list[str]:
    """Return the named causes and the worst misfits, except those in the verdict's sentence."""
    if diagnosis.verdict is Verdict.ADEQUATE:
        return []
    found = diagnosis.verdict is Verdict.DESCRIBED  # the sentence has the force with its intervals
    sentences = [] if found else [cause.words for cause in diagnosis.causes if cause.chosen]
    sentences += [misfit.sentence for misfit in diagnosis.worst[:SHOWN_MISFITS]]
    return [sentence for sentence in sentences if sentence not in diagnosis.sentence]


def _next(diagnosis: Diagnosis) -> list[str]:
    if diagnosis.next_run is None:
        return []
    words = next_run_sentence(diagnosis)
    return [f"Next: {words}" if diagnosis.next_run.planned else words]

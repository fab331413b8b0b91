"""Verdict of a diagnosis: causes named, tied or unexplained, cross-validated gain, separability, the next run."""

from rotorrig.identify.verdict.cause import Cause, ParameterValue
from rotorrig.identify.verdict.cross_validation import Unseen
from rotorrig.identify.verdict.gain import Gain, Predictions, Shift, leave_out_excess, leave_out_idle, predict_unseen
from rotorrig.identify.verdict.nameplate import (
    NameplateSelection,
    conclude_with_nameplate,
    effect_ties,
    nameplate_ties,
    rank_with_nameplate,
    select_beside_nameplate,
)
from rotorrig.identify.verdict.next_run import NextRun, higher_tops
from rotorrig.identify.verdict.sentences import NOT_YET_ALL
from rotorrig.identify.verdict.settings import VERDICT
from rotorrig.identify.verdict.sweep_lag import moving_speed
from rotorrig.identify.verdict.verdict import (
    HiddenEffect,
    Verdict,
    conclude,
    hidden_effects,
    is_supported,
    rank_causes,
    tied_labels,
    visible_share,
)

__all__ = [
    "NOT_YET_ALL",
    "VERDICT",
    "Cause",
    "Gain",
    "HiddenEffect",
    "NameplateSelection",
    "NextRun",
    "ParameterValue",
    "Predictions",
    "Shift",
    "Unseen",
    "Verdict",
    "conclude",
    "conclude_with_nameplate",
    "effect_ties",
    "hidden_effects",
    "higher_tops",
    "is_supported",
    "leave_out_excess",
    "leave_out_idle",
    "moving_speed",
    "nameplate_ties",
    "predict_unseen",
    "rank_causes",
    "rank_with_nameplate",
    "select_beside_nameplate",
    "tied_labels",
    "visible_share",
]

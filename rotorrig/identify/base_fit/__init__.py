"""Fit of the base model and its adequacy, and the angles of trial masses that it may show to be told wrongly."""

from rotorrig.identify.base_fit.base_fit import (
    BASE_FIT,
    AssessedFit,
    BaseProblem,
    KnownEffect,
    SearchOptions,
    assess_fit,
    check_rig,
    config_effects,
    fit_base,
    refit_base,
    search_and_refine,
    with_scatter,
)
from rotorrig.identify.base_fit.trial_angles import judge_trial_angles, recount

__all__ = [
    "BASE_FIT",
    "AssessedFit",
    "BaseProblem",
    "KnownEffect",
    "SearchOptions",
    "assess_fit",
    "check_rig",
    "config_effects",
    "fit_base",
    "judge_trial_angles",
    "recount",
    "refit_base",
    "search_and_refine",
    "with_scatter",
]

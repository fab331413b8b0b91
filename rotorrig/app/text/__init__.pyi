from .amplitude_units import AMPLITUDE_UNITS as AMPLITUDE_UNITS
from .amplitude_units import AS_STATED as AS_STATED
from .amplitude_units import AmplitudeUnit as AmplitudeUnit
from .amplitude_units import amplitude_factor as amplitude_factor
from .amplitude_units import read_amplitude_unit as read_amplitude_unit
from .balancing import CONVENTION as CONVENTION
from .balancing import GMM as GMM
from .balancing import Highest as Highest
from .balancing import comparison_rows as comparison_rows
from .balancing import comparison_sentence as comparison_sentence
from .balancing import correction_rows as correction_rows
from .balancing import grade_sentence as grade_sentence
from .balancing import highest_rows as highest_rows
from .balancing import hole_lines as hole_lines
from .balancing import known_sentences as known_sentences
from .balancing import mass_text as mass_text
from .balancing import mounted_sentence as mounted_sentence
from .causes import CAUSES_TITLE as CAUSES_TITLE
from .causes import cause_evidence as cause_evidence
from .causes import cause_prediction_error as cause_prediction_error
from .causes import cause_size as cause_size
from .causes import cause_status as cause_status
from .causes import causes_to_list as causes_to_list
from .causes import gain_sentence as gain_sentence
from .causes import hidden_effect_lines as hidden_effect_lines
from .causes import hidden_effects_sentence as hidden_effects_sentence
from .causes import next_run_sentence as next_run_sentence
from .causes import parameter_shifts as parameter_shifts
from .causes import tie_sentences as tie_sentences
from .headline import cause_name as cause_name
from .headline import headline as headline
from .investigation import belief_text as belief_text
from .investigation import run_text as run_text
from .missing import missing_lines as missing_lines
from .nameplate import NOTHING_PULLED as NOTHING_PULLED
from .nameplate import finding_sentences as finding_sentences
from .nameplate import misfit_sentence as misfit_sentence
from .nameplate import pull_rows as pull_rows
from .proof_test import proof_test_remark as proof_test_remark
from .quantities import SHOWN as SHOWN
from .quantities import UNDETERMINED as UNDETERMINED
from .quantities import bearing_coefficients as bearing_coefficients
from .quantities import bound_text as bound_text
from .quantities import change_in_sigmas as change_in_sigmas
from .quantities import change_text as change_text
from .quantities import estimate_text as estimate_text
from .quantities import interval_text as interval_text
from .quantities import is_determined as is_determined
from .quantities import long_name as long_name
from .quantities import p_value_text as p_value_text
from .quantities import quantity_text as quantity_text
from .quantities import quantity_with_sigma as quantity_with_sigma
from .resonances import NO_RESONANCE as NO_RESONANCE
from .resonances import critical_speed_cells as critical_speed_cells
from .resonances import critical_words as critical_words
from .resonances import half_power_text as half_power_text
from .resonances import margin_text as margin_text
from .resonances import resonance_text as resonance_text
from .search import search_line as search_line
from .search import stages_text as stages_text
from .tracking import quality_lines as quality_lines
from .tracking import spacing_remark as spacing_remark
from .tracking import tracking_facts as tracking_facts
from .tracking import tracking_line as tracking_line

__all__ = [
    "AMPLITUDE_UNITS",
    "AS_STATED",
    "CAUSES_TITLE",
    "CONVENTION",
    "GMM",
    "NOTHING_PULLED",
    "NO_RESONANCE",
    "SHOWN",
    "UNDETERMINED",
    "AmplitudeUnit",
    "Highest",
    "amplitude_factor",
    "bearing_coefficients",
    "belief_text",
    "bound_text",
    "cause_evidence",
    "cause_name",
    "cause_prediction_error",
    "cause_size",
    "cause_status",
    "causes_to_list",
    "change_in_sigmas",
    "change_text",
    "comparison_rows",
    "comparison_sentence",
    "correction_rows",
    "critical_speed_cells",
    "critical_words",
    "estimate_text",
    "finding_sentences",
    "gain_sentence",
    "grade_sentence",
    "half_power_text",
    "headline",
    "hidden_effect_lines",
    "hidden_effects_sentence",
    "highest_rows",
    "hole_lines",
    "interval_text",
    "is_determined",
    "known_sentences",
    "long_name",
    "margin_text",
    "mass_text",
    "misfit_sentence",
    "missing_lines",
    "mounted_sentence",
    "next_run_sentence",
    "p_value_text",
    "parameter_shifts",
    "proof_test_remark",
    "pull_rows",
    "quality_lines",
    "quantity_text",
    "quantity_with_sigma",
    "read_amplitude_unit",
    "resonance_text",
    "run_text",
    "search_line",
    "spacing_remark",
    "stages_text",
    "tie_sentences",
    "tracking_facts",
    "tracking_line",
]

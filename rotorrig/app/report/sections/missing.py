"""What the model lacks though no known cause explains it: where it acts, how it goes, and its force over speed."""

from html import escape

from rotorrig.app.report.drawings import side_view
from rotorrig.app.report.figures import force_over_motion, force_over_speed
from rotorrig.app.report.html import Section, items, paragraph, plot, scrolling, section
from rotorrig.app.text import missing_lines
from rotorrig.identify import Diagnosis
from rotorrig.identify.discovery import MissingForce
from rotorrig.rig.config import RigConfig

READ = (
    "Dots: what the vectors of one recording lack of force at that place, the rotor taken as fitted, with the noise's "
    "95 % interval; lines: the law that was found. The dots suppose no law."
)
PLACES = "Shaded: how probable each place is for this law, the unknowns of the rotor free."


def missing_section(diagnosis: Diagnosis | None, rig: RigConfig) -> Section | None:
    """Return the section; None where every misfit has a known cause, or none was looked for."""
    if diagnosis is None or diagnosis.missing is None:
        return None
    missing = diagnosis.missing
    heading = "What is missing" if missing.is_described else "What comes nearest, which is no finding"
    return section("missing", heading, items(missing_lines(missing)), _place(missing, rig), _force(missing))


def _place(missing: MissingForce, rig: RigConfig) -> str:
    if not missing.places.size:
        return ""
    drawing = side_view(rig, likely=(missing.places, missing.probability))
    return f'<figure class="wide">{scrolling("Side view", drawing)}<figcaption>{escape(PLACES)}</figcaption></figure>'


def _force(missing: MissingForce) -> str:
    if missing.over_speed is None:
        return ""
    unit = "N m" if missing.kind == "moment" else "N"
    over = f"The {missing.kind} over speed: its size, and the phase lag of each part where that is known."
    against = f"The size of the {missing.kind} against the motion of its place, at the same speeds."
    return "".join(
        [
            plot("missing-speed", force_over_speed(missing.over_speed, unit), caption="Over speed", label=over),
            plot("missing-motion", force_over_motion(missing.over_speed, unit), caption="Over motion", label=against),
            paragraph(READ, kind="figures"),
        ]
    )

"""What the right answer is: which effects of the library a fault of the simulated rig ought to be called, how large.

Faults and effects were written apart and count differently: angles from the shaft's zero or from the keyphasor's edge,
a force or a stiffness, a place anywhere or on a scan. This table is the only place that knows both. A fault that does
not stand in it is an outsider, for which the right answer is that no known cause explains it. What the nameplate has
wrongly is a finding of its own: nameplate_answers.py.
"""

import cmath
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from rotorrig.acquisition.sweep.plans import SETTLING_RAMP
from rotorrig.rig.config import RigConfig, RunUpCoastDown
from rotorrig.sims.effects import catalogue, find
from rotorrig.sims.effects.crack import MOUTHS, Crack
from rotorrig.sims.effects.internal_damping import InternalDamping
from rotorrig.sims.effects.places import MOST_STEPS, STEP, probe_planes
from rotorrig.sims.effects.rub import Rub
from rotorrig.sims.effects.stiffness_over_speed import StiffnessOverSpeed
from rotorrig.sims.effects.unbalance_plane import UnbalancePlane
from rotorrig.sims.plant import FaultSpec, Truth
from rotorrig.sims.plant.faults import load_fault
from rotorrig.sims.plant.faults.internal_damping import RELAXATION
from rotorrig.sims.plant.motor import DRAG_CONSTANT, DRAG_LINEAR
from rotorrig.sims.rotor.model import ONE_RECORDING, between_recordings

Values = Mapping[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """The right answers for one hidden fault."""

    labels: tuple[str, ...]  # any of these is right; none: an outsider
    exact: str = ""  # the one whose size is known
    theta: Mapping[str, float]  # its parameters, SI; approximate where the two do not mean the same
    same: tuple[str, ...] = ()  # those of them that do, so that an interval may be asked to hold them
    disturbed: tuple[str, ...] = ()  # estimates of the base that the fault itself changes
    asked: bool = True  # has to be named; else it may be
    interval: bool = False  # right only if the 95 % interval holds it


OUTSIDER = Answer(labels=(), theta={})


def answer(rig: RigConfig, truth: Truth, hidden: FaultSpec) -> Answer:
    """Return the right answers for a fault in the rig of `truth`."""
    if hidden.name not in ANSWERS:
        return OUTSIDER
    return ANSWERS[hidden.name](rig, truth, load_fault(hidden.name).PARAMETERS | hidden.parameters)


def effect_of(label: str) -> str:
    """Return the effect's name.

    >>> effect_of("runout, plane 2")
    'runout'
    """
    return label.split(", ")[0]


def _plain(label: str, names: Mapping[str, str], *, same: bool = True) -> Callable[[RigConfig, Truth, Values], Answer]:
    """Return a rule for an effect whose parameters are the fault's by other names; of a disk, at the fault's own."""

    def rule(rig: RigConfig, truth: Truth, values: Values) -> Answer:
        theta = {own: values[theirs] for own, theirs in names.items()}
        return _one(_on_disk(rig, label, values), theta, same=tuple(theta) if same else ())

    return rule


def _turning(
    label: str, name: str, amount: str, angle: str, *, order: int = 1
) -> Callable[[RigConfig, Truth, Values], Answer]:
    """Return a rule for one phasor that turns with the shaft."""

    def rule(rig: RigConfig, truth: Truth, values: Values) -> Answer:
        theta = _phasor(name, values[amount], order * (values[angle] + truth.keyphasor_offset))
        return _one(_on_disk(rig, label, values), theta, same=tuple(theta))

    return rule


def _bow(rig: RigConfig, truth: Truth, values: Values) -> Answer:
    """Take a bow of either shape for right; the hidden one is of neither, but as high in its middle."""
    theta = _phasor("bow", values["amount"], values["angle"] + truth.keyphasor_offset)
    pushed = (each.label for each in catalogue(rig) if each.name == "bow")
    return Answer(labels=tuple({"bow, even": 0, **dict.fromkeys(pushed)}), exact="bow, even", theta=theta)


def _coupling(rig: RigConfig, truth: Truth, values: Values) -> Answer:
    """Turn the 2X force from the offset's angle, fixed in space; the shaft's sag, which adds to it, is left out."""
    once = _phasor("force 1X", values["bore_force"], values["bore_angle"] + truth.keyphasor_offset)
    turn = 2 * (values["stiff_diameter"] + truth.keyphasor_offset) - values["offset_angle"]
    twice = _phasor("force 2X", values["stiffness_variation"] * values["offset"], turn)
    diameter = 2 * (values["stiff_diameter"] + truth.keyphasor_offset)
    stiffness = _phasor("stiffness", values["stiffness_variation"], diameter)
    return _one("coupling", once | twice | stiffness, same=())  # whose mean stiffness the effect has no word for


def _friction(rig: RigConfig, truth: Truth, values: Values) -> Answer:
    """Take the creep as the effect has it at first: it comes of the bearings' shaking, which is in no fault."""
    theta = {"force": values["limit"], "give": values["limit"] / values["stuck_stiffness"], "creep": 1e-4}
    return _one("friction", theta, same=())


def _crack(rig: RigConfig, truth: Truth, values: Values) -> Answer:
    """Take the compliance for the softness it makes; fits begin at angles from 0 up to, not at, a whole turn."""
    crack = find(rig, "crack")
    assert isinstance(crack, Crack)
    half = math.pi / MOUTHS
    theta = {
        "softness": crack.softness_of(values["compliance"], values["position"]),
        "mouth": (values["angle"] + truth.keyphasor_offset + half) % math.tau - half,
        "place": values["position"],
    }
    return _one("crack", theta, same=())  # which opens by another law there


def _cross_talk(rig: RigConfig, truth: Truth, values: Values) -> Answer:
    return _one(
        f"cross_talk, {_plane(rig, values['probe'])}", {"leak": values["share"]}, same=()
    )  # it depends on the gaps


def _internal_damping(rig: RigConfig, truth: Truth, values: Values) -> Answer:
    """Take what a backward whirl at the effect's reference loses and stiffens; the hidden one fades above."""
    effect = find(rig, "internal_damping")
    assert isinstance(effect, InternalDamping)
    seen = 2j * effect.reference
    lags = 2 * values["time"] * RELAXATION * seen / (seen + RELAXATION)
    theta = {"beta": abs(lags) / abs(seen), "exponent": cmath.phase(lags) / (math.pi / 2)}
    return _one("internal_damping", theta, same=())


def _line_hum(rig: RigConfig, truth: Truth, values: Values) -> Answer:
    label = "line_hum, 50 Hz"
    return Answer(labels=(label,), exact=label, theta=_phasor("hum", values["amount"], values["phase"]))


def _pedestal(rig: RigConfig, truth: Truth, values: Values) -> Answer:
    """Name the pedestal along x; across it has no resonance within the sweep."""
    omega = math.tau * values["frequency"]
    theta = {
        "lightness": values["compliance"] * omega**2,
        "omega": omega,
        "damping ratio": values["damping_ratio"],
        "compliance across": values["aspect"],
    }
    return _one("pedestal, x", theta, same=("omega",), disturbed=("kyy", "cyy"))  # it rocks, too


def _probe_angle(rig: RigConfig, truth: Truth, values: Values) -> Answer:
    return _one(f"probe_angle, probe {_probe(rig, values)}", {"turn": values["turn"]}, same=("turn",))


def _probe_gain(rig: RigConfig, truth: Truth, values: Values) -> Answer:
    return _one(f"probe_gain, probe {_probe(rig, values)}", {"error": values["gain"]}, same=("error",))


def _rub(rig: RigConfig, truth: Truth, values: Values) -> Answer:
    """Name the ring at the place of the library that is nearest; sizes mean the same at the ring alone."""
    known = {each.label: each for each in catalogue(rig) if isinstance(each, Rub)}
    places = {label: each.places.get(each.place) or rig.disk(each.place).position for label, each in known.items()}
    theta = {"gap": values["gap"], "stiffness": values["stiffness"], "friction": values["friction"]}
    return _one(min(places, key=lambda label: abs(places[label] - values["position"])), theta, same=())


def _runout(rig: RigConfig, truth: Truth, values: Values) -> Answer:
    """Take both parts of the track for right; the larger is the one once per turn, a dent and spots left out."""
    label = f"runout, {_plane(rig, values['probe'])}"
    theta = _phasor("runout", values["eccentricity"], values["angle"] + truth.keyphasor_offset)
    return Answer(labels=(label, f"{label}, twice per turn"), exact=label, theta=theta)


def _soft_left_bearing(rig: RigConfig, truth: Truth, values: Values) -> Answer:
    """Count the seat's compliance in parts of the bearing's own."""
    sought = {name for group in rig.identify.bearings for name in group} if rig.identify else set()
    stiffest = max(b.constant("kxx") for b in rig.bearings if b.name not in sought)
    return _one("soft_left_bearing", {"softness": values["compliance"] * stiffest}, same=())  # it damps, too


def _stiffness_over_speed(rig: RigConfig, truth: Truth, values: Values) -> Answer:
    """Take by how much it has grown at the effect's reference; the hidden one grows by a cube root."""
    label = "stiffness_over_speed"
    effect = find(rig, label)
    assert isinstance(effect, StiffnessOverSpeed)
    ratio = effect.reference / values["reference"]
    grown = ((1.0 + ratio**2) ** (1 / 3) - 1.0) / (2.0 ** (1 / 3) - 1.0)
    return _one(label, {"growth": values["gain"] * grown}, same=())


def _unbalance_plane(rig: RigConfig, truth: Truth, values: Values) -> Answer:
    """Take the neighbours for right: a fit may end nearer to either."""
    places = _nearest(rig, values["position"])
    theta = _phasor("unbalance", values["amount"], values["angle"] + truth.keyphasor_offset)
    theta["shift"] = values["position"] - places[0].position
    return Answer(labels=tuple(e.label for e in places), exact=places[0].label, theta=theta, same=tuple(theta))


def _unbalance_step(rig: RigConfig, truth: Truth, values: Values) -> Answer:
    """Say when the plan passes that speed; the drive lags behind it by some tenths of a second."""
    step = _phasor("step", values["amount"], values["angle"] + truth.keyphasor_offset)
    number = math.ceil(values["run"])
    time = between_recordings(number)
    if number == values["run"]:
        time = number * ONE_RECORDING + max(_passed(rig.plans["default"], values["speed"]), values["time"])
    return _one(_on_disk(rig, "unbalance_step", values), step | {"time": time}, same=tuple(step))


def _passed(plan: RunUpCoastDown, speed: float) -> float:
    """Return when a plan passes a speed on the way up [s], or if negative falls to it on the way down."""
    up = plan.start / SETTLING_RAMP + 2.0 + plan.slow_roll_time
    if speed >= 0:
        return up + max(speed - plan.start, 0.0) / plan.ramp
    down = up + (plan.end - plan.start) / plan.ramp + 1.0
    coast = (DRAG_CONSTANT + DRAG_LINEAR * plan.end) / (DRAG_CONSTANT - DRAG_LINEAR * speed)
    return down + math.log(coast) / DRAG_LINEAR


Rule = Callable[[RigConfig, Truth, Values], Answer]
ANSWERS: Mapping[str, Rule] = {
    "bow": _bow,
    "clearance": _plain("clearance", {"gap": "gap"}, same=False),  # between two balls there is more of it
    "couple": _turning("couple", "skew", "skew", "angle"),
    "coupling": _coupling,
    "crack": _crack,
    "cross_stiffness": _plain("cross_stiffness", {"k": "stiffness"}),
    "cross_talk": _cross_talk,
    "cubic_spring": _plain("cubic_spring", {"k3": "k3"}, same=False),  # of small motion there
    "delay": _plain("delay", {"delay": "time"}),  # of low frequency there: within 1e-3 below 60 Hz
    "disk_inertia": _plain("disk_inertia", {"polar": "polar", "transverse": "transverse"}),
    "drag": _plain("drag", {"c2": "coefficient"}, same=False),  # at one speed there, and past oil that turns
    "friction": _friction,
    "hysteresis": _plain("hysteresis", {"eta": "loss_factor"}, same=False),  # at one amplitude and frequency there
    "internal_damping": _internal_damping,
    "line_hum": _line_hum,
    "pedestal": _pedestal,
    "probe_angle": _probe_angle,
    "probe_gain": _probe_gain,
    "rub": _rub,
    "runout": _runout,
    "shaft_asymmetry": _turning("shaft_asymmetry", "asymmetry", "asymmetry", "stiff_plane", order=2),
    "skew_stiffness": _plain("skew_stiffness", {"k": "stiffness"}, same=False),  # at one speed there
    "soft_left_bearing": _soft_left_bearing,
    "stiffness_over_speed": _stiffness_over_speed,
    "unbalance_plane": _unbalance_plane,
    "unbalance_step": _unbalance_step,
}


def _one(label: str, theta: Mapping[str, float], *, same: tuple[str, ...], disturbed: tuple[str, ...] = ()) -> Answer:
    return Answer(labels=(label,), exact=label, theta=theta, same=same, disturbed=disturbed)


def _phasor(name: str, amount: float, angle: float) -> dict[str, float]:
    z = cmath.rect(amount, angle)
    return {f"{name} re": z.real, f"{name} im": z.imag}


def _probe(rig: RigConfig, values: Values) -> str:
    return rig.probes[round(values["probe"])].name


def _on_disk(rig: RigConfig, label: str, values: Values) -> str:
    """Return a label with the name of the disk that a fault is on, where the rig has several."""
    if "disk" not in values or len(rig.disks) == 1:
        return label
    return f"{label}, {rig.disks[round(values['disk'])].name}"


def _plane(rig: RigConfig, probe: float) -> str:
    """Return the plane in which a probe of that number is."""
    sought = rig.probes[round(probe)]
    return next(name for name, probes in probe_planes(rig).items() if sought in probes)


def _nearest(rig: RigConfig, position: float) -> list[UnbalancePlane]:
    """Return the unbalances on a grid whose place is no more than a step away, nearest first; one at least."""
    step = max(STEP, rig.shaft.length / MOST_STEPS)
    places = [effect for effect in catalogue(rig) if isinstance(effect, UnbalancePlane)]
    nearest, *others = sorted(places, key=lambda effect: abs(effect.position - position))
    return [nearest, *(effect for effect in others if abs(effect.position - position) <= step)]

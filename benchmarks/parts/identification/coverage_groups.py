"""The groups of simulated cases on which intervals are tested."""

from dataclasses import dataclass

from benchmarks.parts.identification.matched_run import Design
from rotorrig.rig.config import RPM

NAMES = ("kxx", "kyy", "cxx", "cyy", "u", "phase")  # of the estimates


@dataclass(frozen=True, kw_only=True)
class Group:
    """Cases of one design, and how their intervals are made."""

    title: str
    design: Design
    share: float  # of the cases asked for
    draws: int = 0  # of the bootstrap
    says: str  # in the page


GROUPS = {
    "ordinary": Group(
        title="well determined",
        design=Design(),
        share=1.0,
        says="the blind plant's noise, and an error of 0.3 % of the reading (`prior.probe_linearity`)",
    ),
    "noisy": Group(
        title="limited by noise",
        design=Design(noise=30.0, linearity=0.0),
        share=0.3,
        says="30 times that noise and perfectly linear probes: the estimated covariance is all there is",
    ),
    "bound": Group(
        title="near a bound",
        design=Design(noise=30.0, linearity=0.0, c=(10.0, 10.6), c_lowest=10.0),
        share=0.3,
        says="30 times that noise, perfectly linear probes, both dampings within 6 % of their lower bound of 10 N s/m",
    ),
    "loose": Group(
        title="badly determined",
        design=Design(noise=5.0, linearity=0.0, fastest=1500 / RPM),
        share=0.3,
        says="5 times that noise, perfectly linear probes, and never faster than 1500 rpm: damping hardly shows",
    ),
    "bootstrap": Group(
        title="bootstrap",
        design=Design(noise=30.0, linearity=0.0, ramp=600 / RPM),
        share=0.1,
        draws=100,
        says="30 times that noise, perfectly linear probes, a sweep seven times as fast, intervals of 100 draws",
    ),
}

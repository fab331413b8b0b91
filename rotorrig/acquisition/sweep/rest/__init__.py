"""Whether the rotor is at rest: three answers, and the evidence for them from keyphasor, probes and drive."""

from rotorrig.acquisition.sweep.rest.evidence import AT_REST, RestEvidence, RotorState

__all__ = ["AT_REST", "RestEvidence", "RotorState"]

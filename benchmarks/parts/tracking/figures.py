"""The figures of one run of the tracking benchmark, and the peers it is compared with."""

import statistics
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.parts.tracking.accuracy import Coverage, Score
from rotorrig.processing.response import Method
from rotorrig.processing.settings import USUAL

PEERS = {"vs_rota_order": "rota-order", "vs_scipy": "plain scipy"}


@dataclass(kw_only=True)
class Figures:
    """What was measured; scores by (case, method)."""

    first: dict[tuple[str, Method], Score] = field(default_factory=dict)  # of the 1X
    second: dict[tuple[str, Method], Score] = field(default_factory=dict)  # of the 2X
    smear: dict[Method, Score] = field(default_factory=dict)  # the window's mean beside the vector in its middle
    coverage: dict[tuple[str, Method], Coverage] = field(default_factory=dict)
    peers: dict[str, Score] = field(default_factory=dict)  # of the 1X, ends left out
    seconds: dict[str, float] = field(default_factory=dict)  # CPU, by what was timed
    realtime: dict[tuple[Method, int], float] = field(default_factory=dict)  # by (method, probes), per probe
    memory: dict[tuple[Method, float], int] = field(default_factory=dict)  # bytes at most, by (method, seconds)
    latency: NDArray[np.float64] | None = None  # s, of rows

    def summary(self) -> dict[str, Any]:
        """Return the headline: the method that is used unless another is asked for, and the ratios to the peers."""
        return self.of(USUAL.method) | {name: self.ratio(peer) for name, peer in PEERS.items()}

    def of(self, method: Method) -> dict[str, Any]:
        """Return the headline of one method; the live view is the same for all."""
        ideal, jittered = self.first["ideal", method], self.first["jitter", method]
        covered = [self.coverage[case, method].share() for case in ("ideal", "jitter")]
        return {
            "realtime_factor": round(min(self.realtime[method, probes] for probes in (1, 8)), 1),
            "rms_percent": round(ideal.vector_percent, 4),
            "phase_deg_rms": round(ideal.phase_deg, 4),
            "rms_percent_jitter": round(jittered.vector_percent, 4),
            "coverage95": round(statistics.mean(covered), 4),
            "live_latency_s": None if self.latency is None else round(float(np.percentile(self.latency, 99)), 3),
        }

    def ratio(self, peer: str) -> dict[str, float]:
        """Return how many times quicker and more exact ours is than a peer."""
        return {
            "speed": round(self.seconds[peer] / self.seconds["ours"], 2),
            "error": round(self.peers[peer].vector_percent / self.peers["ours"].vector_percent, 2),
            "error_jitter": round(
                self.peers[f"{peer}, jitter"].vector_percent / self.peers["ours, jitter"].vector_percent, 2
            ),
        }

"""The one search of CHEA, in the chapter's order, and what a profile has to hand in for it: a `Method`."""

from rotorrig.identify.chea.engine.clusters import nearest_better, next_head
from rotorrig.identify.chea.engine.engine import Clusters, Engine, Index, Method
from rotorrig.identify.chea.engine.local_search import End, LocalSearch

__all__ = ["Clusters", "End", "Engine", "Index", "LocalSearch", "Method", "nearest_better", "next_head"]

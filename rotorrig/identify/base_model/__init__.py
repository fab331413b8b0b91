"""The base model as a least-squares problem: what is unknown, its forward response, objectives and global search."""

from rotorrig.identify.base_model.black_box import SearchName
from rotorrig.identify.base_model.global_search import SearchResult, search
from rotorrig.identify.base_model.objectives import ObjectiveName, thin_rows
from rotorrig.identify.base_model.parameters import Parameters, Reals
from rotorrig.identify.base_model.settings import BASE_MODEL, BaseModelSettings
from rotorrig.identify.base_model.structure import StructuralModel
from rotorrig.identify.base_model.unknowns import Space, Unknown

__all__ = [
    "BASE_MODEL",
    "BaseModelSettings",
    "ObjectiveName",
    "Parameters",
    "Reals",
    "SearchName",
    "SearchResult",
    "Space",
    "StructuralModel",
    "Unknown",
    "search",
    "thin_rows",
]

from .chapter.settings import SEED as SEED
from .chapter.settings import SeedSettings as SeedSettings
from .minimize import chea as chea
from .modern.settings import MODERN as MODERN
from .modern.settings import ModernSettings as ModernSettings
from .profiles import Local as Local
from .profiles import Profile as Profile
from .residuals import ABSOLUTES as ABSOLUTES
from .residuals import RESIDUAL as RESIDUAL
from .residuals import SQUARES as SQUARES
from .residuals import Norm as Norm
from .residuals import Residual as Residual
from .residuals import ResidualResult as ResidualResult
from .residuals import ResidualSettings as ResidualSettings
from .residuals import residual_search as residual_search
from .search import Search as Search
from .session import CheaResult as CheaResult
from .session import SearchState as SearchState
from .session import Stage as Stage
from .session import StopReason as StopReason

__all__ = [
    "ABSOLUTES",
    "MODERN",
    "RESIDUAL",
    "SEED",
    "SQUARES",
    "CheaResult",
    "Local",
    "ModernSettings",
    "Norm",
    "Profile",
    "Residual",
    "ResidualResult",
    "ResidualSettings",
    "Search",
    "SearchState",
    "SeedSettings",
    "Stage",
    "StopReason",
    "chea",
    "residual_search",
]

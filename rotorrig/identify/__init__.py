"""From tracked vectors to a rotor model: identify it, say what it gets wrong, and why.

`identify` fits stiffness, damping and unbalance to one response (base_fit/fit.py), `diagnose` extends that model by
what the data call for (diagnosis.py). Below: `base_model` and `extended_model` (the least-squares problems),
`least_squares` (their solver), `chea` (the optimiser), `uncertainty`, `adequacy` (is the model good enough), `causes`
(which effects to add), `verdict`, `discovery` (the force that no known effect is).
"""

import importlib
import sys
from types import ModuleType
from typing import Any

import lazy_loader


class _CallableFolder(ModuleType):
    """The folder, which can be called as the verb it is named after: `rr.identify(response)` of the Python face."""

    def __call__(self, *args: Any, **options: Any) -> Any:
        return importlib.import_module("rotorrig.app.python").identify(*args, **options)


sys.modules[__name__].__class__ = _CallableFolder

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

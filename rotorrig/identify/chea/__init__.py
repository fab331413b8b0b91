"""CHEA, the clustering-based hybrid evolutionary algorithm: a global optimiser that lists every significant minimum.

One engine searches with the parts it is handed. `chea()` runs a profile (`seed`: the chapter's, as published;
`modern`: ours) with its settings and returns a `CheaResult`; `Search` is the same for whoever calls the objective
himself. `residual_search` has a residual vector and its Jacobian to go by. Knows nothing of rotors; imports numpy and
scipy alone.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

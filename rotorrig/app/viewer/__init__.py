"""Rerun views.

`live` during a sweep or replay, `result` for a response with its fit and diagnosis, `plots` for both.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""A lab: every recording of a folder tracked, identified and diagnosed once, and a catalogue of what came of it.

`run_lab` works through the recordings on many processes (Dask) and goes on where it was left; `query` and
`open_catalogue` ask the catalogue in SQL (DuckDB). Below stand the schema of its tables, the part-files they are kept
in and the steps of one recording. `page` writes all of it as pages for a browser.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

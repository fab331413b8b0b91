from .open import Evidence as Evidence
from .open import LiveView as LiveView
from .open import save_view as save_view
from .open import serve as serve
from .open import view_file as view_file
from .open import write_result_rrd as write_result_rrd

__all__ = [
    "Evidence",
    "LiveView",
    "save_view",
    "serve",
    "view_file",
    "write_result_rrd",
]

from .controllers import Place as Place

__all__ = [
    "Place",
]

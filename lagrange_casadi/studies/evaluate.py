"""A scene over its instants: see :mod:`.solving`."""

from .solving import evaluate

__all__ = ["evaluate"]

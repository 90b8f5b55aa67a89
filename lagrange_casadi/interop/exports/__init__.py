"""A scene as C for other people's programs: a folder that stands alone."""

from .folder import export

__all__ = ["export"]

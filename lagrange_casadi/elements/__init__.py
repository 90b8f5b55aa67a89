"""Parts as they are built, each declared in one call and made of links, joints and loads."""

from .bent import Bent, bent_bar
from .plate import Plate, plate

__all__ = ["Bent", "Plate", "bent_bar", "plate"]

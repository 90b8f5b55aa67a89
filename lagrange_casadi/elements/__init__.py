"""Parts as they are built, each declared in one call and made of links, joints and loads."""

from .bent import Bent, bent_bar
from .cam import Cam, disc_cam
from .cam_profile import CamProfile
from .plate import Plate, plate

__all__ = ["Bent", "Cam", "CamProfile", "Plate", "bent_bar", "disc_cam", "plate"]

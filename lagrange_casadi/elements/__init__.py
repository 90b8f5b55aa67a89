"""Parts as they are built, each declared in one call and made of links, joints and loads."""

from .bent import Bent, bent_bar
from .cam import Cam, disc_cam
from .cam_profile import CamProfile
from .cylinder import Cylinder, cylinder
from .plate import Plate, plate

__all__ = ["Bent", "Cam", "CamProfile", "Cylinder", "Plate", "bent_bar", "cylinder", "disc_cam", "plate"]

"""Parts as they are built, each declared in one call and made of links, joints and loads."""

from .belts import Belt, belt
from .bent import Bent, bent_bar
from .cam import Cam, disc_cam
from .cam_profile import CamProfile
from .cylinder import Cylinder, cylinder
from .gears import Gears, gears
from .planetary import Planetary, planetary
from .plate import Plate, plate
from .wheel import wheel

__all__ = [
    "Belt",
    "Bent",
    "Cam",
    "CamProfile",
    "Cylinder",
    "Gears",
    "Planetary",
    "Plate",
    "belt",
    "bent_bar",
    "cylinder",
    "disc_cam",
    "gears",
    "planetary",
    "plate",
    "wheel",
]

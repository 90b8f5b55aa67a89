"""Parts as they are built, each declared in one call and made of links, joints and loads."""

from .belts import Belt, belt
from .bent import Bent, bent_bar
from .cam import Cam, disc_cam
from .cam_profile import CamProfile
from .cylinder import Cylinder, cylinder
from .cylindrical_cam import CylindricalCam, cylindrical_cam
from .gears import Gears, gears
from .planetary import Planetary, planetary
from .plate import Plate, plate
from .profile_lift import ProfileLift, profile_lift, read_profile
from .supports import Bearings, Bushes, two_bearings, two_bushes
from .wheel import wheel

__all__ = [
    "Bearings",
    "Belt",
    "Bent",
    "Bushes",
    "Cam",
    "CamProfile",
    "Cylinder",
    "CylindricalCam",
    "Gears",
    "Planetary",
    "Plate",
    "ProfileLift",
    "belt",
    "bent_bar",
    "cylinder",
    "cylindrical_cam",
    "disc_cam",
    "gears",
    "planetary",
    "plate",
    "profile_lift",
    "read_profile",
    "two_bearings",
    "two_bushes",
    "wheel",
]

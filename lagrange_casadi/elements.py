"""Parts as they are built, each declared in one call and made of links, joints and loads."""

from .model.elements.belts import Belt, belt
from .model.elements.bent import Bent, bent_bar
from .model.elements.cam import Cam, disc_cam
from .model.elements.cam_profile import CamProfile
from .model.elements.cylinder import Cylinder, cylinder
from .model.elements.cylindrical_cam import CylindricalCam, cylindrical_cam
from .model.elements.gears import Gears, gears
from .model.elements.geneva import Geneva, geneva
from .model.elements.planetary import Planetary, planetary
from .model.elements.plate import Plate, plate
from .model.elements.profile_lift import ProfileLift, profile_lift, read_profile
from .model.elements.strut import gas_spring, strut
from .model.elements.supports import Bearings, Bushes, two_bearings, two_bushes
from .model.elements.wheel import wheel

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
    "Geneva",
    "Planetary",
    "Plate",
    "ProfileLift",
    "belt",
    "bent_bar",
    "cylinder",
    "cylindrical_cam",
    "disc_cam",
    "gas_spring",
    "gears",
    "geneva",
    "planetary",
    "plate",
    "profile_lift",
    "read_profile",
    "strut",
    "two_bearings",
    "two_bushes",
    "wheel",
]

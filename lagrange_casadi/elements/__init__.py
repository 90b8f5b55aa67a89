"""Parts as they are built, each declared in one call and made of links, joints and loads."""

from .bent import Bent, bent_bar
from .cam import Cam, disc_cam
from .cam_profile import CamProfile
from .cylinder import Cylinder, cylinder
from .cylindrical_cam import CylindricalCam, cylindrical_cam
from .plate import Plate, plate
from .profile_lift import ProfileLift, profile_lift, read_profile

__all__ = [
    "Bent",
    "Cam",
    "CamProfile",
    "Cylinder",
    "CylindricalCam",
    "Plate",
    "ProfileLift",
    "bent_bar",
    "cylinder",
    "cylindrical_cam",
    "disc_cam",
    "plate",
    "profile_lift",
    "read_profile",
]

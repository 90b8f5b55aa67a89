"""Cross-sections, materials and notches of links."""

from .analysed import analysed
from .beam import Beam, Notch
from .concentration import hole, keyway, sensitivity, shoulder
from .material import Material, material
from .profiles import Profile, read_profiles
from .properties import Fibre, Properties
from .shape import (
    Course,
    Shape,
    along,
    box,
    c_section,
    ellipse,
    given,
    hollow_section,
    i_section,
    polygon,
    rectangle,
    round_bar,
    stepped,
    t_section,
    tapered,
    tube,
)

__all__ = [
    "Beam",
    "Course",
    "Fibre",
    "Material",
    "Notch",
    "Profile",
    "Properties",
    "Shape",
    "along",
    "analysed",
    "box",
    "c_section",
    "ellipse",
    "given",
    "hole",
    "hollow_section",
    "i_section",
    "keyway",
    "material",
    "polygon",
    "read_profiles",
    "rectangle",
    "round_bar",
    "sensitivity",
    "shoulder",
    "stepped",
    "t_section",
    "tapered",
    "tube",
]

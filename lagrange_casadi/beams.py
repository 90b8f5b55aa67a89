"""Cross-sections, materials and notches of links."""

from .model.beams.analysed import analysed
from .model.beams.beam import Beam, Notch
from .model.beams.concentration import hole, keyway, sensitivity, shoulder
from .model.beams.material import Material, material
from .model.beams.profiles import Profile, read_profiles
from .model.beams.properties import Fibre, Properties
from .model.beams.shape import (
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

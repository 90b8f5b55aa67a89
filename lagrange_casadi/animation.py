"""Animations: the mechanism in motion as a GIF, an MP4, an animated SVG or glTF."""

from .results.pictures import Animation, Film
from .views.animation.film import ENDINGS, check_ending, write_animation

__all__ = ["ENDINGS", "Animation", "Film", "check_ending", "write_animation"]

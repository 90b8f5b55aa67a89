"""Animations: the mechanism in motion as a GIF, an MP4 or an animated SVG."""

from .film import ENDINGS, Film, check_ending, write_animation

__all__ = ["ENDINGS", "Film", "check_ending", "write_animation"]

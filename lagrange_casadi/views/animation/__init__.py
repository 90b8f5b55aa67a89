"""Animations: the mechanism in motion as a GIF, an MP4, an animated SVG or glTF."""

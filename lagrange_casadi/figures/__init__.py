"""Figures: what a case may want drawn, and the drawing of it."""

from ..shapes.specs import (
    DeflectionPlot,
    MechanismDrawing,
    PolarPlots,
    SectionDiagrams,
    SectionMaps,
    SpanPlot,
    Spec,
    StrengthPlot,
    TimePlot,
    UtilisationPlot,
)
from .figures import default_figures, draw

__all__ = [
    "DeflectionPlot",
    "MechanismDrawing",
    "PolarPlots",
    "SectionDiagrams",
    "SectionMaps",
    "SpanPlot",
    "Spec",
    "StrengthPlot",
    "TimePlot",
    "UtilisationPlot",
    "default_figures",
    "draw",
]

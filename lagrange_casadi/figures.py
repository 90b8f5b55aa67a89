"""Figures: what a case may want drawn, and the drawing of it."""

from .views.figures.figures import default_figures, draw
from .views.shapes.specs import (
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

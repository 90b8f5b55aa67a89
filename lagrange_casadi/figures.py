"""Figures: what a case may want drawn, and the drawing of it."""

from .results.store.specs import (
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
from .views.figures.solution_figures import default_figures, draw

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

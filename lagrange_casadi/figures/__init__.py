"""What figures a case may want: the public part of :mod:`.figures.figures`."""

from .figures import (
    DeflectionPlot,
    MechanismDrawing,
    SectionMaps,
    SpanPlot,
    Spec,
    StrengthPlot,
    TimePlot,
    UtilisationPlot,
    default_figures,
    draw,
)

__all__ = [
    "DeflectionPlot",
    "MechanismDrawing",
    "SectionMaps",
    "SpanPlot",
    "Spec",
    "StrengthPlot",
    "TimePlot",
    "UtilisationPlot",
    "default_figures",
    "draw",
]

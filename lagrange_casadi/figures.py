"""What figures a case may want: the public part of :mod:`.draw.figures`."""

from .draw.figures import (
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

"""``lagrange-casadi draw``: a drawing of a case as it is declared, as SVG or PNG."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ..base.units import Number
from ..studies.case import load_case
from .echo import echo
from .options import target


def draw(
    case: Path,
    *,
    out: Path | None = None,
    t: Number | None = None,
    parameters: Mapping[str, float] | None = None,
) -> None:
    """Draw a CASE as it is declared, whether its loops close or not.

    The drawing shows bodies, joints and loads with their names, and what is driven. A loop that
    does not close is drawn with its gap in red.

    Parameters
    ----------
    case : CASE
    out : FILE.svg|FILE.png
        Write the drawing to this file; default: <case>.svg here.
    t : SECONDS
        Set the instant [s]; default: the first one of the case.
    parameters
        As of :func:`.studies.evaluate.evaluate`.
    """
    found = load_case(case)
    path = target("--out", out, f"{found.name}.svg", (".svg", ".png"))
    drawing = found.scene.draw(path, t=t, parameters=parameters)
    echo(*(f"note: {gap}" for gap in drawing.gaps), err=True)
    echo(f"wrote {path}")

"""``lagrange-casadi draw``: a drawing of a case as it is declared, as SVG or PNG."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ..base.units import Number
from ..errors import LagrangeCasadiError
from ..studies.case import case_file, load_case, name_of
from ..views.drawing import ENDINGS, draw_declared
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
    does not close is drawn with its gap in red. Of a case that fails, the drawing shows what
    was declared until then.

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
    file = case_file(case).resolve()
    path = target("--out", out, f"{name_of(file)}.svg", ENDINGS)
    try:
        found = load_case(case)
    except LagrangeCasadiError as error:
        if draw_declared(file, error, path, parameters):
            echo(f"wrote {path}: what was declared before the error")
        raise
    drawing = found.scene.draw(path, t=t, parameters=parameters)
    echo(*(f"note: {gap}" for gap in drawing.gaps), err=True)
    echo(f"wrote {path}")

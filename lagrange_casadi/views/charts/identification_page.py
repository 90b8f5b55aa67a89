"""The page of an identification: what was found, how sure it is, and what is left."""

from __future__ import annotations

import base64
import math
import os
from collections.abc import Iterable, Iterator, Sequence
from html import escape
from pathlib import Path

from ...base.arguments import public
from ...base.files import writing
from ...studies.identification.fit import Comparison
from ...studies.identification.identification import Identification
from ..shapes.index import document, html_table
from ..shapes.picture_files import check_picture
from .identification_chart import BESIDE, DIFFERENCE, chart

ENDINGS = (".html",)

_STYLE = """
body { max-width: 1200px; }
h2 { font-size: 18px; margin: 26px 0 8px; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: 3px 14px 3px 0; border-bottom: 1px solid #8884; text-align: right; }
th { font-weight: 600; vertical-align: bottom; }
th:first-child, td:first-child { text-align: left; min-width: 8em; white-space: normal; }
td { white-space: nowrap; }
td:last-child { text-align: left; }
main { margin-top: 14px; }
li { overflow-wrap: anywhere; }
@media (max-width: 600px) { table { font-size: 13px; } th, td { padding-right: 8px; } }
"""


@public
def report_identification(
    found: Identification, path: str | os.PathLike[str], validation: Comparison | None = None
) -> None:
    """Write a page for a browser, with all tables and pictures, in one file.

    Parameters
    ----------
    found
        The result of :func:`.identify`.
    path
        A name that ends in .html; the file is replaced whole or not at all.
    validation
        Comparison with another record.

    Raises
    ------
    DeclarationError
        For another ending.
    PathError
        If the file cannot be written.
    """
    check_picture(path, ENDINGS)
    text = document(
        f"{found.name}: identification", found.name, "".join(_parts(found, validation)), _STYLE
    )
    with writing(Path(path)) as file:
        file.write(text.encode())


def _parts(found: Identification, validation: Comparison | None) -> Iterator[str]:
    yield (
        f"<p>{len(found.base)} combinations of {len(found.values)} parameters from"
        f" {escape(found.measurements)}; condition number {found.condition:.3g}.</p>\n"
    )
    if found.notes:
        notes = "".join(f"<li>{escape(note)}</li>\n" for note in found.notes)
        yield f"<ul>\n{notes}</ul>\n"
    yield "<h2>What the measurements determine</h2>\n"
    rows = [(o.words, f"{o.value:.6g}", f"{o.error:.2g}", f"{o.t:.3g}", o.unit) for o in found.base]
    yield _table(("combination", "value", "standard error", "t"), rows)
    yield "<h2>Parameters</h2>\n"
    yield _table(("parameter", "before", "found", "standard error"), _values(found))
    for title, compared in (("The record", found.comparison), ("Another record", validation)):
        if compared is not None:
            yield f"<h2>{title}</h2>\n"
            yield from _compared(found, compared)


def _values(found: Identification) -> Iterator[tuple[str, ...]]:
    """Yield a row of the table of parameters for each."""
    for name, value in found.values.items():
        before, error = f"{found.initial[name]:.6g}", f"{found.errors[name]:.2g}"
        if name in found.prior:
            before += f" ± {found.prior[name]:.3g}"
        if not math.isfinite(found.errors[name]):
            error = "not measured" if name in found.absent else "in a sum only"
        yield name, before, f"{value:.6g}", error, found.units[name]


def _compared(found: Identification, compared: Comparison) -> Iterator[str]:
    """Yield a table of what is left, and pictures of measurement, model and difference."""
    relative = compared.relative
    rows = [
        (
            name,
            f"{left:.4g}",
            f"{100.0 * relative[name]:.3g} %",
            f"{found.noise[name]:.3g}",
            compared.units[name],
        )
        for name, left in compared.residual.items()
    ]
    yield _table(("quantity", "difference, rms", "of measured", "noise of the fit"), rows)
    yield "<main>\n"
    for name in compared.measured:
        for curves in (BESIDE, DIFFERENCE):
            image = base64.b64encode(chart(compared, name, curves)).decode()
            words = escape(f"{name}: {', '.join(curves)}")
            yield f'<figure><img src="data:image/svg+xml;base64,{image}" alt="{words}"></figure>\n'
    yield "</main>\n"


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table whose last column, which has no head, has units."""
    return f'<div class="wide">{html_table((*heads, ""), rows)}</div>\n'

"""``lagrange-casadi trade``: what each digit costs, on this machine."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from ..base.files import writing
from ..base.table_writers import aligned
from ..engine.instants.evaluation_method import EvaluationMethod
from ..studies.case import load_case
from ..studies.trade import METHODS, Trade
from ..studies.trade import trade as measure
from ..views.figures.trade_plot import draw_trade
from ..views.shapes.picture_files import PICTURES
from .echo import echo
from .options import refuse, target
from .progress import bar_of


def trade(
    case: Path,
    *,
    accuracy: float | None = None,
    out: Path | None = None,
    figure: Path | None = None,
    **given: Any,
) -> None:
    """Measure time and error of each evaluation method on CASE.

    Methods differ in backend, precision, Newton steps, tables and compiler flags.

    Parameters
    ----------
    case : CASE
    parameters, t, over, wanted
        As of :func:`.studies.evaluate.evaluate`.
    accuracy : ERROR
        Recommend the fastest method whose error, over the peak, is within this number.
    out
        Write the numbers to this JSON file; default: <case>_trade.json here.
    figure
        Draw time over error into this file; default: <case>_trade.png here.
    """
    refuse(
        (
            accuracy is not None and not 0.0 < accuracy < math.inf,
            f"accuracy: expected a finite number above 0, got {accuracy!r}",
        )
    )
    loaded = load_case(case)
    out = target("--out", out, f"{loaded.name}_trade.json", (".json",))
    figure = target("--figure", figure, f"{loaded.name}_trade.png", PICTURES)
    with bar_of("methods", total=len(METHODS)) as bar:

        def progress(method: EvaluationMethod) -> None:
            bar.set_postfix_str(method.options)
            bar.update()

        found = measure(loaded.scene, progress=progress, **given)
    with writing(out) as numbers:
        numbers.write(f"{json.dumps(found.as_dict(), indent=1)}\n".encode())
        numbers.flush()
        draw_trade(found, figure)
    _print(found)
    echo(f"wrote {out} and {figure}")
    if accuracy is not None:
        for place, among in (("", found), (" in exported C", found.exported)):
            if among.measurements:
                best = among.fastest(accuracy)
                cost = f"{1e9 * best.seconds:.3g} ns an instant, relative error {best.largest:.1e}"
                echo(f"fastest within {accuracy:g}{place}: {best.method.options} ({cost})")


def _print(found: Trade) -> None:
    default = next(
        (one.seconds for one in found.measurements if one.method == EvaluationMethod("lanes")),
        found.measurements[0].seconds,
    )
    heads = ["", "method", "ns/instant", "instructions", "x lanes", "largest", "median"]
    rows = [
        [
            "*" if one in found.front else "",
            one.method.options,
            f"{1e9 * one.seconds:.4g}",
            str(one.instructions),
            f"{one.seconds / default:.2f}",
            f"{one.largest:.1e}",
            f"{one.median:.1e}",
            f"{one.worst}; {one.note}" if one.note else one.worst,
        ]
        for one in found.measurements
    ]
    echo(
        (
            f"{found.case}: every output at {found.instants} instants, processor time of one"
            f" thread; errors at {found.compared} instants, relative to each quantity's peak; *"
            " nothing is faster and more accurate; times within 20 % are held to be equal"
        ),
        *aligned([*heads, "worst quantity"], rows, left=(0, 1, 7), indent=""),
        *(f"  {options}: {reason}" for options, reason in found.refused.items()),
    )
    if found.peaks:
        rows = [
            [
                str(row.count),
                *(
                    f"{error:.1e}"
                    for error in (
                        row.sampled_worst,
                        row.sampled_median,
                        row.refined_worst,
                        row.refined_median,
                    )
                ),
            ]
            for row in found.peaks
        ]
        echo(
            (
                "how far peaks of forces fall short, by instants of the cycle; refined: between"
                " them, as by run --refine-peaks"
            ),
            *aligned(["instants", "worst", "median", "refined worst", "refined median"], rows),
        )
    if found.searches:
        rows = [
            [cost.peaks, f"{1e9 * cost.seconds:.4g}", f"{cost.error:.1e}", f"{cost.bound:.1e}"]
            for cost in found.searches
        ]
        echo(
            (
                "peaks of designs, all of them; error of the worst quantity, and its bound,"
                " relative to its peak"
            ),
            *aligned(["peaks", "ns/instant", "error", "bound"], rows, left=(0,)),
        )

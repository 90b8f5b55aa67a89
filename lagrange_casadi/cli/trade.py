"""``lagrange-casadi trade``: what each digit costs, on this machine."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from ..base.files import check_writable, writing
from ..engine.instants.evaluation_method import EvaluationMethod
from ..errors import DeclarationError
from ..studies.case import load_case
from ..studies.trade import METHODS, Trade
from ..studies.trade import trade as measure
from ..views.figures.trade_plot import draw_trade
from ..views.shapes.pictures import PICTURES
from .echo import echo
from .options import target
from .progress import bar_of


def trade(
    case: Path,
    accuracy: float | None,
    out: Path | None,
    figure: Path | None,
    **given: Any,
) -> None:
    """See :func:`.commands.trade`."""
    if accuracy is not None and not 0.0 < accuracy < math.inf:
        raise DeclarationError(f"accuracy: expected a finite number above 0, got {accuracy!r}")
    loaded = load_case(case)
    out = target("--out", out, f"{loaded.name}_trade.json", (".json",))
    check_writable(out)
    figure = target("--figure", figure, f"{loaded.name}_trade.png", PICTURES)
    check_writable(figure)
    with bar_of("methods", total=len(METHODS)) as bar:

        def progress(method: EvaluationMethod) -> None:
            bar.set_postfix_str(method.options)
            bar.update()

        found = measure(loaded.scene, progress=progress, **given)
    with writing(out) as numbers, writing(figure) as picture:
        numbers.write(f"{json.dumps(found.as_dict(), indent=1)}\n".encode())
        numbers.flush()
        draw_trade(found, picture, figure.suffix)
    _print(found)
    echo(f"wrote {out} and {figure}")
    if accuracy is not None:
        for place, among in (("", found), (" in exported C", found.exported)):
            if among.measurements:
                best = among.fastest(accuracy)
                cost = f"{1e9 * best.seconds:.3g} ns an instant, relative error {best.largest:.1e}"
                echo(f"fastest within {accuracy:g}{place}: {best.method.options} ({cost})")


def _print(found: Trade) -> None:
    width = max(len(one.method.options) for one in found.measurements)
    default = next(
        (one.seconds for one in found.measurements if one.method == EvaluationMethod("lanes")),
        found.measurements[0].seconds,
    )
    echo(
        f"{found.case}: every output at {found.instants} instants, processor time of one thread;"
        f" errors at {found.compared} instants, relative to each quantity's peak; * nothing is"
        " faster and more accurate; times within 20 % are held to be equal"
    )
    echo(
        f"  {'method':<{width}} {'ns/instant':>11} {'instructions':>12} {'x lanes':>8}"
        f" {'largest':>9} {'median':>9}   worst quantity"
    )
    for one in found.measurements:
        mark = "*" if one in found.front else " "
        note = f"; {one.note}" if one.note else ""
        echo(
            f"{mark} {one.method.options:<{width}} {1e9 * one.seconds:>11.4g}"
            f" {one.instructions:>12} {one.seconds / default:>8.2f}"
            f" {one.largest:>9.1e} {one.median:>9.1e}   {one.worst}{note}"
        )
    for options, reason in found.refused.items():
        echo(f"  {options}: {reason}")
    if found.peaks:
        echo(
            "how far peaks of forces fall short, by instants of the cycle; refined: between them,"
            " as by run --refine-peaks"
        )
        echo(
            f"  {'instants':>8} {'worst':>9} {'median':>9} {'refined worst':>14}"
            f" {'refined median':>15}"
        )
    for row in found.peaks:
        sampled, refined = (
            f"{row.sampled_worst:>9.1e} {row.sampled_median:>9.1e}",
            f"{row.refined_worst:>14.1e} {row.refined_median:>15.1e}",
        )
        echo(f"  {row.count:>8} {sampled} {refined}")
    if found.searches:
        echo(
            "peaks of designs, all of them; error of the worst quantity, and its bound, relative to"
            " its peak"
        )
        echo(f"  {'peaks':<8} {'ns/instant':>11} {'error':>9} {'bound':>9}")
    for cost in found.searches:
        echo(f"  {cost.peaks:<8} {1e9 * cost.seconds:>11.4g} {cost.error:>9.1e} {cost.bound:>9.1e}")

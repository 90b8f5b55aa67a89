"""Table by which methods of data and keywords of functions reach packages that lie above them.

`Solution`, `Scene` and `Sweep` are data, and so know no report, no animation and no factor of
safety. Their methods look these up here when they are called. No other module may name a module in
a string: ``tests/structure/test_layering.py`` reads this table.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import Any

from .errors import MissingPackageError

METHODS: dict[str, str] = {
    "PostureError.drawn": "figures.postures:draw_postures",
    "Scene._repr_html_": "report:scene_summary",
    "Scene.report": "report:scene_report",
    "Solution._repr_html_": "report:summary",
    "Solution.animate": "animation:write_animation",
    "Solution.deflection": "elastic.deflection:deflection",
    "Solution.life": "strength:life",
    "Solution.notes": "elastic.vibration:swinging",
    "Solution.report": "report:write_report",
    "Solution.report_beside": "report:write_comparison",
    "Solution.safety": "strength.parts:part_safety",
    "Solution.stress": "strength:stress",
    "Solution.view": "report:view",
    "Spec.draw": "figures.figures:drawn",
    "Sweep._repr_html_": "report.sweep_summary:summary",
    "Sweep.report": "report.of_sweep:write_sweep_report",
    "figures.default_figures": "figures:default_figures",
    "figures.draw": "figures:draw",
    "optimise.dask": "cluster.dask_workers:Cluster",
    "sweep.dask": "cluster.dask_workers:Cluster",
}
"""Module and function of each method, by its name."""


def method(name: str) -> Callable[..., Any]:
    """The function that answers a method of :data:`METHODS`.

    Raises :class:`.MissingPackageError` without its package.
    """
    module, _, function = METHODS[name].partition(":")
    try:
        found: Callable[..., Any] = getattr(
            importlib.import_module(f"{__package__}.{module}"), function
        )
    except ModuleNotFoundError as error:
        raise missing(error, name) from None
    return found


def missing(error: ModuleNotFoundError, name: str) -> ImportError:
    """An error of ours where what is missing is a package of ours, which ``name`` needs; else the
    same error.
    """
    lacking = error.name or ""
    if lacking.partition(".")[0] != __package__:
        return error
    return MissingPackageError(
        f"{name} needs {lacking}, which this installation lacks; install all of lagrange_casadi"
    )

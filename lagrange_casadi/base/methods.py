"""Table by which methods of data reach packages that lie above them.

`Solution`, `Scene` and `Sweep` are data, and so know no report, no animation and no factor of
safety. Their methods look these up here when they are called. No other module may name a module in
a string: ``tests/structure/test_layering.py`` reads this table.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import Any

METHODS: dict[str, str] = {
    "Mechanism._repr_html_": "views.drawing:face",
    "Mechanism.draw": "views.drawing:draw_mechanism",
    "Scene._repr_html_": "views.report:scene_summary",
    "Scene.draw": "views.drawing:draw_scene",
    "Scene.report": "views.report:scene_report",
    "Solution._repr_html_": "views.report:summary",
    "Solution.animate": "views.animation.film:write_animation",
    "Solution.deflection": "results.elastic.deflection:deflection",
    "Solution.life": "results.strength.safety:life",
    "Solution.notes": "results.elastic.vibration:swinging",
    "Solution.report": "views.report:write_report",
    "Solution.report_beside": "views.report:write_comparison",
    "Solution.safety": "results.strength.all_parts:part_safety",
    "Solution.stress": "results.strength.safety:stress",
    "Solution.view": "views.report:view",
    "Spec.draw": "views.figures.solution_figures:drawn",
    "Sweep._repr_html_": "views.report.sweep_summary:summary",
    "Sweep.report": "views.report.of_sweep:write_sweep_report",
}
"""Module and function of each method, by its name."""


def method(name: str) -> Callable[..., Any]:
    """The function that answers a method of :data:`METHODS`."""
    module, _, function = METHODS[name].partition(":")
    found: Callable[..., Any] = getattr(
        importlib.import_module(f"..{module}", __package__), function
    )
    return found

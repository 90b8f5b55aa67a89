"""A picture of a link that bends: its deflection over time and along it, and its harmonics beside
its natural frequency.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...base.arrays import Array
from ...results.elastic.vibration import Vibration, vibration
from ...results.solution import Solution
from ..shapes.picture_files import BLUE, RED, subplots
from ..shapes.readable import Scale
from .link_map import draw_along

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_FLOOR = 1e-6
_UNITS = {False: (1e3, "mm"), True: (1.0, "m")}
_FROM = {"ends": "the line between its ends", "base": "its axis at the base"}


def draw_deflection(
    solution: Solution, link: str, along: Array, label: str, si: bool = False
) -> Figure:
    """The deflection of a link across it as a map, and where its span is a cycle the harmonics of
    its bending.
    """
    found, response = solution.deflection(link), vibration(solution, link)
    down = 2 if response.harmonics else 1
    figure, (upper, *lower) = subplots((8.0, 7.0 if response.harmonics else 3.8), down)
    (factor, unit), peak = _UNITS[si], found.peak()
    most = abs(peak.value) * factor or 1.0
    draw_along(
        upper,
        found.member,
        along,
        label,
        lambda t, xi: found.size(np.broadcast_to(xi, (solution.t.size, xi.size)))[t] * factor,
        peak,
        f"largest: {peak.value * factor:.4g} {unit}",
        ends=(0.0, None) if found.member.space else (-most, most),
        scale=Scale(1.0, unit),
        what="deflection across the link",
    )
    for axes in lower:
        _spectrum(axes, response)
    figure.suptitle(f"{solution.case}: deflection of {link} from {_FROM[found.against]}")
    return figure


def _spectrum(axes: Axes, response: Vibration) -> None:
    from matplotlib.ticker import NullFormatter

    assert response.cycle is not None
    shares = np.array(response.harmonics)
    frequencies = response.cycle * np.arange(shares.size)
    shown = (shares > _FLOOR) & (frequencies > 0.0)
    if shown.any():
        axes.vlines(
            frequencies[shown],
            _FLOOR,
            shares[shown],
            color=BLUE,
            linewidth=2.0,
            label="harmonics of its bending",
        )
    axes.axvline(
        response.frequency,
        color=RED,
        label=f"first bending frequency, {' and '.join(response.ends)}",
    )
    off = (
        f"{100 * response.excess:.3g} %"
        if response.excess is not None and response.excess < 10.0
        else "many times"
    )
    verdict = "enough" if response.enough else "NOT enough"
    axes.set(
        xscale="log",
        yscale="log",
        ylim=(_FLOOR, 1e2),  # room for the legend
        xlabel="frequency [Hz]",
        ylabel="share of the largest bending",
        title=f"resonance changes bending by {off}: rigid links are {verdict}",
    )
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.legend()

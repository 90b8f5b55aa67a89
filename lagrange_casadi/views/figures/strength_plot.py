"""Pictures of strength: stress over time and along a link, its swings beside what it bears, and how
far all parts are used.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...base.arrays import Array
from ...results.solution import Solution
from ...results.strength.fatigue import Loaded, loaded, use_score, used
from ...results.strength.fibres import sampled, worst
from ...results.strength.member import Member
from ...results.strength.stress import Stress
from ..shapes.picture_files import BLUE, RED, subplots
from ..shapes.readable import Scale
from .link_map import draw_along

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MEGA = 1e6


def draw_strength(
    solution: Solution, link: str, along: Array, label: str, si: bool = False
) -> Figure:
    """Von Mises' stress of a link as a map, and where its material has an endurance limit its
    swings in Goodman's diagram.
    """
    stress = solution.stress(link)
    fatigue = (
        stress.member.beam.material.endurance is not None
        and stress.member.beam.material.ultimate is not None
    )
    figure, (upper, *lower) = subplots((8.0, 7.6 if fatigue else 3.8), 2 if fatigue else 1)
    # What is drawn is in MPa.
    unit = Scale(_MEGA, "Pa") if si else Scale(1.0, "MPa")
    peak = stress.peak("von_mises")
    draw_along(
        upper,
        stress.member,
        along,
        label,
        lambda t, xi: Stress(stress.member.during(t)).grid("von_mises", xi) / _MEGA,
        peak,
        f"von Mises: peak {unit.said(peak.value / _MEGA)} at {peak.fibre}",
        ends=(0.0, None),
        scale=unit,
        what="von Mises",
    )
    for axes in lower:
        _goodman(axes, stress.member.counted, unit)
    figure.suptitle(f"{solution.case}: strength of {link}, {stress.member.beam.material.name}")
    return figure


def draw_utilisation(solution: Solution, parts: Sequence[str]) -> Figure:
    """Draw the utilisation of every link and joint for each mode of failure: one over the factor of
    safety.
    """
    found = {part: solution.safety(part) for part in parts}
    rows = [
        (f"{part}, {v.against}", 1.0 / v.factor, v is safety.governs)
        for part, safety in found.items()
        for v in safety.verdicts
    ]
    figure, (axes,) = subplots((7.0, 0.32 * len(rows) + 1.4))
    places = np.arange(len(rows))[::-1]
    axes.barh(
        places,
        [share for _, share, _ in rows],
        color=[RED if most else "#92a5b5" for _, _, most in rows],
    )
    axes.set_yticks(places, [name for name, _, _ in rows])
    axes.axvline(1.0, color="k", linewidth=0.9)
    axes.set(
        xlim=(0.0, 1.05 * max(1.0, *(min(share, 10.0) for _, share, _ in rows))),
        xlabel="utilisation, 1 / factor of safety",
    )
    axes.set_title(f"{solution.case}: what governs each part is red", fontsize=11)
    return figure


def _goodman(axes: Axes, member: Member, unit: Scale) -> None:
    material = member.beam.material
    endurance, ultimate = (
        strength / _MEGA
        for strength in material.needs("Goodman's diagram", "endurance", "ultimate")
    )
    cycles: dict[bool, list[Loaded]] = {False: [], True: []}
    for notch, histories in sampled(member):
        cycles[notch is not None] += map(loaded, histories)
    found = worst(member, use_score(material))
    most = loaded(found.history)
    axes.plot([0.0, ultimate], [endurance, 0.0], color=RED, label="Goodman")
    if material.yield_strength is not None:
        strength = material.yield_strength / _MEGA
        axes.plot([0.0, strength], [strength, 0.0], color="0.6", linestyle="--", label="yield")
    top = endurance
    for notched, label, color in (
        (False, "swings, every fibre", BLUE),
        (True, "in notches", "#e08214"),
    ):
        if cycles[notched]:
            means, amplitudes = (
                np.concatenate([getattr(one, name) for one in cycles[notched]]) / _MEGA
                for name in ("mean", "amplitude")
            )
            axes.plot(means, amplitudes, ".", markersize=3, color=color, label=label)
            top = max(top, float(amplitudes.max()))
    k = int(np.argmax(used(most.amplitude, most.mean, material)))
    axes.plot(
        most.mean[k] / _MEGA, most.amplitude[k] / _MEGA, "k+", markersize=13, markeredgewidth=1.8
    )
    least = 1.0 / found.score if found.score else math.inf
    where = "in the notch at " if found.strips.notch else "at "
    axes.set(
        xlim=(0.0, None),
        ylim=(0.0, 1.05 * top),
        xlabel=f"mean [{unit.unit}]",
        ylabel=f"amplitude [{unit.unit}]",
        title=f"fatigue: least factor {least:.4g} {where}"
        rf"$\xi/l$ = {found.xi:.3f}, {found.fibre}",
    )
    unit.put(axes.xaxis)
    unit.put(axes.yaxis)
    axes.legend()

"""What was compared, as a picture: time against the size of the work, a line a method."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import matplotlib as mpl

from .definitions import COMPARISONS, METHODS

MARKERS = "osv^D<>Xph*8PHd1234"
PANELS = (
    (
        "grid-",
        "values",
        "section forces of the slider-crank's rod: values of a grid",
        "ns a (t, xi): axial, shear, bending",
    ),
    (
        "fill-",
        "values",
        "grids filled from a law that is there: values",
        "ns a (t, xi): axial, shear, bending",
    ),
    ("instants-", "t", "all 40 outputs of the slider-crank: instants", "ns an instant"),
    ("chain-", "links", "efforts of an open chain: links", "ns an instant"),
)


def draw(rows: list[dict[str, Any]], path: Path) -> None:
    """Write a picture with a panel for each family of comparisons that was measured."""
    mpl.use("agg")
    import matplotlib.pyplot as plt

    sizes = {c.name: c for c in COMPARISONS}
    families = tuple(panel[0] for panel in PANELS)
    drawn = {row["method"] for row in rows if row["name"].startswith(families) and "ns" in row}
    looks = {
        method: {"marker": marker, "color": mpl.colormaps["tab20"](number), "markersize": 4}
        for number, (method, marker) in enumerate(
            zip((name for name in METHODS if name in drawn), itertools.cycle(MARKERS), strict=False)
        )
    }
    panels = [
        panel
        for panel in PANELS
        if any(row["name"].startswith(panel[0]) and "ns" in row for row in rows)
    ]
    if not panels:
        return
    across, down = min(2, len(panels)), -(-len(panels) // 2)
    figure = plt.figure(figsize=(6.5 * across, 4.8 * down), layout="constrained")
    for place, (family, size, along, up) in enumerate(panels, 1):
        axis = figure.add_subplot(down, across, place)
        found = [row for row in rows if row["name"].startswith(family) and "ns" in row]
        for method in dict.fromkeys(row["method"] for row in found):
            points = [
                (getattr(sizes[row["name"]], size), row["ns"])
                for row in found
                if row["method"] == method
            ]
            style = "-" if method in ("lanes x cores", "lanes", "c", "vm") else "--"
            axis.loglog(*zip(*points, strict=True), style, label=method, **looks[method])
        axis.set_xlabel(along)
        axis.set_ylabel(up)
        axis.grid(alpha=0.3, which="both")
        axis.legend(fontsize=8)
    figure.savefig(path, dpi=110)

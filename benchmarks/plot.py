"""What was compared, as a picture: time against the size of the work, a line a method."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl

from .definitions import COMPARISONS, METHODS

MARKERS = "osv^D<>Xph*8PHd"
PANELS = (
    ("grid-", "values", "section forces of the slider-crank's rod: values of a grid", "ns a (t, xi): axial, shear, bending"),
    ("fill-", "values", "grids filled from a law that is there: values", "ns a (t, xi): axial, shear, bending"),
    ("instants-", "t", "all 40 outputs of the slider-crank: instants", "ns an instant"),
    ("chain-", "links", "efforts of an open chain: links", "ns an instant"),
)


def draw(rows: list[dict[str, Any]], path: Path) -> None:
    """Write a picture with a panel for each family of comparisons that was measured."""
    mpl.use("agg")
    import matplotlib.pyplot as plt

    sizes = {c.name: c for c in COMPARISONS}
    panels = [panel for panel in PANELS if any(row["name"].startswith(panel[0]) and "ns" in row for row in rows)]
    if not panels:
        return
    figure, axes = plt.subplots(1, len(panels), figsize=(6.5 * len(panels), 5), squeeze=False, layout="constrained")
    for (family, size, along, up), axis in zip(panels, axes[0], strict=True):
        found = [row for row in rows if row["name"].startswith(family) and "ns" in row]
        for method in dict.fromkeys(row["method"] for row in found):
            number = list(METHODS).index(method)
            looks = {"marker": MARKERS[number], "color": mpl.colormaps["tab20"](number), "markersize": 4}
            points = [(getattr(sizes[row["name"]], size), row["ns"]) for row in found if row["method"] == method]
            style = "-" if method in ("lanes x cores", "lanes", "c", "vm") else "--"
            axis.loglog(
                *zip(*points, strict=True),
                style,
                marker=MARKERS[number],
                color=mpl.colormaps["tab20"](number),
                label=method,
                markersize=4,
            )
        axis.set_xlabel(along)
        axis.set_ylabel(up)
        axis.grid(alpha=0.3, which="both")
        axis.legend(fontsize=8)
    figure.savefig(path, dpi=110)

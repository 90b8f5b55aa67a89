"""A picture of a :class:`.Trade`: error over time, each method a numbered point, those that nothing
beats joined.
"""

from __future__ import annotations

from pathlib import Path

from ...studies.trade import Trade
from ..shapes.picture_files import one_at_a_time, put_figure, subplots

_OFFSETS = ((0, 6), (0, -14), (0, 17), (0, -25))
_LEAST = 1e-17


@one_at_a_time({"axes.grid": True, "grid.color": "0.9"})
def draw_trade(trade: Trade, path: Path) -> None:
    """Write the picture into a file; its kind follows from the ending of the name."""
    figure, (axes, key) = subplots((12.0, 6.5), 1, 2, width_ratios=(3, 2))
    front = trade.front
    places = {one: (1e9 * one.seconds, max(one.largest, _LEAST)) for one in trade.measurements}
    axes.step(
        *zip(*(places[one] for one in front), strict=True), where="post", color="tab:red", lw=1
    )
    for number, (one, place) in enumerate(places.items(), 1):
        colour = "tab:red" if one in front else "0.35"
        axes.plot(*place, "o", color=colour, ms=5)
        axes.annotate(
            str(number),
            place,
            _OFFSETS[number % len(_OFFSETS)],
            textcoords="offset points",
            ha="center",
            fontsize=8,
            color=colour,
        )
        key.text(
            0.0,
            0.98 - (number - 1) / max(len(places), 20),
            f"{number:>2}  {one.method.options}",
            va="top",
            fontsize=9,
            color=colour,
            family="monospace",
        )
    axes.set(
        xscale="log",
        yscale="log",
        xlabel="time an instant [ns], one thread",
        ylabel="largest error over the peak",
    )
    axes.set_title(f"{trade.case}: speed and accuracy of every output", fontsize=11)
    axes.margins(0.1)
    key.axis("off")
    key.set_title(
        "red: nothing is faster and more accurate", fontsize=9, color="tab:red", loc="left"
    )
    put_figure(figure, path)

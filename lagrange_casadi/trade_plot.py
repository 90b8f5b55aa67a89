"""A picture of a :class:`.Trade`: error over time, each rung a point, those that nothing beats joined."""

from __future__ import annotations

from pathlib import Path

from .trade import Trade


def draw_trade(trade: Trade, path: Path) -> None:
    """Write the picture; its kind is told by the name's ending."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 6), layout="constrained")
    axes = figure.add_subplot()
    shown = {one: max(one.largest, 1e-17) for one in trade.measurements}
    front = trade.front
    axes.step(
        [1e9 * one.seconds for one in front],
        [shown[one] for one in front],
        where="post",
        color="tab:red",
        lw=1,
        label="nothing is better",
    )
    for one, error in shown.items():
        colour = "tab:red" if one in front else "tab:gray"
        axes.plot(1e9 * one.seconds, error, "o", color=colour, ms=5)
        axes.annotate(
            one.rung.options.replace("--", ""),
            (1e9 * one.seconds, error),
            (4, 4),
            textcoords="offset points",
            fontsize=7,
            color=colour,
        )
    axes.set(xscale="log", yscale="log", xlabel="time an instant [ns], one thread", ylabel="largest error over the peak")
    axes.set_title(f"{trade.case}: speed and accuracy of every output")
    axes.grid(alpha=0.3, which="both", lw=0.4)
    axes.legend(loc="upper right")
    figure.savefig(path, dpi=150)

"""Pictures of the signs: ``python docs/signs.py`` writes ``signs_in_space.svg`` and
``signs_of_joints.svg``.
"""

from pathlib import Path

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

HERE = Path(__file__).parent
FORCE, MOMENT, LINK = "#1b4f9c", "#b03a2e", "#777"
SHOWN = np.array([(1.0, 0.0), (0.5, 0.4), (0.0, 1.0)])
"""Where the axes x, y and z of space point on the page."""


def arrow(axes, start, end, text, colour, heads=1):
    """An arrow with its name behind its head; a moment has two heads."""
    start, end = np.array(start), np.array(end)
    for k in range(heads):
        tip = end - 0.09 * k * (end - start) / np.hypot(*(end - start))
        how = {
            "arrowstyle": "-|>",
            "color": colour,
            "lw": 1.6,
            "shrinkA": 0,
            "shrinkB": 0,
        }
        axes.annotate("", tip, start, arrowprops=how)
    side = "center" if end[0] == start[0] else "left"
    axes.annotate(text, end + 0.08 * (end - start), color=colour, ha=side, va="center")


def arc(axes, centre, text, colour=MOMENT, radius=0.32):
    """A counter-clockwise arc about a point, with its name above."""
    turn = np.radians(np.linspace(-60, 200, 60))
    x, y = centre[0] + radius * np.cos(turn), centre[1] + radius * np.sin(turn)
    axes.plot(x, y, color=colour, lw=1.6)
    how = {"arrowstyle": "-|>", "color": colour, "lw": 1.6, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (x[-1], y[-1]), (x[-3], y[-3]), arrowprops=how)
    axes.annotate(
        text, (centre[0], centre[1] + radius + 0.12), color=colour, ha="center"
    )


def picture(name, draw, width):
    """Draw into axes of equal scales without a frame, and write the picture."""
    settings = {"svg.hashsalt": name, "svg.fonttype": "none", "font.size": 10}
    with rc_context(settings):
        figure = Figure(figsize=(width, 2.2), layout="constrained")
        axes = figure.subplots()
        axes.set_aspect("equal")
        axes.axis("off")
        draw(axes)
        figure.savefig(HERE / f"{name}.svg", metadata={"Date": None, "Creator": None})


def in_space(axes):
    """What the tip's part does to the base's part: forces, and moments by the right hand."""
    for k, (colour, names, heads) in enumerate(
        (
            (FORCE, ("axial", "shear_y", "shear_z"), 1),
            (MOMENT, ("torsion", "bending_y", "bending_z"), 2),
        )
    ):
        cut = np.array((3.6 * k, 0.0))
        axes.plot(
            *np.transpose([cut - (1.3, 0), cut]),
            color=LINK,
            lw=7,
            solid_capstyle="butt",
        )
        axes.annotate("base", cut - (1.3, 0.25), color=LINK, ha="center")
        for direction, name in zip(SHOWN, names, strict=True):
            arrow(axes, cut, cut + 0.9 * direction, name, colour, heads)
    axes.set_xlim(-1.6, 5.2)
    axes.set_ylim(-0.5, 1.2)


def of_joints(axes):
    """The parent's action on the child, and the effort of the drive along the coordinate."""
    for k, text in enumerate(
        ("reaction: of the parent on the child", "effort of the drive")
    ):
        pin = np.array((3.4 * k, 0.0))
        axes.plot(*np.transpose([pin - (1.1, 0), pin]), color="#bbb", lw=5)
        axes.plot(*np.transpose([pin, pin + np.array((1.0, 0.6))]), color=LINK, lw=5)
        axes.plot(*pin, "o", mfc="white", mec="black", ms=8)
        axes.annotate("parent", pin - (0.9, 0.3), color="#999", ha="center")
        axes.annotate("child", pin + np.array((1.15, 0.72)), color=LINK, ha="center")
        axes.annotate(text, pin - (0.0, 0.75), ha="center")
    arrow(axes, (0, 0), (0.8, 0.0), "fx", FORCE)
    arrow(axes, (0, 0), (0.0, 0.8), "fy", FORCE)
    arc(axes, (0.0, 0.0), "", radius=0.3)
    axes.annotate("mz", (-0.42, 0.25), color=MOMENT, ha="center")
    arc(axes, (3.4, 0.0), "counter-clockwise")
    axes.set_xlim(-1.4, 4.9)
    axes.set_ylim(-1.0, 1.1)


if __name__ == "__main__":
    picture("signs_in_space", in_space, 7.0)
    picture("signs_of_joints", of_joints, 6.4)

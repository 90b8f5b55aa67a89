"""Figures of an identification: measurements and model over time, and their difference."""

from __future__ import annotations

import io
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ...base.arguments import public
from ...studies.identification.fit import Comparison
from ..shapes.picture_files import GRIDS, one_at_a_time, put_figure, save, subplots

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BESIDE, DIFFERENCE = ("measured", "model"), ("difference",)
"""Curves of the two charts of a quantity."""

_COLOURS = {"measured": "0.6", "model": "#1f4e79", "difference": "#c0392b"}


@public
@one_at_a_time(GRIDS)
def plot_identification(compared: Comparison, path: str | os.PathLike[str]) -> None:
    """Draw measurements and model over time, and what is left, into a file.

    Parameters
    ----------
    compared
        The ``comparison`` of an :class:`.Identification`, or that of another record.
    path
        A name that ends in .png, .pdf or .svg.

    Raises
    ------
    DeclarationError
        For another ending.
    PathError
        If the file cannot be written.
    """
    names = list(compared.measured)
    figure, axes = subplots((9.0, 2.2 * len(names) + 0.6), len(names), 2, sharex=True)
    for name, left, right in zip(names, axes[::2], axes[1::2], strict=True):
        _draw(left, compared, name, BESIDE)
        _draw(right, compared, name, DIFFERENCE)
        left.set_ylabel(f"{name} [{compared.units[name]}]", fontsize=8)
        right.set_title(f"{100 * compared.relative[name]:.3g} % of measured", fontsize=8)
    for one in axes[-2:]:
        one.set_xlabel("t [s]")
    handles = [line for one in axes[:2] for line in one.get_legend_handles_labels()[0]]
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
    put_figure(figure, path)


@one_at_a_time(GRIDS)
def chart(compared: Comparison, name: str, curves: Sequence[str]) -> bytes:
    """Return a picture of some curves of a quantity, as SVG."""
    (figure, (axes,)), file = subplots((5.6, 2.6)), io.BytesIO()
    _draw(axes, compared, name, curves)
    axes.set(xlabel="t [s]", ylabel=f"{name} [{compared.units[name]}]")
    figure.legend(loc="outside upper right", ncols=2)
    save(figure, file, ".svg")
    return file.getvalue()


def _draw(axes: Axes, compared: Comparison, name: str, curves: Sequence[str]) -> None:
    measured, model = compared.measured[name], compared.model[name]
    values = {"measured": measured, "model": model, "difference": measured - model}
    for curve in curves:
        axes.plot(compared.t, values[curve], color=_COLOURS[curve], lw=0.9, label=curve)

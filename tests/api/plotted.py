"""Sweeps to draw, and what figures of them hold."""

from __future__ import annotations

import numpy as np
import sweeps
from forging import forging
from internals import ListingListed as Listed
from internals import Sweep, sweep

BENDING, EFFORT = "peak:section:rod:bending", "peak:effort:O"

CLOSED = "the iterated loops did not converge"
REACH = "no result: the iterated loops did not converge"


def rewritten(found, name, change):
    """The sweep with a column that is changed in its file."""
    with forging(found.path) as file:
        file[name.replace(":", "/")][...] = change(file[name.replace(":", "/")][()])
    return Sweep.open(found.path)


def plain(text):
    """Words without what keeps or breaks their lines."""
    return text.replace("\N{NO-BREAK SPACE}", " ").replace("\n", " ")


def lines(axes, marker):
    return [line for line in axes.get_lines() if line.get_marker() == marker]


def legend(figure):
    return [plain(text.get_text()) for text in figure.legends[0].get_texts()]


def grid_of(monkeypatch, tmp_path):
    """A grid of three parameters, swept by plain formulas."""
    sweeps.use(monkeypatch)
    grid = {"l": (0.15, 0.4, 9), "r": [0.05, 0.1, 0.07], "m1": [0.1, 0.2]}
    return sweep(sweeps.scene(), grid, out=tmp_path / "x.h5", xi=(0, 1, 5))


def list_of(monkeypatch, tmp_path):
    """A list of fifty designs, swept likewise."""
    sweeps.use(monkeypatch)
    rows = np.column_stack(
        [np.random.default_rng(3).uniform(0.1, 0.3, (50, 2)), np.repeat([0.1, 0.2], 25)]
    )
    return sweep(sweeps.scene(), Listed(("l", "r", "m1"), rows), out=tmp_path / "y.h5")

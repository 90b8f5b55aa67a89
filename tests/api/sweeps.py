"""An engine of plain formulas, for tests of what stands around an engine; and what sweeps leave
behind.
"""

from __future__ import annotations

import contextlib
import functools
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import mechanisms
import numpy as np
from internals import DesignEngine, Outcome, Provenance

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.motion import polynomial
from lagrange_casadi.version import __version__

CASE = Path(__file__).parents[2] / "cases" / "slider_crank"
ASKED = "sweep CASE --t 0:0.08:21 --want effort --want section:rod"
BENDING = "peak:section:rod:bending"


class Formula:
    """Numbers that tell the design and the column apart; some have no result."""

    quantities = (
        "effort:O",
        "reaction:A:resultant",
        "reaction:A:fx",
        "section:rod:axial",
        "section:rod:shear",
        "section:rod:bending",
    )
    efforts = ("effort:O",)
    indeterminate, sampled = (), False
    cost, capacity, count = 1 / 15, 0, 7
    laws = ("n0", "n1", "n2", "f0", "f1", "f2", "m0")
    columns = ("effort:O", *(f"section:rod:law:{name}" for name in laws))
    provenance = Provenance(
        "formula", "double", "", "", "(default)", {"lagrange_casadi": __version__}
    )

    def of(self, program, timing, *_):
        """The engine of a program."""
        self.program, self.times = program, SimpleNamespace(timing=timing)
        return self

    def failures(self, p, whole):
        return {}

    def evaluate(self, p, *, threads=None, histories=False):
        # Not by a product of matrices, whose rounding depends on how many rows there are.
        seed = sum(
            factor * column for factor, column in zip((1.0, 2.0, 5.0, 7.0, 11.0), p.T, strict=True)
        )
        status = (np.sin(1e3 * seed) > 0.8).astype(np.int8)

        def numbers(width, shift):
            values = np.sin(seed[:, None] * (1.0 + np.arange(width)) + shift)
            return np.where(status[:, None] == 0, values, np.nan)

        value, t, xi = (numbers(len(self.quantities), k) for k in range(3))
        series = (
            np.stack([numbers(self.count, 10 + k) for k in range(len(self.columns))], axis=1)
            if histories
            else None
        )
        return Outcome(status, value, t, np.abs(xi), numbers(1, 5), numbers(1, 6), series)


def use(monkeypatch):
    """Let sweeps use one :class:`Formula`, which is given back."""
    engine = Formula()
    monkeypatch.setattr(DesignEngine, "compiled", engine.of)
    return engine


@functools.cache
def scene():
    """The paper's mechanism, whose parameters are r, l, m1, m2 and m3."""
    return mechanisms.slider_crank(t=(0, 0.08, 7))


@functools.cache
def turning(*wanted, mass=1.0):
    """A scene of a rod that turns by a radian in a time that may be chosen."""
    m = Mechanism("turning")
    duration = m.parameter("T", 1.0, "s", low=0.01)
    m.revolute("O", m.ground, m.link("rod", length=0.3, mass=mass))
    law = polynomial(0.0, 1.0, duration)
    return Scene(m, {"O": law}, t=(0, duration, 5), wanted=wanted or ("effort",))


@contextlib.contextmanager
def process(*command, **keywords):
    """A process of its own that does not outlive its test."""
    started = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **keywords
    )
    try:
        yield started
    finally:
        started.kill()
        started.communicate()


@contextlib.contextmanager
def held(path, mode):
    """A file that another program has open."""
    program = "h = h5py.File(*sys.argv[1:]); print('open', flush=True); sys.stdin.read()"
    asked = (sys.executable, "-c", f"import h5py, sys; {program}", str(path), mode)
    with process(*asked, stdin=subprocess.PIPE) as holder:
        assert holder.stdout.readline() == "open\n"
        yield


def wait_for(condition, seconds=60.0):
    """Wait until something is so."""
    until = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until, "it never came"
        time.sleep(0.002)


class StopError(Exception):
    """What stops a sweep from its progress."""


def stop_after(count):
    """A progress that stops a sweep after so many reports of designs."""
    seen = iter(range(count))

    def progress(what, _done, _total):
        if what == "designs" and next(seen, None) is None:
            raise StopError

    return progress

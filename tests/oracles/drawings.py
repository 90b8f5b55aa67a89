"""Mechanisms in space as a drawing tells them: each axis, direction and place that is given as
numbers is off by rounding.
"""

import runpy

import numpy as np
from conftest import CASES

from lagrange_casadi import SpatialMechanism


def drawing(noise, seed=1, exact=()):
    """A kind of SpatialMechanism whose declarations are off by so much, in each component, in
    radians or metres.

    But for joints that are ``exact``.
    """
    rng = np.random.default_rng(seed)

    def off(vector):
        return (
            None if vector is None else tuple(x + float(noise * rng.uniform(-1, 1)) for x in vector)
        )

    def put(place):
        """A point that was given by numbers; base and tip of a link are what they are."""
        if getattr(place, "end", "base") is not None or not place.body.oriented:
            return place
        return place.body.at(*off(place.place))

    class Drawn(SpatialMechanism):
        def _spatial(self, name, kind, bodies, axes, at, turned, pitch=0.0):
            if name in exact:
                return super()._spatial(name, kind, bodies, axes, at, turned, pitch)
            if len(turned) == 2 and all(len(one) == 3 for one in turned):
                turned = tuple(map(off, turned))
            return super()._spatial(
                name, kind, tuple(map(put, bodies)), tuple(map(off, axes)), off(at), turned, pitch
            )

        def link(self, name, *, between=None, beside=None, **options):
            between = between and tuple(map(off, between))
            return super().link(name, between=between, beside=off(beside), **options)

    return Drawn


def drawn(case, noise, seed=1):
    """The scene of a case in space, as it was drawn."""
    scene = runpy.run_path(str(CASES / case / "case.py"))["scene"]
    scene.__globals__["SpatialMechanism"] = drawing(noise, seed)
    return scene()

"""A case with every number of its declaration a parameter, so that none is folded into a rounded
constant of its graphs.
"""

from __future__ import annotations

import itertools
from dataclasses import replace

import pytest

from lagrange_casadi import Mechanism, load_case


def declared(path):
    """The scene of a case; lengths, masses, densities, places, angles and gravity are parameters
    with the case's values.
    """
    count, made, plain = itertools.count(), [], Mechanism("plain")
    ground, bar = plain.ground, plain.link("bar", length=1.0, mass=1.0)

    def free(x):
        if isinstance(x, tuple):
            return tuple(free(part) for part in x)
        return (
            made[-1].parameter(f"number{next(count)}", float(x))
            if isinstance(x, int | float) and x
            else x
        )

    def gravity(mechanism, *, begin=Mechanism.__post_init__):
        begin(mechanism)
        made.append(mechanism)
        mechanism.gravity = free(mechanism.gravity)

    def link(mechanism, name, *, density=None, declare=Mechanism.link, **numbers):
        if density is not None:
            density = replace(density, cells=free(density.cells))
        return declare(
            mechanism, name, density=density, **{word: free(x) for word, x in numbers.items()}
        )

    def joint(
        mechanism, name, kind, parent, child, axis=None, angle=0.0, *, declare=Mechanism._joint
    ):
        return declare(mechanism, name, kind, parent, child, axis, free(angle))

    def friction(mechanism, name, joint, *, declare=Mechanism.friction, **numbers):
        return declare(mechanism, name, joint, **{word: free(x) for word, x in numbers.items()})

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Mechanism, "__post_init__", gravity)
        patch.setattr(Mechanism, "link", link)
        patch.setattr(Mechanism, "_joint", joint)
        patch.setattr(Mechanism, "friction", friction)
        patch.setattr(
            Mechanism,
            "point_mass",
            lambda m, name, mass, declare=Mechanism.point_mass: declare(m, name, free(mass)),
        )
        for kind in (type(ground), type(bar)):
            patch.setattr(kind, "at", lambda body, x, y=0.0, at=kind.at: at(body, free(x), free(y)))
        return load_case(path).scene

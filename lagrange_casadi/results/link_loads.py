"""Loads of a link as numbers: what acts at stations, and along it, with the functions that go with
its coefficients.

See :mod:`.engine.section_function`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..base.arrays import Array


@dataclass(frozen=True, eq=False)
class DistributedLoad:
    """A load along a link up to ``end``, a ratio xi/l, on ``width`` of the link, both (t,) and the
    same at all instants.

    ``terms`` are by direction, ``qn`` and ``qf``, in space ``qn``, ``qfy``, ``qfz``: the
    coefficients [N/m] of rising powers of (end - xi/l)/width, each (t,). What the rotary inertia of
    slices does is one too, of couples ``cx``, ``cy``, ``cz`` [N].
    """

    name: str
    width: Array
    end: Array
    terms: Mapping[str, tuple[Array, ...]]

    @property
    def powers(self) -> int:
        """Number of powers."""
        return max(map(len, self.terms.values()))

    @property
    def sound(self) -> bool:
        """True if the load acts on some part of the link."""
        return bool(np.isfinite([self.width, self.end]).all() and (self.width > 0.0).all())


def distributed_load(
    name: str, members: Mapping[str, Array], terms: Mapping[str, Mapping[int, Array]]
) -> DistributedLoad:
    """A load along a link, by the names of its members, and of its terms by direction and power.

    Raises ``ValueError`` where one of these is missing.
    """
    powers = {
        direction: tuple(found[j] for j in range(len(found)) if j in found)
        for direction, found in terms.items()
    }
    many = {len(rows) for rows in (*powers.values(), *terms.values())}
    if set(members) != {"width", "end"} or len(many) != 1:
        raise ValueError(f"the load along the link '{name}' is incomplete")
    return DistributedLoad(name, members["width"], members["end"], powers)


@dataclass(frozen=True, eq=False)
class PointLoad:
    """Action on a link at a load point, whose ``station`` is the ratio xi/l, (t,): it moves where
    something slides along the link.

    ``acts`` are by member, each (t,): in the plane the force along ``n`` and across ``f`` the
    link's axis [N] and the moment ``m`` [N m], in space forces ``n``, ``fy``, ``fz`` and moments
    ``mx``, ``my``, ``mz``.
    """

    name: str
    station: Array
    acts: Mapping[str, Array]

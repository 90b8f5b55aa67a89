"""Open chains in space by Pinocchio: efforts, and section forces of links that are cut, and welded
by joints held at zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import pinocchio as pin

from . import arm_data
from .paper_case import Array, Work


@dataclass(frozen=True)
class Piece:
    """A link of a chain: its joint's axis on the link before, how it is turned there at zero (3x3),
    where it is on it, and matter.

    A slender link has a ``length`` and a ``mass``, a rigid one a ``mass``, a ``centre`` and an
    ``inertia`` about it. It ``slides`` along the axis, or turns about it; without one it is welded
    on. It is cut at the ratios ``cuts``, which ascend strictly within 0 < xi < 1.
    """

    axis: Array | None
    turned: Array
    at: Sequence[float]
    mass: float
    length: float
    slides: bool = False
    centre: Array | None = None
    inertia: Array | None = None
    cuts: Sequence[float] = ()


class Chain:
    """A model of pieces, each on the one before; its efforts are those of the joints, and of each
    cut six: force, then moment.
    """

    def __init__(
        self, pieces: Sequence[Piece], gravity: Sequence[float] = (0.0, 0.0, -9.81)
    ) -> None:
        self.model = pin.Model()
        self.model.gravity.linear = np.array(gravity, float)
        self.joints: list[int] = []
        self.cuts: list[tuple[int, float, int]] = []
        joint, turned, reach = 0, np.eye(3), 0.0
        for k, piece in enumerate(pieces):
            place = pin.SE3(turned, turned @ (np.asarray(piece.at, float) - [reach, 0.0, 0.0]))
            own, reach = pin.SE3(np.asarray(piece.turned, float), np.zeros(3)), 0.0
            if piece.axis is None:
                own = place * own
            else:
                kind = (
                    pin.JointModelPrismaticUnaligned
                    if piece.slides
                    else pin.JointModelRevoluteUnaligned
                )
                joint = self.model.addJoint(
                    joint, kind(np.asarray(piece.axis, float)), place, f"joint{k}"
                )
                self.joints.append(joint)
            turned = own.rotation
            if piece.inertia is not None:
                matter = pin.Inertia(
                    piece.mass, np.asarray(piece.centre, float), np.asarray(piece.inertia, float)
                )
                self.model.appendBodyToJoint(joint, matter, own)
                continue
            for start, stop in pairwise([0.0, *piece.cuts, 1.0]):
                if start:
                    place = own * pin.SE3(
                        np.eye(3), np.array([start * piece.length - reach, 0.0, 0.0])
                    )
                    joint = self.model.addJoint(
                        joint, pin.JointModelFreeFlyer(), place, f"cut{k}:{start!r}"
                    )
                    self.cuts.append((k, start, self.model.joints[joint].idx_v))
                    own, turned, reach = pin.SE3.Identity(), np.eye(3), start * piece.length
                self.model.appendBodyToJoint(joint, _rod(piece, start, stop), own)

    def columns(self, q: Array, v: Array, a: Array) -> tuple[Array, Array, Array]:
        """Motions of the joints (joints, n) as Pinocchio takes them: cuts rest at zero."""
        configuration = np.tile(pin.neutral(self.model)[:, None], q.shape[1])
        rate, acceleration = (np.zeros((self.model.nv, q.shape[1])) for _ in range(2))
        places, rates = (
            [getattr(self.model.joints[k], name) for k in self.joints]
            for name in ("idx_q", "idx_v")
        )
        configuration[places], rate[rates], acceleration[rates] = q, v, a
        return tuple(np.asfortranarray(x) for x in (configuration, rate, acceleration))  # type: ignore[return-value]

    def work(self, q: Array, v: Array, a: Array, threads: int = 1) -> Work:
        """What works out all efforts, (efforts, n), by one ``rneaInParallel``, or one ``rnea`` for
        one instant.
        """
        moved = self.columns(q, v, a)
        if q.shape[1] == 1:
            data, single = self.model.createData(), [column[:, 0] for column in moved]
            return lambda: pin.rnea(self.model, data, *single)[:, None]
        pool = pin.ModelPool(self.model, threads)
        out = np.zeros((self.model.nv, q.shape[1]), order="F")

        def call() -> Array:
            pin.rneaInParallel(threads, pool, *moved, out)
            return out

        return call

    @property
    def efforts(self) -> list[int]:
        """The rows of the joints' efforts."""
        return [self.model.joints[k].idx_v for k in self.joints]

    def sections(self, efforts: Array) -> dict[tuple[int, float], Array]:
        """The six section forces at each cut, (6, n), of all efforts: the tip's part on the base's,
        on the link's axes.
        """
        return {(k, ratio): -efforts[first : first + 6] for k, ratio, first in self.cuts}


def _rod(piece: Piece, start: float, stop: float) -> Any:
    """A piece of a slender link, from where it begins."""
    mass, length = piece.mass * (stop - start), piece.length * (stop - start)
    return pin.Inertia(
        mass, np.array([length / 2, 0.0, 0.0]), np.diag([0.0, 1.0, 1.0]) * mass * length**2 / 12
    )


def arm_efforts(t: Array, threads: int = 1) -> Work:
    """What works out the arm's efforts, (6, t), by one ``rneaInParallel`` over the instants."""
    return _arm(()).work(*arm_data.motion(t), threads)


def arm_sections(t: Array, xi: Array, threads: int = 1) -> Work:
    """What works out six section forces of the second link, (6, t, xi), which is in as many pieces
    as ratios and one.
    """
    chain = _arm(tuple(xi.tolist()))
    work, first = chain.work(*arm_data.motion(t), threads), [first for *_, first in chain.cuts]

    def call() -> Array:
        efforts = work()
        return -np.stack([efforts[[k + member for k in first]].T for member in range(6)])

    return call


def _arm(cuts: tuple[float, ...]) -> Chain:
    pieces, reach = [], 0.0
    for k, axis in enumerate(arm_data.AXES):
        turned, own = np.eye(3) if k else arm_data.UPRIGHT, cuts if k == arm_data.SECOND else ()
        pieces.append(
            Piece(
                np.array(axis),
                turned,
                (reach, 0.0, 0.0),
                arm_data.MASSES[k],
                arm_data.LENGTHS[k],
                cuts=own,
            )
        )
        reach = arm_data.LENGTHS[k]
    return Chain(pieces, arm_data.GRAVITY)

"""Kinks of what is differentiated twice: of motions over time, and of constraints over what they
see.

They are looked for where a mechanism goes, with the parameters that it has there.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
import numpy.typing as npt

from ..base.arrays import Array
from ..base.symbolic import Graphs, symbolic
from .constraints import Constraint
from .kinks import Smooth
from .mechanism import Mechanism
from .motion_laws import Motion
from .sampled_laws import law_expression
from .scene import Scene

_SAMPLED = 4001


def smooth_constraint(mechanism: Mechanism, constraint: Constraint) -> Smooth | None:
    """Condition that a constraint has no kink over its symbols; None if it can have none."""
    curve = constraint.phi if constraint.lift is None else constraint.lift
    seen = ca.vertcat(mechanism.measures.places, mechanism.time)
    name = constraint.name
    what = f"constraint '{name}'" if constraint.lift is None else f"cam '{name}': its lift"
    return Smooth.of(what, curve, seen, mechanism.symbols)


@dataclass(frozen=True, eq=False)
class Corners(Graphs):
    """Functions of a scene that may have a kink: ``laws`` of motion, and ``constraints`` by
    name.
    """

    laws: tuple[Smooth, ...]
    constraints: Mapping[str, Smooth]

    @property
    def _each(self) -> tuple[Smooth, ...]:
        return *self.laws, *self.constraints.values()

    @property
    def whole(self) -> tuple[bool, ...]:
        """True for each mark of laws, then of constraints, that counts at whole numbers."""
        return tuple(bool(whole) for smooth in self._each for whole in smooth.whole)

    @property
    def hidden(self) -> bool:
        """True if a law or constraint cannot be followed, so that its marks are not known."""
        return not all(smooth.whole.size for smooth in self._each)

    @classmethod
    @symbolic
    @functools.lru_cache(maxsize=64)
    def of(cls, scene: Scene) -> Corners:
        """Return the corners of a scene."""
        m = scene.mechanism
        found = {
            name: smooth_constraint(m, constraint) for name, constraint in m.constraints.items()
        }
        constraints = {name: smooth for name, smooth in found.items() if smooth is not None}
        return cls(tuple(_smooth_laws(scene.laws, m.symbols)), constraints)

    def refuse_laws(self, t: Array, p: Sequence[float], **asked: bool) -> None:
        """Raise :class:`.DeclarationError` for a motion with a kink along instants ``t`` (t,), for
        parameters ``p``, or one that is other at an instant than on both sides of it: not ``at``
        instants where that is false, and with ``between`` also between them, where peaks may be
        sought.
        """
        for smooth in self.laws:
            smooth.refuse(t[None], p, **asked)

    def refuse_constraints(
        self, arguments: Callable[[str], Array], p: Sequence[float], *, between: bool = False
    ) -> None:
        """Raise :class:`.DeclarationError` for a constraint with a kink, or isolated at an instant,
        for parameters ``p``.

        ``arguments`` gives what a constraint sees over the instants, (symbols, t); ``between`` is
        that of motions.
        """
        for name, smooth in self.constraints.items():
            smooth.refuse(arguments(name), p, between=between)

    def broken_laws(self, t: Array, p: Array) -> npt.NDArray[np.bool_]:
        """Return the designs ``p`` (d, parameters) in which a motion has a kink between the
        instants ``t`` (1 or d, t), or is isolated.
        """
        found = np.zeros(len(p), bool)
        start, stop = (np.broadcast_to(t[:, k], len(p)) for k in (0, -1))
        for smooth in self.laws:
            # Most designs share what their motions depend on.
            rows = np.column_stack([start, stop, np.where(smooth.uses, p, 0.0)])
            each, number = np.unique(rows, axis=0, return_inverse=True)
            found |= _broken_law(smooth, each.tobytes())[number.ravel()]
        return found

    def broken_constraints(
        self, arguments: Callable[[str], Array], p: Array
    ) -> npt.NDArray[np.bool_]:
        """Return the designs in which a constraint has a kink, or is isolated; ``arguments`` as
        above, (d, symbols, t).
        """
        found = np.zeros(len(p), bool)
        for name, smooth in self.constraints.items():
            # Designs often share a cam's coordinates.
            paths, known = arguments(name), np.where(smooth.uses, p, 0.0)
            rows = np.concatenate([paths.reshape(len(paths), -1), known], axis=1)
            _, which, number = np.unique(rows, axis=0, return_index=True, return_inverse=True)
            found |= smooth.broken(paths[which], known[which])[number.ravel()]
        return found


@functools.lru_cache(maxsize=256)
def _broken_law(smooth: Smooth, rows: bytes) -> npt.NDArray[np.bool_]:
    """Return, for each row of a start, a stop and parameters, whether a law has a kink."""
    start, stop, *p = np.frombuffer(rows).reshape(-1, 2 + smooth.uses.size).T
    paths = np.linspace(start, stop, _SAMPLED, axis=-1)[:, None]
    return smooth.broken(paths, np.array(p).T.reshape(start.size, -1))


def _smooth_laws(laws: Mapping[str, Motion], parameters: ca.SX) -> Iterator[Smooth]:
    """Laws that may have kinks in time: moves go on smoothly by their making, wherever parameters
    allow them, and so do samples.
    """
    t = ca.SX.sym("t")
    for joint, law in laws.items():
        if not (law.knots or law.stretches):
            expression = law_expression(joint, law, t, parameters)
            smooth = Smooth.of(f"the motion of joint '{joint}'", expression, t, parameters)
            yield from () if smooth is None else (smooth,)

"""A scene: a mechanism, the motion it must make, and what is wanted of it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import NoReturn

from ..errors import DeclarationError, ParameterError, PickleError, UnknownNameError
from .density import Density
from .even_points import EvenPoints, checked
from .limits import no_sections, told_parameters
from .mechanism import Mechanism
from .motion import Motion
from .times import Instants, Over, Times, Timing, instants_of, span_of


def checked_ratios(even: EvenPoints) -> EvenPoints:
    """Even section ratios xi/l in numbers. Raises :class:`DeclarationError` outside [0, 1]."""
    start, stop, count = checked("xi", even)
    if start < 0.0 or stop > 1.0:
        raise DeclarationError(f"xi: ratios xi/l must lie in [0, 1], got {start:g} to {stop:g}")
    return start, stop, count


@dataclass(frozen=True)
class Wanted:
    """Outputs by kind, each in the order of declaration whatever the order of wanting."""

    effort: bool
    motion: bool
    reactions: tuple[str, ...]
    multipliers: tuple[str, ...]
    loads: tuple[str, ...]
    sections: tuple[str, ...]

    @classmethod
    def of(cls, mechanism: Mechanism, names: Sequence[str]) -> Wanted:
        """Read names: ``effort``, ``motion``, ``reaction:JOINT``, ``multiplier:NAME``, ``load:NAME``, ``section:LINK``, ``all``."""
        choices = outputs(mechanism)
        if isinstance(names, str) or not all(isinstance(name, str) for name in names):
            raise DeclarationError(f"wanted: expected a list of output names, got {names!r}; valid: {', '.join(choices)}")
        for name in names:
            if name not in choices:
                _refuse_output(mechanism, name)
                raise UnknownNameError("output", name, choices)
        chosen = set(choices if "all" in names else names)
        if not chosen:
            raise DeclarationError(f"no output wanted; valid: {', '.join(choices)}")

        def parts(kind: str) -> tuple[str, ...]:
            return tuple(name.partition(":")[2] for name in choices if name in chosen and name.startswith(f"{kind}:"))

        kinds = ("reaction", "multiplier", "load", "section")
        return cls("effort" in chosen, "motion" in chosen, *(parts(kind) for kind in kinds))

    @property
    def forces(self) -> bool:
        """Whether any force is wanted that equilibrium gives."""
        return bool(self.effort or self.reactions or self.multipliers or self.sections)


def outputs(mechanism: Mechanism) -> list[str]:
    """Every output that can be wanted of a mechanism."""
    reactions = [f"reaction:{joint}" for joint in mechanism.joints]
    multipliers = [f"multiplier:{name}" for name in (*mechanism.constraints, *mechanism.rows)]
    loads = [f"load:{name}" for name in mechanism.loads]
    sections = [f"section:{name}" for name, link in mechanism.links.items() if isinstance(link.mass, Density)]
    return ["all", "effort", "motion", *reactions, *multipliers, *loads, *sections]


def _refuse_output(mechanism: Mechanism, name: str) -> None:
    kind, _, part = name.partition(":")
    if kind == "section" and part in mechanism.bodies:
        why = no_sections(part, link=part in mechanism.links, links=mechanism.links)
        raise DeclarationError(f"output '{name}': {why}")


@dataclass(frozen=True, eq=False)
class Scene:
    """A mechanism, the motion of its driven joints, and the outputs wanted over a grid of time and of section ratios.

    Parameters
    ----------
    mechanism
        The mechanism; it freezes here.
    motion
        The law of every driven joint, by the joint's name.
    wanted
        Output names, see :func:`outputs`. Only these are derived, compiled and evaluated.
    t, xi
        Grids of time [s] and of the ratio xi/l: start, stop, count. Those of time may be expressions of parameters.
    over
        Instants in equal steps of a driven coordinate, in place of ``t``: the joint's name, start, stop [rad, or text such as
        ``"720 deg"``; or m] and count; start and stop may be expressions of parameters, and are in the order of time. The times
        follow from the joint's motion, which must not turn back on the way. Where the motion's rate depends on time, the stretch
        counts that goes through the start of ``t``.
    posture
        Rough directions of links [rad] and places of slides [m] at the first instant, to choose between the ways in which a loop
        can be assembled.
    assembly
        Values of parameters with which loops are first assembled, in place of the defaults. The way to assemble is chosen there.

    Raises :class:`.DeclarationError` for what does not fit the mechanism, :class:`.UnknownNameError` for names it does not have,
    and :class:`.ParameterError` where the default parameters make a part impossible.
    """

    mechanism: Mechanism
    motion: Mapping[str, Motion]
    wanted: Sequence[str] = ("all",)
    t: Times = (0.0, 1.0, 101)
    xi: EvenPoints = (0.0, 1.0, 101)
    posture: Mapping[str, float] = field(default_factory=dict)
    assembly: Mapping[str, float] = field(default_factory=dict)
    over: Over | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.mechanism, Mechanism):
            raise DeclarationError(f"scene: expected a Mechanism, got {self.mechanism!r}")
        for what, mapping in (("motion", self.motion), ("posture", self.posture), ("assembly", self.assembly)):
            if not isinstance(mapping, Mapping):
                raise DeclarationError(f"{what}: expected a mapping by name, got {mapping!r}")
            object.__setattr__(self, what, MappingProxyType(dict(mapping)))
        joints = self.mechanism.joints
        for name, law in self.motion.items():
            if name not in joints:
                raise UnknownNameError("joint in motion", name, joints)
            if joints[name].coordinate is None:
                why = (
                    "a weld does not move"
                    if joints[name].kind == "weld"
                    else "a point mass has no direction, so a pin at it has no angle"
                )
                raise DeclarationError(f"joint '{name}' cannot be driven: {why}")
            if not isinstance(law, Motion):
                raise DeclarationError(f"motion of joint '{name}': expected a law of lagrange_casadi.motion, got {law!r}")
        places = [*self.mechanism.links, *(n for n, j in joints.items() if j.slides)]
        for name, rough in self.posture.items():
            if name not in places:
                raise UnknownNameError("link or sliding joint in posture", name, places)
            if not isinstance(rough, (int, float)) or not math.isfinite(rough):
                raise DeclarationError(f"posture of '{name}': expected a finite number, got {rough!r}")
        for row in self.mechanism.rows.values():
            if row.replaces not in self.motion:
                raise DeclarationError(
                    f"non-holonomic constraint '{row.name}' replaces the drive of joint '{row.replaces}', which has no motion"
                )
        self.mechanism.freeze()
        Wanted.of(self.mechanism, self.wanted)
        checked_ratios(self.xi)
        timing = self.timing()
        try:
            self.mechanism.values()
        except ParameterError as error:
            raise ParameterError(f"{error}{told_parameters(self.mechanism, {})}") from None
        self.mechanism.values(self.assembly)
        if not timing.shared:
            self.span  # noqa: B018 - it refuses what has no instants

    def __repr__(self) -> str:
        start, stop = self.t[:2]
        motion = ", ".join(self.motion) or "nothing"
        wanted = ", ".join(self.wanted)
        asked = f"from {start} to {stop} s" if self.over is None else f"over {self.over[0]} from {self.over[1]} to {self.over[2]}"
        return f"<Scene of {self.mechanism.name}: drives {motion}, wants {wanted}, {self.timing().count} instants {asked}>"

    def timing(self, t: Times | None = None, over: Over | None = None) -> Timing:
        """How its instants are asked for, or others: ``t`` or ``over`` in place of its own.

        Raises :class:`.DeclarationError` where both are given, and for what cannot be.
        """
        if t is not None and over is not None:
            raise DeclarationError("t and over exclude each other: instants are in equal steps of time, or of a driven coordinate")
        asked = self.over if t is None and over is None else over
        return Timing.of(self.mechanism, self.motion, self.t if t is None else t, asked)

    @cached_property
    def span(self) -> tuple[float, float]:
        """Its own first and last instant [s], with the parameters with which it is assembled."""
        return span_of(self.mechanism, self.motion, self.timing(), self.mechanism.values(self.assembly))

    def instants(self, timing: Timing, values: Mapping[str, float]) -> Instants:
        """Instants for values of all parameters. Raises :class:`.DeclarationError` where there are none."""
        return instants_of(self.mechanism, self.motion, timing, values)

    def __reduce__(self) -> NoReturn:
        """Raise :class:`PickleError`."""
        raise PickleError(
            "a Scene cannot be pickled: its expressions and laws of motion live in this process alone; send a Case from load_case, "
            "which the other process loads anew, or call there the function that makes the scene"
        )

    def __copy__(self) -> Scene:
        """Itself: nothing of it changes."""
        return self

    def __deepcopy__(self, _memo: object) -> Scene:
        """Itself: nothing of it changes."""
        return self

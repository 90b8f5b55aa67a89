"""State of a mechanism under declaration, for the functions that check it or read it."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any, ClassVar, cast

import casadi as ca

from ..base.arguments import public
from ..base.scalars import column
from ..base.symbolic import Graphs, symbolic
from ..errors import DeclarationError, shown
from .constraints import Constraint, Row
from .declared_parts import (
    Asked,
    Body,
    Expression,
    Ground,
    Link,
    Named,
    Outline,
    Parameter,
    Path,
    PitchCircles,
    PointMass,
    Roller,
    Track,
    UserOutput,
    Vector,
)
from .drives import Drive
from .expressions import check_name
from .fitted import Fittings
from .joints import Axis, Joint
from .loads import Load
from .measures import Measures
from .strokes import Stroke


@public
@symbolic
@dataclass(eq=False, repr=False)
class Declaration(Graphs):
    """Parts of a mechanism that are declared so far, by their names, and notes on them.

    :class:`.Mechanism` has the methods that declare. ``rough`` are coordinates at which parts are
    turned as they were declared to be [rad or m]; ``snapped`` are by how much axes [rad] and places
    [m] of a part were moved to the exact ones. ``one_way`` are outputs of forces that cannot pull,
    with what happens where they are negative. ``shaken`` are outputs of shaking forces, with the
    names of the bodies that they are of.
    """

    space: ClassVar[bool] = False
    """True if it lies in space, not in a plane."""

    name: str
    parameters: dict[str, Parameter] = field(
        default_factory=partial(Named, "parameter"), init=False
    )
    bodies: dict[str, Body] = field(default_factory=partial(Named, "body"), init=False)
    joints: dict[str, Joint] = field(default_factory=partial(Named, "joint"), init=False)
    loads: dict[str, Load] = field(default_factory=partial(Named, "load"), init=False)
    drives: dict[str, Drive] = field(default_factory=partial(Named, "drive"), init=False)
    constraints: dict[str, Constraint] = field(
        default_factory=partial(Named, "constraint"), init=False
    )
    rows: dict[str, Row] = field(
        default_factory=partial(Named, "non-holonomic constraint"), init=False
    )
    outputs: dict[str, UserOutput] = field(default_factory=partial(Named, "output"), init=False)
    paths: dict[str, Path] = field(default_factory=partial(Named, "path"), init=False)
    contacts: list[str] = field(default_factory=list, init=False)
    fitted: dict[str, Fittings] = field(default_factory=dict, init=False)
    turning: dict[str, str] = field(default_factory=dict, init=False)
    rough: dict[str, float] = field(default_factory=dict, init=False)
    snapped: dict[str, tuple[float, float]] = field(default_factory=dict, init=False)
    rounding: float = field(default=0.0, init=False)
    outlines: dict[str, list[Outline]] = field(default_factory=dict, init=False)
    rollers: dict[str, Roller] = field(default_factory=dict, init=False)
    pitch_circles: dict[str, PitchCircles] = field(default_factory=dict, init=False)
    tracks: dict[str, Track] = field(default_factory=dict, init=False)
    shaken: dict[str, tuple[str, ...]] = field(default_factory=dict, init=False)
    strokes: dict[str, Stroke] = field(default_factory=dict, init=False)
    one_way: dict[str, str] = field(default_factory=dict, init=False)
    gravity: Vector = field(default=(0.0, -9.81, 0.0), init=False)
    frozen: bool = field(default=False, init=False)
    time: Any = field(default_factory=lambda: ca.SX.sym("t"), init=False)
    measures: Measures = field(default_factory=Measures, init=False)
    asked: dict[Hashable, Asked] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        check_name("mechanism", self.name)
        self.bodies["ground"] = Ground("ground")

    @property
    def ground(self) -> Ground:
        """The fixed frame; ``ground.at(x, y)`` is a point of it, ``ground`` itself its origin."""
        return cast(Ground, self.bodies["ground"])

    @property
    def moving(self) -> tuple[Link | PointMass, ...]:
        """The links and point masses, in the order of declaration."""
        return tuple(body for body in self.bodies.values() if isinstance(body, Link | PointMass))

    @property
    def links(self) -> dict[str, Link]:
        """The links by name."""
        links = {name: body for name, body in self.bodies.items() if isinstance(body, Link)}
        return Named("link", links)

    @property
    def coordinates(self) -> dict[str, tuple[Joint, Axis]]:
        """The coordinates by name, as the joint and its axis: ``JOINT``, or ``JOINT:NAME`` where a
        joint has several.
        """
        each = {
            axis.coordinate: (joint, axis) for joint in self.joints.values() for axis in joint.axes
        }
        return Named("coordinate", each)

    @property
    def symbols(self) -> Expression:
        """The parameters' symbols as one column, in the order of declaration."""
        return column(parameter.symbol for parameter in self.parameters.values())

    def number(self, expression: Expression, values: Mapping[str, float]) -> float:
        """Return the value of an expression of parameters.

        Parameters
        ----------
        expression : float or casadi.SX
            The expression.
        values : mapping
            Values of all parameters by name, as of :meth:`.Mechanism.values`.

        Returns
        -------
        float
            Its value.

        Raises
        ------
        DeclarationError
            If it has other symbols, or a parameter has no value.
        """
        if not isinstance(expression, ca.SX):
            try:
                return float(expression)
            except (TypeError, ValueError, OverflowError, RuntimeError):
                raise DeclarationError(
                    f"number: expected an expression in parameters, got {shown(expression)}"
                ) from None
        if missing := [name for name in self.parameters if name not in values]:
            raise DeclarationError(
                f"number: expected values of all parameters, and {', '.join(missing)} have none"
            )
        try:
            numbers = column(values[name] for name in self.parameters)
            return float(ca.evalf(ca.substitute(expression, self.symbols, numbers)))
        except (RuntimeError, NotImplementedError):
            raise DeclarationError(
                f"number: expected an expression of parameters only, got {shown(expression)}"
            ) from None

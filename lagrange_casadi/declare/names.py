"""Names of parts: which part has a name that is taken."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ..errors import DeclarationError
from .expressions import check_name
from .joints import Joint
from .parts import (
    Body,
    Constraint,
    Force,
    Friction,
    Ground,
    LineLoad,
    Link,
    Load,
    Parameter,
    Path,
    PointMass,
    Row,
    Spring,
    Torque,
)
from .results import UserOutput

_WORDS: dict[type[object], str] = {
    Constraint: "a constraint",
    Force: "a load",
    Friction: "a load",
    Ground: "the ground",
    Joint: "a joint",
    LineLoad: "a load",
    Link: "a link",
    UserOutput: "an output",
    Parameter: "a parameter",
    Path: "a path",
    PointMass: "a point mass",
    Row: "a non-holonomic constraint",
    Spring: "a load",
    Torque: "a load",
}

Part = Parameter | Body | Joint | Load | Constraint | Row | UserOutput | Path


def check_free(kind: str, name: str, mechanism: str, others: Iterable[Mapping[str, Part]]) -> None:
    """Raise :class:`DeclarationError` for what cannot be a name, or is that of one of the other
    parts.
    """
    check_name(kind, name)
    for part in (parts[name] for parts in others if name in parts):
        bearer = next(_WORDS[known] for known in type(part).__mro__ if known in _WORDS)
        if bearer in (f"a {kind}", f"an {kind}"):
            raise DeclarationError(f"{kind} '{name}' is declared twice in mechanism '{mechanism}'")
        raise DeclarationError(
            f"{kind} '{name}': the name is taken by {bearer} of mechanism '{mechanism}'"
        )

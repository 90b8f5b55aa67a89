"""Terms of a search, to be minimised or limited: a peak, a largest or smallest value, a mean, the
fluctuation of energy of a drive, or a parameter.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

import casadi as ca

from ...base.arguments import public
from ...base.numerals import real
from ...base.quantities import AVERAGED, Output
from ...base.units import typed
from ...engine.model_data import ModelData
from ...errors import DeclarationError

Kind: TypeAlias = Literal["peak", "max", "min", "mean", "rms", "fluctuation", "mass", "parameter"]

KINDS: Mapping[Kind, str] = {
    "peak": "the largest magnitude of a quantity over the motion",
    "max": "its largest value",
    "min": "its smallest value",
    "mean": "the mean of an effort or an output",
    "rms": "the root of its mean square",
    "fluctuation": "the fluctuation of energy of an effort",
}
"""First words of a term."""

MASS: Literal["mass"] = "mass"
"""The mass of a part, or of ``all``."""

_AVERAGES: tuple[Kind, ...] = ("mean", "rms")
_UPPER: tuple[Kind, ...] = ("peak", "max", "rms", "fluctuation")
_CONSTRAINT = re.compile(r"\s*([^<>=!]+?)\s*(<=|>=|<|>)\s*([^<>=!]+?)\s*")
_EXAMPLE = "peak:section:rod:bending <= 12"


def tired_link(output: Output | None) -> str | None:
    """The link whose utilisation against fatigue an output is; None of any other."""
    fatigue = output is not None and (output.group, output.member) == ("utilisation", "fatigue")
    return output.part if output is not None and fatigue else None


@public
@dataclass(frozen=True)
class Term:
    """A number that a design has: a ``kind``, and the quantity it is of by full name, or the
    parameter.
    """

    kind: Kind
    name: str

    @classmethod
    def parse(cls, text: str, parameters: Mapping[str, object]) -> Term:
        """Read ``peak:effort:O``, ``rms:effort:O`` or the like, or a parameter's name.

        Raises :class:`DeclarationError`.
        """
        word, _, name = text.strip().partition(":")
        for kind in KINDS:
            if word == kind and name:
                try:
                    output = Output.of(name)
                except KeyError:
                    break
                if kind in _AVERAGES and output.group not in AVERAGED:
                    raise DeclarationError(
                        f"'{text}': means exist of {', '.join(AVERAGED)} only; use peak:{name}"
                    )
                if kind == "fluctuation" and output.group != "effort":
                    raise DeclarationError(
                        f"'{text}': a fluctuation of energy is that of an effort, as"
                        " fluctuation:effort:O"
                    )
                return cls(kind, str(output))
        if text.strip() in parameters:
            return cls("parameter", text.strip())
        if word == MASS and name:
            return cls(MASS, name)
        raise DeclarationError(
            f"'{text}' is neither a parameter nor"
            f" {', '.join(f'{kind}:QUANTITY' for kind in KINDS)}; an example is peak:effort:O"
        )

    @property
    def averaged(self) -> bool:
        """True if it is a mean over all instants."""
        return self.kind in _AVERAGES

    @property
    def pointed(self) -> bool:
        """True if it is the largest of values at points, of which a search knows some."""
        return self.kind in ("peak", "max", "min")

    @property
    def output(self) -> Output | None:
        """The quantity, None of a parameter and of a mass."""
        return None if self.kind in ("parameter", MASS) else Output.of(self.name)

    def of_parameters(self, data: ModelData) -> ca.Function:
        """A parameter or a mass as a function of all parameters.

        Raises :class:`.UnknownNameError` for what is none.
        """
        found = (
            data.mass(self.name, data.symbols)
            if self.kind == MASS
            else data.parameters[self.name].symbol
        )
        return ca.Function("of_parameters", [data.symbols], [found])

    def unit(self, data: ModelData) -> str:
        """Unit of the term."""
        if self.kind == MASS:
            return "kg"
        if self.kind == "fluctuation":
            return "J"
        if tired_link(self.output):
            return "1"
        return (
            data.parameters[self.name].unit if self.output is None else self.output.unit(data.kinds)
        )

    def __str__(self) -> str:
        return self.name if self.kind == "parameter" else f"{self.kind}:{self.name}"


@public
@dataclass(frozen=True)
class Constraint:
    """A term that is at most, or with ``least`` at least, a ``limit``; ``unit`` is its text's."""

    term: Term
    limit: float
    least: bool = False
    unit: str = ""

    @classmethod
    def parse(cls, text: str, parameters: Mapping[str, object]) -> Constraint:
        """Read ``TERM <= NUMBER`` or ``TERM >= NUMBER``; the number may have a unit, as 5 kN.

        Raises :class:`DeclarationError`.
        """
        found = _CONSTRAINT.fullmatch(text) if isinstance(text, str) else None
        limit, unit = typed(found[3] if found else "")
        try:
            limit = limit if unit else real(limit)
            if not math.isfinite(limit):
                raise ValueError
        except ValueError:
            raise DeclarationError(
                f"expected a constraint such as '{_EXAMPLE}', got {text!r}"
            ) from None
        assert found is not None
        term, least = Term.parse(found[1], parameters), found[2].startswith(">")
        if least and term.kind in _UPPER:
            advice = (
                f"use min:{term.name}"
                if term.kind == "max"
                else f"{term.name} can be limited from above only"
            )
            raise DeclarationError(f"'{text}': {advice}")
        if not least and term.kind == "min":
            raise DeclarationError(
                f"'{text}': a smallest value has only a lower limit; use max:{term.name}"
            )
        if term.kind == "peak" and limit < 0.0:
            raise DeclarationError(
                f"'{text}': a peak is a magnitude, so it cannot be {limit:g} or less"
            )
        return cls(term, limit, least, unit)

    def excess(self, value: float) -> float:
        """Excess of a value over the limit; below zero if it is within."""
        return self.limit - value if self.least else value - self.limit

    def scale(self, value: float) -> float:
        """Size of the term, relative to which its excess is large or small."""
        return abs(self.limit) or abs(value) or 1.0

    @property
    def words(self) -> str:
        """The constraint with all digits of its limit."""
        return f"{self.term} {'>=' if self.least else '<='} {self.limit!r}"

    def __str__(self) -> str:
        return f"{self.term} {'>=' if self.least else '<='} {self.limit:g}"

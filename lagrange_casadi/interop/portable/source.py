"""The header and the source of an exported program, filled in from their templates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from ...base.arrays import Array
from ...engine.codegen.printer import print_functions
from ...version import __version__
from .contract import Contract
from .exported_calls import MODEL
from .exported_program import ExportedProgram
from .exported_slopes import ExportedSlopes
from .exported_slopes import code as sensitivity
from .golden import Golden
from .sections import functions
from .statements import Statements
from .statuses import STATUSES
from .text import comment, indented, quoted, template


@dataclass(frozen=True, eq=False)
class Source:
    """Data from which header and source are written.

    ``identity`` is the hash of the scene, ``guess`` where iterated loops begin, ``method`` the
    options by which it is evaluated, ``values`` are the parameters, of which a table leaves none
    open, and ``golden`` what it must compute, ``slopes`` the derivatives of its outputs, where they
    are wanted.
    """

    contract: Contract
    exported: ExportedProgram
    identity: str
    guess: Sequence[float]
    method: str
    values: Mapping[str, float]
    golden: Golden
    slopes: ExportedSlopes | None = None

    @cached_property
    def code(self) -> str:
        """The source: ``<prefix>.c``."""
        written = Statements(self.contract, self.exported, self.guess)
        sections = functions(self.contract, self.exported) if self.contract.links else ""
        if self.slopes is not None:
            sections += sensitivity(self.contract, self.slopes)
        return template(
            "mechanism.c",
            **self.words,
            includes="\n#include <string.h>" if self.exported.cycle is not None else "",
            graph=print_functions(self.exported.functions, self.contract.precision, prefix="graph"),
            seal=f"0x{self.identity[:8]}u",
            helpers=written.helpers(),
            put=indented(written.put()),
            defaults=written.defaults(),
            prepare=indented(written.prepare()),
            motion=indented(written.motion()),
            instant=indented(written.instant()),
            between=written.between(),
            rows=len(self.exported.columns),
            sections=sections,
            messages="\n".join(
                f'  case {self.words["P"]}_{key}:\n    return "{text}";'
                for key, text in STATUSES.items()
            ),
        )

    @property
    def words(self) -> dict[str, str]:
        """Values of every template."""
        c = self.contract
        return c.words | {
            "name": comment(c.name),
            "called": quoted(c.name).replace("%", "%%"),  # in a format of printf's
            "space": " " * (2 * len(c.prefix) + 9),
            "and_parameters": f", const {c.prefix}_parameters* parameters" if c.settings else "",
            "and_defaults": ", 0" if c.settings else "",
            "and_rest": f", {c.prefix}_real time_rest" if c.rests else "",
            "version": __version__,
            "casadi": ca.CasadiMeta.version(),
            "scene": self.identity,
        }

    @property
    def fixed(self) -> Mapping[str, float]:
        """The parameters that are no longer open."""
        return {} if self.contract.settings else self.values

    @property
    def p(self) -> Array:
        """The parameters as one vector."""
        return np.array(list(self.values.values()))

    @property
    def story(self) -> str:
        """Description of the evaluation, its accuracy, and its fixed numbers."""
        error, output = self.golden.worst
        text = f"In {self.contract.precision} precision; options of the export: {self.method}. "
        text += (
            f"Its outputs are off by about {error:.0e} of their largest values over the scene's"
            f" motion at most ({output})."
        )
        if self.fixed:
            text += (
                " Fixed here: "
                + ", ".join(f"{name} = {value:.6g}" for name, value in self.fixed.items())
                + "."
            )
        return text

    @property
    def iterated(self) -> bool:
        """True if it follows loops from one instant to the next."""
        return "loops" in self.exported.functions

    @property
    def closing(self) -> bool:
        """True if it has loops that may pass a dead centre between instants."""
        return "closing" in self.exported.functions

    @property
    def model(self) -> list[tuple[str, str, int]]:
        """The members of a model: name, type, where ``real`` is that of the precision, and how many
        of it.
        """
        sizes = self.exported.sizes
        closed = [("closed", "int", 1)] if self.exported.newton is not None else []
        return [
            ("seal", "unsigned", 1),
            *closed,
            *((name, "real", sizes[name]) for name in MODEL if sizes[name]),
        ]

    @property
    def span(self) -> tuple[float, float]:
        """The times [s] that all motions cover."""
        return self.exported.program.laws.span

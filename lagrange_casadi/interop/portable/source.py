"""The header and the source of an exported program, filled in from their templates."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from ...base.arrays import Array
from ...engine.codegen.printer import function_name, print_functions
from ...version import __version__
from .contract import Contract
from .data import table_text
from .exported_calls import MODEL, PREPARE
from .exported_program import ExportedProgram
from .exported_slopes import ExportedSlopes
from .exported_slopes import code as sensitivity
from .golden import Golden
from .sections import functions
from .statements import between, closing_loops, instant, motion, prepare, put
from .statuses import STATUSES
from .text import comment, indented, quoted, template


@dataclass(frozen=True, eq=False)
class Source:
    """Data from which header and source are written.

    ``identity`` is the hash of the scene, ``method`` the options by which it is evaluated,
    ``values`` are the parameters, of which a table leaves none open, ``golden`` is what it must
    compute, and ``slopes`` are the derivatives of its outputs that are wanted.
    """

    exported: ExportedProgram
    identity: str
    method: str
    values: Mapping[str, float]
    golden: Golden
    slopes: ExportedSlopes

    @property
    def contract(self) -> Contract:
        """The interface."""
        return self.exported.contract

    @cached_property
    def code(self) -> str:
        """The source: ``<prefix>.c``."""
        c, exported, P = self.contract, self.exported, self.contract.words["P"]
        number, sizes, at = exported.number, exported.sizes, 2 if c.rests else 1
        sections = functions(exported) if c.links else ""
        return template(
            "mechanism.c",
            **self.words,
            includes="\n#include <string.h>" if exported.cycle is not None else "",
            graph=print_functions(exported.functions, c.precision, prefix="graph"),
            seal=f"0x{self.identity[:8]}u",
            turning=bool(exported.program.loop_angles),
            turn=number(math.tau),
            half=number(0.5),
            ceil=function_name("ceil", c.precision),
            loops=closing_loops(exported) if self.iterated else "",
            rules=bool(exported.program.rules),
            broken=", ".join(f"{P}_{name}" for name in exported.answers()),
            tables=table_text(exported),
            put=indented(put(exported)),
            defaults=",\n".join(f"  {number(m.default)} /* {m.name} */" for m in c.settings),
            sound=sizes["sound_of"],
            prepared=exported.called(PREPARE),
            prepare=indented(prepare(exported)),
            at=at,
            d=at * len(c.drives),
            drives=len(c.drives),
            far=sizes["far"],
            motion=indented(motion(exported)),
            moment=sizes["moment"],
            counted=sizes["counted"],
            drive=0 if exported.cycle is None else sizes["evaluated"],
            instant=indented(instant(exported)),
            between=between(exported) if self.closing else "",
            rows=len(exported.columns),
            sections=sections + (sensitivity(c, self.slopes) if self.slopes.by else ""),
            messages="\n".join(
                f'  case {P}_{key}:\n    return "{text}";' for key, text in STATUSES.items()
            ),
        )

    @property
    def words(self) -> dict[str, object]:
        """Values of every template.

        Of parameters, links and derivatives ``setting``, ``link`` and ``by`` name the first, and
        are empty where there is none.
        """
        c, (coordinate, output) = self.contract, self.contract.shown
        return {
            **c.words,
            "setting": c.settings[0].name if c.settings else "",
            "link": c.links[0].name if c.links else "",
            "constant": c.links[0].constant if c.links else "",
            "by": self.slopes.by[0].name if self.slopes.by else "",
            "coordinate": coordinate.name,
            "output": output.name,
            "first_output": c.outputs[0].name,
            "iterated": self.iterated,
            "closing": self.closing,
            "name": comment(c.name),
            "called": quoted(c.name).replace("%", "%%"),  # in a format of printf's
            "space": " " * (2 * len(c.prefix) + 9),
            "and_parameters": f", const {c.prefix}_parameters* parameters" if c.settings else "",
            "and_defaults": ", 0" if c.settings else "",
            "and_rest": f", {c.prefix}_real time_rest" if c.rests else "",
            "and_zero": ", 0" if c.rests else "",
            "corners": "Corners of motions, constraints and lifts were checked with the default"
            " parameters only.",
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
        fixed = ", ".join(f"{name} = {value:.6g}" for name, value in self.fixed.items())
        return (
            f"In {self.contract.precision} precision; options of the export: {self.method}. Its"
            f" outputs are off by about {error:.0e} of their largest values over the scene's motion"
            f" at most ({output}).{f' Fixed here: {fixed}.' if fixed else ''}"
        )

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

"""Measured quantities as the model has them, and their derivatives by unknown parameters, along a
measured motion.
"""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from ...base.arrays import Array, Expression
from ...base.brief import Brief
from ...base.quantities import Column, Output
from ...base.symbolic import Graphs, symbolic
from ...base.tables import table_of
from ...engine.derive import compile_scene
from ...engine.instants.backends import begun
from ...engine.instants.evaluation_method import EvaluationMethod
from ...engine.program import Program
from ...engine.reciprocals import differentiable
from ...engine.section_function import Place
from ...engine.section_stress import CrossSections
from ...errors import AssemblyError, DeclarationError, UnknownNameError, check_known
from ...model.limits import END
from ...model.scene import Scene
from ...results.sensitivity.jacobian import total
from ...results.sensitivity.slopes import Batch
from .base import Ranking

_ALONG = re.compile(r"(section|strain):([^:@]+):([^:@]+)@([0-9.eE+-]+)")
_FORCES = ("effort", "reaction", "multiplier", "load", "friction", "output")
_STRIDE = 0.1
"""Largest change of a driven coordinate [rad or m] over which loops are followed in one step."""

_STEPS, _CLOSED = 60, 1e-13
"""Steps of Newton's method at most, and the relative correction at which a loop is closed."""

MOTION = ("", "_rate", "_acceleration")
"""Ends of the names of a drive's coordinate, rate and acceleration."""

_NAMES = ["t", "d", "d_rate", "d_acceleration", "z", "p"]


class DrivenMotion(NamedTuple):
    """Times (n,) [s], and coordinates, rates and accelerations (n, drives) of the driven joints."""

    t: Array
    d: Array
    rate: Array
    acceleration: Array

    def __repr__(self) -> str:
        instants, drives = self.d.shape
        return (
            f"<DrivenMotion of {drives} drives: {instants} instants from {self.t[0]:.5g} to"
            f" {self.t[-1]:.5g} s>"
        )


class Along(NamedTuple):
    """A section force, or the strain of a fibre, of a ``link`` at a ratio xi/l."""

    kind: str
    link: str
    member: str
    ratio: float


@dataclass(frozen=True, eq=False, repr=False)
class Regressor(Graphs, Brief):
    """Compiled derivatives of ``quantities`` by the ``unknown`` parameters of a scene.

    The motion of the drives is an input, not the law of the scene, so derivatives are those at a
    motion that stands still.
    """

    program: Program
    quantities: tuple[str, ...]
    units: tuple[str, ...]
    unknown: tuple[str, ...]
    batch: Batch

    @classmethod
    @symbolic
    @functools.lru_cache(maxsize=8)
    def of(
        cls,
        scene: Scene,
        quantities: tuple[str, ...],
        unknown: tuple[str, ...],
        method: EvaluationMethod,
    ) -> Regressor:
        """Derive and compile them, once for a scene.

        Raises :class:`.UnknownNameError` for quantities and parameters that the scene does not
        have, and :class:`.DeclarationError` without parameters.
        """
        if not unknown:
            raise DeclarationError("expected at least one unknown parameter, got none")
        check_known("parameter", unknown, scene.parameters)
        program = compile_scene(scene, _wanted(scene, quantities))
        laws = program.data.laws
        t, p = laws.motion.sx_in()
        still = [ca.SX.zeros(len(laws.joints)) for _ in range(3)]
        motion = ca.Function("motion", [t, p], still, ["t", "p"], _NAMES[1:4])
        given = replace(program, data=replace(program.data, laws=replace(laws, motion=motion)))
        by = [list(program.data.parameters).index(name) for name in unknown]
        rows = _rows(program, quantities)
        numbers = [program.outputs[output] for output in rows]
        inputs = differentiable(program.instant).sx_in()
        local = differentiable(program.instant)(*inputs)[numbers]
        slopes = total(given, numbers, by)(*inputs)
        columns = ca.SX.sym("columns", len(rows))
        values: dict[Column, Any] = dict(zip(rows, ca.vertsplit(columns), strict=True))
        p = inputs[-1]
        found = [_quantity(program, name, values, p) for name in quantities]
        seeds = ca.vertcat(slopes.T, ca.SX.eye(p.numel())[:, by])
        measured = ca.vertcat(*(value for value, _ in found))
        changes = ca.jtimes(measured, ca.vertcat(columns, p), seeds)
        both = ca.densify(ca.horzcat(measured, changes).T)
        inner = ca.Function("measured", [columns, *inputs], [both])
        function = ca.Function(
            "at_once", inputs, [inner(local, *inputs)], _NAMES, ["found"], {"cse": True}
        )
        units = tuple(unit for _, unit in found)
        batch = Batch.of(function, method)
        return cls(program, tuple(quantities), units, tuple(unknown), batch)

    @property
    def numbers(self) -> list[int]:
        """Places of the unknown parameters among all."""
        return [list(self.program.data.parameters).index(name) for name in self.unknown]

    def ranking(self, p: Array) -> Ranking:
        """Rank the unknown parameters as they are declared, masses last: those are parts of the
        moments of the links that carry them. Sizes are those of values ``p`` of all.
        """
        values, parameters = p[self.numbers], self.program.data.parameters
        masses = [parameters[name].unit == "kg" for name in self.unknown]
        order = sorted(range(len(masses)), key=masses.__getitem__)
        return Ranking(np.where(values == 0.0, 1.0, np.abs(values)), tuple(order))

    @property
    def unchanged(self) -> DeclarationError:
        """Error for quantities that the unknown parameters do not change."""
        names = ", ".join(self.unknown)
        return DeclarationError(
            f"nothing that is measured depends on the unknown parameters {names}"
        )

    @property
    def expected(self) -> dict[str, str]:
        """SI units of all that may be measured: the motion of the drives, and the quantities."""
        moving = [f"{drive}{end}" for drive in self.program.driven for end in MOTION]
        kinds = self.program.data.kinds
        found = {name: Output.of(f"motion:{name}").unit(kinds) for name in moving}
        return found | dict(zip(self.quantities, self.units, strict=True))

    def at(self, motion: DrivenMotion, z: Array, p: Array) -> tuple[Array, Array]:
        """Return values (n, quantities), and their derivatives (n, quantities, unknown)."""
        given = {"t": (motion.t[:, None], 1), "d": (motion.d, 1), "d_rate": (motion.rate, 1)}
        given |= {"d_acceleration": (motion.acceleration, 1), "z": (z, 1), "p": (p[None], 0)}
        contiguous = {name: (np.ascontiguousarray(x), each) for name, (x, each) in given.items()}
        found = self.batch.at(motion.t.size, contiguous)
        found = found.reshape(motion.t.size, len(self.quantities), 1 + len(self.unknown))
        return found[..., 0], found[..., 1:]

    def follow(self, motion: DrivenMotion, p: Array, guess: Array | None = None) -> Array:
        """Return the iterated coordinates (n, z) along a motion.

        They begin from a ``guess`` (n, z), those of other parameters, or are followed from the
        scene's own start. Raises :class:`.AssemblyError` where a loop cannot be closed.
        """
        loop = self.program.newton
        if loop is None:
            return np.zeros((motion.t.size, 0))
        if guess is not None:
            return self._closed(motion, p, guess)
        start = self.program.data.span[0]
        d = np.asarray(self.program.motion(start, p)[0]).ravel()
        z, found = np.array(begun(self.program, start, tuple(p.tolist())), float), []
        for k, end in enumerate(motion.d):
            strides = max(1, math.ceil(float(np.abs(end - d).max()) / _STRIDE))
            for share in np.arange(1, strides + 1) / strides:
                here = DrivenMotion(motion.t[k : k + 1], (d + share * (end - d))[None], *motion[2:])
                z = self._closed(here, p, z[None], row=k)[0]
            d = end
            found.append(z)
        return np.array(found)

    def _closed(self, motion: DrivenMotion, p: Array, z: Array, row: int = 0) -> Array:
        loop = self.program.newton
        assert loop is not None
        values = ca.repmat(ca.DM(p), 1, motion.t.size)
        for _ in range(_STEPS):
            step, size = loop.step(z.T, motion.t[None], motion.d.T, values)
            z = z + np.asarray(step).reshape(-1, motion.t.size).T
            sizes = np.asarray(size).ravel()
            if not np.isfinite(sizes).all():
                break
            if (sizes <= _CLOSED).all():
                return z
        worst = int(np.argmax(np.where(np.isfinite(sizes), sizes, np.inf)))
        if sizes[worst] <= _CLOSED**0.75:  # rounding keeps it from less
            return z
        raise AssemblyError(
            f"{loop.joints} cannot be closed at row {row + worst + 1} of the measurements,"
            f" t = {motion.t[worst]:.6g} s: the measured coordinates lie beyond what the mechanism"
            " can reach"
        )


def _wanted(scene: Scene, quantities: Sequence[str]) -> list[str]:
    """Return the names to want for quantities.

    Raises :class:`.UnknownNameError` for a quantity whose part there is not.
    """
    wanted: dict[str, None] = {}
    for name in quantities:
        kind, _, part = name.partition(":")
        group = "section" if kind == "strain" else kind
        want = group if group == "effort" else f"{group}:{part.partition(':')[0]}"
        if group not in (*_FORCES, "section") or want not in scene.outputs:
            sections = [one for one in scene.outputs if one.startswith("section:")]
            forces = [one for one in scene.outputs if one.partition(":")[0] in _FORCES[1:]]
            forces = [f"effort:{drive}" for drive in scene.laws] + forces
            along_links = [one.replace("section", kind, 1) for one in sections]
            valid = along_links if group == "section" and sections else forces
            raise UnknownNameError("measured quantity", name, valid)
        if group == "section" and along(name) is None:
            raise DeclarationError(
                f"measured quantity '{name}': expected a force or a fibre, and a place xi/l"
                f" from 0 to 1, as {want}:bending@0.5"
            )
        wanted[want] = None
    return list(wanted)


def along(name: str) -> Along | None:
    """Read the name of a section force, ``section:LINK:FORCE@XI``, or of a strain,
    ``strain:LINK:FIBRE@XI``; None for another name, or a place that is not on the link.
    """
    if match := _ALONG.fullmatch(name):
        with suppress(ValueError):
            if 0.0 <= (ratio := float(match[4])) <= 1.0:
                return Along(match[1], match[2], match[3], ratio)
    return None


def _rows(program: Program, quantities: Sequence[str]) -> list[Output]:
    """Return the columns of the graph of which quantities are made."""
    found: list[Output] = []
    for name in quantities:
        place = along(name)
        if place is not None:
            found += [o for o in program.outputs if o.along and o.part == place.link]
        elif (output := Output.of(name)) in program.outputs:
            found.append(output)
        else:
            raise UnknownNameError("measured quantity", name, [*map(str, program.outputs)])
    return list(dict.fromkeys(found))


def _quantity(
    program: Program, name: str, columns: Mapping[Column, Expression], p: ca.SX
) -> tuple[Expression, str]:
    """Return a quantity as an expression of columns and parameters, and its unit."""
    place, data = along(name), program.data
    if place is None:
        output = Output.of(name)
        return columns[output], output.unit(data.kinds)
    inside, here = data.section(place.link, columns, p), Place(ca.SX(place.ratio))
    if place.kind == "section":
        check_known("section force", [place.member], table_of(data.space).forces, place=name)
        output = Output("section", place.link, place.member)
        return inside.at(place.member, here, END["double"]), output.unit(data.kinds)
    check_known("link with a beam", [place.link], data.content.materials, place=name)
    link = data.link(place.link, p)
    assert link.beam is not None
    sections = CrossSections(link.beam, data.space)
    breaks = link.beam.course.breaks
    cell = int(np.clip(np.searchsorted(breaks, place.ratio, "right") - 1, 0, len(breaks) - 2))
    fibres = sections.fibres(cell).names
    check_known("fibre", [place.member], fibres, place=name)
    forces = [inside.at(force, here, END["double"]) for force in sections.forces]
    normal, _, _ = sections.stresses(cell, place.ratio, [fibres.index(place.member)], forces)
    elasticity = link.beam.material.needs(f"quantity '{name}'", "elasticity")[0]
    return normal / elasticity, "1"

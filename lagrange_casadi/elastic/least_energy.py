"""Forces that equilibrium leaves open, by least strain energy (Menabrea 1858; Castigliano 1879).

All forces are f + S x: those of an equilibrium, and what is open, x. Of all equilibria the true one has the least strain energy,
where parts fit without strain (Timoshenko, *Strength of Materials*, part I, on least work). Strain energy is the sum of squares of
section forces, each times a factor of its cross-section, over all links: a problem of least squares at every instant. Section
forces are polynomials between two marks, so Gauss's nodes sum it exactly.

Of links without a beam the stiffness is not known. What loads one of them is open, and so is whatever else depends on it; what
loads no link at all, as two bearings on one pin do, is open too. Points and the ground are rigid.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..base.arrays import Array
from ..base.quantities import Output
from ..base.tables import MOMENT
from ..beams.told import beam_told
from ..codegen.stages import plain
from ..declare.description import Description, density_of, in_space
from ..declare.giving import Elastic
from ..equations.checks import Column
from ..equations.open_forces import OpenForces
from ..equations.program import Program
from ..equations.stress import FORCES
from ..errors import DeclarationError, one_line
from ..instants.laws import law_of
from ..instants.section_law import SectionLaw
from ..strength.member import Member
from .compliance import Compliance, Nodes, nodes, sorted_edges

_NONE = 1e-9
"""Of all that forces change with something: what is no change."""

_NO_BEAM = "no beam"
_FINER = 4
"""Nodes more, between two marks, by which it is checked that the energy is least."""


@dataclass(frozen=True, eq=False)
class Completed:
    """Columns ``out`` (columns, t) with what elasticity tells of them, the outputs that it tells, and those that stay open.

    ``reasons`` says why some do. ``residual`` (t,) is how far the strain energy is from its least, as a cosine. ``magnified`` is
    how much relative errors of section forces may grow in what is told.
    """

    out: Array
    told: tuple[Output, ...]
    left_open: tuple[Output, ...]
    reasons: tuple[str, ...]
    residual: Array
    magnified: float = 1.0


def complete(
    graph: Program,
    out: Array,
    iterated: Array,
    t: Array,
    p: Array,
    told: Description,
    left_open: Sequence[Output],
    elastic: Elastic,
) -> Completed:
    """The columns ``out`` of a graph over instants with the forces of least strain energy in the place of what is ``left_open``.

    ``told`` describes the mechanism at parameters ``p``; ``elastic`` is as in :class:`.Scene`. Raises :class:`.DeclarationError`
    where a material has no elasticity.
    """
    free, known = graph.open_forces, np.isfinite(out).all(axis=0)
    if free is None or not left_open or not known.any():
        return Completed(out, (), tuple(left_open), (), np.zeros(t.size))
    driven = [rows.full() for rows in plain(graph).drive(t[None, known], p)]
    given = (driven[0][:1], driven[0][1:], *driven[1:], iterated[:, known], p)
    slopes = _sloping(free, given, np.zeros((free.count, int(known.sum()))))
    state = _State(graph, told, t[known], p, out[:, known], free, slopes)
    giving, others = _links(told, elastic)
    firm = dict(others)
    beams: dict[str, Compliance] = {}
    for link in giving:
        try:
            beams[link] = Compliance.of(state.member(link), f"elastic link '{link}'")
        except DeclarationError as error:
            if elastic is not True:
                raise
            firm[link] = one_line(error)
    stiff = {link: state.loading(link) for link in firm}
    none = np.zeros((len(state.t), 0, free.count))
    loaded = [np.concatenate([none, *each], axis=1) for each in (stiff.values(), [state.loading(link) for link in beams])]
    parts = (state.sizes, *loaded, *state.strained(beams))
    found = [_least(*(part[i] for part in parts)) for i in range(len(state.t))]
    x = np.stack([one.x for one in found], axis=1)
    done = out.copy()
    values = free.values(*given, x).full()
    for k, column in enumerate(free.columns):
        done[graph.columns.index(column), known] = values[k]
    still = _still_open(free, left_open, found, _sloping(free, given, x))
    residual = np.zeros(t.size)
    residual[known] = state.stationarity(beams, done[:, known], found)
    reasons = tuple(_reasons(firm, stiff, found)) if still else ()
    gone = tuple(output for output in left_open if output not in still)
    return Completed(done, gone, still, reasons, residual, max(one.magnified for one in found))


def _links(told: Description, elastic: Elastic) -> tuple[list[str], dict[str, str]]:
    """The links that give way; and those whose stiffness is not known, with why."""
    bodies = told["bodies"]
    if elastic is not True:
        return list(elastic or ()), {}
    having = [name for name, body in bodies.items() if "beam" in body]
    lacking = (name for name, body in bodies.items() if body["length"] is not None and name not in having)
    return having, dict.fromkeys(lacking, _NO_BEAM)


def _sloping(free: OpenForces, given: tuple[Any, ...], x: Array) -> Array:
    """How the columns change with what is open, (columns, t, count)."""
    return np.asarray(free.slopes(*given, x).full().reshape(len(free.columns), x.shape[1], free.count))


@dataclass(frozen=True, eq=False)
class _State:
    """The columns at instants at which they are numbers, and their ``slopes`` (open columns, t, count)."""

    graph: Program
    told: Description
    t: Array
    p: Array
    out: Array
    free: OpenForces
    slopes: Array

    @property
    def space(self) -> bool:
        return in_space(self.told)

    @property
    def extent(self) -> float:
        """A length beside which moments are forces [m]."""
        return max([body["length"] or 0.0 for body in self.told["bodies"].values()]) or 1.0

    @property
    def sizes(self) -> Array:
        """What reactions, and forces at tips and stations, change with what is open, moments by the extent: (t, n, count)."""
        rows = []
        for column, slopes in zip(self.free.columns, self.slopes, strict=True):
            if isinstance(column, Output) and column.group in ("reaction", "law", "station"):
                rows.append(slopes / (self.extent if column.quantity.unit == MOMENT else 1.0))
        return np.stack([np.zeros((len(self.t), self.free.count)), *rows], axis=1)

    def law(self, link: str, rows: Array | None, unit: int | None = None) -> SectionLaw:
        """The law of a link by columns; or by what these change with a number that is open."""
        own = {output: k for output, k in self.graph.outputs.items() if output.along and output.part == link}
        if rows is not None:
            found = {output: rows[k] for output, k in own.items()}
        else:
            changes = dict(zip(self.free.columns, self.slopes[:, :, unit], strict=True))
            nil = np.zeros_like(self.t)
            found = {output: changes.get(output, nil) for output in own if output.group != "spread"}
            found |= {output: self.out[k] for output, k in own.items() if output.member == "station"}
        body = self.told["bodies"][link]
        return law_of(link, found, body["length"], density_of(body))

    def member(self, link: str, rows: Array | None = None) -> Member:
        """A link with a beam, with the section forces of columns, by default of those with nothing for what is open."""
        law = self.law(link, self.out if rows is None else rows)
        return Member(link, beam_told(self.told["bodies"][link]["beam"]), law, self.t, np.zeros(1), self.space)

    def units(self, link: str, at: Nodes) -> Array:
        """What section forces change with each number that is open, (forces, count, t, n)."""
        laws = [self.law(link, None, unit) for unit in range(self.free.count)]
        return np.stack([np.stack([law.at(force, at.u) for law in laws]) for force in FORCES[self.space]])

    def loading(self, link: str) -> Array:
        """How a link is loaded by what is open, in forces: (t, n, count)."""
        body = self.told["bodies"][link]
        if "density" not in body:
            return _on_body(self.told, link, dict(zip(self.free.columns, self.slopes, strict=True)), self.extent, len(self.t))
        law = self.law(link, None, 0)
        edges = sorted_edges(self.t, [np.clip(load.station, 0.0, 1.0) for load in law.loads], [0.0, 1.0])
        at = Nodes.between(edges, (0.0, 1.0), 2, law.length)
        forces = self.units(link, at)
        moments = [k for k, force in enumerate(FORCES[self.space]) if force.startswith(("bending", "torsion"))]
        forces[moments] /= self.extent
        # A part without length has no inside.
        forces *= at.weights > _NONE * law.length
        return _rows(forces)

    def strained(self, beams: Mapping[str, Compliance]) -> tuple[Array, Array]:
        """Strains at all nodes, times their weights' roots: for each number that is open (t, n, count), and of the rest (t, n)."""
        bent, resting = [np.zeros((len(self.t), 0, self.free.count))], [np.zeros((len(self.t), 0))]
        for link, beam in beams.items():
            at = nodes(beam.member)
            root = np.sqrt(at.weights)
            bent.append(_rows(beam.scaled(self.units(link, at), at.index, at.u) * root))
            own = beam.member.at(at.u)
            resting.append(np.moveaxis(beam.scaled(own, at.index, at.u) * root, 1, 0).reshape(len(self.t), -1))
        return np.concatenate(bent, axis=1), np.concatenate(resting, axis=1)

    def stationarity(self, beams: Mapping[str, Compliance], done: Array, found: Sequence[_Least]) -> Array:
        """How far the strain energy of completed columns is from its least, by other nodes: the largest cosine (t,)."""
        slope, along, across = 0.0, 0.0, 0.0
        ways = _stacked([one.chosen for one in found])
        if not ways.size:
            return np.zeros(len(self.t))
        for link in beams:
            beam = Compliance.of(self.member(link, done), f"elastic link '{link}'")
            at = nodes(beam.member, _FINER)
            root = np.sqrt(at.weights)
            moved = _rows(beam.scaled(self.units(link, at), at.index, at.u) * root) @ ways
            strained = np.moveaxis(beam.scaled(beam.member.at(at.u), at.index, at.u) * root, 1, 0).reshape(len(self.t), -1)
            before = np.moveaxis(beam.scaled(self.member(link).at(at.u), at.index, at.u) * root, 1, 0).reshape(len(self.t), -1)
            slope = slope + np.einsum("tnk,tn->tk", moved, strained)
            along = along + np.sum(moved**2, axis=1)
            across = across + np.maximum(np.sum(strained**2, axis=1), np.sum(before**2, axis=1))
        size = np.sqrt(along * np.asarray(across)[:, None])
        return np.asarray(np.max(np.divide(np.abs(slope), size, out=np.zeros_like(size), where=size > 0.0), axis=1))


def _rows(forces: Array) -> Array:
    """Forces (forces, count, t, n) as rows (t, forces n, count)."""
    return np.moveaxis(forces, (2, 1), (0, 3)).reshape(forces.shape[2], -1, forces.shape[1])


def _on_body(told: Description, name: str, changes: Mapping[Column, Array], extent: float, size: int) -> Array:
    """What the joints of a body change with what is open, those at one place together, in forces: (t, n, count)."""
    members = ("fx", "fy", "fz", "mx", "my", "mz") if in_space(told) else ("fx", "fy", "mz")
    sums: dict[tuple[Any, ...], list[Any]] = {}
    for joint, declared in told["joints"].items():
        for place, sign in ((declared["parent"], -1.0), (declared["child"], 1.0)):
            if place["body"] != name:
                continue
            slides = declared["kind"] not in ("revolute", "spherical", "universal", "weld")
            own = (joint,) if slides else (place["x"], place["y"], place.get("z", 0.0))
            entries = sums.setdefault(own, [0.0] * len(members))
            for k, member in enumerate(members):
                unit = extent if member.startswith("m") else 1.0
                entries[k] = entries[k] + sign * changes.get(Output("reaction", joint, member), 0.0) / unit
    count = next(iter(changes.values())).shape[1]
    rows = [entry for entries in sums.values() for entry in entries if isinstance(entry, np.ndarray)]
    return np.stack([np.zeros((size, count)), *rows], axis=1)


@dataclass(frozen=True, eq=False)
class _Least:
    """What is open at one instant: its numbers ``x``, the ways in which these were ``chosen``, and those that stay ``open``,
    columns of both; ``unseen`` are ways that no force tells of. ``scale`` makes ways of forces of size one. ``idle`` tells whether
    some load nothing that gives way.
    """

    x: Array
    chosen: Array
    open: Array
    unseen: Array
    scale: Array
    idle: bool
    magnified: float


def _least(sizes: Array, stiff: Array, loading: Array, bent: Array, resting: Array) -> _Least:
    """The least of |resting + bent x|, as far as x loads nothing ``stiff``, and loads something that gives way."""
    _, s, v = np.linalg.svd(sizes)
    rank = int(np.sum(s > _NONE * max(s[0], np.finfo(float).tiny)))
    scale, unseen = v[:rank].T / s[:rank], v[rank:].T
    unknown, known = _seen(stiff @ scale)
    given, idle = _seen(loading @ scale @ known)
    chosen = scale @ known @ given
    open_ = scale @ np.concatenate([unknown, known @ idle], axis=1)
    x, magnified = np.zeros(len(scale)), 1.0
    if chosen.shape[1]:
        u, s, v = np.linalg.svd(bent @ chosen, full_matrices=False)
        solve = chosen @ (v.T / s) @ u.T
        x, magnified = -solve @ resting, float(s[0] / s[-1])
        open_ = open_ - solve @ (bent @ open_)
    return _Least(x, chosen, open_, unseen, scale, bool(idle.size), magnified)


def _seen(matrix: Array) -> tuple[Array, Array]:
    """Ways of which a matrix makes something, and those of which it makes nothing, as columns."""
    rows, count = matrix.shape
    if not rows or not count:
        return np.zeros((count, 0)), np.eye(count)
    _, s, v = np.linalg.svd(matrix)
    rank = int(np.sum(s > _NONE))
    return v[:rank].T, v[rank:].T


def _still_open(free: OpenForces, left_open: Sequence[Output], found: Sequence[_Least], slopes: Array) -> tuple[Output, ...]:
    """Those of the outputs that change with what stays open at some instant, by slopes (columns, t, count)."""
    rows = {column: k for k, column in enumerate(free.columns)}
    ways, scale, unseen = (_stacked([getattr(one, name) for one in found]) for name in ("open", "scale", "unseen"))

    def stays(output: Output) -> bool:
        if output not in rows:
            return True
        own = slopes[rows[output]]
        whole = np.linalg.norm(own, axis=1).max()
        return bool(
            np.any(_norms(own, ways) > _NONE * _norms(own, scale).max(initial=0.0)) or np.any(_norms(own, unseen) > _NONE * whole)
        )

    return tuple(output for output in left_open if stays(output))


def _norms(rows: Array, ways: Array) -> Array:
    """How much rows (t, count) change along ways (t, count, n), (t,)."""
    return np.asarray(np.linalg.norm(np.einsum("tk,tkn->tn", rows, ways), axis=1))


def _stacked(ways: Sequence[Array]) -> Array:
    """Ways (count, n) of every instant as (t, count, n), with nil ways where there are fewer."""
    most = max(part.shape[1] for part in ways)
    return np.stack([np.pad(part, ((0, 0), (0, most - part.shape[1]))) for part in ways])


def _reasons(firm: Mapping[str, str], stiff: Mapping[str, Array], found: Sequence[_Least]) -> Iterator[str]:
    """Why something stays open."""
    through = [
        link
        for link, rows in stiff.items()
        if any(np.abs(row @ one.scale).max(initial=0.0) > _NONE for row, one in zip(rows, found, strict=True))
    ]
    if bare := [f"'{link}'" for link in through if firm[link] == _NO_BEAM]:
        yield f"they go through {', '.join(bare)}, which {'has' if len(bare) == 1 else 'have'} no beam"
    yield from (firm[link] for link in through if firm[link] != _NO_BEAM)
    if any(one.unseen.size or one.idle for one in found):
        yield "some bend no link"

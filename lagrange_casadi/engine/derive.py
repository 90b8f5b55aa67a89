"""Derivation of a scene's graphs: kinematics, Lagrange terms and internal forces together, and
nothing that is not wanted.
"""

from __future__ import annotations

import copy
import functools
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

import casadi as ca

from ..base import cache
from ..base.arguments import Outputs, public, texts
from ..base.arrays import Expression
from ..base.quantities import Check, Column, Output
from ..base.scalars import column, entries, graph
from ..base.symbolic import symbolic
from ..base.tables import MOMENT, Table, table_of
from ..errors import AssemblyError, DeclarationError, MobilityError, PostureError
from ..model.declared_parts import Asked, Link
from ..model.end_conditions import effective_lengths, ends_of
from ..model.limits import END, FITS, MISSES
from ..model.link_density import Density
from ..model.mechanism import Mechanism
from ..model.scene import STRENGTH, Scene, Wanted
from ..model.wanted_names import among
from .deflections import deflections
from .drives import closure
from .identity import identity_of
from .indeterminate import SOME, Forces
from .iteration import CLOSED
from .least_energy import Completion, LeastEnergy, feeling, least_energy
from .load_points import gathered
from .mobility import internal_forces
from .model_data import ModelData, template
from .moving import Moving
from .placement import explained
from .program import Program
from .reciprocals import share_reciprocals
from .sampling import Sampling
from .section_function import Place, Section
from .sizes import extent
from .two_force_links import find_two_force_links, unaimed
from .utilisation import stresses, utilisation
from .verdicts import OPEN

_SERVES = 1e-10
"""Largest residual of redundant equations at the start for other parameters, for which the graphs
are still valid: a tenth of the certificates' tolerance.
"""

_ALONG = 0.0, 1 / 64, 1 / 16, 1 / 4, 1 / 2, 1.0
"""Parts of the motion at which loops are looked at: as it begins, parts that were given by their
places fit, however their axes are rounded.
"""

_CONTACT = {"pulls": "normal", "slides": "margin"}
"""Outputs of a contact by what it does where they are negative."""


@public
@symbolic
def compile_scene(
    scene: Scene,
    wanted: Outputs | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
) -> Program:
    """Compile a scene to CasADi functions of an instant and tables of plain data.

    The result does not need the scene any more. It can be pickled, and read in another process that
    has no file of the case. A scene is compiled once: the result is kept in the process, and in the
    cache folder by the content of the declaration.

    Parameters
    ----------
    scene
        The scene.
    wanted
        Output names, as in :class:`.Scene`; by default the scene's own.
    parameters
        Values with which loops are assembled where they cannot be with the scene's own.

    Returns
    -------
    Program
        The functions and tables.

    Raises
    ------
    MobilityError, DeclarationError, AssemblyError
        If the loops cannot be solved.
    """
    values = None if parameters is None else scene.values(parameters)
    with explained(scene, values):
        return derived(scene, wanted, values)[0]


derive = compile_scene
"""An earlier name of the same function."""


@symbolic
def derived(
    scene: Scene, wanted: Outputs | None, values: Mapping[str, float] | None
) -> tuple[Program, Scene]:
    """Derive a scene, assembled with its own parameters, else with ``values`` of all, checked; and
    the scene as it was assembled, with the rounding of its axes.

    Where redundant equations hold with the scene's own parameters but not with the values, it is
    assembled with the values.

    Raises :class:`.AssemblyError` and :class:`.MobilityError` if it can be assembled with neither,
    and :class:`.PostureError` for a posture that leaves branches open.
    """
    names = scene.wanted if wanted is None else wanted
    listed = texts(names)
    want = Wanted.of(scene.mechanism, names) if listed is None else _wanted(scene, tuple(listed))
    return _chosen(scene, want, None if values is None else tuple(values.items()))


@functools.lru_cache(maxsize=32)
def _chosen(
    scene: Scene, want: Wanted, values: tuple[tuple[str, float], ...] | None
) -> tuple[Program, Scene]:
    """The Program and scene of :func:`derived`, for values of all parameters by name."""
    if values is None or dict(values) == scene.mechanism.values(scene.assembly):
        return _assembled(scene, want)
    try:
        found = _assembled(scene, want)
    except (AssemblyError, MobilityError):
        return _assembled(replace(scene, assembly=dict(values)), want)
    if (
        scene.mechanism.space
        and scene.rounding
        and _misses(found[0], dict(values), iterated=False) > _SERVES
    ):
        with suppress(AssemblyError, MobilityError):
            return _assembled(replace(scene, assembly=dict(values)), want)
    return found


@functools.lru_cache(maxsize=64)
def _wanted(scene: Scene, names: tuple[str, ...]) -> Wanted:
    """Wanted outputs, by names. Raise :class:`DeclarationError` for a bar whose strength is asked
    for by name, and which has no direction for it.
    """
    want = Wanted.of(scene.mechanism, names)
    named = [name for name in names if name != "all"]
    for two_force_link in find_two_force_links(scene.guided, scene.laws) if named else ():
        asked = any(among(kind, [two_force_link.link.name], named) for kind in STRENGTH)
        if (
            asked
            and not two_force_link.aimed
            and two_force_link.link.beam is not None
            and not two_force_link.link.beam.round
        ):
            raise DeclarationError(unaimed(two_force_link.link.name))
    return want


@functools.lru_cache(maxsize=32)
def _assembled(scene: Scene, want: Wanted) -> tuple[Program, Scene]:
    """Derive a scene as it is declared; in space, if its loops do not close, with the rounding of
    its axes and places.
    """
    try:
        program = _program(scene, want)
    except (AssemblyError, MobilityError):
        if (near := _rounded(scene, want)) is None:
            raise
        return near
    except PostureError as error:
        error.scene = scene
        raise
    own = scene.mechanism.values(scene.assembly)
    misses = _misses(program, own, _ALONG, iterated=True) > FITS
    return (_rounded(scene, want) if misses else None) or (program, scene)


def _rounded(scene: Scene, want: Wanted) -> tuple[Program, Scene] | None:
    """Derive a scene whose axes and places may be off; None where its loops do not close within
    their rounding.
    """
    if not (scene.mechanism.space and scene.rounding):
        return None
    mechanism = copy.copy(scene.mechanism)
    mechanism.rounding = scene.rounding
    near = replace(scene, mechanism=mechanism)
    with suppress(AssemblyError, MobilityError):
        program, own = _program(near, want), mechanism.values(scene.assembly)
        if _misses(program, own, iterated=False) <= MISSES * scene.rounding:
            return replace(program, identity=identity_of(scene, want)), near
    return None


def _program(scene: Scene, want: Wanted) -> Program:
    """Read the Program of a scene from the cache folder, or derive it and keep it there."""
    identity = identity_of(scene, want)
    text = cache.read(f"{identity}.graph") if identity else None
    if text is not None:
        program = Program.loads(text)
        # Scenes of one name may differ in what follows from nothing that is derived.
        return replace(program, data=replace(program.data, timing=scene.timing()))
    program = replace(_derive(scene, want), identity=identity)
    if identity:
        cache.write(f"{identity}.graph", program.dumps())
    return program


def _misses(
    program: Program,
    values: Mapping[str, float],
    parts: Sequence[float] = (0.0,),
    *,
    iterated: bool,
) -> float:
    """Residual of loops with redundant equations, relative to the links' length, at the start or at
    several ``parts`` of the motion, as far as loops close: of all of them, or those ``iterated``.
    """
    rows = [
        row
        for name, row in program.checks("misfit").items()
        if program.iterates(name) or not iterated
    ]
    if not rows:
        return 0.0
    (start, stop), p, newton = program.data.span, list(values.values()), program.newton
    z, missed = ca.DM(newton.guess if newton else []), 0.0
    for t in (start + part * (stop - start) for part in parts):
        motion = program.motion(t, p)
        z, size = newton.closed(z, t, motion[0], p) if newton else (z, 0.0)
        if float(size) >= CLOSED:
            break
        out = program.instant(t, *motion, z, p)
        missed = max(missed, *(float(out[row]) for row in rows))
    return missed


def _joint_forces(
    moving: Moving, columns: Mapping[Column, Expression]
) -> tuple[dict[Column, Expression], ca.SX, Mapping[str, Expression]]:
    """The forces that are wanted, and those of ``columns`` that friction goes into, over the
    inputs; the symbols of what equilibrium leaves open in them; and the forces of frictions.
    """
    want = moving.want
    if not want.forces:
        return {}, ca.SX(0, 1), {}
    links = moving.scene.mechanism.links.values()
    forces, free, friction = internal_forces(moving.body, moving.solved, want, moving.scene)
    dependent = {
        key: value
        for key, value in columns.items()
        if friction.symbols.numel() and ca.depends_on(ca.SX(value), friction.symbols)
    }
    placed = ca.substitute(column(dependent.values()), friction.symbols, friction.values)
    pressed = dict(zip(dependent, entries(placed), strict=True))
    sampling = Sampling.of(moving.body).over(moving.solved.found)
    acting = gathered(forces, free, links, sampling) | pressed
    # Beside the start of the motion, for a drive through a gear moves little of what it drives, and
    # holds it all the same.
    for check in acting:
        if isinstance(check, Check) and check.kind == "hold":
            acting[check] = closure(acting[check], float(moving.begins(acting[check])))
    return acting, free, friction.forces


def _derive(scene: Scene, asked: Wanted) -> Program:
    mechanism = scene.mechanism
    want = feeling(mechanism, asked) if scene.elastic and asked.forces else asked
    want = _standing(mechanism, want) if mechanism.contacts and asked.forces else want
    moving = Moving.of(scene, want)
    columns, loop_angles = moving.columns()
    acting, free, frictions = _joint_forces(moving, columns)
    columns = {key: value for key, value in columns.items() if key not in acting}
    units = {
        Output("multiplier", equation.loop.name): extent(mechanism) / equation.unit
        for block, _ in moving.solved.systems
        for equation in block.equations
        if equation.loop.declared
    }
    own, units_of_own = user_outputs(moving, columns | acting, free, units)
    acting, units = acting | own, units | units_of_own
    least = _least_energy(scene, acting, free, frictions) if scene.elastic else None
    forces = (
        Forces.over(acting, free, units) if least is None else least.completed(acting, free, units)
    )
    forces = forces.with_those_of(lambda found: _strength(scene, asked, {**columns, **found}))
    columns |= forces.columns
    columns = (
        columns
        if want is asked
        else {key: value for key, value in columns.items() if _is_asked(key, asked)}
    )
    columns |= _contacts(mechanism.contacts, forces) if want.forces else {}
    instant = graph("instant", moving.solved.inputs, out=column(columns.values()))
    return Program(
        data=ModelData.of(scene, moving.laws),
        wanted=asked,
        instant=share_reciprocals(instant, "p"),
        newton=moving.solved.newton,
        columns=tuple(columns),
        loop_angles=loop_angles,
        completion=None
        if least is None
        else Completion.of(least, forces, columns, moving.solved.inputs),
    )


def _least_energy(
    scene: Scene,
    acting: Mapping[Column, Expression],
    free: ca.SX,
    frictions: Mapping[str, Expression],
) -> LeastEnergy | None:
    """Choose by least strain energy what equilibrium leaves open, ``free``; None where this is
    nothing.

    Raises :class:`.DeclarationError` where frictions follow it: what rubs is not linear in what
    presses on it.
    """
    for name, value in frictions.items():
        if ca.depends_on(ca.SX(value), free):
            raise DeclarationError(
                f"elastic: cannot be combined with friction '{name}', whose reaction is statically"
                " indeterminate; leave one of them out"
            )
    indeterminate = any(ca.depends_on(ca.SX(value), free) for value in acting.values())
    return least_energy(scene.mechanism, scene.elastic, acting, free) if indeterminate else None


def _strength(
    scene: Scene, want: Wanted, columns: Mapping[Column, ca.SX]
) -> dict[Column, Expression]:
    """Stresses, utilisation and deflections of the links of which they are wanted."""
    found: dict[Column, Any] = {}
    for name in want.stressed:
        found |= stresses(scene.mechanism, name, columns)
    if want.used or want.bent:
        values = scene.mechanism.values(scene.assembly)
        description = template(scene).at([*values.values()])
        for name in want.used:
            beam = scene.mechanism.links[name].beam
            assert beam is not None
            found |= utilisation(
                scene.mechanism, name, columns, beam.columns or effective_lengths(description, name)
            )
        for name in want.bent:
            found |= deflections(
                scene.mechanism, name, columns, ends="free" not in ends_of(description, name)
            )
    return found


def _standing(mechanism: Mechanism, want: Wanted) -> Wanted:
    """Add to what is wanted all contacts' forces, by which it is found which pull or slide."""
    reactions = {*want.reactions, *mechanism.contacts}
    own = {*want.own, *(f"{name}_{of}" for name in mechanism.contacts for of in _CONTACT.values())}
    return replace(
        want,
        reactions=tuple(name for name in mechanism.joints if name in reactions),
        own=tuple(name for name in mechanism.outputs if name in own),
    )


def _contacts(names: Sequence[str], forces: Forces) -> dict[Column, Expression]:
    """Checks of contacts' forces that must not be negative, zero where equilibrium leaves them
    open; and beside them the size of all normal forces.
    """
    found: dict[Column, Any] = {}
    total = sum((ca.fabs(forces.values[_of_contact(name, "pulls")]) for name in names), ca.SX(0))
    for name in names:
        for kind in _CONTACT:
            output = _of_contact(name, kind)
            known = forces.open.get(output, 0.0) <= OPEN["single"]
            found[Check(kind, f"contact '{name}'")] = known * forces.values[output]
        found[Check("rowsize", f"contact '{name}'")] = total
    return found


def _of_contact(name: str, kind: str) -> Output:
    return Output("output", f"{name}_{_CONTACT[kind]}")


def _is_asked(key: Column, asked: Wanted) -> bool:
    """Return whether a column was asked for; others are for strain energy or contacts alone."""
    output = key.part if isinstance(key, Check) else key
    if not isinstance(output, Output):
        return True
    if output.group == "reaction":
        return output.part in asked.reactions
    if output.group == "output":
        return output.part in asked.own
    return not output.along or output.part in asked.sections


def user_outputs(
    moving: Moving, found: Mapping[Column, ca.SX], free: ca.SX, units: Mapping[Output, Expression]
) -> tuple[dict[Column, ca.SX], dict[Output, ca.SX]]:
    """The user's outputs as expressions of an instant, where ``found`` are the columns that they
    may be made of; and by how much they change where each of these that changes with what is open,
    ``free``, does as a force of one: by its ``units``.
    """
    body, mechanism = moving.body, moving.body.mechanism
    asked = [
        asked
        for asked in mechanism.asked.values()
        if any(asked in mechanism.outputs[name].made_of for name in body.user_outputs)
    ]
    values = column(_value(mechanism.links, one, found, table_of(mechanism.space)) for one in asked)
    symbols = column(one.symbol for one in asked)
    placed = moving.solved.found.put_into(column(body.user_outputs.values()))
    kinds, length = template(moving.scene).content.kinds, extent(mechanism)
    changes = column(
        (length if one.output.unit(kinds) == MOMENT else units.get(one.output, 1))
        * ca.depends_on(value, free)
        for one, value in zip(asked, entries(values), strict=True)
    )
    beside = ca.fabs(ca.jacobian(placed, symbols)) @ changes
    made, beside = (ca.substitute(part, symbols, values) for part in (placed, beside))
    beside = ca.substitute(beside, free, SOME * ca.SX.ones(free.numel()))
    names = [Output("output", name) for name in body.user_outputs]
    own: dict[Column, ca.SX] = dict(zip(names, entries(made), strict=True))
    return own, dict(zip(names, entries(beside + (beside == 0)), strict=True))


def _value(
    links: Mapping[str, Link], asked: Asked, found: Mapping[Column, ca.SX], table: Table
) -> Expression:
    if asked.output.group == "section":
        link = links[asked.output.part]
        assert isinstance(link.mass, Density)
        section = Section(link.name, table, found, link.length, link.mass)
        # One graph serves both precisions.
        return section.at(asked.output.member, Place(asked.ratio), END["single"])
    if asked.output not in found:
        if asked.passive:
            return ca.SX(0)
        drives = ", ".join(
            str(key.part) for key in found if isinstance(key, Output) and key.group == "effort"
        )
        raise DeclarationError(
            f"an output is made of {asked.output}, but joint '{asked.output.part}' is not a drive;"
            f" drives: {drives}"
        )
    return found[asked.output]

"""A scene whose motion is solved, and what depends on no force: motions, poses and loads, and
checks of loops and curves.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ..base.arrays import Expression
from ..base.quantities import Check, Column, Output, force_members, motions_of
from ..base.scalars import column, entries
from ..base.tables import ANGLE
from ..base.vectors import ZERO, dot
from ..errors import DeclarationError
from ..model.beyond_ends import beyond_ends
from ..model.limits import parameters_note
from ..model.mechanism import Mechanism
from ..model.sampled_laws import Laws
from ..model.scene import Scene, Wanted
from . import kinematics
from .assembly import assemble
from .drives import pushed
from .iteration import Start
from .loop_turns import Guide, depends_on_turns
from .mobility import Action, needed_reactions
from .model_data import template
from .multibody import Coordinate, Multibody, own_coordinate
from .tree import span
from .two_force_links import across_link


@dataclass(frozen=True, eq=False)
class Moving:
    """A scene whose motion is solved: bodies and coordinates over time and the driven motion, and
    where the motion starts.

    ``deviations`` are the differences of unwrapped angles from the middle of their range.
    """

    scene: Scene
    want: Wanted
    body: Multibody
    laws: Laws
    start: Start
    solved: kinematics.Kinematics
    deviations: Mapping[str, Any]

    @classmethod
    def of(cls, scene: Scene, want: Wanted) -> Moving:
        """Assemble the mechanism, and solve its loops."""
        mechanism, tree = scene.mechanism, span(scene.guided, scene.laws)
        needed = needed_reactions(mechanism, want.reactions, want.sections)
        body = assemble(
            scene.guided,
            tree,
            scene.laws,
            needed,
            pushed(scene.needs_drives, scene.weights),
            want.own,
        )
        laws, start, solved = solved_motion(scene, body)
        deviations = _with_turns(body, solved, start, _seeing(body, want))
        return cls(scene, want, body, laws, start, solved, deviations)

    def begins(self, expression: Expression) -> Expression:
        """An expression in the inputs where the motion starts."""
        start, newton = self.start, self.solved.newton
        at_start = (
            start.t,
            *start.motion(start.t, start.parameters),
            newton.guess if newton else [],
            start.parameters,
        )
        return ca.Function("start", [*self.solved.inputs.values()], [expression])(*at_start)

    def columns(self) -> tuple[dict[Column, Expression], dict[Output, dict[Column, int]]]:
        """Columns that need no force: checks, motion and loads; and the sums of angles that loops
        determine.
        """
        columns, loop_angles = self._checks(), dict[Output, dict[Column, int]]()
        if self.want.motion:
            motions, loop_angles = self._motions()
            columns |= motions
        for part in reversed(self.body.applied):
            if part.source in self.want.loads:
                action = Action(part.force, part.couple)
                columns |= {
                    Output("load", part.source, member): action.member(member)
                    for member in force_members(self.scene.mechanism.space)
                }
        placed = self.solved.found.put_into(column(columns.values()))
        return dict(zip(columns, entries(placed), strict=True)), loop_angles

    def _checks(self) -> dict[Column, Expression]:
        """Checks that loops close, and that rows and curves are kept to."""
        body, solved = self.body, self.solved
        columns = _beyond(body, _seeing(body, self.want))
        measured = (
            (loop.name, ca.vertsplit(loop.counted))
            for loop in body.loop_equations
            if loop.counted is not None
        )
        columns |= {
            Check("seen", f"{name}:{k}"): value
            for name, values in measured
            for k, value in enumerate(values)
        }
        columns |= _locks(self.scene.mechanism, body, forces=self.want.forces)
        columns |= _rolls(body, self.want)
        columns |= {Check("stroke", what): 2.0 * used - 1.0 for what, used in body.strokes.items()}
        columns |= {Check("closure", name): closure for name, closure in solved.closures.items()}
        columns |= {Check("gap", name): residual for name, residual in solved.residuals.items()}
        columns |= {
            Check("misfit", name): redundancy_residual
            for name, redundancy_residual in solved.redundancy_residuals.items()
        }
        for program in body.rows:
            columns |= {
                Check("row", program.row.name): program.residual,
                Check("rowsize", program.row.name): program.size,
            }
        return columns | {
            Check("turned", name): deviation
            for name, deviation in {**solved.deviations, **self.deviations}.items()
        }

    def _motions(self) -> tuple[dict[Column, Expression], dict[Output, dict[Column, int]]]:
        """Motions and poses; and of angles that loops set, how often each coordinate's turns go
        into them.
        """
        mechanism, body, solved = self.scene.mechanism, self.body, self.solved
        motions = _motion_columns(mechanism, body)
        kinds = template(self.scene).content.kinds
        angles = [c for c in body.coordinates if c.kind == "angle"]
        wrapped: dict[Column, Any] = {
            _known_by(c): c.value for c in angles if c.name in solved.wrapped
        }
        counted: dict[Column, Any] = {
            Check("turns", c.name): c.value for c in angles if c.name not in solved.wrapped
        }
        reported = {
            output: value
            for output, value in motions.items()
            if output.member in ("", "angle") and output.unit(kinds) == ANGLE
        }
        loop_angles = {
            output: revolutions
            for output, revolutions in _turns(
                reported if wrapped else {}, wrapped | counted
            ).items()
            if not wrapped.keys().isdisjoint(revolutions)
        }
        loop_angles |= {output: {output: 1} for output in _within_a_turn(mechanism, body, motions)}
        whole = {check: ca.floor(value * (1 / math.tau)) for check, value in counted.items()}
        within = column(value - math.tau * whole[check] for check, value in counted.items())
        motions |= {
            output: ca.substitute(ca.SX(motions[output]), column(counted.values()), within)
            for output in loop_angles
        }
        columns = {
            check: value
            for check, value in whole.items()
            if any(check in revolutions for revolutions in loop_angles.values())
        }
        return columns | dict(motions.items()) | _unmeasured_angles(body, motions), loop_angles


def solved_motion(scene: Scene, body: Multibody) -> tuple[Laws, Start, kinematics.Kinematics]:
    """The laws of a scene's driven coordinates, where its motion starts, and its loops solved."""
    laws = scene.prescribed.only([c.name for c in body.coordinates if c.driven])
    values = list(scene.mechanism.values(scene.assembly).values())
    note = parameters_note(scene.mechanism.parameters, scene.assembly)
    start = Start(laws.motion, scene.span, values, note)
    posture = scene.mechanism.rough | dict(scene.posture)
    return laws, start, kinematics.solve(body, posture, start)


def _with_turns(
    body: Multibody, solved: kinematics.Kinematics, start: Start, used: Mapping[str, ca.SX]
) -> dict[str, Any]:
    """Note in the kinematics the angles that ``used`` expressions of loads and rows see, by their
    names; swings, by angle.

    At the start of the motion angles lie in (-pi, pi]. Those that are seen only where whole turns
    make no difference, as under a sine, are left there. Raises :class:`DeclarationError` for angles
    whose turns do not follow from those of drives.
    """
    angles = [c for c in body.coordinates if c.kind == "angle"]
    wrapped = column(c.value for c in angles if c.name in solved.wrapped)
    counted = solved.found.put_into(column(c.value for c in angles if c.name not in solved.wrapped))
    values: dict[str, Any] = {}
    users: dict[str, list[str]] = {}
    for turned in body.turned:
        users[turned.name] = [
            name for name, expression in used.items() if ca.depends_on(expression, turned.symbol)
        ]
        if not ca.depends_on(turned.angle, wrapped):
            values[turned.name] = turned.angle
        elif not any(depends_on_turns(used[name], turned.symbol) for name in users[turned.name]):
            values[turned.name] = turned.within
    uncounted = [turned for turned in body.turned if turned.name not in values]
    deviations: dict[str, Any] = {}
    guide = Guide.of(body, solved.inputs["d"], solved.inputs["z"], solved.newton, start)
    within = solved.found.put_into(column(turned.within for turned in uncounted))
    for turned, rule in zip(uncounted, guide.rules(within, counted), strict=True):
        if rule is None:
            raise DeclarationError(
                f"{', '.join(users[turned.name])}: the angle of '{turned.name}' enters with its"
                " number of revolutions, which cannot be determined from the drives; use its sine"
                " and cosine, or the angle of a drive"
            )
        c, s = (solved.found.put_into(part) for part in (turned.cosine, turned.sine))
        values[turned.name], deviations[turned.name] = rule.angle(c, s, counted)
    solved.found.note(
        column(turned.symbol for turned in body.turned),
        solved.found.put_into(column(values[turned.name] for turned in body.turned)),
    )
    return deviations


def _seeing(body: Multibody, want: Wanted) -> dict[str, Expression]:
    """The expressions of loads, rows and multipliers that are evaluated, by what they are of."""
    parts = [
        part for part in (*body.applied, *body.held) if want.forces or part.source in want.loads
    ]
    found = {
        f"row '{program.row.name}'": ca.vertcat(program.residual, program.size)
        for program in body.rows
    }
    found |= {f"output '{name}'": expression for name, expression in body.user_outputs.items()}
    for part in parts:
        kind = (
            "load"
            if part.source in body.mechanism.loads
            else "constraint"
            if part.source in body.mechanism.constraints
            else "row"
        )
        name = f"{kind} '{part.source}'"
        found[name] = ca.vertcat(found.get(name, ca.SX(0, 1)), *part.force, *part.couple)
    return found


def _beyond(body: Multibody, seeing: Mapping[str, Expression]) -> dict[Column, Expression]:
    """Distance of curves' arguments beyond their ends, by the constraint, load or row that uses the
    curve.
    """
    found = {
        f"constraint '{loop.name}'": loop.residual for loop in body.loop_equations if loop.declared
    }
    columns: dict[Column, Any] = {}
    for name, expression in (found | dict(seeing)).items():
        for k, (argument, far) in enumerate(beyond_ends(expression), 1):
            part = name if k == 1 else f"{name}, curve {k}"
            columns[Check("beyond", f"{part}: {argument}")] = far
    return columns


def _locks(mechanism: Mechanism, body: Multibody, *, forces: bool) -> dict[Column, Expression]:
    """Square of the cosine of the second angle of joints with three turns as coordinates: zero if
    the third axis is the first.

    There (gimbal lock) loops cannot set them, and they cannot give every couple. Their motion is
    evaluated where it is given.
    """
    found: dict[Column, Any] = {}
    for joint in mechanism.joints.values():
        known = [
            turn
            for axis in joint.axes
            if axis.kind == "angle" and (turn := own_coordinate(axis, body.coordinates)) is not None
        ]
        if len(known) == 3 and (forces or not all(turn.driven for turn in known)):
            found[Check("gimbal", joint.name)] = ca.cos(known[1].value) ** 2
    return found


def _rolls(body: Multibody, want: Wanted) -> dict[Column, Expression]:
    """Square of the sine of the angle of bars with their declared y direction: zero if the
    direction is undefined.

    Of those whose cross-section is not round, and whose sections are wanted.
    """
    found: dict[Column, Any] = {}
    for two_force_link in body.tree.two_force_links:
        link = two_force_link.link
        turned = two_force_link.aimed and link.beam is not None and not link.beam.round
        if turned and link.name in want.sections:
            part = across_link(two_force_link, body.frames[link.name].rotation.x)
            found[Check("roll", link.name)] = dot(part, part)
    return found


def _unmeasured_angles(body: Multibody, motions: Collection[Output]) -> dict[Column, Expression]:
    """Check of the turns of spherical joints, which are ``open`` in gimbal lock; the second angle
    is defined there.
    """
    columns: dict[Column, Any] = {}
    for spherical in body.sphericals:
        revolutions = [axis.coordinate for axis in spherical.joint.axes if axis.kind == "angle"]
        locked = body.turns_of(spherical).locked
        outputs = (output for name in revolutions for output in motions_of(name))
        columns |= {
            Check("open", output): locked
            for output in outputs
            if output != Output("motion", revolutions[1]) and output in motions
        }
    return columns


def _motion_columns(mechanism: Mechanism, body: Multibody) -> dict[Output, Expression]:
    columns: dict[Output, Any] = {}
    for name, (joint, axis) in mechanism.coordinates.items():
        if body.tree.measures(joint, axis):
            columns |= zip(motions_of(name), body.motion_along(joint, axis), strict=True)
    for part in mechanism.moving:
        frame = body.frames[part.name]
        place = zip("xyz" if mechanism.space else "xy", frame.place_of(ZERO), strict=False)
        columns |= {Output("pose", part.name, component): value for component, value in place}
        if part.oriented and mechanism.space:
            axes = (frame.rotation.x, frame.rotation.y, frame.rotation.z)
            columns |= {
                Output("pose", part.name, name + component): ca.SX(value)
                for name, axis in zip("xyz", axes, strict=True)
                for component, value in zip("xyz", axis, strict=True)
            }
        elif part.oriented:
            columns[Output("pose", part.name, "angle")] = frame.rotation.angle
    return columns


def _within_a_turn(
    mechanism: Mechanism, body: Multibody, motions: Collection[Output]
) -> list[Output]:
    """The angles of joints in space that are known by a direction alone: none of them is a
    coordinate of the tree.
    """
    angles = [
        axis
        for _, axis in mechanism.coordinates.values()
        if mechanism.space and axis.kind == "angle"
    ]
    measured = [
        Output("motion", axis.coordinate)
        for axis in angles
        if own_coordinate(axis, body.coordinates) is None
    ]
    return [output for output in measured if output in motions]


def _known_by(coordinate: Coordinate) -> Output:
    """The output that an angle that a loop sets is the same as."""
    return (
        Output("motion", coordinate.name)
        if coordinate.relative
        else Output("pose", coordinate.body, "angle")
    )


def _turns(
    angles: Mapping[Output, Expression], parts: Mapping[Column, Expression]
) -> dict[Output, dict[Column, int]]:
    """Multiples with which coordinates' angles enter other angles, by angle."""
    slopes = ca.evalf(ca.jacobian(column(angles.values()), column(parts.values()))).full()
    return {
        output: {part: int(slope) for part, slope in zip(parts, row, strict=True) if slope}
        for output, row in zip(angles, slopes, strict=True)
    }

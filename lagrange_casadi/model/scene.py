"""A scene: a mechanism, the motion it must make, and what is wanted of it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from types import MappingProxyType
from typing import Any, NoReturn, get_args

from ..base.arguments import Outputs, fitting, public, texts
from ..base.drawn import Drawing
from ..base.methods import method
from ..base.symbolic import Graphs, symbolic, symbolic_property
from ..base.units import Number, double, quantity
from ..base.vocabulary import Precision
from ..errors import (
    DeclarationError,
    ParameterError,
    PickleError,
    UnknownNameError,
    check_kind,
    check_known,
    listed,
    shown,
)
from .declared_parts import Expression, Parameter
from .even_points import EvenPoints, checked_ratios
from .guiding import guided, laws_of
from .limits import no_sections, parameters_note
from .link_density import Density
from .loads import Friction
from .mechanism import Mechanism
from .motion_laws import Motion
from .sampled_laws import Laws
from .scene_arguments import Elastic, compliant_links, links_with_beams, rough_posture, weighed
from .shaking import refuse_late
from .stretches import Timetable, timetable
from .times import Over, Times, Timing, span_of
from .validity import ParameterConstraints, demands
from .wanted_names import SENSITIVITY, among, others

_KINDS = ("reaction", "multiplier", "load", "friction", "section", "output")
STRENGTH = ("stress", "safety", "life", "deflection")
"""Outputs of links that have a beam: they follow from section forces, which are wanted with
them.
"""


@dataclass(frozen=True)
class Wanted:
    """Outputs by kind, each in the order of declaration whatever the order of wanting.

    ``stressed``, ``used`` and ``bent`` are links whose stress, utilisation and deflection are
    wanted at every instant.
    """

    effort: bool
    motion: bool
    reactions: tuple[str, ...]
    multipliers: tuple[str, ...]
    loads: tuple[str, ...]
    frictions: tuple[str, ...]
    sections: tuple[str, ...]
    own: tuple[str, ...]
    stressed: tuple[str, ...] = ()
    used: tuple[str, ...] = ()
    bent: tuple[str, ...] = ()

    @classmethod
    def of(cls, mechanism: Mechanism, names: Sequence[str]) -> Wanted:
        """Read names: ``effort``, ``motion``, ``reaction:JOINT``, ``multiplier:NAME``,
        ``load:NAME``, ``friction:NAME``, ``section:LINK``, ``output:NAME``, ``all``; and of links
        with a beam ``stress:LINK``, ``safety:LINK``, ``life:LINK``, ``deflection:LINK``.

        A kind alone, as ``section``, is all that the mechanism has of it. What an output of the
        user's own is made of is wanted with it. ``sensitivity`` and ``sensitivity:PARAMETER`` are
        of the other outputs that are wanted, and ``all`` is without.
        """
        every = outputs(mechanism)
        choices = [*every, *kinds(every)]
        if (listed := texts(names)) is None:
            raise DeclarationError(
                f"wanted: expected a list of output names, got {shown(names)}; valid:"
                f" {', '.join(choices)}"
            )
        names = listed
        for name in names:
            if name not in choices:
                _refuse_output(mechanism, name)
                raise UnknownNameError("output", name, choices)
            _check_material(mechanism, name)
        if names and not others(names):
            raise DeclarationError(
                f"output '{names[0]}': sensitivities need other outputs; add some to wanted, such"
                " as effort"
            )
        chosen = set(every if "all" in names else names)
        chosen |= {
            asked.wanted
            for name in among("output", mechanism.outputs, chosen)
            for asked in mechanism.outputs[name].made_of
        }
        beams = links_with_beams(mechanism)
        chosen |= {f"section:{link}" for kind in STRENGTH for link in among(kind, beams, names)}
        if fitted := among("safety", mechanism.fitted, names):
            chosen |= {"motion", *(f"reaction:{joint}" for joint in fitted)}
        chosen |= {
            f"friction:{name}"
            for name in among("load", mechanism.loads, chosen)
            if isinstance(mechanism.loads[name], Friction)
        }
        if not chosen:
            raise DeclarationError(f"no output wanted; valid: {', '.join(choices)}")

        def parts(kind: str) -> tuple[str, ...]:
            listed = (
                name for name in every if name.startswith(f"{kind}:") and chosen & {kind, name}
            )
            return tuple(name.partition(":")[2] for name in listed)

        named = [name for name in names if name != "all"]
        strength = (tuple(among(kind, beams, named)) for kind in ("stress", "safety", "deflection"))
        return cls("effort" in chosen, "motion" in chosen, *map(parts, _KINDS), *strength)

    @property
    def names(self) -> list[str]:
        """The names of outputs that are wanted, but for those of strength."""
        parts = (self.reactions, self.multipliers, self.loads, self.frictions, self.sections)
        return [
            *(name for name in ("effort", "motion") if getattr(self, name)),
            *(
                f"{kind}:{part}"
                for kind, of in zip(_KINDS, (*parts, self.own), strict=True)
                for part in of
            ),
        ]

    @property
    def forces(self) -> bool:
        """True if any force from equilibrium is wanted."""
        return bool(
            self.effort or self.reactions or self.multipliers or self.frictions or self.sections
        )


def outputs(mechanism: Mechanism) -> list[str]:
    """Every output that can be wanted of a mechanism."""
    links, loads = mechanism.links.items(), mechanism.loads.items()
    parts: list[tuple[str, Iterable[str]]] = [
        ("reaction", mechanism.joints),
        ("multiplier", (*mechanism.constraints, *mechanism.rows)),
        ("load", mechanism.loads),
        ("friction", [name for name, load in loads if isinstance(load, Friction)]),
        ("section", [name for name, link in links if isinstance(link.mass, Density)]),
        ("output", mechanism.outputs),
        *((kind, links_with_beams(mechanism)) for kind in STRENGTH),
        ("safety", mechanism.fitted),
        (SENSITIVITY, mechanism.parameters),
    ]
    named = (f"{kind}:{part}" for kind, each in parts for part in each)
    return ["all", "effort", "motion", *named]


def _check_material(mechanism: Mechanism, name: str) -> None:
    """Raise :class:`.DeclarationError` where a material lacks a number that what is wanted of a
    link needs.
    """
    kind, _, link = name.partition(":")
    if kind not in STRENGTH or link not in mechanism.links:
        return
    beam = mechanism.links[link].beam
    assert beam is not None
    needs = {
        "safety": ("elasticity", "yield_strength"),
        "life": ("ultimate", "endurance"),
        "deflection": ("elasticity",),
    }
    beam.material.needs(f"output '{name}'", *needs.get(kind, ()))


def kinds(names: Sequence[str]) -> list[str]:
    """Choose the kinds of output of which there are any among names, beside the efforts and the
    motion; each can be wanted.
    """
    return [
        kind
        for kind in (*_KINDS, *STRENGTH, SENSITIVITY)
        if any(name.startswith(f"{kind}:") for name in names)
    ]


def _refuse_output(mechanism: Mechanism, name: str) -> None:
    kind, _, part = name.partition(":")
    if name in (*_KINDS, *STRENGTH, SENSITIVITY):
        why = ", because no link has a beam=" if name in STRENGTH else ""
        raise DeclarationError(
            f"output '{name}': not an output of mechanism '{mechanism.name}'{why}; valid:"
            f" {', '.join(outputs(mechanism))}"
        )
    if kind in STRENGTH and part in mechanism.links:
        raise DeclarationError(
            f"output '{name}': link '{part}' has no beam=; links with a beam:"
            f" {', '.join(links_with_beams(mechanism)) or 'none'}"
        )
    if kind == "section" and part in mechanism.bodies:
        why = no_sections(part, link=part in mechanism.links, links=mechanism.links)
        raise DeclarationError(f"output '{name}': {why}")


@symbolic
@fitting
@dataclass(frozen=True, eq=False)
class Scene(Graphs):
    """A mechanism, the motion of its driven joints, and the outputs wanted over a grid of time and
    of section ratios.

    Parameters
    ----------
    mechanism
        The mechanism; it freezes here.
    motion
        The law of every driven joint, by the joint's name. Or the laws of x and y of a path's point
        [m], by the path's name, or of x, y and angle of a link's base and axis, by the link's name;
        these need ``drives``.
    wanted
        Output names, see :func:`outputs`, or kinds, as ``section`` for those of all links. Only
        these are derived, compiled and evaluated.
    t, xi
        Grids of time [s] and of the ratio xi/l: start, stop, count. Those of time may be
        expressions of parameters.
    over
        Instants in equal steps of a driven coordinate, in place of ``t``: the joint's name, start,
        stop [rad, or text such as ``"720 deg"``; or m] and count; start and stop may be expressions
        of parameters, and are in the order of time. The times follow from the joint's motion, which
        must not turn back on the way. If the motion's rate depends on time, the interval is taken
        that contains the start of ``t``.
    posture
        Rough directions of links and coordinates of joints at the first instant [rad, or text as
        ``"350 deg"``; m], by name, to choose between the ways in which a loop can be assembled.
    assembly
        Values of parameters with which loops are first assembled, in place of the defaults. The
        branch is chosen with them.
    drives
        The joints whose efforts produce the motion; by default those whose motion is given. If
        there are more drives than needed, the weighted sum of squares of their efforts is least: a
        mapping gives weights by joint, numbers or expressions of parameters; a list gives each the
        weight 1.
    elastic
        True if least strain energy of the links' beams shall determine the forces that equilibrium
        does not; or the names of the links that are elastic, and all others are rigid. Forces that
        go through a link without a beam stay indeterminate.
    rounding
        How far axes [rad] and places [of its size] in space may be off where loops do not close as
        declared, 0 to 1e-3. A loop may then miss by ten times that.

    Raises
    ------
    DeclarationError
        For what does not fit the mechanism.
    UnknownNameError
        For names that the mechanism does not have.
    ParameterError
        If the default parameters make a part impossible.
    """

    mechanism: Mechanism
    motion: Mapping[str, Motion | Sequence[Motion]]
    wanted: Sequence[str] = ("all",)
    t: Times = (0.0, 1.0, 101)
    xi: EvenPoints = (0.0, 1.0, 101)
    posture: Mapping[str, Any] = field(default_factory=dict)
    assembly: Mapping[str, float] = field(default_factory=dict)
    drives: Mapping[str, Expression] | Sequence[str] | None = None
    over: Over | None = None
    elastic: Elastic = False
    rounding: float = 1e-6

    def __post_init__(self) -> None:
        check_kind("scene", self.mechanism, "a Mechanism", Mechanism)
        put = partial(object.__setattr__, self)
        for what in ("motion", "posture", "assembly"):
            mapping = getattr(self, what)
            check_kind(what, mapping, "a mapping by name", Mapping)
            put(what, MappingProxyType(dict(mapping)))
        coordinates = self.mechanism.coordinates
        guides = [name for name in self.laws if name not in coordinates]
        if guides and self.drives is None:
            raise DeclarationError(
                f"motion of '{guides[0].partition('.')[0]}': a guided point or pose has no effort;"
                " list the joints that drive it in drives="
            )
        put("posture", MappingProxyType(rough_posture(self.mechanism, self.posture)))
        for row in self.mechanism.rows.values():
            if row.replaces not in self.motion:
                raise DeclarationError(
                    f"non-holonomic constraint '{row.name}' replaces the drive of joint"
                    f" '{row.replaces}', which has no motion"
                )
        if self.drives is not None:
            weights = weighed(self.mechanism, self.drives, self.needs_drives)
            put("drives", MappingProxyType(weights))
        put("elastic", compliant_links(self.mechanism, self.elastic))
        refuse_late(self.mechanism)
        self.mechanism.freeze()
        Wanted.of(self.mechanism, self.wanted)
        checked_ratios(self.xi)
        if (rounding := double(self.rounding)) is None or not 0.0 <= rounding <= 1e-3:
            raise DeclarationError(
                f"rounding: expected a number from 0 to 0.001, got {shown(self.rounding)}"
            )
        put("rounding", rounding)
        timing = self.timing()
        try:
            self.mechanism.values()
        except ParameterError as error:
            raise ParameterError(
                f"{error}{parameters_note(self.mechanism.parameters, {})}"
            ) from None
        numbers = self.mechanism.values(self.assembly)
        self.checked(numbers)
        put("assembly", MappingProxyType({name: numbers[name] for name in self.assembly}))
        if not timing.shared:
            self.span  # noqa: B018 - it refuses what has no instants

    @symbolic_property
    def laws(self) -> Mapping[str, Motion]:
        """The laws of motion by joint, those of the guides of points and poses too
        (:mod:`.guiding`).
        """
        return MappingProxyType(laws_of(self.mechanism, self.motion))

    @symbolic_property
    def prescribed(self) -> Laws:
        """These laws as functions of time and the parameters."""
        return Laws.of(self.laws, self.mechanism.symbols)

    @symbolic_property
    def guided(self) -> Mechanism:
        """The mechanism, with the guides of points and poses whose motion is given."""
        return guided(self.mechanism, self.motion)

    @property
    def needs_drives(self) -> tuple[str, ...]:
        """The joints whose motion needs an effort: those with a motion, but for what non-holonomic
        constraints replace.
        """
        replaced = {row.replaces for row in self.mechanism.rows.values()}
        return tuple(name for name in self.laws if name not in replaced)

    @property
    def weights(self) -> Mapping[str, Expression] | None:
        """The drives' weights by joint, in the order of the joints; None where efforts are where
        the motion is given.
        """
        return self.drives if isinstance(self.drives, Mapping) else None

    def __repr__(self) -> str:
        start, stop = self.t[:2]
        asked = (
            f"from {start} to {stop}{'' if isinstance(stop, str) else ' s'}"
            if self.over is None
            else f"over {self.over[0]} from {self.over[1]} to {self.over[2]}"
        )
        return (
            f"<Scene of {self.mechanism.name}: drives {listed(self.motion, 'nothing')}, wants"
            f" {listed(self.wanted)}, {self.timing().count} instants {asked}>"
        )

    def _repr_html_(self) -> str:
        """Show a drawing at the first instant and the parts, in a notebook."""
        return str(method("Scene._repr_html_")(self))

    @public
    def draw(
        self,
        path: str | os.PathLike[str] | None = None,
        *,
        t: Number | None = None,
        parameters: Mapping[str, float] | None = None,
    ) -> Drawing:
        """Draw the scene at an instant, whether its loops close or not.

        Parameters
        ----------
        path : path, optional
            The file, which ends in .svg or .png; by default none is written.
        t : float or str, optional
            The instant [s, or a text such as ``"20 ms"``]; by default the first one.
        parameters : mapping, optional
            Values by name; by default the parameters' defaults.

        Returns
        -------
        Drawing
            As of :meth:`.Mechanism.draw`.

        Raises
        ------
        DeclarationError
            For another ending, and for what is no instant.
        UnknownNameError
            For names that the mechanism does not have.
        ParameterError
            For values that are not finite, or out of their range.
        """
        at = None if t is None else quantity("t", t, "s")
        draw: Callable[..., Drawing] = method("Scene.draw")
        return draw(self, path, t=at, parameters=parameters)

    @public
    def report(
        self,
        path: str | os.PathLike[str],
        *,
        parameters: Mapping[str, float] | None = None,
        wanted: Outputs | None = None,
        live: bool = False,
    ) -> None:
        """Evaluate the scene, and write a page that shows it in a browser.

        Parameters
        ----------
        path : path
            The file, which ends in .html.
        parameters : mapping, optional
            Values by name; by default the parameters' defaults.
        wanted : sequence of str, optional
            Outputs, as of :func:`.evaluate`; motion is always wanted.
        live : bool
            True if the page shall evaluate other parameters.

        Raises
        ------
        DeclarationError
            For another ending; with ``live`` if there is no parameter to change.
        LagrangeCasadiError
            What :func:`.evaluate` and :meth:`.Solution.report` raise; with ``live`` if ziglang is
            missing.
        """
        method("Scene.report")(self, path, parameters, wanted, live)

    @property
    def name(self) -> str:
        """The name of its mechanism."""
        return self.mechanism.name

    @property
    def parameters(self) -> Mapping[str, Parameter]:
        """The parameters of its mechanism."""
        return self.mechanism.parameters

    @property
    def outputs(self) -> list[str]:
        """The names of all outputs that can be wanted."""
        return outputs(self.mechanism)

    @fitting
    def wants(self, names: Sequence[str] | None = None) -> Wanted:
        """Read names of outputs.

        Parameters
        ----------
        names : sequence of str, optional
            The names; by default those that the scene wants.

        Returns
        -------
        Wanted
            What they mean for this mechanism.

        Raises
        ------
        DeclarationError
            For what is no output, or lacks a beam or a number of its material.
        """
        return Wanted.of(self.mechanism, self.wanted if names is None else names)

    @public
    def values(self, parameters: Mapping[str, float] | None = None) -> dict[str, float]:
        """Return the values of all parameters: see :meth:`.Mechanism.values`.

        Parameters
        ----------
        parameters : mapping, optional
            Values by name; by default the parameters' defaults.

        Returns
        -------
        dict
            A value for every parameter.

        Raises
        ------
        UnknownNameError
            For a name that is not a parameter.
        ParameterError
            For values that are out of their range, or make a part impossible.
        """
        return self.mechanism.values(parameters)

    @fitting
    def with_elastic(self, elastic: Elastic | None) -> Scene:
        """Return the scene with another choice of elastic links.

        Parameters
        ----------
        elastic : bool, sequence of str or None
            As of the scene; None keeps its own.

        Returns
        -------
        Scene
            The scene, or itself if nothing changes.

        Raises
        ------
        UnknownNameError
            For what is no link.
        DeclarationError
            For a link without a beam, or with a material without elasticity.
        """
        gives = self.elastic if elastic is None else compliant_links(self.mechanism, elastic)
        return self if gives == self.elastic else _compliant(self, gives)

    @fitting
    def timing(self, t: Times | None = None, over: Over | None = None) -> Timing:
        """Define the instants.

        Parameters
        ----------
        t : (start, stop, count), optional
            Grid of time [s], in place of the scene's.
        over : (joint, start, stop, count), optional
            Steps of a driven coordinate [rad or m], in place of the scene's.

        Returns
        -------
        Timing
            The scene's own without either.

        Raises
        ------
        DeclarationError
            If both are given, and for what cannot be.
        """
        if t is not None and over is not None:
            raise DeclarationError(
                "t and over exclude each other: instants are in equal steps of time, or of a driven"
                " coordinate"
            )
        return Timing.of(
            self.guided,
            self.laws,
            self.t if t is None else t,
            self.over if t is None and over is None else over,
        )

    @symbolic_property
    def span(self) -> tuple[float, float]:
        """First and last instant [s], with the parameters with which the scene is assembled."""
        return span_of(self.prescribed, self.timing(), self.mechanism.values(self.assembly))

    @public
    def parameter_constraints(self, precision: Precision = "double") -> ParameterConstraints:
        """Return the conditions on the parameters, of parts and of moves of the motion.

        Parameters
        ----------
        precision : str
            Precision that determines their tolerance.

        Returns
        -------
        ParameterConstraints
            The conditions.
        """
        check_known("precision", [precision], get_args(Precision))
        parts = demands(self.mechanism, precision)
        moved = [demand for law in self.laws.values() for demand in law.parameter_constraints]
        return ParameterConstraints(parts.symbols, (*parts.each, *moved)) if moved else parts

    @public
    def checked(self, values: Mapping[str, float]) -> None:
        """Raise if a part or a move of the motion is impossible.

        Parameters
        ----------
        values : mapping
            Values of all parameters by name.

        Raises
        ------
        ParameterError
            Names the part, and the condition that does not hold.
        """
        if any(law.parameter_constraints for law in self.laws.values()):
            self.parameter_constraints().check(
                list(values.values()), lambda expression: self.mechanism.number(expression, values)
            )

    @public
    def timetable(self, name: str, parameters: Mapping[str, float] | None = None) -> Timetable:
        """Return the moves and dwells of a joint's motion in numbers.

        Parameters
        ----------
        name : str
            Name of the driven joint.
        parameters : mapping, optional
            Values by name; by default the parameters' defaults.

        Returns
        -------
        Timetable
            Its stretches with their largest speed, acceleration and jerk, and its jumps.

        Raises
        ------
        UnknownNameError
            If the joint has no motion.
        DeclarationError
            If its motion is not made of moves.
        """
        check_known("driven joint", [name], self.laws)
        law, values = self.laws[name], self.values(parameters)
        if not law.stretches:
            raise DeclarationError(
                f"the motion of joint '{name}' is not made of moves, so it has no timetable;"
                " expected a motion by moves()"
            )
        self.checked(values)
        return timetable(
            law.stretches, law.period, lambda expression: self.mechanism.number(expression, values)
        )

    def __reduce__(self) -> NoReturn:
        """Raise :class:`PickleError`."""
        raise PickleError(
            "a Scene cannot be pickled, because its expressions belong to this process; send a Case"
            " from load_case, or make the scene in the other process"
        )

    def __deepcopy__(self, _memo: object = None) -> Scene:
        """Itself: nothing of it changes."""
        return self

    __copy__ = __deepcopy__


@lru_cache(maxsize=32)
def _compliant(scene: Scene, elastic: Elastic) -> Scene:
    return replace(scene, elastic=elastic)


def margins(scene: Scene) -> list[str]:
    """Names of the margins of a scene's contacts, among its outputs."""
    return [f"output:{name}_margin" for name in scene.mechanism.contacts]


def strokes(scene: Scene) -> list[str]:
    """Names of the shares of strokes that are out, among a scene's outputs."""
    return [f"output:{name}_stroke" for name in scene.mechanism.strokes]

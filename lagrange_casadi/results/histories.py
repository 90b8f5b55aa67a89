"""Histories of a scene's outputs: named arrays over time, section forces over time and xi/l, and
peaks.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, NoReturn

import numpy as np
import numpy.typing as npt

from ..base.arguments import public
from ..base.arrays import Array, during
from ..base.brief import no_attribute
from ..base.quantities import Output, motions_of
from ..base.tables import Table, table_of
from ..engine.instants.evaluation_method import Provenance
from ..errors import DeclarationError, UnknownNameError, shown
from ..model.description import Description
from ..model.limits import no_sections
from ..model.times import DriveAxis
from .section_laws import law_of, made_of
from .statistics import Statistics
from .vector_sizes import largest, size_of
from .views import JointMotion, Pose, Reaction, Section

if TYPE_CHECKING:
    from typing_extensions import Self


@dataclass(frozen=True)
class Peak:
    """The value of a quantity that is largest in size, with its sign, in ``unit``, and where it is.

    ``t`` is its time [s]; ``xi`` the ratio xi/l of a section force, None of other quantities.
    ``value`` is NaN where the peak between the instants cannot be determined; ``least`` is then the
    largest size that was found. ``over`` is the coordinate [rad or m] of the drive by which
    instants were asked for, None where they were not.
    """

    name: str
    value: float
    unit: str
    t: float
    xi: float | None = None
    least: float | None = None
    over: float | None = None


@public
@dataclass(frozen=True, eq=False, repr=False)
class Histories:
    """The outputs of a scene over its instants, before anything is said of how good they are.

    ``outputs`` holds every array over time, each of shape (t,); :mod:`.base.tables` says what each
    means, its unit and its sign. ``t`` are the instants [s], ``xi`` the ratios xi/l of the section
    grids. ``indeterminate`` are outputs that equilibrium does not determine, because the mechanism
    is over-constrained: their values are NaN. :attr:`series` and :attr:`undetermined` are the same
    by full names. ``over`` is the coordinate of the drive by which the instants were asked for, or
    None.

    Methods that take a name raise :class:`.UnknownNameError` for one that there is not, and list
    those there are; :class:`.DeclarationError` for a section that was not evaluated.
    """

    if not TYPE_CHECKING:
        __getattr__ = no_attribute

    case: str
    t: Array
    xi: Array
    outputs: Mapping[Output, Array]
    description: Description
    provenance: Provenance
    indeterminate: tuple[Output, ...] = ()
    over: DriveAxis | None = None

    _known_as: ClassVar[str] = "a Solution"
    """Words of messages: users have no histories without evidence."""

    _over_time: ClassVar[tuple[str, ...]] = ("t", "over", "outputs")
    """The fields that have a value at every instant."""

    @cached_property
    def table(self) -> Table:
        """Table of quantities: that of planar mechanisms, or that of spatial ones."""
        return table_of(self.description.space)

    @cached_property
    def series(self) -> Mapping[str, Array]:
        """Every array over time, (t,), by full name: ``effort:O``, ``reaction:guide:fy``,
        ``section:link:law:n0``.
        """
        return {str(output): values for output, values in self.outputs.items()}

    @property
    def undetermined(self) -> tuple[str, ...]:
        """The full names of what equilibrium does not determine."""
        return tuple(map(str, self.indeterminate))

    def __getitem__(self, name: object) -> NoReturn:
        """Refuse brackets, and say what takes a name."""
        raise DeclarationError(
            f"{self._known_as} takes no brackets: expected .array({shown(name)})"
        )

    def effort(self, joint: str) -> Array:
        """Return the effort of the drive at a joint.

        Parameters
        ----------
        joint : str
            Name of the driven joint.

        Returns
        -------
        array (t,)
            Effort [N m or N], positive along the joint's coordinate.
        """
        return self._find("drive", Output("effort", joint))

    def reaction(self, joint: str) -> Reaction:
        """Return the reaction of a joint, without the drive's effort.

        Parameters
        ----------
        joint : str
            Name of the joint.

        Returns
        -------
        Reaction
            Force [N] and moments [N m] of the parent on the child, in ground axes.
        """
        fx, fy = (
            self._find("joint with a reaction", Output("reaction", joint, member))
            for member in ("fx", "fy")
        )
        mz, fz, mx, my = (
            self.outputs.get(Output("reaction", joint, member))
            for member in ("mz", "fz", "mx", "my")
        )
        return Reaction(fx, fy, mz, None if fz is None else (fz, mx, my))

    def motion(self, joint: str) -> JointMotion:
        """Return the motion of a joint's coordinate.

        Parameters
        ----------
        joint : str
            Name of the joint, or of one coordinate, as ``JOINT:slide_1``.

        Returns
        -------
        JointMotion
            Value [rad or m], rate and acceleration, each (t,).
        """
        return JointMotion(
            *(self._find("joint with a motion", output) for output in motions_of(joint))
        )

    def output(self, name: str) -> Array:
        """Return a user-defined output of the mechanism.

        Parameters
        ----------
        name : str
            Its name, without ``output:``.

        Returns
        -------
        array (t,)
            Its values, in the unit that it was declared with.
        """
        return self._find("user-defined output of the mechanism", Output("output", name))

    def pose(self, body: str) -> Pose:
        """Return place and direction of a link or point mass, in ground axes.

        Parameters
        ----------
        body : str
            Name of the body.

        Returns
        -------
        Pose
            Place of its base [m] and direction of its axis [rad], each (t,).
        """
        x, y = (
            self._find("body with a pose", Output("pose", body, member)) for member in ("x", "y")
        )
        angle, z = (self.outputs.get(Output("pose", body, member)) for member in ("angle", "z"))
        return Pose(x, y, angle, z, self._axes(body))

    def _axes(self, body: str) -> Array | None:
        """The axes of a body in ground axes (t, 3, 3), or None where it has no direction."""
        found = np.full((self.t.size, 3, 3), np.nan)
        for (i, axis), (k, component) in itertools.product(enumerate("xyz"), enumerate("xyz")):
            found[:, i, k] = self.outputs.get(Output("pose", body, axis + component), np.nan)
        return None if np.isnan(found[:, 0]).all() else found

    def section(self, link: str) -> Section:
        """Return the forces inside a link.

        Parameters
        ----------
        link : str
            Name of the link.

        Returns
        -------
        Section
            Axial force, shear force [N] and bending moment [N m], each (t, xi); in space torsion
            too.

        Raises
        ------
        DeclarationError
            If its sections were not evaluated, or only its mass, centre and inertia are known.
        """
        if link in self._sections:
            return self._sections[link]
        bodies = self.description.bodies
        if link not in bodies:
            raise UnknownNameError("link with sections", link, self._sections)
        if bodies[link].density is not None:
            raise DeclarationError(
                f"the sections of link '{link}' were not evaluated; add section:{link} too"
            )
        links = self.description.links
        raise DeclarationError(no_sections(link, link=link in links, links=links))

    @property
    def links_with_sections(self) -> tuple[str, ...]:
        """The links whose sections were wanted."""
        return tuple(self._sections)

    @cached_property
    def resting(self) -> npt.NDArray[np.bool_]:
        """Instants (t,) at which a joint with friction is at rest: what depends on its friction is
        NaN there.
        """
        found = np.zeros(self.t.size, dtype=bool)
        if self.description.has_friction:
            for output, values in self.outputs.items():
                if output not in self.indeterminate:
                    found |= np.isnan(values)
        return found

    def during(self, instants: slice | npt.NDArray[np.bool_]) -> Self:
        """Return the same at some of the instants.

        Parameters
        ----------
        instants : slice or array of bool (t,)
            The instants that stay.

        Returns
        -------
        Histories
            All arrays over time, cut to these; of a solution a solution.

        Raises
        ------
        DeclarationError
            If it is neither a slice nor a mask of the instants.
        """
        marked = (
            isinstance(instants, np.ndarray)
            and instants.dtype == bool
            and instants.shape == self.t.shape
        )
        if not (isinstance(instants, slice) or marked):
            raise DeclarationError(
                "during: expected a slice, or True or False for each instant, got"
                f" {shown(instants)}"
            )
        cut = {name: getattr(self, name) for name in self._over_time}
        return replace(self, **during(cut, instants))

    def determined(self, name: str | Output) -> bool:
        """Return whether equilibrium determines a quantity, at all instants.

        Parameters
        ----------
        name : str
            Full name, as ``effort:O`` or ``section:LINK:FORCE``.

        Returns
        -------
        bool
            True if it is not indeterminate.
        """
        output = self._output(name)
        if output.group == "section":
            return not made_of(self.indeterminate, output.part, output.member, self.table)
        return not any(
            component in self.indeterminate for component in output.components(self.table)
        )

    def made_of(self, output: Output) -> tuple[Output, ...]:
        """Return the components of a resultant, as far as the solution has them.

        Parameters
        ----------
        output : Output
            The output.

        Returns
        -------
        tuple of Output
            The components; any other output is made of itself.
        """
        components = output.components(self.table)
        return tuple(o for o in components if o in self.outputs) or components

    def quantities(self) -> Iterator[Output]:
        """All quantities, the coefficients of the laws left out and the section forces in their
        place.
        """
        yield from (output for output in self.outputs if not output.along)
        yield from (
            Output("section", link, force) for link in self._sections for force in self.table.forces
        )

    def names(self) -> Iterator[str]:
        """The full names of all quantities."""
        return map(str, self.quantities())

    def unit(self, name: str | Output) -> str:
        """Return the unit of a quantity, as ``N m``.

        Parameters
        ----------
        name : str
            Full name, as ``effort:O`` or ``section:LINK:FORCE``.

        Returns
        -------
        str
            Its unit.
        """
        output = self._output(name)
        if output.group not in ("certificate", "holding") and not self._series(output):
            self._of_section(output)
        return output.unit(self.description.kinds)

    def array(self, name: str | Output) -> Array:
        """Return a quantity.

        ``reaction:JOINT:resultant`` is the size of the force.

        Parameters
        ----------
        name : str
            Full name, as ``effort:O`` or ``section:LINK:FORCE``.

        Returns
        -------
        array (t,) or (t, xi)
            Its values; over xi too for a section force.
        """
        output = self._output(name)
        if values := self._series(output):
            return values[0] if len(values) == 1 else size_of(values)
        return self._of_section(output).array(output.member)

    def extremes(self, name: str | Output) -> tuple[Array, Array | None]:
        """Return a quantity at every instant, reduced along the link if it is a section force.

        Parameters
        ----------
        name : str
            Full name, as ``effort:O`` or ``section:LINK:FORCE``.

        Returns
        -------
        tuple of arrays (t,)
            Values, and their ratios xi/l: of a section force those largest in size along the link,
            with their sign. The ratios of any other quantity are None.
        """
        output = self._output(name)
        if output.group != "section":
            return self.array(output), None
        places, values = self._of_section(output).law.extreme(output.member)
        return values, places

    def peak(self, name: str | Output) -> Peak:
        """Return the value of a quantity that is largest in size over the instants.

        Along a link it is exact, whatever the grid of xi. Between the instants the quantity may be
        larger: :func:`.refine` gives the largest over all times.

        Parameters
        ----------
        name : str
            Full name, as ``effort:O`` or ``section:LINK:FORCE``.

        Returns
        -------
        Peak
            The value with its sign, its time and its ratio xi/l.
        """
        values, places = self.extremes(name)
        i = largest(values)
        xi = None if places is None else float(places[i])
        over = None if self.over is None else float(self.over.values[i])
        return Peak(str(name), float(values[i]), self.unit(name), float(self.t[i]), xi, over=over)

    def statistics(self, name: str | Output) -> Statistics:
        """Return the statistics of a quantity over the instants.

        Parameters
        ----------
        name : str
            Full name, as ``effort:O`` or ``section:LINK:FORCE``.

        Returns
        -------
        Statistics
            Mean, root mean square, smallest and largest value, and the peak.
        """
        output = self._output(name)
        if output.group == "section":
            return Statistics.along(
                str(output),
                self.unit(output),
                self.t,
                *self._of_section(output).law.reached(output.member),
            )
        return Statistics.over(str(output), self.unit(output), self.t, self.array(output))

    @cached_property
    def _sections(self) -> dict[str, Section]:
        bodies, precision = self.description.bodies, self.provenance.precision
        laws = {
            link: law_of(link, self.outputs, *bodies[link].length_and_density, precision)
            for link in dict.fromkeys(one.part for one in self.outputs if one.group == "law")
        }
        return {link: Section(law, self.xi) for link, law in laws.items()}

    def _output(self, name: str | Output) -> Output:
        try:
            output = Output.of(name)
            output.meant(self.table)
        except KeyError:
            raise UnknownNameError("quantity", str(name), self.names()) from None
        return output

    def _series(self, output: Output) -> list[Array]:
        """The series whose size a quantity is, or itself; none of a section force."""
        return [self.outputs[one] for one in self.made_of(output) if one in self.outputs]

    def _of_section(self, output: Output) -> Section:
        """The section that a section force is of."""
        if output.group != "section":
            raise UnknownNameError("quantity", str(output), self.names())
        return self.section(output.part)

    def multiplier(self, name: str) -> Array:
        """Return the multiplier of a constraint or a non-holonomic constraint.

        Its force is + lambda dPhi/dq along the coordinates of Phi (paper, eq. 2).

        Parameters
        ----------
        name : str
            Name of the constraint.

        Returns
        -------
        array (t,)
            The multiplier, in the unit of power over Phi'.
        """
        return self._find("constraint or row with a multiplier", Output("multiplier", name))

    def _find(self, kind: str, output: Output) -> Array:
        if not isinstance(output.part, str) or output not in self.outputs:
            raise UnknownNameError(
                kind,
                str(output.part),
                dict.fromkeys(o.part for o in self.outputs if o.group == output.group),
            )
        return self.outputs[output]

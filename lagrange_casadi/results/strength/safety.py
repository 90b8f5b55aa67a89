"""Is a link strong enough: factors of safety against yielding, buckling and fatigue, what governs,
and how long it lasts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...base.arguments import public
from ...base.brief import Brief
from ...engine import buckling as columns
from ...engine.buckling import Column
from ...errors import check_known
from ...model.description import Description
from ...model.end_conditions import effective_lengths
from ..histories import Histories
from .critical_plane import FINDLEY, critical_plane, plane_factor, plane_score
from .fatigue import CRITERIA, damage_score, lacking, loaded, use_score, used
from .fibres import worst
from .member import Member
from .stress import Stress, StressPeak


@dataclass(frozen=True)
class Verdict:
    """A factor of safety against a way to fail: by how much all loads may grow; and where it is
    decided, in words.
    """

    against: str
    factor: float
    where: str


@public
@dataclass(frozen=True, repr=False)
class Safety(Brief):
    """The factors of safety of a link; ``not_evaluated`` are those that are missing, each with its
    reason.
    """

    link: str
    verdicts: tuple[Verdict, ...]
    not_evaluated: tuple[str, ...] = ()

    @property
    def governs(self) -> Verdict:
        """The smallest of them."""
        return min(self.verdicts, key=lambda verdict: verdict.factor)

    @property
    def factor(self) -> float:
        """The smallest factor of safety."""
        return self.governs.factor

    @property
    def utilisation(self) -> float:
        """One over the smallest factor of safety: above 1 the link fails."""
        return 1.0 / self.factor if self.factor > 0.0 else math.inf

    def against(self, what: str) -> float:
        """Return a factor of safety.

        Parameters
        ----------
        what : {"yield", "buckling", "fatigue"}
            The failure.

        Returns
        -------
        float
            The factor; NaN if it was not evaluated.
        """
        return next(
            (verdict.factor for verdict in self.verdicts if verdict.against == what), math.nan
        )


@dataclass(frozen=True)
class Life:
    """Fatigue life of a link, its span of time repeated: ``damage`` by Miner's sum of one span,
    ``cycles`` and ``hours`` until it is 1, infinite where no swing is above the endurance limit;
    and where, by ratio xi/l and fibre.

    A life below a thousand cycles follows from a line that begins there, and is a rough estimate.
    """

    link: str
    damage: float
    cycles: float
    hours: float
    xi: float
    fibre: str


@public
def stress(solution: Histories, link: str) -> Stress:
    """Return the stresses in a link.

    Parameters
    ----------
    solution : Solution
        Has the section forces of the link.
    link : str
        Name of a link with a beam.

    Returns
    -------
    Stress
        Normal, shear, von Mises and Tresca stresses at every instant, ratio xi/l and fibre.

    Raises
    ------
    DeclarationError
        If the link has no beam or no sections, or its forces are indeterminate.
    """
    return Stress(Member.of(solution, link))


@public
def safety(
    solution: Histories,
    link: str,
    *,
    criterion: str = "goodman",
    yield_criterion: str = "von_mises",
) -> Safety:
    """Return the factors of safety of a link against yielding, buckling and fatigue.

    Parameters
    ----------
    solution : Solution
        Has the section forces of the link.
    link : str
        Name of a link with a beam.
    criterion : str
        Fatigue: treatment of mean stresses, one of :data:`.CRITERIA`, or ``"findley"`` for the
        critical plane.
    yield_criterion : str
        ``"von_mises"`` or ``"tresca"``.

    Returns
    -------
    Safety
        The factors over all instants. Yielding uses nominal stresses, as for ductile parts; fatigue
        includes the factors of notches. Fatigue is not evaluated if the material has no endurance
        limit or lacks the strength that the criterion needs.

    Raises
    ------
    DeclarationError
        If the material lacks another number that is needed, the link has no beam, or its forces are
        indeterminate.
    UnknownNameError
        For another criterion or kind of stress.
    """
    member = Member.of(solution, link)
    return rated(
        member,
        as_column(solution.description, member),
        criterion=criterion,
        yield_criterion=yield_criterion,
    )


def rated(
    member: Member,
    of: Column,
    *,
    criterion: str = "goodman",
    yield_criterion: str = "von_mises",
    enough: float = 0.0,
) -> Safety:
    """Safety of a link in numbers; results after a factor that is not ``enough`` are left out."""
    check_known("fatigue criterion", [criterion], (*CRITERIA, FINDLEY))
    member = member.counted
    missing, verdicts = lacking(member.beam.material, criterion), list[Verdict]()
    for verdict in (
        lambda: yielded(member, Stress(member).peak(yield_criterion)),
        lambda: buckling(member, of),
        *(() if missing else (lambda: tired(member, criterion),)),
    ):
        verdicts.append(verdict())
        if verdicts[-1].factor < enough:
            return Safety(member.link, tuple(verdicts))
    return Safety(member.link, tuple(verdicts), (missing,) if missing else ())


def tired(member: Member, criterion: str) -> Verdict:
    """The factor of safety of a link against fatigue."""
    material = member.beam.material
    if criterion == FINDLEY:
        found = worst(member, plane_score())
        plane = critical_plane(found.history)
        value = plane_factor(plane, material)
        text = (
            f"{plane.amplitude / 1e6:.4g} MPa in shear and {plane.normal / 1e6:.4g} MPa across, on"
            f" a plane at {math.degrees(plane.angle):.0f} deg to the cross-section, by {criterion}"
        )
    else:
        found = worst(member, use_score(material, criterion))
        value = 1.0 / found.score if found.score else math.inf
        cycles = loaded(found.history)
        k = int(np.argmax(used(cycles.amplitude, cycles.mean, material, criterion)))
        text = (
            f"mean {cycles.mean[k] / 1e6:.4g} MPa, amplitude {cycles.amplitude[k] / 1e6:.4g} MPa by"
            f" {criterion}"
        )
    notch = ", notch" if found.strips.notch else ""
    at = f"at xi/l = {found.xi:.4f}, {found.fibre}{notch}"
    return Verdict("fatigue", value, f"{text} {at}")


def as_column(description: Description, member: Member) -> Column:
    """A link as a column, by the effective lengths of its beam or its joints."""
    effective = member.beam.columns or effective_lengths(description, member.link)
    return Column.of(member.cross, member.law.length, effective)


def yielded(member: Member, peak: StressPeak) -> Verdict:
    """The factor of safety of a link against yielding, by the peak of a stress."""
    (strength,) = member.beam.material.needs("safety against yielding", "yield_strength")
    where = (
        f"{peak.kind} {peak.value / 1e6:.4g} MPa at t = {peak.t:.5g} s, xi/l = {peak.xi:.4f},"
        f" {peak.fibre}"
    )
    return Verdict("yield", strength / abs(peak.value) if peak.value else math.inf, where)


def buckling(member: Member, of: Column) -> Verdict:
    """The factor of safety of a link against buckling, with the largest moment along it at every
    instant.
    """
    law = member.law
    compression = -law.reached("axial")[1][0]
    names = ("bending_z", "bending_y") if member.space else ("bending",)
    moments = [np.abs(law.extreme(name)[1]) for name in names]
    with np.errstate(divide="ignore", invalid="ignore"):
        used = columns.used(of, compression, moments)
    k = int(np.argmax(used))
    if not used[k]:
        return Verdict("buckling", math.inf, "nothing is compressed")
    axis = int(np.argmin(of.critical))
    mode = (
        ("along y", "along z")[axis] if member.space else ("in the plane", "out of the plane")[axis]
    )
    kind = "Euler" if of.critical[axis] >= of.euler[axis] * (1.0 - 1e-12) else "Johnson"
    load = f"{kind}'s {of.critical[axis]:.4g} N {mode}, slenderness {of.slenderness[axis]:.3g}"
    return Verdict(
        "buckling",
        1.0 / float(used[k]),
        f"{load}; {compression[k]:.4g} N and {moments[0][k]:.4g} N m at t = {member.t[k]:.5g} s",
    )


@public
def life(solution: Histories, link: str, *, criterion: str = "goodman") -> Life:
    """Return the fatigue life of a link whose span of time is repeated.

    Parameters
    ----------
    solution : Solution
        Has the section forces of the link.
    link : str
        Name of a link with a beam.
    criterion : str
        Treatment of mean stresses, one of :data:`.CRITERIA`.

    Returns
    -------
    Life
        Cycles (one is the span) and hours, and the place that fails first.

    Raises
    ------
    DeclarationError
        If the material has no endurance limit or lacks another number, or if the link has no beam
        or its forces are indeterminate.
    UnknownNameError
        For another criterion.

    Notes
    -----
    Rainflow counting (ASTM E1049), the mean by the criterion, Miner's sum with the S-N line.
    """
    member = Member.of(solution, link).counted
    material = member.beam.material
    material.needs("a life", "endurance", "ultimate")
    found = worst(member, damage_score(material, criterion))
    damage = max(found.score, 0.0)
    many = 1.0 / damage if damage else math.inf
    span = float(solution.t[-1] - solution.t[0])
    return Life(link, damage, many, many * span / 3600.0, found.xi, found.fibre)

"""Is rigid inverse dynamics enough for a link: its first bending frequency beside the harmonics of
its own bending.

The bending moments of rigid links bend the first mode, over a cycle. Each of its harmonics, of
frequency f, swings 1/(1 - (f/f_1)^2) times as far (Timoshenko, Young and Weaver, *Vibration
Problems in Engineering*, forced vibration without damping). What this changes is by how much the
forces of rigid links are off.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...base.arguments import public
from ...base.arrays import Array
from ...base.brief import Brief
from ...engine.strains import moduli_of
from ...errors import DeclarationError
from ...model.description import BodyNumbers
from ...model.end_conditions import ENDS, Ends, ends_of
from ..histories import Histories
from ..strength.member import Member
from .bending_modes import Mode, first_mode

ENOUGH = 0.1
"""Relative error of bending up to which rigid links are enough."""

_CYCLE = 1e-3
_UNEVEN = 1e-6
_SLIGHT = 1e-12
_FEWEST = 4


@dataclass(frozen=True, repr=False)
class Vibration(Brief):
    """The first bending frequency of a link [Hz], and what it means for forces that were computed
    with rigid links.

    The frequency is between ``lower``, None where a link can move as a whole, and ``frequency``;
    for a link with such ``ends``, at base and tip, alone: what hangs on it lowers the frequency.
    Both are infinite for a link without mass. ``cycle`` is how often a second the span of time is
    repeated. ``excess`` is the largest difference that swinging makes to bending, over the largest
    bending; ``harmonic`` the multiple of the cycle that makes most of it. These are None where the
    span is no cycle, and ``reason`` says why. ``harmonics`` are the amplitudes of bending in the
    first mode, the mean first, over the largest bending: in space in the plane that swings most.
    """

    link: str
    ends: Ends
    frequency: float
    lower: float | None
    cycle: float | None = None
    harmonic: int | None = None
    excess: float | None = None
    reason: str = ""
    harmonics: tuple[float, ...] = ()

    @property
    def enough(self) -> bool | None:
        """True if rigid links are enough: bending is off by a tenth at most.

        None where it cannot be decided.
        """
        return None if self.excess is None else self.excess <= ENOUGH

    @property
    def words(self) -> str:
        """Result in a sentence."""
        if math.isinf(self.frequency):
            return "no bending frequency of its own, because it has no mass"
        text = f"first bending frequency {self.frequency:.5g} Hz, {' and '.join(self.ends)}"
        if self.cycle is None or self.harmonic is None or self.excess is None:
            return f"{text}; {self.reason}"
        text += f", {self.frequency / self.cycle:.4g} times that of the cycle"
        off = f"{100 * self.excess:.3g} %" if self.excess < 10 else "many times"
        if self.enough:
            return f"{text}; resonance changes its bending by {off} at most"
        which = f"harmonic {self.harmonic}, {self.harmonic * self.cycle:.5g} Hz"
        return f"{text}; rigid links are not enough: {which}, changes its bending by {off}"


@public
def vibration(solution: Histories, link: str, ends: Ends | None = None) -> Vibration:
    """Return the first bending frequency of a link, and whether rigid links are enough for it.

    Parameters
    ----------
    solution
        A solution with the link's section forces.
    link
        Name of a link with a beam.
    ends
        Supports of base and tip, each "pinned", "clamped", "free" or "guided", which holds the
        slope alone. By default they follow from the joints, as for columns: a link that is pinned
        at both ends is pinned; if one end is held, by a weld, a slide or the drive of a pin, the
        other end is free sideways.

    Returns
    -------
    Vibration
        Frequency [Hz], in space that of the softer plane of bending, and the error of bending
        moments by resonance.

    Raises
    ------
    DeclarationError
        If the link has no beam, its sections were not evaluated, its forces are indeterminate, its
        material has no elasticity, or ``ends`` has other words.
    """
    if ends is not None and not (
        isinstance(ends, Sequence) and len(ends) == 2 and all(end in ENDS for end in ends)
    ):
        raise DeclarationError(
            f"vibration of '{link}': expected how base and tip are held, two of {', '.join(ENDS)},"
            f" got {ends!r}"
        )
    member = Member.of(solution, link)
    elasticity, _ = moduli_of(member.beam, f"vibration of '{link}'", space=member.space)
    held = ends or ends_of(solution.description, link)
    body = solution.description.bodies[link]
    many = 2 if member.space else 1
    planes = [_plane(member, elasticity, body, held, number) for number in range(many)]
    modes, forces = zip(*planes, strict=True)
    softest, t = min(modes, key=lambda mode: mode.upper), solution.t
    lower = None if softest.lower is None else softest.lower / math.tau
    found = Vibration(link, held, softest.upper / math.tau, lower)
    whole = float(np.max(np.abs(forces)))
    if reason := _no_cycle(t, forces, whole):
        return replace(found, reason=reason)
    cycle = 1.0 / float(t[-1] - t[0])
    swung = [_swung(force[:-1], cycle, mode.upper / math.tau, whole) for mode, force in planes]
    excess, harmonic, shares = max(swung, key=lambda one: one[0])
    return replace(found, cycle=cycle, harmonic=harmonic, excess=excess, harmonics=shares)


def swinging(solution: Histories) -> Iterator[str]:
    """Names of the links whose deflections are series in a solution, and for which rigid links are
    not enough.
    """
    for output in solution.outputs:
        if output.group == "deflection" and solution.determined(output):
            found = vibration(solution, output.part)
            if found.enough is False:
                yield f"link '{output.part}': {found.words}"


def _plane(
    member: Member, elasticity: float, body: BodyNumbers, ends: Ends, number: int
) -> tuple[Mode, Array]:
    """The first mode in a plane of bending; and its load, (t,): the sum of bending moments times
    curvature, as large as moments are.
    """
    length, density = body.length_and_density
    breaks = tuple(sorted({*member.beam.course.breaks, *density.breaks}))
    middle = _stiffness(member, elasticity, np.array([0.5]))[..., 0]
    axis = np.linalg.eigh(middle)[1][:, number]

    def stiffness(u: Array) -> Array:
        found = _stiffness(member, elasticity, u.ravel())
        return np.asarray(np.einsum("i,ijn,j->n", axis, found, axis)).reshape(u.shape)

    mode = first_mode(stiffness, lambda u: density.at(u) / length, length, breaks, ends)
    u = np.broadcast_to(mode.u, (member.t.size, mode.u.size))
    bending = member.forces[-axis.size :]
    moments = sum(part * member.law.at(name, u) for part, name in zip(axis, bending, strict=True))
    return mode, np.asarray(moments @ (mode.weights * mode.curvature))


def _stiffness(member: Member, elasticity: float, u: Array) -> Array:
    """Bending stiffness at ratios (n,): in the plane (1, 1, n), in space of the curvatures about y
    and z, (2, 2, n).
    """
    many = 2 if member.space else 1
    found = np.empty((many**2, u.size))
    for here, p in member.properties(u):
        plane = (p.iz - p.iyz**2 / p.iy,)
        for k, value in enumerate((p.iy, -p.iyz, -p.iyz, p.iz) if many > 1 else plane):
            found[k, here] = elasticity * value
    return found.reshape(many, many, -1)


def _no_cycle(t: Array, forces: Sequence[Array], whole: float) -> str:
    """Reason why there are no harmonics; empty if there are."""
    if t.size < _FEWEST:
        return "harmonics need more instants"
    steps = np.diff(t)
    if steps.max() - steps.min() > _UNEVEN * (t[-1] - t[0]):
        return "harmonics need equally spaced instants"
    if any(abs(force[-1] - force[0]) > _CYCLE * whole for force in forces):
        return "harmonics need a whole cycle: the last bending moment differs from the first"
    return ""


def _swung(
    force: Array, cycle: float, frequency: float, whole: float
) -> tuple[float, int, tuple[float, ...]]:
    """The largest difference that swinging makes, over the largest bending; the harmonic that makes
    most of it; and all of them.
    """
    if whole == 0.0:
        return 0.0, 1, ()
    harmonics = np.fft.rfft(force) / force.size
    # What rounding leaves of a harmonic resonates with nothing.
    harmonics[np.abs(harmonics) <= _SLIGHT * whole] = 0.0
    ratio = np.arange(harmonics.size) * cycle / frequency
    with np.errstate(divide="ignore", invalid="ignore"):
        more = np.where(harmonics == 0.0, 0.0, harmonics * (ratio**2 / (1.0 - ratio**2)))
    most, shares = int(np.argmax(np.abs(more))), np.abs(harmonics) / whole
    shares[1:] *= 2.0
    excess = math.inf
    if np.isfinite(more).all():
        excess = float(np.abs(np.fft.irfft(more * force.size, force.size)).max() / whole)
    return excess, most, tuple(shares.tolist())

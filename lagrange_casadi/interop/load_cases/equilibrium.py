"""Forces on one link at the instants that govern, on its own axes, in equilibrium with its inertia.

They are the actions by which the certificate balances bodies, so nothing of the derivation is used.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Annotated

import numpy as np
import numpy.typing as npt

from ...base.arguments import Row, public
from ...base.arrays import Array
from ...engine.derive import compile_scene
from ...errors import CertificateError, DeclarationError, check_known
from ...model.description import BodyNumbers, Triple
from ...model.scene import Scene
from ...model.stated import Stated
from ...results.solution import Solution
from ...results.verification.balance import Action, all_actions, forces_needed
from ...results.verification.certificate import placed_of, reported_of
from ...results.verification.instant_vectors import NIL, constant, cross, resolve, size
from ...results.verification.placing import Moving, Placed
from ...studies.case import Case, scene_of
from .load_case import Load, LoadCase, on_own_axes, refused

_SLIGHT = 1e-9
"""Share of the largest load below which a peak is rounding, and governs nothing."""

_NEAR = 1e-9
"""Distance of a time from an instant, as a share of the last instant, that counts as none."""

_Instants = npt.NDArray[np.bool_]
"""Some instants, as a mask of all."""


@public
def link_load_cases(
    solution: Solution,
    link: str,
    t: Annotated[Row, "s"] | None = None,
    scene: Scene | Case | None = None,
) -> tuple[LoadCase, ...]:
    """Return load cases of a link or rigid body, for finite elements.

    Parameters
    ----------
    solution
        A solution with ``motion`` and all forces on the link: ``effort``, ``reaction``, ``load``,
        ``multiplier``.
    link
        Name of the link, rigid body or point mass.
    t
        Instants of the solution [s]. Default: those at which a section force or a stress of the
        link, or the force or moment of a joint on it, is largest in size; those at which friction
        at rest leaves forces indeterminate are left out.
    scene
        The scene, for a mechanism with constraints: along which directions they act is not in a
        solution.

    Returns
    -------
    tuple of LoadCase
        One for each instant, in order of time.

    Raises
    ------
    UnknownNameError
        If there is no such link.
    DeclarationError
        For outputs that were not evaluated, reactions that equilibrium does not determine,
        constraints without ``scene``, and times that are no instants.
    CertificateError
        If the loads are not in equilibrium within the tolerance of the solution.
    """
    described = solution.description.bodies
    check_known("link", [link], described)
    declared, stated = solution.description, _stated(solution, link, scene)
    needed = forces_needed(declared, link)
    if missing := [f"{one.group}:{one.part}" for one in needed if one not in solution.outputs]:
        raise DeclarationError(
            f"load cases of link '{link}' need {', '.join(missing)}, which the solution does not"
            " have; evaluate with wanted=['all']"
        )
    if (placed := placed_of(declared, stated, reported_of(solution, {}))) is None:
        why = "the motion is missing; evaluate with wanted=['motion', ...], or ['all']"
        raise refused(link, why)
    numbers = None if t is None else _numbers(solution, link, t)
    loads, body = _loads_on(placed, link), described[link]
    known = _known(solution, link, loads, numbers)
    placing = placed.bodies[link]
    vectors = placing.origin[2], *placing.spin, placed.reported.straight(declared.gravity)
    *moved, gravity = (resolve(placing.axes, vector) for vector in vectors)
    motion = on_own_axes(*moved)
    residual, largest = _residual(body, motion, gravity, loads, known)
    if numbers is None:
        scales = {"N": largest, "N m": largest * declared.size, "Pa": 0.0}
        governing = _governing(_peaks(solution, link, loads), known, scales)
    else:
        governing = {i: [] for i in numbers}
    found = []
    for i, governs in sorted(governing.items()):
        case = LoadCase(
            link=link,
            t=float(solution.t[i]),
            governs=tuple(governs),
            loads=tuple(
                Load(one.name, _at(one.at, i), _at(one.force, i), _at(one.couple, i))
                for one in loads
            ),
            acceleration=_at(motion.origin[2], i),
            omega=_at(motion.spin[0], i),
            alpha=_at(motion.spin[1], i),
            gravity=_at(gravity, i),
            mass=body.whole.mass,
            centre=body.whole.centre,
            inertia=body.whole.inertia,
            residual=(float(residual[0, i]), float(residual[1, i])),
            rod=body if body.beam else None,
        )
        if not all(one <= solution.tolerance for one in case.residual):
            raise CertificateError(
                f"load case of link '{link}' at t = {case.t:.6g} s is not in equilibrium: residuals"
                f" of force {case.residual[0]:.2g} and moment {case.residual[1]:.2g}, but at most"
                f" {solution.tolerance:.2g} is rounding"
            )
        found.append(case)
    return tuple(found)


def _stated(solution: Solution, link: str, scene: Scene | Case | None) -> Stated:
    """Return the constraints of the mechanism, if there are some, and all that stands beside
    them.
    """
    declared = solution.description
    if not declared.multipliers:
        return Stated()
    expected = "expected scene=, the scene of the solution"
    if scene is None:
        names = ", ".join(declared.multipliers)
        why = f"a solution does not say along which directions {names} act; {expected}"
        raise refused(link, why)
    values = declared.values
    if [*scene_of(scene).parameters] == [*values]:
        data = compile_scene(scene_of(scene), ["motion"], parameters=values).data
        found = data.at([*values.values()])
        stated = data.stated.at([*values.values()])
        own, known = found.plain(), declared.plain()
        if (own["bodies"], own["joints"]) == (known["bodies"], known["joints"]):
            return stated
    raise refused(link, f"{expected}; the one given has other parameters, bodies or joints")


def _loads_on(placed: Placed, link: str) -> list[Action]:
    """Return loads on a link, on its axes; of one name, those at one place are added up."""
    motion, found = placed.bodies[link], dict[str, Action]()
    for one in all_actions(placed):
        if not (sign := one.sign_on(link)):
            continue
        at, number, name = resolve(motion.axes, one.at - motion.at), 1, one.name
        force, couple = (resolve(motion.axes, sign * acts) for acts in (one.force, one.couple))
        while name in found and np.any(found[name].at != at):
            number, name = number + 1, f"{one.name}:{number + 1}"
        if name in found:
            force, couple = found[name].force + force, found[name].couple + couple
        found[name] = Action(name, link, at, force, couple)
    return [*found.values()]


def _numbers(solution: Solution, link: str, times: Sequence[float]) -> list[int]:
    """Return the numbers of the instants at which times are."""
    instants = solution.t
    numbers = [int(np.argmin(np.abs(instants - time))) for time in times]
    for time, nearest in zip(times, instants[numbers], strict=True):
        if not abs(nearest - time) <= _NEAR * np.abs(instants).max():
            why = f"t = {time:.9g} s is no instant of the solution; the nearest is {nearest:.9g} s"
            raise refused(link, why)
    return numbers


def _known(
    solution: Solution, link: str, loads: Sequence[Action], numbers: Sequence[int] | None
) -> _Instants:
    """Return the instants at which all loads are known: those of the numbers, or some, must be."""
    finite = np.isfinite([np.broadcast_to(sum(x.sizes), solution.t.shape) for x in loads])
    known = np.asarray(finite.all(axis=0))
    if known.any() if numbers is None else known[numbers].all():
        return known
    unknown = [i for i in (range(known.size) if numbers is None else numbers) if not known[i]]
    names = ", ".join(
        load.name for load, at in zip(loads, finite, strict=True) if not at[unknown].all()
    )
    cure = "give the links beams and evaluate with elastic=True, or release a joint"
    why = f"equilibrium does not determine {names}; {cure}"
    if solution.resting[unknown].any():
        rest = f"a joint with friction is at rest at t = {solution.t[unknown[0]]:.6g} s"
        why = f"{rest}, which leaves {names} indeterminate"
    raise refused(link, why)


def _residual(
    body: BodyNumbers, motion: Moving, gravity: Array, loads: Sequence[Action], known: _Instants
) -> tuple[Array, float]:
    """Return the residuals of forces and of moments about the centre, and the largest force."""
    whole = body.whole
    centre, force, moment = motion.point(whole.centre)[0], NIL, NIL
    weight = whole.mass * (gravity - motion.point(whole.centre)[2])
    inertia = Action("", "", centre, weight, -motion.turning(constant(whole.inertia)))
    for one in (acting := [inertia, *loads]):
        force = force + one.force
        moment = moment + one.couple + cross(one.at - centre, one.force)
    sizes = zip(*((*one.sizes, size(one.at - centre)) for one in acting), strict=True)
    push, twist, reach = (
        max(float(np.broadcast_to(one, known.shape)[known].max()) for one in x) for x in sizes
    )
    scale = max(twist, push * max(reach, body.length or 0.0)) or 1.0
    turns = np.zeros(known.shape) if body.length is None else size(moment) / scale
    return np.array([size(force) / (push or 1.0), turns]), push


def _governing(
    peaks: Iterable[tuple[str, Array, str]], known: _Instants, scales: Mapping[str, float]
) -> dict[int, list[str]]:
    """Return the names of what is largest in size at an instant, by its number; ``scales`` are what
    peaks are compared with, by their units.
    """
    found: dict[int, list[str]] = {}
    for name, values, unit in peaks:
        sizes = np.where(known, np.nan_to_num(np.abs(values)), 0.0)
        i = int(np.argmax(sizes))
        if sizes[i] > _SLIGHT * scales[unit]:
            found.setdefault(i, []).append(name)
    return found or {int(np.argmax(known)): []}


def _peaks(
    solution: Solution, link: str, loads: Sequence[Action]
) -> Iterator[tuple[str, Array, str]]:
    """Yield quantities whose peaks govern, over time, with their units."""
    if link in solution.links_with_sections:
        for force in solution.table.forces:
            name = f"section:{link}:{force}"
            yield name, solution.extremes(name)[0], solution.unit(name)
        with suppress(DeclarationError):  # no beam, or stresses that are not known
            stress = solution.stress(link)
            for kind in ("normal", "shear", "von_mises"):
                yield f"stress:{link}:{kind}", stress.largest(kind).value, "Pa"
    members = (*solution.table.reactions, "mz")[:2]  # a plane has no resultant of moments
    for load in loads:
        if load.name.startswith("reaction:"):
            for member, size, unit in zip(members, load.sizes, ("N", "N m"), strict=True):
                yield f"{load.name}:{member}", size, unit


def _at(vector: Array, i: int) -> Triple:
    """Return a vector of a plane or of space at an instant, without zeros of a negative sign."""
    found = (vector[:, min(i, vector.shape[1] - 1)] + 0.0).tolist()
    x, y, z = {1: (0.0, 0.0, *found), 2: (*found, 0.0)}.get(len(found), found)
    return x, y, z

"""Forces on one link at the instants that govern, on its own axes, in equilibrium with its inertia.

They are the actions by which the certificate balances bodies, so nothing of the derivation is used.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..arguments import public
from ..base.arrays import Array
from ..beams.beam import beam_from_numbers
from ..case import Case, scene_of
from ..declare.declared import Declared
from ..declare.description import Description, density_of
from ..declare.scene import Scene
from ..declare.stated import Triple
from ..equations.derive import compile_scene
from ..errors import CertificateError, DeclarationError, UnknownNameError
from ..instants.solution import Solution
from ..verification.balance import all_actions, forces_needed
from ..verification.certificate import placed_of, reported_of, tolerance
from ..verification.placing import Moving, Placed
from ..verification.vectors import Vector
from .loads import Load, LoadCase, Rod, inertia_field

_SLIGHT = 1e-9
"""Share of the largest load below which a peak is rounding, and governs nothing."""

_NEAR = 1e-9
"""Distance of a time from an instant, as a share of the last instant, that counts as none."""


@public
def link_load_cases(
    solution: Solution,
    link: str,
    t: Sequence[float] | None = None,
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
    if link not in solution.description["bodies"]:
        raise UnknownNameError("link", link, solution.description["bodies"])
    declared = _declared(solution, link, scene)
    _check_reported(solution, declared, link)
    placed = placed_of(declared, reported_of(solution, {}))
    if placed is None:
        raise DeclarationError(
            f"load cases of link '{link}': the motion is missing; evaluate with wanted=['motion',"
            " ...], or 'all'"
        )
    loads, motion = _loads_on(placed, link, solution.t.size), placed.bodies[link]
    vectors = motion.change, motion.rate, motion.acceleration, Vector(*declared.gravity)
    moved = _on_axes(motion, solution.t.size, *vectors)
    return _History(solution, declared, link, loads, moved).cases(t)


def _declared(solution: Solution, link: str, scene: Scene | Case | None) -> Declared:
    """Return the mechanism in numbers, with its constraints where there are some."""
    declared = Declared.of(solution.description)
    if not declared.multipliers:
        return declared
    if scene is None:
        raise DeclarationError(
            f"load cases of link '{link}': a solution does not say along which directions"
            f" {', '.join(declared.multipliers)} act; expected scene=, the scene of the solution"
        )
    values = {name: one["value"] for name, one in solution.description["parameters"].items()}
    if [*scene_of(scene).parameters] == [*values]:
        program = compile_scene(scene_of(scene), ["motion"], parameters=values)
        stated = program.data.declared(list(values.values()))
        if (stated.bodies, stated.joints) == (declared.bodies, declared.joints):
            return stated
    raise DeclarationError(
        f"load cases of link '{link}': expected scene=, the scene of the solution; the one given"
        " has other parameters, bodies or joints"
    )


def _check_reported(solution: Solution, declared: Declared, link: str) -> None:
    """Raise :class:`DeclarationError` for forces that the solution does not have."""
    needed = forces_needed(declared, link)
    missing = [f"{one.group}:{one.part}" for one in needed if one not in solution.outputs]
    if missing:
        raise DeclarationError(
            f"load cases of link '{link}' need {', '.join(missing)}, which the solution does not"
            " have; evaluate with wanted='all'"
        )


def _loads_on(placed: Placed, link: str, count: int) -> dict[str, Array]:
    """Return loads on a link by name, each its place, force and moment over time (3, t, 3); several
    of one name that act at one place are added up.
    """
    motion, found = placed.bodies[link], dict[str, Array]()
    for action in all_actions(placed):
        for body, opposite in action.moving:
            if body != link:
                continue
            sign = -1.0 if opposite else 1.0
            acting = action.at - motion.at, sign * action.force, sign * action.couple
            load, number, name = _on_axes(motion, count, *acting), 1, action.name
            while name in found and not np.array_equal(found[name][0], load[0]):
                number, name = number + 1, f"{action.name}:{number + 1}"
            if name in found:
                found[name][1:] += load[1:]
            else:
                found[name] = load
    return found


def _on_axes(motion: Moving, count: int, *vectors: Vector) -> Array:
    """Return vectors in ground axes on the axes of a body, over time (vectors, t, 3)."""
    found = np.empty((len(vectors), count, 3))
    for rows, vector in zip(found, vectors, strict=True):
        for k, component in enumerate(motion.axes.resolve(vector).components):
            rows[:, k] = component
    return found


@dataclass(frozen=True, eq=False)
class _History:
    """Loads on a link over all instants, on its axes; ``moved`` are the acceleration of its origin,
    its angular velocity and acceleration, and gravity (4, t, 3).
    """

    solution: Solution
    declared: Declared
    link: str
    loads: Mapping[str, Array]
    moved: Array

    def cases(self, t: Sequence[float] | None) -> tuple[LoadCase, ...]:
        """Return the load cases at times, or at the instants that govern."""
        acting = np.stack([load[1:] for load in self.loads.values()])
        known = np.asarray(np.isfinite(acting).all(axis=(0, 1, 3)))
        asked = np.arange(known.size) if t is None else self._numbers(t)
        unknown = asked[~known[asked]]
        if unknown.size and (t is not None or not known.any()):
            raise DeclarationError(self._indeterminate(unknown))
        residuals, largest = self._residuals(known)
        governing: dict[int, list[str]] = {i: [] for i in asked.tolist()}
        if t is None:
            governing = self._governing(known, largest)
        rod = _rod(self.solution.description["bodies"][self.link])
        found = [self._case(i, governing[i], residuals[:, i], rod) for i in sorted(governing)]
        limit = tolerance(self.solution)
        for case in found:
            if not max(case.residual) <= limit:
                raise CertificateError(
                    f"load case of link '{self.link}' at t = {case.t:.6g} s is not in equilibrium:"
                    f" residuals of force {case.residual[0]:.2g} and moment"
                    f" {case.residual[1]:.2g}, but at most {limit:.2g} is rounding"
                )
        return tuple(found)

    def _case(self, i: int, governs: Sequence[str], residual: Array, rod: Rod | None) -> LoadCase:
        """Return the load case of an instant."""
        body = self.declared.bodies[self.link]
        acceleration, omega, alpha, gravity = map(_triple, self.moved[:, i])
        of_forces, of_moments = residual.tolist()
        return LoadCase(
            link=self.link,
            t=float(self.solution.t[i]),
            governs=tuple(governs),
            loads=tuple(Load(name, *map(_triple, load[:, i])) for name, load in self.loads.items()),
            acceleration=acceleration,
            omega=omega,
            alpha=alpha,
            gravity=gravity,
            mass=body.mass,
            centre=body.centre,
            inertia=body.inertia,
            residual=(of_forces, of_moments),
            rod=rod,
        )

    def _residuals(self, known: npt.NDArray[np.bool_]) -> tuple[Array, float]:
        """Return the residuals of forces and of moments about the centre (2, t), and the largest
        force.
        """
        body, (_, omega, alpha, _) = self.declared.bodies[self.link], self.moved
        centre, inertia = np.array(body.centre), np.array(body.inertia)
        at, pushes, couples = np.stack([*self.loads.values()], axis=1)
        arms = at - centre
        weight = body.mass * inertia_field(self.moved, centre)
        spun = alpha @ inertia.T + np.cross(omega, omega @ inertia.T)
        force, moment = sum(pushes, weight), -spun
        for couple, turning in zip(couples, np.cross(arms, pushes), strict=True):
            moment = moment + couple + turning
        largest, twisting, reach = (
            float(_sizes(np.stack([*rows])[:, known]).max(initial=0.0))
            for rows in ((weight, *pushes), (spun, *couples), arms)
        )
        reach = max(reach, body.length or 0.0)
        residuals = np.zeros((2, known.size))
        residuals[0] = _sizes(force) / (largest or 1.0)
        if self.declared.oriented(self.link):
            residuals[1] = _sizes(moment) / (max(twisting, largest * reach) or 1.0)
        return residuals, largest

    def _numbers(self, times: Sequence[float]) -> npt.NDArray[np.intp]:
        """Return the numbers of the instants that were asked for."""
        instants = self.solution.t
        numbers = np.array([np.argmin(np.abs(instants - time)) for time in times], dtype=np.intp)
        for time, nearest in zip(times, instants[numbers], strict=True):
            if not abs(nearest - time) <= _NEAR * np.abs(instants).max():
                raise DeclarationError(
                    f"load cases of link '{self.link}': t = {time:.9g} s is no instant of the"
                    f" solution; the nearest is {nearest:.9g} s"
                )
        return numbers

    def _indeterminate(self, numbers: npt.NDArray[np.intp]) -> str:
        """Return why loads are not known at instants."""
        names = ", ".join(
            name for name, load in self.loads.items() if not np.isfinite(load[1:, numbers]).all()
        )
        if self.solution.resting[numbers].any():
            return (
                f"load cases of link '{self.link}': a joint with friction is at rest at"
                f" t = {self.solution.t[numbers[0]]:.6g} s, which leaves {names} indeterminate"
            )
        return (
            f"load cases of link '{self.link}': equilibrium does not determine {names}; give the"
            " links beams and evaluate with elastic=True, or release a joint"
        )

    def _governing(self, known: npt.NDArray[np.bool_], largest: float) -> dict[int, list[str]]:
        """Return what is largest in size at an instant, by its number."""
        found: dict[int, list[str]] = {}
        for name, values, scale in self._peaking(largest, largest * self.declared.size):
            sizes = np.where(known, np.nan_to_num(np.abs(values)), 0.0)
            i = int(np.argmax(sizes))
            if sizes[i] > _SLIGHT * scale:
                found.setdefault(i, []).append(name)
        return found or {int(np.argmax(known)): []}

    def _peaking(self, force: float, moment: float) -> Iterator[tuple[str, Array, float]]:
        """Yield quantities whose peaks govern, over time, each with the load to compare with."""
        solution = self.solution
        if self.link in solution.links_with_sections:
            for section in solution.table.forces:
                name = f"section:{self.link}:{section}"
                is_moment = solution.unit(name) == "N m"
                yield name, solution.extremes(name)[0], moment if is_moment else force
            with suppress(DeclarationError):  # no beam, or stresses that are not known
                stress = solution.stress(self.link)
                for kind in ("normal", "shear", "von_mises"):
                    yield f"stress:{self.link}:{kind}", stress.largest(kind).value, 0.0
        for name, (_, push, couple) in self.loads.items():
            if name.startswith("reaction:"):
                yield f"{name}:resultant", _sizes(push), force
                yield f"{name}:moment", _sizes(couple), moment


def _rod(body: Description) -> Rod | None:
    """Return a described link as a bar, where it has a beam."""
    if "beam" not in body:
        return None
    slices = body["density"].get("slices", {})
    moments = tuple(density_of({"density": slices[name]}) for name in slices)
    return Rod(body["length"], density_of(body), moments, beam_from_numbers(body["beam"]))


def _sizes(rows: Array) -> Array:
    return np.asarray(np.linalg.norm(rows, axis=-1))


def _triple(row: Array) -> Triple:
    x, y, z = (row + 0.0).tolist()  # without zeros of a negative sign
    return x, y, z

"""Forces on one link at the instants that govern, on its own axes, in equilibrium with its inertia.

They are the actions by which the certificate balances bodies, so nothing of the derivation is used.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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
from ..verification.placing import Moving
from ..verification.vectors import Vector
from .loads import Load, LoadCase, Rod

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
    history = _History(declared, link, placed.bodies[link], (solution.t.size, 3), {})
    for action in all_actions(placed):
        for body, opposite in action.moving:
            if body == link:
                sign = -1.0 if opposite else 1.0
                history.add(action.name, action.at, sign * action.force, sign * action.couple)
    return history.cases(solution, t)


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


@dataclass(eq=False)
class _History:
    """Loads on a link over all instants, on its axes, each array (t, 3)."""

    declared: Declared
    link: str
    motion: Moving
    shape: tuple[int, int]
    loads: dict[str, tuple[Array, Array, Array]]

    def _rows(self, vector: Vector) -> Array:
        """A vector in ground axes as rows (t, 3) on the link's axes."""
        rows = np.empty(self.shape)
        for column, component in zip(
            rows.T, self.motion.axes.resolve(vector).components, strict=True
        ):
            column[:] = component
        return rows

    def add(self, name: str, at: Vector, force: Vector, moment: Vector) -> None:
        """Take a load; several of one name that act at one place are added up."""
        found = self._rows(at - self.motion.at), self._rows(force), self._rows(moment)
        number, key = 1, name
        while key in self.loads:
            if np.array_equal(self.loads[key][0], found[0]):
                before = self.loads[key]
                found = before[0], before[1] + found[1], before[2] + found[2]
                break
            number, key = number + 1, f"{name}:{number + 1}"
        self.loads[key] = found

    def cases(self, solution: Solution, t: Sequence[float] | None) -> tuple[LoadCase, ...]:
        """Return the load cases at times, or at the instants that govern."""
        body, limit = self.declared.bodies[self.link], tolerance(solution)
        rod = _rod(solution.description["bodies"][self.link])
        known = np.ones(self.shape[0], dtype=bool)
        for _, force, moment in self.loads.values():
            known &= np.isfinite(force + moment).all(axis=1)
        chosen = self._chosen(solution, t, known)
        vectors = (self.motion.change, self.motion.rate, self.motion.acceleration)
        fields = [*map(self._rows, vectors), self._rows(Vector(*self.declared.gravity))]
        residuals, largest = self._residuals(known, *fields)
        governing: dict[int, list[str]] = {i: [] for i in chosen}
        if t is None:
            governing = self._governing(solution, known, largest)
        found = []
        for i, governs in sorted(governing.items()):
            force_residual, moment_residual = residuals[:, i].tolist()
            if not max(force_residual, moment_residual) <= limit:
                raise CertificateError(
                    f"load case of link '{self.link}' at t = {solution.t[i]:.6g} s is not in"
                    f" equilibrium: residuals of force {force_residual:.2g} and moment"
                    f" {moment_residual:.2g}, but at most {limit:.2g} is rounding"
                )
            loads = (
                Load(name, *(_triple(rows[i]) for rows in load))
                for name, load in self.loads.items()
            )
            acceleration, omega, alpha, gravity = (_triple(rows[i]) for rows in fields)
            case = LoadCase(
                link=self.link,
                t=float(solution.t[i]),
                governs=tuple(governs),
                loads=tuple(loads),
                acceleration=acceleration,
                omega=omega,
                alpha=alpha,
                gravity=gravity,
                mass=body.mass,
                centre=body.centre,
                inertia=body.inertia,
                residual=(force_residual, moment_residual),
                rod=rod,
            )
            found.append(case)
        return tuple(found)

    def _residuals(
        self,
        known: npt.NDArray[np.bool_],
        acceleration: Array,
        omega: Array,
        alpha: Array,
        gravity: Array,
    ) -> tuple[Array, float]:
        """Return the residuals of forces and of moments about the centre (2, t), and the largest
        force.
        """
        body = self.declared.bodies[self.link]
        centre, inertia = np.array(body.centre), np.array(body.inertia)
        change = acceleration + np.cross(alpha, centre)
        change += np.cross(omega, np.cross(omega, centre))
        inertial = body.mass * (change - gravity)
        spun = alpha @ inertia.T + np.cross(omega, omega @ inertia.T)
        force, moment = -inertial, -spun
        largest, twisting = _largest(inertial[known]), _largest(spun[known])
        reach = body.length or 0.0
        for at, push, couple in self.loads.values():
            force = force + push
            moment = moment + couple + np.cross(at - centre, push)
            largest = max(largest, _largest(push[known]))
            twisting = max(twisting, _largest(couple[known]))
            reach = max(reach, _largest((at - centre)[known]))
        residuals = np.zeros((2, self.shape[0]))
        residuals[0] = _sizes(force) / (largest or 1.0)
        if self.declared.oriented(self.link):
            residuals[1] = _sizes(moment) / (max(twisting, largest * reach) or 1.0)
        return residuals, largest

    def _chosen(
        self, solution: Solution, t: Sequence[float] | None, known: npt.NDArray[np.bool_]
    ) -> list[int]:
        """Return the numbers of the instants that were asked for, at each of which all is known."""
        instants, chosen = solution.t, []
        for time in () if t is None else t:
            i = int(np.argmin(np.abs(instants - time)))
            if not abs(instants[i] - time) <= _NEAR * np.abs(instants).max():
                raise DeclarationError(
                    f"load cases of link '{self.link}': t = {time:.9g} s is no instant of the"
                    f" solution; the nearest is {instants[i]:.9g} s"
                )
            chosen.append(i)
        numbers = np.flatnonzero(known) if t is None else np.array(chosen, dtype=int)
        if known[numbers].all() and (numbers.size or t is not None):
            return chosen
        numbers = numbers[~known[numbers]] if t is not None else np.arange(known.size)
        names = ", ".join(
            name
            for name, (_, force, moment) in self.loads.items()
            if not np.isfinite(force[numbers] + moment[numbers]).all()
        )
        if solution.resting[numbers].any():
            raise DeclarationError(
                f"load cases of link '{self.link}': a joint with friction is at rest at"
                f" t = {solution.t[numbers[0]]:.6g} s, which leaves {names} indeterminate"
            )
        raise DeclarationError(
            f"load cases of link '{self.link}': equilibrium does not determine {names}; give the"
            " links beams and evaluate with elastic=True, or release a joint"
        )

    def _governing(
        self, solution: Solution, known: npt.NDArray[np.bool_], largest: float
    ) -> dict[int, list[str]]:
        """Return what is largest in size at an instant, by its number."""
        found: dict[int, list[str]] = {}
        size = largest * self.declared.size
        for name, values, scale in self._peaking(solution, largest, size):
            sizes = np.where(known, np.nan_to_num(np.abs(values)), 0.0)
            i = int(np.argmax(sizes))
            if sizes[i] > _SLIGHT * scale:
                found.setdefault(i, []).append(name)
        return found or {int(np.argmax(known)): []}

    def _peaking(
        self, solution: Solution, force: float, moment: float
    ) -> Iterator[tuple[str, Array, float]]:
        """Yield quantities whose peaks govern, over time, each with the load to compare with."""
        if self.link in solution.links_with_sections:
            for section in solution.table.forces:
                name = f"section:{self.link}:{section}"
                is_moment = solution.unit(name) == "N m"
                yield name, solution.extremes(name)[0], moment if is_moment else force
            with suppress(DeclarationError):  # no beam, or stresses that are not known
                stress = solution.stress(self.link)
                for kind in ("normal", "shear", "von_mises"):
                    yield f"stress:{self.link}:{kind}", stress.largest(kind).value, 0.0
        for name, (_, forces, moments) in self.loads.items():
            if name.startswith("reaction:"):
                yield f"{name}:resultant", _sizes(forces), force
                yield f"{name}:moment", _sizes(moments), moment


def _rod(body: Description) -> Rod | None:
    """Return a described link as a bar, where it has a beam."""
    if "beam" not in body:
        return None
    slices = body["density"].get("slices", {})
    moments = tuple(density_of({"density": slices[name]}) for name in slices)
    return Rod(body["length"], density_of(body), moments, beam_from_numbers(body["beam"]))


def _sizes(rows: Array) -> Array:
    return np.asarray(np.linalg.norm(rows, axis=1))


def _largest(rows: Array) -> float:
    return float(_sizes(rows).max(initial=0.0))


def _triple(row: Array) -> Triple:
    x, y, z = (row + 0.0).tolist()  # without zeros of a negative sign
    return x, y, z

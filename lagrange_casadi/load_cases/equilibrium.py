"""Forces on one link at the instants that govern, on its own axes, in equilibrium with its inertia.

They are the actions by which the certificate balances bodies, so nothing of the derivation is used.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..arguments import public
from ..base.arrays import Array
from ..base.quantities import Output
from ..case import Case, scene_of
from ..declare.declared import Declared
from ..declare.scene import Scene
from ..declare.stated import Triple
from ..equations.derive import compile_scene
from ..errors import CertificateError, DeclarationError, UnknownNameError
from ..instants.solution import Solution
from ..verification.balance import all_actions
from ..verification.certificate import placed_of, reported_of, tolerance
from ..verification.placing import Moving
from ..verification.vectors import Vector

_SLIGHT = 1e-9
"""Share of the largest load below which a peak is rounding, and governs nothing."""

_NEAR = 1e-9
"""Distance of a time from an instant, as a share of the last instant, that counts as none."""


@dataclass(frozen=True)
class Load:
    """A force [N] and a moment [N m] about the place ``at`` [m], on the link's axes.

    ``name`` is that of the output it is reported as: ``reaction:A``, ``effort:O``, ``load:gas``,
    ``multiplier:mesh``. A line load is its resultant.
    """

    name: str
    at: Triple
    force: Triple
    moment: Triple


@dataclass(frozen=True)
class LoadCase:
    """Everything that loads a link at time ``t`` [s], on its own axes, from its origin.

    ``governs`` are the quantities that are largest at this instant. The link bears ``loads``, and
    on each of its masses at r the inertia and weight ``gravity - acceleration - alpha x r - omega x
    (omega x r)``: ``acceleration`` of the origin [m/s^2], angular velocity ``omega`` [rad/s],
    angular acceleration ``alpha`` [rad/s^2]. With ``mass`` [kg], its ``centre`` [m] and the
    ``inertia`` about it [kg m^2] these are in equilibrium, but for ``residual``: of forces, and of
    moments about the centre, each relative to the largest on the link.
    """

    link: str
    t: float
    governs: tuple[str, ...]
    loads: tuple[Load, ...]
    acceleration: Triple
    omega: Triple
    alpha: Triple
    gravity: Triple
    mass: float
    centre: Triple
    inertia: tuple[Triple, Triple, Triple]
    residual: tuple[float, float]


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
        Instants of the solution [s]. Default: those at which a section force of the link, or the
        force or moment of a joint on it, is largest in size.
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
        f"load cases of link '{link}': scene= has other parameters, bodies or joints than the"
        " solution"
    )


def _check_reported(solution: Solution, declared: Declared, link: str) -> None:
    """Raise :class:`DeclarationError` for forces that the solution does not have."""
    joints = {
        name: joint
        for name, joint in declared.joints.items()
        if link in (joint.parent.body, joint.child.body)
    }
    axes = (axis.coordinate for joint in joints.values() for axis in joint.axes)
    loads = (
        name
        for name, load in declared.loads.items()
        if any(point.body == link for point in load.points)
    )
    needed = {
        **{f"reaction:{name}": Output("reaction", name, "fx") for name in joints},
        **{f"effort:{name}": Output("effort", name) for name in axes if name in declared.drives},
        **{f"load:{name}": Output("load", name, "fx") for name in loads},
        **{f"multiplier:{name}": Output("multiplier", name) for name in declared.multipliers},
    }
    if missing := [name for name, output in needed.items() if output not in solution.outputs]:
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
        body = self.declared.bodies[self.link]
        forces = {name: load[1] for name, load in self.loads.items()}
        moments = {name: load[2] for name, load in self.loads.items()}
        finite = np.ones(self.shape[0], dtype=bool)
        for name in self.loads:
            finite &= np.isfinite(forces[name] + moments[name]).all(axis=1)
        chosen = self._chosen(solution.t, t, finite)
        centre, inertia = np.array(body.centre), np.array(body.inertia)
        gravity = self._rows(Vector(*self.declared.gravity))
        acceleration = self._rows(self.motion.change)
        omega, alpha = self._rows(self.motion.rate), self._rows(self.motion.acceleration)
        change = acceleration + np.cross(alpha, centre)
        change += np.cross(omega, np.cross(omega, centre))
        inertial = body.mass * (change - gravity)
        spun = alpha @ inertia.T + np.cross(omega, omega @ inertia.T)
        arms = {name: load[0] - centre for name, load in self.loads.items()}
        turning = {name: moments[name] + np.cross(arms[name], forces[name]) for name in self.loads}
        force = sum(forces.values(), -inertial)
        moment = sum(turning.values(), -spun)
        largest = _largest([*forces.values(), inertial], finite)
        reach = max([body.length or 0.0, *(_largest([arm], finite) for arm in arms.values())])
        twisting = max(_largest([*moments.values(), spun], finite), largest * reach)
        off = np.zeros((2, self.shape[0]))
        off[0] = _sizes(force) / (largest or 1.0)
        if self.declared.oriented(self.link):
            off[1] = _sizes(moment) / (twisting or 1.0)
        governing: dict[int, list[str]] = {i: [] for i in chosen}
        if t is None:
            governing = self._governing(solution, finite, largest)
        limit = tolerance(solution)
        found = []
        for i, governs in sorted(governing.items()):
            if not off[:, i].max() <= limit:
                raise CertificateError(
                    f"load case of link '{self.link}' at t = {solution.t[i]:.6g} s is not in"
                    f" equilibrium: residuals of force {off[0, i]:.2g} and moment {off[1, i]:.2g},"
                    f" but at most {limit:.2g} is rounding"
                )
            loads = (
                Load(name, *(_triple(rows[i]) for rows in load))
                for name, load in self.loads.items()
            )
            case = LoadCase(
                link=self.link,
                t=float(solution.t[i]),
                governs=tuple(governs),
                loads=tuple(loads),
                acceleration=_triple(acceleration[i]),
                omega=_triple(omega[i]),
                alpha=_triple(alpha[i]),
                gravity=_triple(gravity[i]),
                mass=body.mass,
                centre=body.centre,
                inertia=body.inertia,
                residual=(float(off[0, i]), float(off[1, i])),
            )
            found.append(case)
        return tuple(found)

    def _chosen(
        self, instants: Array, t: Sequence[float] | None, finite: npt.NDArray[np.bool_]
    ) -> list[int]:
        """Return the numbers of the instants that were asked for, in each of which all is known."""
        chosen = []
        for time in () if t is None else t:
            i = int(np.argmin(np.abs(instants - time)))
            if not abs(instants[i] - time) <= _NEAR * np.abs(instants).max():
                raise DeclarationError(
                    f"load cases of link '{self.link}': t = {time:.9g} s is no instant of the"
                    f" solution; the nearest is {instants[i]:.9g} s"
                )
            chosen.append(i)
        asked = finite[chosen] if t is not None else finite
        if asked.all() if t is not None else asked.any():
            return chosen
        numbers = chosen if t is not None else slice(None)
        names = [
            name
            for name, (_, force, moment) in self.loads.items()
            if not np.isfinite(force[numbers] + moment[numbers]).all()
        ]
        raise DeclarationError(
            f"load cases of link '{self.link}': equilibrium does not determine {', '.join(names)};"
            " give the links beams and evaluate with elastic=True, or release a joint"
        )

    def _governing(
        self, solution: Solution, finite: npt.NDArray[np.bool_], largest: float
    ) -> dict[int, list[str]]:
        """Return what is largest in size at an instant, by its number."""
        found: dict[int, list[str]] = {}
        size = largest * self.declared.size
        for name, values, scale in self._peaking(solution, largest, size):
            sizes = np.where(finite, np.nan_to_num(np.abs(values)), 0.0)
            i = int(np.argmax(sizes))
            if sizes[i] > _SLIGHT * scale:
                found.setdefault(i, []).append(name)
        return found or {int(np.argmax(finite)): []}

    def _peaking(
        self, solution: Solution, force: float, moment: float
    ) -> Iterator[tuple[str, Array, float]]:
        """Yield quantities whose peaks govern, over time, each with the load to compare with."""
        if self.link in solution.links_with_sections:
            for section in solution.table.forces:
                name = f"section:{self.link}:{section}"
                turns = solution.unit(name) == "N m"
                yield name, solution.extremes(name)[0], moment if turns else force
        for name, (_, forces, moments) in self.loads.items():
            if name.startswith("reaction:"):
                yield f"{name}:resultant", _sizes(forces), force
                yield f"{name}:moment", _sizes(moments), moment


def _sizes(rows: Array) -> Array:
    return np.asarray(np.linalg.norm(rows, axis=1))


def _largest(each: Sequence[Array], finite: npt.NDArray[np.bool_]) -> float:
    """Return the largest size of vectors over the instants where all are known."""
    return max((float(_sizes(rows[finite]).max(initial=0.0)) for rows in each), default=0.0)


def _triple(row: Array) -> Triple:
    x, y, z = (row + 0.0).tolist()  # without zeros of a negative sign
    return x, y, z

"""The engine itself in a page: the exported C as WebAssembly, and which of its numbers go where.

The page evaluates the whole cycle anew for other parameters. What it shows are arrays with numbers
(:mod:`.arrays`); here stands of which outputs each is made, and where the numbers of the picture
come from: lengths, places and axes are expressions of parameters, and are evaluated in the module
too.
"""

from __future__ import annotations

import base64
import itertools
import shlex
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial

import casadi as ca
import numpy as np
import numpy.typing as npt

from ...base.arrays import Json
from ...base.quantities import Output
from ...base.scalars import column
from ...base.templates import Leaf
from ...engine.codegen.printer import print_functions
from ...engine.derive import compile_scene
from ...engine.gaps import ends_of, joined
from ...engine.instants.evaluation_method import EvaluationMethod
from ...engine.model_data import ModelData
from ...engine.nearest import Nearest
from ...engine.placement import stand
from ...engine.released_loops import State
from ...errors import DeclarationError
from ...interop.portable.data import LARGEST
from ...interop.portable.source import Source
from ...interop.portable.sourced import sourced
from ...interop.portable.wasm import check_zig, layout, page_build, places
from ...model.description import Description, JointNumbers
from ...model.scene import Scene
from ...model.times import Timing
from ...results.solution import Solution
from .array_block import Arrays

_CORNERS = (
    "Corners of motions, constraints and lifts were checked with the first values of the"
    " parameters only, not with those of the sliders."
)

_FUNCTIONS = """#include <math.h>
typedef double casadi_real;
{functions}
void live_numbers(const double* p, double* numbers) {{
  const casadi_real* arg[1];
  casadi_real* res[1];
  arg[0] = p;
  res[0] = numbers;
  numbers_of(arg, res);
}}
void live_posture(const double* p, const double* x, double* posture) {{
  const casadi_real* arg[2];
  casadi_real* res[1];
  arg[0] = p;
  arg[1] = x;
  res[0] = posture;
  posture_of(arg, res);
}}
"""


def run_of(case: str) -> str:
    """Begin the command line that evaluates a case."""
    return f"lagrange-casadi run {shlex.quote(case)}"


@dataclass(frozen=True, eq=False)
class Live:
    """Program of a live page: the ``source`` of its solution's program, and the definition of its
    instants.

    ``command`` is how a command line begins that evaluates the same. ``numbers`` and ``posture``
    are how many numbers these functions of a module give. ``standing`` gives the loops, and the
    state of the coordinates at an instant [s] for parameters.
    """

    standing: Callable[[float, Mapping[str, float]], tuple[Nearest, State]]
    source: Source
    timing: Timing
    command: str
    numbers: int
    posture: int
    module: Future[bytes]
    """WebAssembly, which is compiled while the solution is evaluated."""

    @classmethod
    def of(
        cls,
        scene: Scene,
        timing: Timing,
        wanted: Sequence[str] | None,
        command: str,
        parameters: Mapping[str, float] | None = None,
    ) -> Live:
        """Derive a scene, for outputs that are ``wanted``, and begin to compile it; ``parameters``
        are those of the solution.

        Raises :class:`.DeclarationError` where a scene has no parameter,
        :class:`.LagrangeCasadiError` where ziglang is missing, and what :func:`.export` does.
        """
        data = compile_scene(scene, wanted, parameters=parameters).data
        if not data.parameters:
            raise DeclarationError(
                f"live: mechanism '{data.name}' has no parameter to change; declare one, or leave"
                " live out"
            )
        check_zig("a live report")
        source = sourced(
            scene, "", parameters, wanted, EvaluationMethod("auto", "double"), LARGEST["double"]
        )
        nearest, _ = stand(scene, scene.span[0], parameters or {})
        functions = {"numbers_of": _numbers(data, timing), "posture_of": _posture(nearest)}
        text = _FUNCTIONS.format(functions=print_functions(functions, "double", prefix="live"))
        build = page_build(source, {"live.c": text}, ["live_numbers", "live_posture"])
        compilers = ThreadPoolExecutor(1)
        module = compilers.submit(build)
        compilers.shutdown(wait=False)
        numbers, posture = (function.numel_out() for function in functions.values())
        return cls(partial(stand, scene), source, timing, command, numbers, posture, module)

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes for whoever changes parameters in the page."""
        corners = self.source.exported.program.data.corners
        return (_CORNERS,) if corners.laws or corners.constraints else ()


def _numbers(data: ModelData, timing: Timing) -> ca.Function:
    """The ends of the instants, and the numbers of the picture, by the parameters."""
    start, stop = timing.ends(data.symbols)
    numbers = ca.vertcat(start, stop, data.template.numbers(data.symbols))
    return ca.Function("numbers_of", [data.symbols], [ca.densify(numbers)], {"cse": True})


def _posture(nearest: Nearest) -> ca.Function:
    """The posture by the parameters and by x, which is the time, the coordinates u and the
    quaternions of balls: the equations of loops, their derivatives by u, the bodies, the ends of
    loops, and the quaternions turned by u.
    """
    released, multibody = nearest.released, nearest.multibody
    u, q, t, p = released.given
    ends = (ends_of(multibody, loop) for loop in multibody.loop_equations if not loop.declared)
    placed = ca.substitute(
        column([nearest.placed, *ends]), released.variables, released.placed(*released.given)
    )
    slopes = ca.densify(ca.jacobian(released.residuals, u))
    found = column([released.residuals, ca.vec(slopes.T), placed, released.turned(u, q)])
    # A two-force link has no other axes than that along it: its sides stay as they are.
    inputs, outputs = [p, ca.vertcat(t, u, q)], [ca.densify(found)]
    sides = column(ca.Function("open", inputs, outputs, {"allow_free": True}).free_sx())
    outputs = [ca.substitute(found, sides, ca.DM(nearest.numbers.of(sides)))]
    return ca.Function("posture_of", inputs, outputs, {"cse": True})


def _posture_entry(nearest: Nearest, state: State, known: Mapping[str, int]) -> dict[str, Json]:
    """Layout of the posture's numbers, and the coordinates at the first instant."""
    u, q, *_ = state
    multibody, sizes = nearest.multibody, nearest.released.sizes
    return {
        "u": u.tolist(),
        "q": q.tolist(),
        "free": np.flatnonzero(nearest.free).tolist(),
        "resting": np.flatnonzero(nearest.released.resting).tolist(),
        "driven": [
            [k, known[f"motion:{coordinate.name}"], sizes[k]]
            for k, coordinate in enumerate(multibody.coordinates)
            if coordinate.driven
        ],
        "bodies": list(multibody.frames),
        "loops": [
            {
                "name": loop.name,
                "kind": loop.kind,
                "rows": [rows.start, rows.stop],
                "bodies": [] if loop.declared else [point.body.name for point in joined(loop)],
            }
            for loop, rows in zip(multibody.loop_equations, nearest.released.loops, strict=True)
        ],
    }


def live_entry(
    live: Live, solution: Solution, chosen: npt.NDArray[np.intp], arrays: Arrays
) -> dict[str, Json]:
    """Data of a page beside its solution: the module, and its inputs, outputs and numbers.

    ``chosen`` are the instants that are shown, by number.
    """
    source, timing = live.source, live.timing
    data = source.exported.program.data
    contract = source.contract
    known = {member.source: k for k, member in enumerate((*contract.inputs, *contract.outputs))}
    values = {name: one.value for name, one in solution.description.parameters.items()}
    nearest, state = live.standing(float(solution.t[0]), values)
    more = live.numbers + live.posture + 1 + sum(map(len, state[:2]))
    return {
        "module": base64.b64encode(live.module.result()).decode("ascii"),
        "layout": layout(source) | {"more": more},
        "defaults": data.defaults.tolist(),
        "loops": (
            [places(source)["loops"], source.exported.sizes["loops"]] if source.iterated else None
        ),
        "wrapped": [k for k, member in enumerate(contract.outputs) if member.wrapped],
        "of": [
            [number, [known[name] for name in names]]
            for number, names in enumerate(arrays.of)
            if names and known.keys() >= set(names)
        ],
        "poses": {body: _pose(body, solution, known) for body in solution.description.bodies},
        "links": {
            link.name: _link(link.name, k, solution, known) for k, link in enumerate(contract.links)
        },
        "forces": solution.table.forces,
        "timing": {
            "count": timing.count,
            "joint": timing.joint,
            "coordinate": known.get(f"motion:{timing.joint}", -1),
        },
        "posture": _posture_entry(nearest, state, known),
        "shown": None if chosen.size == timing.count else chosen.tolist(),
        "numbers": live.numbers,
        "picture": _picture(data.content, 2),
        "command": live.command,
    }


def _pose(body: str, solution: Solution, known: Mapping[str, int]) -> list[int]:
    """Places of the numbers of a body's pose, -1 for those that it lacks; in the plane three, in
    space twelve.
    """
    members = ["x", "y", "angle"]
    if solution.description.space:
        members = ["x", "y", "z", *(axis + component for axis in "xyz" for component in "xyz")]
    return [known.get(str(Output("pose", body, member)), -1) for member in members]


def _link(link: str, number: int, solution: Solution, known: Mapping[str, int]) -> dict[str, Json]:
    """Pieces of a link's functions along it: the breaks of its density, distributed loads, and the
    highest degree.
    """
    law = solution.section(link).law
    density = law.density
    degree = max([*map(len, density.cells), *(load.powers for load in law.distributed_loads)]) + 2
    return {
        "number": number,
        "breaks": density.breaks,
        "degree": degree,
        "spreads": [
            [known[str(Output("spread", link, member, load.name))] for member in ("width", "end")]
            for load in law.distributed_loads
        ],
    }


def _picture(described: Description, first: int) -> dict[str, Json]:
    """The numbers that a picture is made of, as their places behind ``first``; -1 is nothing."""

    def at(number: float | None) -> int:
        return -1 if number is None else first + int(number)

    def vector(components: Sequence[float]) -> list[int]:
        return [*map(at, components), *[-1] * (3 - len(components))]

    def joint(one: JointNumbers) -> dict[str, Json]:
        axes = [vector(axis.direction) for axis in one.axes]
        second = one.kind == "universal" and len(axes) > 1
        return {
            "parent": vector(one.parent.at),
            "child": vector(one.child.at),
            "axes": axes if described.space else [vector(one.triad[0])],
            "turned": [*map(vector, one.turned)] if second else None,
        }

    pitches, tracks = described.pitch_circles.values(), described.tracks.values()
    carried = [
        *itertools.chain(*((*one.radii, *sum(one.centres + one.axes, ())) for one in pitches)),
        *itertools.chain(*((one.radius, *sum(one.way, ())) for one in tracks)),
    ]
    return {
        "bodies": {
            name: {
                "length": at(body.length),
                "mass": at(body.mass),
                "centre": None if body.centre is None else vector(body.centre),
                "outlines": [
                    [vector(corner) for corner in outline]
                    for outline in described.outlines.get(name, ())
                ],
            }
            for name, body in described.bodies.items()
        },
        "joints": [*map(joint, described.joints.values())],
        "loads": [[vector(point.at) for point in load.points] for load in described.loads.values()],
        "closed": [at(load.closed) for load in described.loads.values()],
        "carried": [first + number for number in carried if isinstance(number, Leaf)],
        "paths": [vector(point.at) for point in described.paths.values()],
        "rollers": [
            {
                "body": roller.centre.body,
                "at": vector(roller.centre.at),
                "radius": at(roller.radius),
            }
            for roller in described.rollers.values()
        ],
    }

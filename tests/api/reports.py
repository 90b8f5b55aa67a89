"""Solutions to report, at a few instants, and what their pages hold."""

import base64
import functools
import json
import tempfile
from dataclasses import fields, is_dataclass, replace
from pathlib import Path

import numpy as np
from mechanisms import links_of, pins_of

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, density, evaluate
from lagrange_casadi.motion import polynomial
from lagrange_casadi.studies.case import load_case

CASES = Path(__file__).parents[2] / "cases"

HOSTILE = (
    "<script>window.told = 1</script>",
    "</script><!--",
    '"><img src=x onerror=window.told=1>',
    "a & b 'c' ξ 日本",
)
"""Names that would be markup where a page took them for such."""


@functools.cache
def solved(name, count=41):
    """A case with all that it wants, at some instants."""
    scene = load_case(CASES / name).scene
    asked = {"over": (*scene.over[:3], count)} if scene.over else {"t": (*scene.t[:2], count)}
    return evaluate(scene, **asked, backend="vm")


@functools.cache
def press(t=(0, 0.628, 9), wanted=("all",), unit="m"):
    """The slider-crank of the README."""
    m = Mechanism("press")
    crank, rod = links_of(m, crank=(0.1, 1.2), rod=(m.parameter("l", 0.5, unit, low=0.0), 2.0))
    ram = m.point_mass("ram", 15.0)
    drive, *_ = pins_of(m, O=(m.ground, crank), A=(crank.tip, rod), B=(rod.tip, ram))
    m.prismatic("guide", m.ground, ram, axis=(0, 1))
    m.output("own", m.rate(drive), unit=unit)
    return evaluate(
        Scene(m, {"O": polynomial(0, 10)}, t=t, posture={"rod": 1.5}, wanted=list(wanted)),
        backend="vm",
    )


@functools.cache
def snowed(space=False):
    """A bar that turns under loads along a part of it, in the plane or in space."""
    m = SpatialMechanism("snowed") if space else Mechanism("snowed")
    bar = m.link("bar", length=m.parameter("l", 2.0, "m", low=0.0), mass=3.0)
    m.revolute("O", m.ground, bar, **({"axis": (0, 0, 1)} if space else {}))
    m.force("push", bar.at(0.7), x=1.0, y=20.0)
    m.line_load(
        "snow",
        bar,
        x=(1.0, 2.0),
        y=(-40.0, 0.0),
        **({"z": (5.0, 60.0)} if space else {}),
        between=(0.3, 1.4),
    )
    return evaluate(Scene(m, {"O": polynomial(0, 3)}, t=(0, 1, 9)), backend="vm")


@functools.cache
def wound():
    """A bar in space that tumbles, whose slices have rotary inertia that changes along it, under a
    load along a part of it.
    """
    m = SpatialMechanism("wound")
    slices = {
        "yy": density.polynomial(0.02, 0.03, -0.01),
        "zz": density.polynomial(0.05),
        "yz": density.polynomial(0.0, 4e-3),
    }
    bar = m.link(
        "bar",
        length=m.parameter("l", 0.8, "m"),
        density=density.thick(density.polynomial(3.0, 1.0), **slices),
    )
    m.spherical("O", m.ground, bar)
    m.line_load("snow", bar, y=(-40.0, 0.0), z=(5.0, 60.0), between=(0.3, 0.5))
    m.force("push", bar.at(0.2), x=1.0, y=20.0, z=-4.0)
    laws = [polynomial(0.1, 2.0, 1.5), polynomial(0.2, -3.0), polynomial(0.3, 1.0, -2.0)]
    return Scene(m, {"O": laws}, t=(0, 0.3, 9), xi=(0, 1, 7))


def hostile():
    """The same as a forged file may have it: names that nobody can declare."""
    solution = press(unit=HOSTILE[0])
    names = dict(zip(("O", "A", "crank", "rod"), HOSTILE, strict=True))

    def renamed(value):
        if isinstance(value, dict):
            return {names.get(key, key): renamed(one) for key, one in value.items()}
        if isinstance(value, list | tuple):
            return type(value)(map(renamed, value))
        if is_dataclass(value):
            return type(value)(*(renamed(getattr(value, one.name)) for one in fields(value)))
        return names.get(value, value) if isinstance(value, str) else value

    outputs = {
        replace(output, part=names.get(output.part, output.part)): values
        for output, values in solution.outputs.items()
    }
    return replace(
        solution,
        case=HOSTILE[0],
        outputs=outputs,
        description=renamed(solution.description),
        errors={},
    )


def page(solution):
    """The text of a report."""
    with tempfile.TemporaryDirectory() as folder:
        solution.report(Path(folder) / "page.html")
        return (Path(folder) / "page.html").read_text()


def held(text):
    """What a page holds: its contents, and its arrays by number."""
    start = '<script type="application/json" id="contents">'
    found = json.loads(text.partition(start)[2].partition("</script>")[0])
    block = np.frombuffer(base64.b64decode(found["numbers"]), "<f8")

    def array(number):
        place = found["arrays"][number]
        if "at" not in place:
            return np.full(place["count"], place["value"])
        return block[place["at"] : place["at"] + place["count"]]

    return found, array

"""Scenes in other units: a metre, a kilogram and a second are so many of the new ones.

Every number and expression of a declaration is multiplied by the size of its unit, and its symbols
are divided by the sizes of theirs, so parameters keep their values. With powers of two nothing is
rounded, and each result is the former one times the size of its unit.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Any

import casadi as ca

from lagrange_casadi import Scene

_DIMENSIONS = {
    "1": (0, 0, 0),
    "rad": (0, 0, 0),
    "m": (1, 0, 0),
    "kg": (0, 1, 0),
    "s": (0, 0, 1),
    "N": (1, 1, -2),
    "W": (2, 1, -3),
    "J": (2, 1, -2),
}
_FIELDS = {
    **dict.fromkeys(("between", "centre", "couple", "length", "lift", "origin", "outlines"), "m"),
    **dict.fromkeys(("closed", "open", "pitch", "radius", "reach", "tip"), "m"),
    **dict.fromkeys(("value", "across"), "N m"),
    "mass": "kg",
    **dict.fromkeys(("inertia", "rotor_inertia"), "kg m^2"),
    "stiffness": "N/m",
    "damping": "N s/m",
    "stribeck": "m/s",
    "slack": "N",
    "gravity": "m/s^2",
}
"""The units of fields of whatever part has them; other fields are numbers, names, or parts."""

_ALONG = {
    "viscous": ("N m s", "N s/m"),
    "smooth": ("1/s", "m/s"),
    "speed": ("1/s", "m/s"),
    **dict.fromkeys(("coulomb", "effort"), ("N m", "N")),
    "armature": ("kg m^2", "kg"),
    "ratio": ("1", "1/m"),
}
"""The units of fields of what is along a joint's axis: an angle, and a slide."""

_KEPT = ("accelerations", "beam", "fits", "loss", "mu", "name", "places", "rates", "static")
_KEPT += ("symbol",)


def unit_of(part: Any, name: str) -> str:
    """The unit of a part's field; what else the part has tells a force from a place."""
    if name == "components":
        return "N m" if hasattr(part, "against") else "N"
    if name in ("x", "y", "z"):
        along, axes = hasattr(part, "between"), hasattr(part, "angle")
        return "N/m" if along else "1" if axes else "m"
    if name in _ALONG and hasattr(part, "axis"):
        return _ALONG[name][part.axis.kind == "slide"]
    if name == "phi" and part.transmission is not None:
        return "m"
    return _FIELDS.get(name, "1")


@dataclass(frozen=True)
class Units:
    """A metre, a kilogram and a second in the new units."""

    metre: float = 1.0
    kilogram: float = 1.0
    second: float = 1.0

    def size(self, unit: str) -> float:
        """The size of a unit, as ``N m`` or ``kg m^2``; what is divided by has one word."""
        found, (above, *below) = 1.0, unit.split("/")
        for word, sign in (
            (w, s) for part, s in ((above, 1), *((b, -1) for b in below)) for w in part.split()
        ):
            name, _, power = word.partition("^")
            for base, dimension in zip(
                (self.metre, self.kilogram, self.second), _DIMENSIONS[name], strict=True
            ):
                found *= base ** (sign * dimension * int(power or 1))
        return found

    def of(self, scene: Scene, solution, output) -> float:
        """The size of the unit of a solution's output; a constraint without parts is a number."""
        m = scene.mechanism
        if output.group != "multiplier":
            return self.size(solution.unit(output))
        if output.part in m.rows:
            return self.size("W")
        return self.size("J" if m.constraints[output.part].transmission is None else "N")

    def scene(self, scene: Scene) -> Scene:
        """A scene in these units, without outputs of its own."""
        return Rescaling(self, scene).scene


@dataclass(eq=False)
class Rescaling:
    """A ``given`` scene in other units, and what it is evaluated with."""

    units: Units
    given: Scene
    made: dict[tuple[int, str], Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        m = self.given.mechanism
        self.slides = {n for n, (_, axis) in m.coordinates.items() if axis.kind == "slide"}
        sizes = [(m.time, "s")]
        for measure in m.measures.asked.values():
            slides = measure.axis.kind == "slide" if measure.axis else hasattr(measure.of, "place")
            for row, per in ((measure.places, ""), (measure.rates, "/s")):
                sizes += [(symbol, ("m" if slides else "1") + per) for symbol in row]
        self.symbols = ca.vertcat(*(symbol for symbol, _ in sizes))
        self.former = ca.vertcat(*(symbol / self.units.size(unit) for symbol, unit in sizes))

    @property
    def scene(self) -> Scene:
        old, m = self.given, self.given.mechanism
        new = type(m)(m.name)
        for one in fields(m):
            if one.name not in ("name", "time", "frozen", "outputs", "asked"):
                setattr(new, one.name, self.of(getattr(m, one.name), unit_of(m, one.name)))
        new.time = m.time
        drives = old.drives and {
            name: weight / (1.0 if name in self.slides else self.units.metre**2)
            for name, weight in old.drives.items()
        }
        return Scene(
            new,
            {name: self.laws(name, law) for name, law in old.motion.items()},
            wanted=old.wanted,
            posture={name: self.of(x, self.unit(name)) for name, x in old.posture.items()},
            assembly=dict(old.assembly),
            drives=drives,
            **self.timing(old.t, old.over),
        )

    def unit(self, coordinate: str) -> str:
        return "m" if coordinate in self.slides else "1"

    def timing(self, t: Any = None, over: Any = None) -> dict[str, Any]:
        """Instants, as arguments of a scene or an evaluation."""
        found = {}
        if t is not None:
            found["t"] = *(self.of(x, "s") for x in t[:2]), t[2]
        if over is not None:
            joint, *ends, count = over
            found["over"] = joint, *(self.of(x, self.unit(joint)) for x in ends), count
        return found

    def laws(self, name: str, law: Any) -> Any:
        """The law of a coordinate, those of a joint that has several, or of a guided part."""
        if not isinstance(law, tuple | list):
            return self.law(law, self.unit(name))
        joint = self.given.mechanism.joints.get(name)
        kinds = [self.unit(axis.coordinate) for axis in joint.axes] if joint else ("m", "m", "1")
        return [self.law(one, unit) for one, unit in zip(law, kinds, strict=False)]

    def law(self, law: Any, unit: str) -> Any:
        second, size = self.units.second, self.units.size(unit)
        return replace(
            law,
            graph=lambda t: size * law.graph(t / second),
            span=tuple(second * x for x in law.span),
            knots=tuple(second * x for x in law.knots),
            stretches=(),
        )

    def of(self, value: Any, unit: str = "1") -> Any:
        """A part, a number or an expression, each once."""
        key = id(value), unit
        if key not in self.made:
            self.made[key] = value, self._of(value, unit)
        return self.made[key][1]

    def _of(self, value: Any, unit: str) -> Any:
        if isinstance(value, ca.SX):
            return self.units.size(unit) * ca.substitute(value, self.symbols, self.former)
        if isinstance(value, int | float) and not isinstance(value, bool):
            return value * self.units.size(unit)
        if isinstance(value, dict):
            return {name: self.of(one, unit) for name, one in value.items()}
        if type(value) in (tuple, list):
            return type(value)(self.of(one, unit) for one in value)
        if hasattr(value, "per_length"):
            return self.density(value, "kg" if unit == "1" else unit)
        if not is_dataclass(value):
            return value
        given = [one.name for one in fields(value) if one.init and one.name not in _KEPT]
        return replace(value, **{n: self.of(getattr(value, n), unit_of(value, n)) for n in given})

    def density(self, value: Any, unit: str) -> Any:
        slices = value.slices and replace(
            value.slices,
            **{n: self.density(getattr(value.slices, n), "kg m^2") for n in ("yy", "zz", "yz")},
        )
        cells = self.of(value.cells, unit + ("/m" if value.per_length else ""))
        return replace(value, cells=cells, slices=slices)

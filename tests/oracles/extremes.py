"""Scenes at the ends of their ranges: what each is, and ``python tests extremes``, which prints
how exact its outputs are.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from arithmetic import DTYPES, ROUNDING
from estimates import kind
from mechanisms import links_of, pins_of
from truth import true_errors, truth

from lagrange_casadi import Mechanism, Scene, evaluate
from lagrange_casadi.motion import harmonic, polynomial

PRECISIONS = ("double", "single")
RATE = 25 * math.pi
CYCLE = (0.0, 0.08, 7)


@dataclass(frozen=True, eq=False)
class Extreme:
    """A scene with parameters and instants.

    ``lost`` is the largest coordinate over the shortest length: a rounding of the one is so much
    more of the other. ``single`` is what a refusal in single precision says, empty where there is
    none.
    """

    name: str
    scene: Callable[[], Scene]
    values: Mapping[str, float] = field(default_factory=dict)
    t: tuple[float, float, int] = CYCLE
    lost: float = 1.0
    single: str = ""

    def solution(self, **options):
        """The scene evaluated."""
        return evaluate(self.scene(), parameters=self.values, t=self.t, wanted=["all"], **options)

    def judged(self, solution):
        """The largest error of every quantity, at the instant of the largest condition and another
        one, and its share of the peak of the quantity's kind.
        """
        n, scene = solution.t.size, replace(self.scene(), t=self.t)
        worst = np.argmax(solution.certificate.get("condition", solution.t))
        some = solution.during(np.isin(np.arange(n), [n // 3, worst]))
        exact = truth(scene, some.t, scene.mechanism.values(self.values))
        errors, peaks = true_errors(some, exact), {}
        for name in errors:
            peaks[kind(name)] = max(peaks.get(kind(name), 0.0), abs(solution.peak(name).value))
        # What is smaller than the smallest normal number is no error.
        tiny = float(np.finfo(DTYPES[solution.provenance.precision]).tiny)
        return {
            name: (error, max(error - tiny, 0.0) / (peaks[kind(name)] or 1.0))
            for name, error in errors.items()
        }

    def bound(self, solution):
        """What the condition of a solution lets an error be of a peak: a rate has lost as much as
        a place has, once more.
        """
        condition = np.max(solution.certificate.get("condition", 1.0))
        return ROUNDING[solution.provenance.precision] * float(condition) ** 2 * self.lost


def _declared(name):
    m = Mechanism(name)

    def number(symbol, default, unit="m"):
        return m.parameter(symbol, default, unit)

    motion = polynomial(
        number("angle", 0.3, "rad"), number("rate", RATE, "rad/s"), number("change", 5.0, "rad/s^2")
    )
    return m, number, motion


@functools.cache
def rotor():
    m, number, motion = _declared("rotor")
    m.revolute(
        "O", m.ground, m.link("crank", length=number("r", 0.1), mass=number("m1", 0.1, "kg"))
    )
    return Scene(m, {"O": motion})


@functools.cache
def spinner():
    """A link that spins on one that hardly moves."""
    m, number, motion = _declared("spinner")
    arm = m.link("arm", length=number("r", 0.1), mass=number("m1", 0.1, "kg"))
    pins_of(
        m,
        O=(m.ground, arm),
        A=(arm.tip, m.link("wheel", length=number("l", 0.2), mass=number("m2", 0.1, "kg"))),
    )
    return Scene(m, {"O": polynomial(0.4, 0.01), "A": motion})


@functools.cache
def slider_crank(law=None, pin=Mechanism.revolute):
    m, number, motion = _declared("slider_crank")
    crank, rod = links_of(
        m,
        crank=(number("r", 0.1), number("m1", 0.1, "kg")),
        rod=(number("l", 0.2), number("m2", 0.1, "kg")),
    )
    slider = m.point_mass("slider", number("m3", 0.1, "kg"))
    pins_of(m, O=(m.ground.at(number("x", 0.0), number("y", 0.0)), crank), A=(crank.tip, rod))
    pin(m, "B", rod.tip, slider)
    m.prismatic("guide", m.ground.at(number("gx", 0.0), number("gy", 0.0)), slider, axis=(1, 0))
    return Scene(m, {"O": law or motion}, posture={"rod": 0.0, "guide": 0.3})


@functools.cache
def swung():
    return slider_crank(harmonic(0.5, 2.0, 12.5, 0.1))


@functools.cache
def four_bar(pin=Mechanism.revolute):
    m, number, motion = _declared("four_bar")
    a, b, c = (
        m.link(name, length=number(f"l{name}", length), mass=number(f"m{name}", mass, "kg"))
        for name, length, mass in (("a", 0.1, 0.3), ("b", 0.35, 0.5), ("c", 0.25, 0.4))
    )
    pins_of(m, O=(m.ground.at(number("x", 0.0), number("y", 0.0)), a), A=(a.tip, b))
    pin(m, "B", b.tip, c.tip)
    m.revolute("C", m.ground.at(number("cx", 0.3), number("cy", 0.05)), c)
    return Scene(m, {"O": motion}, posture={"b": 0.9, "c": 1.5})


@functools.cache
def platform(size=1.0, frequency=1.0):
    """A 3-RRR platform, whose loops are iterated; of another size, for what is judged when it is
    derived.
    """
    m = Mechanism("platform")
    corners = {
        radius: [(radius * math.cos(a), radius * math.sin(a)) for a in _THIRDS]
        for radius in (0.5 * size, 0.12 * size)
    }
    plate = m.link(
        "plate",
        length=0.2 * size,
        mass=1.5,
        centre=(0.0, 0.0),
        inertia=m.parameter("inertia", 0.01 * size**2, "kg m^2"),
    )
    lengths = [m.parameter(f"l{i}", 0.28 * size, "m") for i in range(6)]
    posture, motion = {"plate": 0.0}, {}
    for i, (foot, corner) in enumerate(zip(*corners.values(), strict=True)):
        upper = m.link(f"upper{i}", length=lengths[2 * i], mass=0.8)
        lower = m.link(f"lower{i}", length=lengths[2 * i + 1], mass=0.5)
        m.revolute(f"drive{i}", m.ground.at(*foot), upper)
        m.revolute(f"knee{i}", upper.tip, lower)
        m.revolute(f"foot{i}", lower.tip, plate.at(*corner))
        inward = _THIRDS[i] + math.pi
        posture |= {f"upper{i}": inward - 0.8, f"lower{i}": inward + 0.8}
        motion[f"drive{i}"] = harmonic(inward - 0.8, 0.2, frequency, 4 * _THIRDS[i])
    return Scene(m, motion, posture=posture)


_THIRDS = [2 * math.pi * i / 3 + math.pi / 6 for i in range(3)]


def _platform(name, t=(0.0, 0.9, 31), **keywords):
    return Extreme(f"3-RRR platform: {name}", functools.partial(platform, **keywords), {}, t)


def _through(centre, width):
    """Parameters that lead the crank through a direction, and the instants from so far before it to
    so far behind.
    """
    return {"angle": centre - width, "change": 0.0}, (0.0, 2 * width / RATE, 9)


def _near_90(gap):
    turn, t = _through(math.pi / 2, 4 * math.sqrt(2 * gap))
    return {"r": 0.2 * (1 - gap)} | turn, t


def _four_bar_near(centre, gap, **lengths):
    turn, t = _through(centre, 4 * math.sqrt(2 * gap))
    return {"cy": 0.0} | lengths | turn, t


_DEAD = "dead centre"
_90_TO_3, _90_TO_6, _90_TO_9 = (_near_90(gap) for gap in (1e-3, 1e-6, 1e-9))


def _dead_centres():
    for gap in (1e-3, 1e-6, 1e-9):
        kinds = {
            "coupler and rocker stretched": (math.pi, {"lb": 0.25, "lc": 0.4 * (1 + gap) - 0.25}),
            "coupler and rocker folded": (0.0, {"lb": 0.35, "lc": 0.35 - 0.2 * (1 - gap)}),
            "change point at 0 deg": (0.0, {"la": 0.1, "lb": 0.3, "lc": 0.1 * (1 + gap)}),
            "change point at 180 deg": (math.pi, {"la": 0.1, "lb": 0.3, "lc": 0.1 * (1 + gap)}),
        }
        for what, (centre, lengths) in kinds.items():
            single = "" if gap == 1e-3 or (gap == 1e-6 and "stretched" in what) else _DEAD
            values, t = _four_bar_near(centre, gap, **lengths)
            yield Extreme(f"four-bar: {what} but for {gap:.0e}", four_bar, values, t, single=single)


def _masses():
    for part, symbol in (("crank", "m1"), ("rod", "m2"), ("slider", "m3")):
        for mass in (0.0, 1e-10, 1e8):
            yield Extreme(f"slider-crank: {part} of {mass:g} kg", slider_crank, {symbol: mass})
    for symbol in ("ma", "mb", "mc"):
        for mass in (0.0, 1e8):
            yield Extreme(
                f"four-bar: link {symbol[1]} of {mass:g} kg",
                four_bar,
                {symbol: mass},
            )


def _times():
    for t in (1e3, 1e6):
        for scene in (slider_crank, four_bar):
            values = {"change": 0.0}
            name = scene.__name__.replace("_", "-")
            yield Extreme(
                f"{name}: t = {t:.0e} s, {RATE * t:.2g} rad",
                scene,
                values,
                (t, t + 0.08, 7),
            )
    yield Extreme("slider-crank, swung: t = 1e+06 s", swung, {}, (1e6, 1e6 + 0.08, 7))


EXTREMES = (
    Extreme("slider-crank: r/l = 1e-6", slider_crank, {"r": 0.2e-6}),
    Extreme("slider-crank: r/l = 1 - 1e-3 through 90 deg", slider_crank, *_90_TO_3),
    Extreme("slider-crank: r/l = 1 - 1e-6 through 90 deg", slider_crank, *_90_TO_6, single=_DEAD),
    Extreme("slider-crank: r/l = 1 - 1e-9 through 90 deg", slider_crank, *_90_TO_9, single=_DEAD),
    *_dead_centres(),
    *_masses(),
    Extreme(
        "slider-crank: 1e-3 rad/s",
        slider_crank,
        {"rate": 1e-3, "change": 0.0},
        (0.0, 6e3, 7),
    ),
    Extreme(
        "slider-crank: 1e5 rad/s",
        slider_crank,
        {"rate": 1e5, "change": 0.0},
        (0.0, 6e-5, 7),
    ),
    Extreme("four-bar: 1e5 rad/s", four_bar, {"rate": 1e5, "change": 0.0}, (0.0, 6e-5, 7)),
    Extreme("rotor: 1e5 rad/s", rotor, {"rate": 1e5, "change": 0.0}, (0.0, 6e-5, 7)),
    Extreme("spinner: 1e5 rad/s", spinner, {"rate": 1e5, "change": 0.0}, (0.0, 6e-5, 7)),
    Extreme(
        "slider-crank: crank of 1e8 kg at 1e5 rad/s",
        slider_crank,
        {"m1": 1e8, "rate": 1e5},
        (0.0, 6e-5, 7),
    ),
    Extreme("slider-crank: 1e9 rad/s^2", slider_crank, {"change": 5e8}, (0.0, 1e-4, 7)),
    Extreme("four-bar: 1e9 rad/s^2", four_bar, {"change": 5e8}, (0.0, 1e-4, 7)),
    *_times(),
    _platform("micrometres", size=1e-5),
    _platform("1e5 rad/s", (0.0, 9e-6, 31), frequency=1e5),
    _platform("t = 1e+06 s, 6e+06 rad", (1e6, 1e6 + 0.9, 31)),
    Extreme("slider-crank: micrometres", slider_crank, {"r": 1e-6, "l": 2e-6}),
    Extreme("slider-crank: kilometres", slider_crank, {"r": 1e3, "l": 2e3}),
    Extreme(
        "four-bar: micrometres",
        four_bar,
        {"la": 1e-6, "lb": 3.5e-6, "lc": 2.5e-6, "cx": 3e-6, "cy": 5e-7},
    ),
    Extreme(
        "four-bar: kilometres",
        four_bar,
        {"la": 1e3, "lb": 3.5e3, "lc": 2.5e3, "cx": 3e3, "cy": 500.0},
    ),
    Extreme(
        "slider-crank: micrometres on kilometres",
        slider_crank,
        {"r": 1e-6, "l": 1e3},
    ),
    Extreme(
        "four-bar: coupler of a micrometre",
        four_bar,
        {"la": 5e-7, "lb": 1e-6, "lc": 0.3, "cy": 0.0},
        lost=6e5,
    ),
    Extreme(
        "four-bar: rocker of a micrometre",
        four_bar,
        {"la": 5e-7, "lb": 0.3, "lc": 1e-6, "cy": 0.0},
        lost=6e5,
    ),
    Extreme(
        "slider-crank: a kilometre from the origin",
        slider_crank,
        {"x": 1e3, "y": 1e3, "gx": 1e3, "gy": 1e3},
        lost=1e4,
    ),
    Extreme(
        "four-bar: a kilometre from the origin",
        four_bar,
        {"x": 1e3, "y": 1e3, "cx": 1000.3, "cy": 1000.05},
        lost=1e4,
    ),
    Extreme("slider-crank: slider of 1e-310 kg", slider_crank, {"m3": 1e-310}),
    Extreme(
        "slider-crank: all of 1e-310 kg", slider_crank, {"m1": 1e-310, "m2": 1e-310, "m3": 1e-310}
    ),
    Extreme("slider-crank: crank of 1e-310 m", slider_crank, {"r": 1e-310}),
    Extreme("slider-crank: 1e-310 rad/s", slider_crank, {"rate": 1e-310, "change": 0.0}),
    Extreme("slider-crank: t from 0 to 1e-310 s", slider_crank, {}, (0.0, 1e-310, 3)),
)


def row(extreme):
    """A row of the table: for each precision the largest error over peak, and over its bound."""
    cells = []
    for precision in PRECISIONS:
        if precision == "single" and extreme.single:
            cells.append(f"{extreme.single} | ")
            continue
        solution = extreme.solution(precision=precision)
        worst = max(share for _, share in extreme.judged(solution).values())
        cells.append(f"{worst:.1e} | {worst / extreme.bound(solution):.2g}")
    return f"| {extreme.name} | {' | '.join(cells)} |"


def main():
    print("| scene | double: error / peak | of its bound | single: error / peak | of its bound |")
    print("| --- | --- | --- | --- | --- |")
    for extreme in EXTREMES:
        print(row(extreme), flush=True)


if __name__ == "__main__":
    main()

"""Random mechanisms of any pattern that can be declared, each reproduced by its seed.

:func:`draw` draws a mechanism in a posture, first by a pattern that has a name or by chance alone,
then with whatever else can be joined to it; then what drives it, what loads it, and how it is
evaluated. The oracle follows its motion, and says how far it goes.
"""

from __future__ import annotations

import functools
import math
import re
from dataclasses import dataclass

import numpy as np
import random_drives as drives
import random_elements as elements
import random_linkages as linkages
import random_parts as parts
import random_patterns as patterns
from random_draft import Draft
from random_growth import LEAST, attempt, close, dyad, freedom, hang, twice, values
from random_loads import line_load, load, one_way, rotor, strokes
from random_path import Path, follow
from random_patterns import PATTERNS

_HEAD = """import casadi as ca
from casadi import cos, sin, sqrt
from lagrange_casadi import Mechanism, Scene, curve, density, evaluate, motion, table
from lagrange_casadi.elements import belt, bent_bar, cylinder, disc_cam, gas_spring, gears, geneva
from lagrange_casadi.elements import planetary, plate, strut, two_bearings, two_bushes, wheel
"""
_LINKAGES = [linkages.slider_crank, linkages.crank_rocker, linkages.inverted, patterns.open_chain]
KINDS = {
    **dict.fromkeys(parts.PARTS, _LINKAGES),
    "line": [*_LINKAGES, linkages.platform],
    "damper": _LINKAGES,
    "torsion": _LINKAGES,
    "timed": [patterns.led_arm],
    "oldham": [linkages.oldham],
    "toothed": [patterns.planetary, patterns.geared_five_bar, patterns.rack],
    "rolling": [patterns.sleigh, patterns.rolling_wheel],
    "one_way": [],
    "stroke": [],
    "rotor": [],
}
"""What may be asked for in a mechanism, and on which patterns that is built: by default on any."""

_ALONG, _ELEMENTS, _DRIVES, _ASKED, _SWITCHED, _ENDS, _TURNS = range(1, 8)
SPACING = 0.4
"""Of the samples of a motion [s]."""

_DRIVEN = (0.1, 0.03, 1e-4)
"""How singular the gaps may become by the choice of drives: as little as can be."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """A random mechanism: what declares it, how it is evaluated, and the path that the oracle
    follows over the instants.

    ``instants`` are the scene's, ``keywords`` what :func:`evaluate` is given. ``told`` is whether
    the posture says all that may be asked for.
    """

    seed: int
    kind: str
    draft: Draft
    instants: tuple[float, float, int]
    grid: tuple[float, float, int]
    posture: dict[str, float]
    keywords: dict
    path: Path
    told: bool

    @property
    def source(self) -> str:
        """The declaration in Python."""
        d = self.draft
        laws = [f'"{joint}": {text}' for joint, (text, _) in d.laws.items()]
        laws += [f'"{name}": ({", ".join(t for t, _ in led)})' for name, led in d.guides.items()]
        drives = ""
        if d.pushed:
            even = set(d.pushed.values()) == {1.0}
            drives = f", drives={[*d.pushed] if even else d.pushed}"
        scene = (
            f"scene = Scene(m, motion={{{', '.join(laws)}}}, t={self.instants},"
            f" posture={self.posture}{drives})"
        )
        return "\n".join([_HEAD, f'm = Mechanism("{d.name}")', "t = m.time", *d.lines, scene, ""])

    def scene(self):
        """The scene as the source declares it."""
        space: dict = {}
        exec(compile(self.source, f"random mechanism {self.seed}", "exec"), space)
        return space["scene"]

    def describe(self) -> str:
        """Python to paste."""
        keywords = "".join(f", {name}={value!r}" for name, value in self.keywords.items())
        return f"{self.source}solution = evaluate(scene{keywords})\n"


@functools.lru_cache(maxsize=4)
def draw(seed: int, kind: str = "") -> Drawn:
    """The mechanism of a seed; if it is of a kind, with what that says."""
    among = KINDS.get(kind)
    rng = np.random.default_rng([2024, seed, *([[*KINDS].index(kind)] if among else [])])
    while True:
        d = _structure(seed, rng, kind)
        if d is not None and _drive(d):
            if not among and d.chance(0.03):
                _misdrive(d)
            else:
                drives.move(d, np.random.default_rng((seed, _DRIVES)))
                drives.lead(d, np.random.default_rng((seed, _DRIVES, 1)))
            return _finish(seed, d, kind)


def _structure(seed: int, rng: np.random.Generator, kind: str) -> Draft | None:
    """A mechanism without drives; None where chance made too much of it, or nothing."""
    d = Draft(f"random_{kind}{seed}", rng)
    d.parametric, d.far = d.choose(
        (0.0, 0.0), (0.2, 1.0), (0.5, 1.0), (0.2, 0.0), weights=[5, 3, 1, 1]
    )
    d.start = d.choose(0.0, d.between(-2.0, 5.0), weights=[3, 1])
    if among := KINDS.get(kind):
        return _of_kind(d, kind, d.choose(*among))
    whole, grows = _pattern(d)
    for _ in range(grows):
        way = d.choose("hang", "dyad", "close", "twice", weights=[6, 6, 4, 1])
        if way == "hang":
            hang(d)
        elif way == "dyad":
            attempt(d, dyad, takes=0)
        elif way == "twice":
            attempt(d, twice)
        elif freedom(d) > 1 and close(d):
            whole = []
    if not any(body.mass for body in d.bodies.values()):
        return None
    elements.add(d, np.random.default_rng((seed, _ELEMENTS)))
    d.leads = [*whole[:1], *d.leads]
    d.whole = bool(whole) and freedom(d) == 1
    return d if len(d.bodies) <= 14 else None


def _of_kind(d: Draft, kind: str, pattern) -> Draft | None:
    """A pattern with what a kind says, none of it written by parameters."""
    d.leads = [*pattern(d)[:1], *d.leads]
    d.lines.insert(0, f"# {pattern.__name__}, {kind}")
    d.parametric, parametric = 0.0, d.parametric
    if kind in parts.PARTS and not parts.join(d, kind):
        return None
    d.parametric = parametric
    return d if any(body.mass for body in d.bodies.values()) else None


def _pattern(d: Draft):
    """A pattern that has a name, or chance alone: joints that may turn all the way round, and how
    often more is joined.
    """
    whole: list[str] = []
    if d.chance(0.7):
        for _ in range(d.choose(1, 2, weights=[9, 1])):
            pattern = d.choose(*PATTERNS, weights=list(PATTERNS.values()))
            whole = pattern(d)
            d.lines.insert(0, f"# {pattern.__name__}")
        return whole, d.choose(0, 1, 2, 4, weights=[5, 3, 2, 1])
    d.loose_axes = True
    for _ in range(d.choose(2, 3, 4, 5, 7, weights=[2, 3, 3, 2, 1])):
        hang(d)
    for _ in range(8):
        if freedom(d) > d.choose(0, 1, 2, weights=[1, 5, 2]):
            close(d)
    return whole, d.choose(0, 1, 2)


def _drive(d: Draft) -> bool:
    """Choose drives for all that is free, and their laws; False where nothing that can be driven
    moves it well.
    """
    joints = [j for j in d.movable() if j not in d.laws]
    order = [j for j in d.leads if j in joints]
    order += [str(j) for j in d.rng.permutation(joints) if j not in order]
    chosen, left = list(d.laws), freedom(d) - len(d.laws)
    for steady in _DRIVEN:
        for joint in order:
            if left and joint not in chosen:
                found = values(d, [*chosen, joint])
                full = found[found >= LEAST]
                if int(np.sum(found < LEAST)) == left - 1 and full[-1] > steady:
                    chosen.append(joint)
                    left -= 1
    if left or (not chosen and d.chance(0.5)) or values(d, chosen)[-1] < LEAST:
        return False
    for joint in chosen:
        if joint not in d.laws:
            _law(d, joint)
    for joint in chosen:
        if not d.rows and d.chance(0.04):
            # A row that says of a drive what its motion is.
            (rate,) = names = d.measured("coordinate", joint, rate=True)
            jet = d.laws[joint][1].jet(None, d.start)
            if d.laws[joint][0].count(",") == 1 and jet.a == 0.0:
                d.row(d.formula(f"{rate} - ({jet.d!r})", names), joint)
    return True


def _misdrive(d: Draft) -> None:
    """One drive too few, one too many, or another one than would do."""
    kind, free = d.choose("less", "more", "other"), [j for j in d.movable() if j not in d.laws]
    held = [joint for joint in d.laws if joint not in [replaced for _, replaced in d.rows.values()]]
    if kind != "more" and held:
        del d.laws[d.choose(*held)]
    if kind != "less" and free:
        _law(d, d.choose(*free))
    found = values(d, d.laws)
    d.fits = len(d.laws) == freedom(d) and bool(found[-1] >= LEAST)


def _law(d: Draft, joint: str) -> None:
    """A motion that begins in the posture."""
    slides = d.joints[joint].slides
    here, t = d.coordinate(joint), f"(t - {d.start!r})"
    if d.whole and not slides and joint in d.leads:
        speed, gain = d.between(2.0, 9.0) * d.choose(-1, 1), d.choose(0.0, d.between(-1.0, 1.0))
    else:
        speed, gain = d.between(0.1, 1.0) * d.choose(-1, 1), d.choose(0.0, d.between(-1.0, 1.0))
        if slides:
            speed, gain = 0.2 * speed, 0.2 * gain
    kinds = ("line", "polynomial", "harmonic", "expression", "samples", "rest")
    kind = d.choose(*kinds, weights=[2, 4, 2, 1, 0.4, 4.0 if joint in d.defaults else 0.3])
    s = d.start
    if kind == "rest":
        c0 = d.number(here, 0.3 if d.whole else 0.005, d.defaults.get(joint))
        d.drive(joint, f"motion.polynomial({c0.text})", f"{c0.text} + 0.0 * t")
    elif kind in ("line", "polynomial"):
        c1 = d.number(speed - 2 * gain * s if kind == "polynomial" else speed, None if s else 0.3)
        c2 = gain if kind == "polynomial" else 0.0
        c0 = d.number(
            here - c1.value * s - c2 * s * s,
            None if s else 0.3 if d.whole else 0.005,
            d.defaults.get(joint),
        )
        more = f", {c2!r}" if kind == "polynomial" else ""
        d.drive(
            joint,
            f"motion.polynomial({c0.text}, {c1.text}{more})",
            f"{c0.text} + {c1.text} * t + {c2!r} * t**2",
        )
    elif kind == "harmonic":
        size, hertz, phase = speed / 3.0, d.between(0.2, 0.8), d.between(-3.0, 3.0)
        mean = here - size * math.sin(math.tau * hertz * s + phase)
        law = f"{mean!r} + {size!r} * sin({math.tau * hertz!r} * t + {phase!r})"
        d.drive(joint, f"motion.harmonic({mean!r}, {size!r}, {hertz!r}, {phase!r})", law)
    elif kind == "expression":
        law = f"{here!r} + {speed!r} * sin({t}) + {gain!r} * {t} * {t}"
        d.drive(joint, f"motion.expression(lambda t: {law})", law)
    else:  # a cubic is its own spline
        law = f"{here!r} + {speed!r} * {t} + {gain!r} * {t}**3"
        times = [s + SPACING * k for k in range(8)]
        formula = d.formula(law, {})
        d.drive(joint, f"motion.samples({times}, {[formula.jet(None, x).v for x in times]})", law)


def _finish(seed: int, d: Draft, kind: str) -> Drawn:
    """Loads, gravity, instants, posture; and the path."""
    d.gravity = d.choose(
        (0.0, -9.81), (0.0, 0.0), (d.between(-10, 10), d.between(-10, 10)), weights=[5, 1, 2]
    )
    if d.gravity != (0.0, -9.81):
        x, y = (d.number(value, 0.5) for value in d.gravity)
        d.lines.append(f"m.set_gravity({x.text}, {y.text})")
    asked = {"damper": "damper", "torsion": "torsion", "stroke": "spring"}.get(kind)
    for _ in range(3 if asked else d.choose(0, 1, 2, 4)):
        load(d, asked)
    line_load(d, np.random.default_rng((seed, _ALONG)), 1.0 if kind == "line" else 0.4)
    duration = d.choose(d.between(0.3, 1.0), d.between(0.8, 2.5), weights=[2, 1])
    scene_grid = (d.start, d.start + duration, d.choose(5, 21, 61, 121))
    moves = scene_grid[2] - 1
    grid = scene_grid
    if d.chance(0.2):
        first = float(d.start + duration * d.rng.uniform(0.0, 0.6))
        grid = (first, first + float(duration * d.rng.uniform(0.1, 0.4)), moves // 2 + 2)
    elif d.chance(0.1):
        grid = d.choose((d.start, d.start, 1), (d.start, d.start + 0.05, 2))
    path = follow(d, grid[1], 0.05 if d.whole else 0.1)
    if kind == "one_way" and path.motions and d.fits:
        one_way(d, np.random.default_rng((seed, _SWITCHED)), path.motions)
    rotor(d, np.random.default_rng((seed, _TURNS)), 1.0 if kind == "rotor" else 0.1)
    if path.motions:
        often = 1.0 if kind == "stroke" else 0.3
        strokes(d, np.random.default_rng((seed, _ENDS)), path, often)
    own = np.random.default_rng((seed, _ASKED))
    if path.motions and d.fits:
        elements.lose(d, own, path.motions[0])
        drives.push(d, own, path)
        drives.ask(d, own)
    if path.end < grid[1] and d.chance(0.8) and path.end > grid[0] + 0.05:
        stop = grid[0] + float(f"{0.9 * (path.end - grid[0]):.2g}")
        scene_grid = (scene_grid[0], max(stop, scene_grid[0] + 0.01), scene_grid[2])
        grid = (grid[0], stop, grid[2])
    if all(
        text.startswith("motion.polynomial") and "," not in text for text, _ in d.laws.values()
    ) and d.chance(0.5):  # at rest
        scene_grid = grid = (d.start, d.start, 1)
    noise = d.choose(0.0, 0.02, 0.05, weights=[1, 4, 2])
    posture = {}
    for name, body in d.bodies.items():
        if body.oriented:
            posture[name] = round(d.poses[name][2] + float(d.rng.normal(0.0, noise)), 4)
    for name, joint in d.joints.items():
        if joint.slides:
            posture[name] = round(d.coordinate(name) + float(d.rng.normal(0.0, 0.3 * noise)), 4)
    told = d.chance(0.95)
    if not told:
        posture = {name: value for name, value in posture.items() if d.chance(0.7)}
    if d.chance(0.3):
        d.lines = _shuffled(d)
    over = drives.over(d, own, scene_grid, grid) if path.end >= grid[1] else None
    keywords = {"t": grid} if over is None else {"over": over}
    if moved := {
        name: value for name, (default, value) in d.parameters.items() if default != value
    }:
        keywords["parameters"] = moved
    if d.chance(0.1):
        names = (
            [f"section:{link}" for link in d.limited]
            + [f"reaction:{joint}" for joint in d.joints]
            + ["effort"]
        )
        keywords["wanted"] = ["motion", *(name for name in sorted(names) if d.chance(0.4))]
    return Drawn(seed, kind, d, scene_grid, grid, posture, keywords, path.until(grid[1]), told)


def _shuffled(d: Draft) -> list[str]:
    """The declaration in another order, each line after those whose names it takes."""
    waiting, known, found = [str(line) for line in d.rng.permutation(d.lines)], set(), []
    made = {
        name: line
        for line in d.lines
        for name in re.findall(r"\w+", line.partition(" = ")[0])
        if " = " in line
    }
    while waiting:
        for line in waiting:
            words = re.findall(r"\w+", re.sub('"[^"]*"', "", line))
            own = {name for name in words if name in made and made[name] != line}
            if own <= known:
                break
        waiting.remove(line)
        found.append(line)
        known |= {name for name in made if made[name] == line}
    return found

"""A solution beside the oracle, at some of its instants.

A quantity is right within 1e-9 of its peak over the instants looked at, or of a thousandth of the
largest of its kind. Rounding is ``64 eps / s^2`` of the largest of its kind, with s the least
singular value of the loops' slope (its steadiness): a posture is off by eps / s, and that changes s
itself by the part eps / s^2. Where that is more, as near a dead centre, so much is right; where s
is below 1e-6 nothing is judged. What a load magnifies is found by trial: see
:meth:`Comparison._blur`.
"""

from __future__ import annotations

import collections
import functools
import math
from dataclasses import dataclass

import numpy as np
import oracle
from random_formula import joint_coordinate, under
from random_mechanisms import SPACING, Drawn
from random_path import Path, follow

TOLERANCE = 1e-9
SMALL = 1e-3
ROUNDING = 2.0**-52
CONDEMNED, WITHHELD = "its certificate fails", "is withheld, and unique"
_UNJUDGED = 1e-6
_INSTANTS, _CLOSED_AT = 4, 12
_BESIDE, _AT_STATION = 2e-3, 1e-5
_NOTHING = 1e-300
_PEAKS, _AT_PEAK, _STEADY_PEAK = 3, 1e-8, 1e-3
FACTOR, STATED = 10.0, 640.0
"""An error that is stated is within a factor of what it is of, and no more than so many roundings
of the largest of its kind, as the loops magnify these.
"""


@dataclass(frozen=True, eq=False)
class _Gap:
    """How far a quantity is off at an instant, its value, the part that is rounding there, and the
    instant's solution.
    """

    t: float
    gap: float
    value: float
    rounding: float
    exact: oracle.Result
    ratios: dict[str, list[float]]


def _nearest(angle: float, to: float) -> float:
    """An angle with the turns that bring it nearest to another."""
    return angle + math.tau * round((to - angle) / math.tau) if math.isfinite(angle) else angle


def _places(exact: oracle.Result) -> dict[str, tuple[float, ...]]:
    return {name: tuple(x.v for x in q) for name, q in exact.q.items()}


def _at(laws, name: str):
    """Of a section's three forces at a ratio the one of this name."""
    full, _, ratio = name.partition("@")
    _, link, force = full.split(":")
    return laws[link](float(ratio))[oracle.SECTION.index(force)]


def _open(exact: oracle.Result, name: str) -> bool:
    """Whether equilibrium leaves a quantity open."""
    return _at(exact.open_sections, name) if "@" in name else name in exact.open


class Comparison:
    """A solution beside the oracle."""

    def __init__(self, drawn: Drawn, solution) -> None:
        self.drawn, self.d, self.solution = drawn, drawn.draft, solution
        self.rng = np.random.default_rng(drawn.seed)
        self.notes: list[str] = []
        self.faults: list[str] = []
        self.found: dict[str, list[_Gap]] = collections.defaultdict(list)
        self.withheld: dict[str, list[bool]] = collections.defaultdict(
            list
        )  # whether each value is open indeed
        self.angles = {
            f"motion:{name}" for name, joint in self.d.joints.items() if not joint.slides
        }
        self.units: dict[str, float] = {}  # the force of a unit multiplier
        self.size = self.d.oracle(self.d.start).size
        self.determined = functools.cache(solution.determined)

    def look(self, peaks=()) -> None:
        """Fill ``faults``, what is wrong, and ``notes``, what is doubtful: the first fault tells
        most. ``peaks`` are those that the package has between the instants.
        """
        path = self._path()
        if path is None:
            return
        for i in self._some(_CLOSED_AT):
            self._closes(i, path)
        for i in self._some(_INSTANTS):
            # An instant that is asked for by a drive's coordinate is exact to some roundings.
            if self.solution.t[i] - path.end <= 64 * ROUNDING * max(1.0, abs(path.end)):
                self._compare(i, path)
        self._weigh()
        self._look_at_peaks(peaks, path)
        for name, loose in self.withheld.items():
            if not any(loose):
                self.notes.append(f"'{name}' {WITHHELD} at all instants that were evaluated")
        for name, worst in self.solution.failed.items():
            self.notes.append(f"{CONDEMNED} by {name} {worst:.2g}")

    def _some(self, count: int) -> list[int]:
        n = self.solution.t.size
        return sorted({0, n - 1, *(int(k) for k in self.rng.integers(0, n, count - 2))})

    # Motion

    def poses(self, i: int, near) -> dict[str, tuple[float, float, float]]:
        """What the solution says of the bodies' places, its angles with the turns that make them
        nearest to others.
        """
        found = {}
        for name, body in self.d.bodies.items():
            x, y = (float(self.solution.series[f"pose:{name}:{k}"][i]) for k in "xy")
            angle = float(self.solution.series[f"pose:{name}:angle"][i]) if body.oriented else 0.0
            found[name] = (x, y, _nearest(angle, near[name][2]))
        return found

    def _path(self) -> Path | None:
        """The oracle's path, or the one from the posture in which the solution begins, where that
        is another.
        """
        path, t = self.drawn.path, float(self.solution.t[0])
        if not path.times or path.end < t:
            gap = self._gap(t, self.poses(0, self.d.poses))
            if gap > 1e-6 * self.size:
                self.faults.append(
                    f"the oracle closes its loops up to t = {path.end:g} s only; a gap of {gap:.3g}"
                    " is left in the solution"
                )
            return None
        near = path.near(t)
        mine = self.d.oracle(t).move(self.d.drives(t), near)
        poses = self.poses(0, _places(mine))
        off = self._off(poses, mine)
        if off < 1e-5:
            return path
        gap = self._gap(t, poses)
        if gap > 1e-6 * self.size:
            self.faults.append(
                f"at t = {t:g} s a gap of {gap:.3g} is left between bodies, the posture is off by"
                f" {off:.3g}"
            )
            return None
        other = follow(self.d, float(self.solution.t[-1]), 0.1, t, self._unwound(t, poses))
        return other if other.times else None

    def _off(self, poses, exact) -> float:
        """How far poses are from exact ones, in sizes and radians."""
        scales = (self.size, self.size, 1.0)
        gaps = [
            abs(a - b.v) / s
            for name, q in exact.q.items()
            for a, b, s in zip(poses[name], q, scales, strict=True)
        ]
        return float(max(gaps)) if all(map(math.isfinite, gaps)) else math.inf

    def _gap(self, t: float, poses) -> float:
        """The largest gap that poses leave."""
        poses = self._unwound(t, poses)
        q = np.array([x for name in self.d.bodies for x in poses[name]])
        gaps = self.d.oracle(t).gaps(q, np.zeros_like(q), self.d.drives(t))[0]
        return float(np.max(np.abs(gaps), initial=0.0)) if np.isfinite(gaps).all() else math.inf

    def _unwound(self, t: float, poses):
        """Poses whose whole turns fit the joints that tie directions."""
        known, drives = {"ground": 0.0}, self.d.drives(t)
        poses, moved = dict(poses), True
        oriented = [name for name, body in self.d.bodies.items() if body.oriented]
        while len(known) <= len(oriented):
            if not moved:  # nothing ties what is left to what is known: it stays as it is
                known |= {
                    name: poses[name][2] for name in [n for n in oriented if n not in known][:1]
                }
            moved = False
            for name, joint in self.d.joints.items():
                tied = (
                    joint.angle
                    if joint.kind in ("prismatic", "weld")
                    else drives.get(name, (None,))[0]
                )
                ends = (joint.parent[0], joint.child[0])
                if (
                    tied is None
                    or (joint.slides and joint.kind == "slot")
                    or sum(e in known for e in ends) != 1
                ):
                    continue
                if not all(e == "ground" or self.d.bodies[e].oriented for e in ends):
                    continue
                near, far, sign = (*ends, 1) if ends[0] in known else (*ends[::-1], -1)
                x, y, angle = poses[far]
                known[far] = _nearest(angle, known[near] + sign * tied)
                poses[far], moved = (x, y, known[far]), True
        return poses

    def _closes(self, i: int, path: Path) -> None:
        """Hold the bodies' places against the path's, or where that ends or may go on in two ways,
        look at the gaps alone.
        """
        t = float(self.solution.t[i])
        if t <= min(path.end, path.passes):
            found = self.d.oracle(t).move(self.d.drives(t), path.near(t))
            off = self._off(self.poses(i, _places(found)), found)
            if off > 1e-6 / max(found.steadiness, _UNJUDGED):
                self.faults.append(f"at t = {t:g} s the bodies are off by {off:.3g}")
        elif (
            not self.d.constraints
            and (gap := self._gap(t, self.poses(i, path.near(t)))) > 1e-7 * self.size
        ):
            self.faults.append(f"at t = {t:g} s a gap of {gap:.3g} is left between bodies")

    # Everything at an instant

    def _compare(self, i: int, path: Path) -> None:
        t = float(self.solution.t[i])
        model, near = self.d.oracle(t), path.near(t)
        if t > path.passes:
            # Either way on is a motion: the solution's own is looked at, if it is one.
            near = self._unwound(t, self.poses(i, near))
        exact = model.solve(self.d.drives(t), near)
        if exact.steadiness < _UNJUDGED or exact.vague:
            return
        for extra in model.extras:
            if extra.effect is None:
                continue
            acts = [
                max(abs(fx), abs(fy), abs(mz) / self.size)
                for _, fx, fy, mz in extra.effect(model.places(exact))
            ]
            self.units[extra.name] = max(acts, default=0.0) or 1.0
        ratios = self._ratios(exact, model.places(exact))
        rounding = 64 * ROUNDING / exact.steadiness**2
        told = self._told(i, ratios)
        for name, value in self._named(exact, model, ratios).items():
            full, loose = name.partition("@")[0], _open(exact, self._source(name)[0])
            if not self.determined(full):
                self.withheld[full].append(loose)
            elif loose:
                self.faults.append(f"'{name}' is given, and is not unique at t = {t:g} s")
            else:
                mine, whole = told[name], name.endswith(":angle") or name in self.angles
                gap = (
                    math.remainder(mine - value, math.tau)
                    if whole and math.isfinite(mine)
                    else mine - value
                )
                self.found[name].append(_Gap(t, gap, value, rounding, exact, ratios))

    def _told(self, i: int, ratios: dict[str, list[float]]) -> dict[str, float]:
        """What the solution says of everything, by full name; of section forces at ratios."""
        told = {name: float(values[i]) for name, values in self.solution.series.items()}
        for link, some in ratios.items():
            law = self.solution.section(link).law.during(slice(i, i + 1))
            for force in oracle.SECTION:
                names = [f"section:{link}:{force}@{u!r}" for u in some]
                told |= zip(names, law.at(force, np.array([some]))[0].tolist(), strict=True)
        return told

    def _named(self, exact, model, ratios) -> dict[str, float]:
        """What the oracle says of all that the solution has or should have, by full name; of
        section forces at ratios.
        """
        known, place = {*self.solution.series, *self.solution.undetermined}, model.places(exact)
        named = {
            f"pose:{name}:{k}": x.v
            for name, q in exact.q.items()
            for k, x in zip(("x", "y", "angle"), q, strict=True)
        }
        for name, joint in self.d.joints.items():
            jet = joint_coordinate(joint, place)
            named |= {
                f"motion:{name}": jet.v,
                f"motion:{name}_rate": jet.d,
                f"motion:{name}_acceleration": jet.a,
            }
            named |= {
                f"reaction:{name}:{k}": x
                for k, x in zip(oracle.FORCES, exact.reactions[name], strict=True)
            }
        named |= {f"effort:{name}": x for name, x in exact.efforts.items()}
        named |= {f"multiplier:{name}": x for name, x in exact.multipliers.items()}
        for name, spot in self.d.paths.items():
            for k, jet in zip("xy", place(spot.point), strict=False):
                named |= {
                    f"output:{name}_{k}": jet.v,
                    f"output:{name}_v{k}": jet.d,
                    f"output:{name}_a{k}": jet.a,
                }
        for name, contact in self.d.contacts.items():
            told = contact.outputs(exact.multipliers[name])
            named |= {f"output:{output}": x for output, x in told.items()}
        for name, (first, second, (closed, out)) in self.d.strokes.items():
            (ax, ay, _), (bx, by, _) = place(first), place(second)
            reach = math.hypot(bx.v - ax.v, by.v - ay.v)
            named[f"output:{name}_stroke"] = (reach - closed) / (out - closed)
        for name, (of, factor) in self.d.outputs.items():
            force = _at(exact.sections, of) if "@" in of else named[of]
            named[f"output:{name}"] = factor * force
        named = {name: float(x) for name, x in named.items() if name in known}
        for link in self.solution.links_with_sections:
            for u in ratios[link]:
                forces = exact.sections[link](u)
                named |= {
                    f"section:{link}:{force}@{u!r}": float(x)
                    for force, x in zip(oracle.SECTION, forces, strict=True)
                }
        return named

    def _source(self, name: str) -> tuple[str, float]:
        """What an output is so many times of, as the multiplier of a contact; others themselves."""
        _, _, output = name.partition("output:")
        contact = next((name for name in self.d.contacts if output.startswith(f"{name}_")), "")
        if contact:
            return f"multiplier:{contact}", 1.0
        return self.d.outputs.get(output, (name, 1.0))

    def _ratios(self, exact, place) -> dict[str, list[float]]:
        """Where to look at each link: its ends, anywhere, and beside its stations; not where a
        station is just now.
        """
        found = {}
        for link in self.solution.links_with_sections:
            l = self.d.bodies[link].length
            fixed = {
                point[1] / l
                for joint in self.d.joints.values()
                for point in (joint.parent, joint.child)
                if point[0] == link
            }
            fixed |= {x / l for x in self.d.stations.get(link, ())}
            moving = {
                float(under(j, place)[1]) / l
                for j in self.d.joints.values()
                if j.slides and j.parent[0] == link
            }
            ratios = [
                0.0,
                1.0,
                *self.rng.random(3),
                *(s + e for s in sorted(fixed) for e in (-_BESIDE, _BESIDE)),
            ]
            found[link] = [
                float(u)
                for u in ratios
                if 0.0 <= u <= 1.0
                and all(
                    abs(u - s) > _AT_STATION
                    for s in (moving if u in (0.0, 1.0) else moving | fixed)
                )
            ]
        return found

    def _weigh(self) -> None:
        """Hold every gap against its quantity's peak, and against a small part of the largest of
        its kind.
        """
        peaks: dict[str, float] = collections.defaultdict(float)
        for name, gaps in self.found.items():
            full = name.partition("@")[0]
            peaks[full] = max(peaks[full], *(abs(gap.value) for gap in gaps))
        largest = self._largest(peaks)
        self._weigh_errors(largest)
        for name, gaps in self.found.items():
            kind, scale = self._kind(name)
            most, kin = peaks[name.partition("@")[0]], largest[kind] / scale
            for gap in gaps:
                part = max(TOLERANCE, gap.rounding)
                allowed = max(part * most, part * SMALL * kin, gap.rounding * kin)
                if not abs(gap.gap) <= allowed and not abs(gap.gap) <= self._blur(name, gap):
                    off = f"off by {abs(gap.gap) / (most or 1.0):.2g} of its peak"
                    value = f"'{name}' is {gap.value + gap.gap:.12g} for {gap.value:.12g}"
                    self.faults.append(f"{value} at t = {gap.t:.6g} s: {off}")
                    break
        self.faults.sort(key=lambda fault: "not unique" in fault)

    def _weigh_errors(self, largest) -> None:
        """Hold every error that is stated against the gap that there is, and against what rounding
        may make of the largest of its kind.
        """
        for name, gaps in self.found.items():
            kind, scale = self._kind(name)
            stated = self.solution.errors.get(name.partition("@")[0])
            if stated is None:
                continue
            least = min(gap.exact.steadiness for gap in gaps)
            part = STATED * ROUNDING / min(least, self.drawn.path.steadiness) ** 2
            most = part * largest[kind] / scale + _NOTHING
            for gap in gaps:
                own = gap.rounding * largest[kind] / scale
                told = f"'{name}' states {stated:.3g}"
                if (
                    abs(gap.gap) > FACTOR * stated + own
                    and abs(gap.gap) > self._blur(name, gap) + own
                ):
                    self.faults.append(f"{told} and is off by {gap.gap:.3g} at t = {gap.t:.6g} s")
                    break
                if stated > most and stated > STATED * self._blur(name, gap):
                    self.faults.append(f"{told}, far more than the {most:.3g} that rounding makes")
                    break

    def _look_at_peaks(self, peaks, path: Path) -> None:
        """Hold peaks against the oracle: none is less than its value at any instant that was looked
        at, and at the peak's own time that is the value.
        """
        told = {peak.name: peak for peak in peaks if math.isfinite(peak.value)}
        scales = {name: self._kind(name) for name in self.found}
        sizes: dict[str, float] = collections.defaultdict(float)
        for name, gaps in self.found.items():
            kind, scale = scales[name]
            sizes[kind] = max(sizes[kind], *(abs(gap.value) * scale for gap in gaps))
        for name, gaps in self.found.items():
            full, (kind, scale) = name.partition("@")[0], scales[name]
            most = max(abs(gap.value) for gap in gaps)
            if full in told and abs(told[full].value) < most - 1e-7 * sizes[kind] / scale:
                self.faults.append(f"the peak {told[full]} is less than {most}")
        some = [peak for peak in told.values() if peak.t < min(path.end, path.passes)]
        for k in self.rng.permutation(len(some))[:_PEAKS]:
            self._look_at_peak(some[k], path, sizes)

    def _look_at_peak(self, peak, path: Path, sizes) -> None:
        """At its own time, or just beside where a load comes to a link or leaves it."""
        kind, scale = self._kind(peak.name)
        allowed = 1e-6 * max(abs(peak.value), sizes[kind] / scale)
        for by in (0.0, -_AT_PEAK, _AT_PEAK):
            t = peak.t + by
            model = self.d.oracle(t)
            try:
                exact = model.solve(self.d.drives(t), path.near(t))
            except oracle.OpenLoopError:  # where a pin enters a slot, Newton's method goes between
                return
            if exact.steadiness < _STEADY_PEAK or exact.vague:
                return
            if peak.xi is None:
                named = self._named(exact, model, collections.defaultdict(list))
                values = [named.get(peak.name, peak.value)]
            else:
                _, link, force = peak.name.split(":")
                ratios = [min(max(peak.xi + x, 0.0), 1.0) for x in (0.0, -_AT_PEAK, _AT_PEAK)]
                values = [exact.sections[link](u)[oracle.SECTION.index(force)] for u in ratios]
            if min(abs(abs(value) - abs(peak.value)) for value in values) <= allowed:
                return
        self.faults.append(f"the peak {peak} is {values[0]} there")

    def _largest(self, peaks: dict[str, float]) -> dict[str, float]:
        """The largest of each kind, given loads, weight and inertia among the forces."""
        largest: dict[str, float] = collections.defaultdict(float)
        for name, peak in peaks.items():
            kind, scale = self._kind(name)
            largest[kind] = max(largest[kind], peak * scale)
        largest["acceleration"] = max(largest["acceleration"], largest["rate"] ** 2)
        if any(
            text.startswith("motion.samples") for text, _ in self.d.laws.values()
        ):  # a spline divides what they are rounded by
            most = max(
                abs(law.jet(None, t).v)
                for _, law in self.d.laws.values()
                for t in self.solution.t[[0, -1]]
            )
            largest["acceleration"] = max(largest["acceleration"], most / SPACING**2)
        for name, values in self.solution.series.items():
            if name.startswith("load:"):
                given = float(np.max(np.abs(values))) / (self.size if name.endswith(":mz") else 1.0)
                largest["force"] = max(largest["force"], given)
        mass = sum(body.mass for body in self.d.bodies.values())
        weight = math.hypot(*self.d.gravity)
        largest["force"] = max(
            largest["force"], mass * (weight + largest["acceleration"] * self.size)
        )
        largest["place"], largest["angle"] = self.size / SMALL, 1.0 / SMALL
        return largest

    def _blur(self, name: str, gap: _Gap) -> float:
        """What the rounding of the motion makes of a quantity, as the loads magnify it: eight times
        the most of four trials.
        """
        model, most = self.d.oracle(gap.t), 0.0
        for _ in range(4):
            q = {
                body: tuple(self._rounded(x, gap.exact) for x in jets)
                for body, jets in gap.exact.q.items()
            }
            other = oracle.Result(q)
            try:
                model.balance(other, self.d.drives(gap.t))
            except AssertionError:  # a repeated equation is off by the rounding
                return most
            most = max(most, abs(self._named(other, model, gap.ratios)[name] - gap.value))
        return 8.0 * most

    def _rounded(self, x: oracle.Jet, exact) -> oracle.Jet:
        rates = max(abs(y.d) for jets in exact.q.values() for y in jets)
        bends = max(abs(y.a) for jets in exact.q.values() for y in jets)
        by = ROUNDING / exact.steadiness * self.rng.uniform(-1.0, 1.0, 3)
        return oracle.Jet(x.v + by[0], x.d + by[1] * rates, x.a + by[2] * (bends + rates * rates))

    def _kind(self, name: str) -> tuple[str, float]:
        """What a quantity is compared with, and its factor there: moments are forces at an arm of
        the mechanism's size.
        """
        name, factor = self._source(name)
        if factor != 1.0:
            kind, scale = self._kind(name)
            return kind, scale / abs(factor)
        name = name.partition("@")[0]
        group, part, *_ = name.split(":")
        if part.endswith("_stroke"):
            closed, out = self.d.strokes[part.removesuffix("_stroke")][-1]
            return "place", out - closed
        if group == "output":  # of a path
            order = {"v": "rate", "a": "acceleration"}.get(part[-2])
            return (order, 1.0 / self.size) if order else ("place", 1.0)
        if group == "pose":
            return ("angle" if name.endswith("angle") else "place"), 1.0
        joint = self.d.joints.get(part.removesuffix("_rate").removesuffix("_acceleration"))
        if group == "motion":
            order = part.removeprefix(joint.name).removeprefix("_")
            if not order:
                return ("place" if joint.slides else "angle"), 1.0
            return order, 1.0 / self.size if joint.slides else 1.0
        if group == "multiplier":
            return "force", self.units[part]
        moment = name.endswith((":mz", ":bending")) or (group == "effort" and not joint.slides)
        return "force", 1.0 / self.size if moment else 1.0

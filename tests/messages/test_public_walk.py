"""Every public function, class and method is called with every wrong kind: only errors of this
package come, in one line.
"""

import importlib
import inspect
import itertools
import random
import re
import warnings
from collections.abc import Mapping
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import casadi as ca
import numpy as np
import public_calls
import pytest
from commands import Hung, limited

from lagrange_casadi import Mechanism
from lagrange_casadi.errors import LagrangeCasadiError

# ruff: noqa: SIM905 - names in lines are read more easily

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

NEVER = {
    "object": object,
    "bytes": lambda: b"x",
    "set": lambda: {1, 2},
    "complex": lambda: 1j,
    "class": lambda: int,
    "our class": lambda: Mechanism,
    "module": lambda: np,
    "exception": lambda: ValueError("x"),
    "ellipsis": lambda: ...,
    "frozen set": lambda: frozenset(["x"]),
    "date": lambda: np.datetime64("2020"),
    "objects": lambda: np.array([object()], object),
    "list of objects": lambda: [object()],
    "MX": lambda: ca.MX.sym("z"),
}
"""What no parameter takes."""

SOME = {
    "None": lambda: None,
    "3": lambda: 3,
    "-1": lambda: -1,
    "0": lambda: 0,
    "nan": lambda: float("nan"),
    "inf": lambda: float("inf"),
    "1e40": lambda: 10**40,
    "-1e40": lambda: -(10**40),
    "1e400": lambda: 10**400,
    "True": lambda: True,
    "text": lambda: "x",
    "no text": lambda: "",
    "nul": lambda: "a\0b",
    "half a letter": lambda: "\ud800",
    "long text": lambda: "x" * 100_000,
    "list": list,
    "tuple": tuple,
    "mapping": dict,
    "[3]": lambda: [3],
    "[None]": lambda: [None],
    "['x']": lambda: ["x"],
    "ragged": lambda: [[1], [1, 2]],
    "nested": lambda: [[[]]],
    "mixed": lambda: ("x", 3),
    "{3: 3}": lambda: {3: 3},
    "{x: None}": lambda: {"x": None},
    "{l: []}": lambda: {"l": []},
    "array": lambda: np.array([1.0, 2.0]),
    "0-d": lambda: np.array(1.0),
    "2-d": lambda: np.ones((2, 2)),
    "empty array": lambda: np.empty(0),
    "texts": lambda: np.array(["x", "y"]),
    "nans": lambda: np.full(3, np.nan),
    "lambda": lambda: lambda *_: None,
    "SX": lambda: ca.SX.sym("z"),
    "SX of two": lambda: ca.SX.sym("z", 2),
    "DM": lambda: ca.DM([1, 2]),
    "DM of one": lambda: ca.DM(1),
    "path": lambda: Path("nowhere/x"),
    "generator": lambda: (i for i in range(3)),
    "range": lambda: range(3),
    "another mechanism": lambda: Mechanism("other"),
    "slice": lambda: slice(None),
    "memory": lambda: memoryview(b"xx"),
    "single": lambda: np.float32(3),
    "decimal": lambda: Decimal("NaN"),
    "fraction": lambda: Fraction(1, 3),
}
"""What some parameters may take."""

KINDS = {**NEVER, **SOME}

CALLED = {("select", "duty"), ("optimise", "progress"), ("sweep", "progress"), ("elements", "lift")}
"""The user's functions: what they raise goes through."""

LONG = """
export optimise sweep tolerances size Scene.report draw Sweep.report Solution.report Solution.view Solution.animate
""".split()  # noqa: E501
"""What takes long where it takes a value: left out of the quick walk."""


@pytest.fixture(scope="module")
def things(tmp_path_factory, interpreted):
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("walk"))
        public_calls.files()
        yield public_calls.solved()


NUMBERS = itertools.count()


def call(function, given):
    """Call a function by names of arguments, what it declares under a name of its own; what it
    gives in turn is walked over.
    """
    named = {
        name: f"new{next(NUMBERS)}" if isinstance(value, str) and value == "new" else value
        for name, value in given.items()
    }
    stars = named.pop("*", ())
    found = function(*stars, **named)
    return list(found) if inspect.isgenerator(found) else found


def changed(function, given, name, value):
    """Arguments of which one is another."""
    each = inspect.signature(function).parameters
    given, kind, place = dict(given), each[name].kind, list(each).index(name)
    if kind is inspect.Parameter.VAR_KEYWORD:
        given.pop("*", None)
        return {**given, "l": value}
    if kind is inspect.Parameter.VAR_POSITIONAL:
        return {**given, "*": (*given.get("*", ())[:-1], value)}
    if kind is inspect.Parameter.POSITIONAL_ONLY:
        return {"*": (value,)}
    if "*" in given:
        stars = list(given["*"])
        stars[place] = value
        return {**given, "*": tuple(stars)}
    return {**given, name: value}


def fault(function, given):
    """What is wrong with how a call ends; nothing where it is refused as it should be."""
    try:
        with limited(120), warnings.catch_warnings():
            warnings.simplefilter("error")
            call(function, given)
    except LagrangeCasadiError as error:
        text = str(error)
        return "" if text and "\n" not in text and len(text) < 2100 else f"says {text[:200]!r}"
    except Hung:
        return "hangs"
    except Exception as error:  # what the test is about
        return f"{type(error).__name__}: {str(error)[:200]}"
    return "is accepted"


def fault_of_kind(of, function, given, name, kind):
    """What is wrong with a call where one argument is of another kind; nothing too where that is
    right.
    """
    said = fault(function, changed(function, given, name, KINDS[kind]()))
    if said == "is accepted":
        callable_kind = kind in ("class", "our class") and (
            name in ("lift", "law", "duty", "progress") or (of, name) in CALLED
        )
        return said if kind in NEVER and not callable_kind else ""
    return "" if (of, name) in CALLED and said != "hangs" and not said.startswith("says ") else said


def wrong_calls(calls):
    """Every call with each parameter of each kind."""
    for of, (function, _) in calls.items():
        for name in inspect.signature(function).parameters:
            yield from ((of, name, kind) for kind in KINDS)


def walked(things, chosen):
    """The faults of wrong calls.

    What declares is called on a mechanism of its own, made anew after some calls.
    """
    calls, declared = public_calls.rights(things), {of for of, _ in public_calls.declarations()}
    found, fresh = {}, calls
    for number, (of, name, kind) in enumerate(chosen):
        if of in declared and number % 10 == 0:
            fresh = dict(public_calls.declarations())
        function, given = fresh[of] if of in fresh else calls[of]
        if said := fault_of_kind(of, function, given, name, kind):
            found[of, name, kind] = said
    return found


def ours(thing, depth=1):
    """A thing of this package and those that it holds for users to see."""
    if type(thing).__module__.partition(".")[0] == "lagrange_casadi":
        yield thing
        if depth:
            for name, inner in getattr(thing, "__dict__", {}).items():
                if not name.startswith("_"):
                    yield from ours(inner, depth - 1)
    elif isinstance(thing, Mapping):
        for inner in thing.values():
            yield from ours(inner, depth)
    elif isinstance(thing, list | tuple):
        for inner in thing:
            yield from ours(inner, depth)


def unlike_a_line(thing):
    """What is wrong with how a notebook shows a thing."""
    text = repr(thing)
    return text[:300] if len(text) > 200 or "\n" in text or " object at 0x" in text else ""


def test_right_calls_are_right_and_give_what_is_shown_in_a_line(things):
    seen, found = set(), {}
    for function, given in public_calls.rights(things).values():
        for thing in ours(call(function, given)):
            seen.add(type(thing).__name__)
            if said := unlike_a_line(thing):
                found[type(thing).__name__] = said
    assert found == {}
    assert {"Gears", "LoadCase", "Optimum", "Program", "Sizing", "Solution", "Spreads"} <= seen


def test_wrong_kinds_are_refused(things):
    every = [
        one
        for one in wrong_calls(public_calls.rights(things))
        if one[0] not in LONG and one[2] != "long text"
    ]
    assert walked(things, random.Random(17).sample(every, 400)) == {}


@pytest.mark.long
@pytest.mark.parametrize("part", range(16))
def test_every_wrong_kind_is_refused(things, part):
    assert walked(things, list(wrong_calls(public_calls.rights(things)))[part::16]) == {}


TOLD = re.compile(r"^(\w[\w, ]*)(?: : .*)?\n((?:    .*\n|\n)+)", re.MULTILINE)
UNITLESS = {
    *("Mechanism.drive:ratio", "Mechanism.friction:static", "gears:teeth", "Scene:rounding"),
    *("motion.read_samples:ratio", "motion.read_samples:stretch", "duty_of:ratio"),
    "Measurements:t",
}
"""Arguments without a unit that a docstring tells beside others, and an array of measured times."""


def in_another_unit(value):
    """A text in a unit of no argument, or a list of such texts of the same shape."""
    return [*map(in_another_unit, value)] if isinstance(value, list | tuple) else "2 kg^7"


def test_what_has_a_unit_is_read_with_a_unit(things):
    """No number that a docstring says in a unit is refused as a text for being no plain number."""
    plain = set()
    for of, (function, given) in public_calls.rights(things).items():
        told = TOLD.findall(inspect.getdoc(inspect.unwrap(function)) or "")
        names = {name for names, words in told if "[" in words for name in names.split(", ")}
        for name in names & {*inspect.signature(function).parameters}:
            try:
                call(function, changed(function, given, name, in_another_unit(given.get(name))))
            except LagrangeCasadiError as error:
                if re.match(r"[^\[]*(?<!whole )number[^\[]*(, got|$)", str(error)):
                    plain.add(f"{of}:{name}")
    assert plain == UNITLESS


def misfits(function, given):
    """Calls that name what a function does not take, give too much, or lack what it needs."""
    each = inspect.signature(function).parameters.values()
    kinds = {one.kind for one in each}
    yield "another name", {**given, "nonsense": 3}
    if inspect.Parameter.VAR_POSITIONAL not in kinds:
        yield "too many", {"*": (None,) * 99}
    for one in each:
        if one.default is one.empty and one.name in given:
            yield (
                f"no {one.name}",
                {name: value for name, value in given.items() if name != one.name},
            )


def test_calls_that_do_not_fit_are_refused(things):
    found = {
        (of, how): said
        for of, (function, right) in public_calls.rights(things).items()
        for how, given in misfits(function, right)
        if (said := fault(function, given))
    }
    assert not found, "\n".join(map(str, found))


RESULTS = """
Bearings Belt Bent Bushes Cam CamProfile Cylinder CylindricalCam Gears Geneva Planetary Plate
ProfileLift
Choice InertiaRatio Animation Fibre Properties Course Density Slices Dwell Motion Move Column Life
Plane Safety Stress StressPeak StressCycle Verdict Constraint Front FrontPoint Limit LocalOptimum
Optimum Start LoadCase BearingLoads Term Axis Design Sweep Case Curve Peak Prepared Sensitivities
Solution Keep Duty Spec Cycle Event Flywheel FreeMotion Law Identification
""".split()
"""Classes that users are given, and make none of."""

INNER = """
direction
multiplier output check_ending analysed mapped needs rows parameter_constraints refined instants timetable block scale outside made_of
at ends tails cell_at whole holds excess of_parameters unit __getitem__ __call__ largest
grid size draw needs count index curvature copy
""".split()  # noqa: E501
"""Methods that are the package's own between its rooms, or of tuples."""


def public_things():
    """All names of the public modules, and methods with arguments of public classes."""
    for door in public_calls.DOORS:
        module = importlib.import_module(door)
        for name in module.__all__:
            thing = getattr(module, name)
            if isinstance(thing, type) and not issubclass(thing, Exception):
                if name not in RESULTS:
                    yield f"{door}.{name}", thing
                for method, function in inspect.getmembers(thing, inspect.isfunction):
                    if (
                        not method.startswith("_")
                        and method not in INNER
                        and len(inspect.signature(function).parameters) > 1
                    ):
                        yield f"{door}.{name}.{method}", inspect.unwrap(function)
            elif inspect.isfunction(thing) and name not in INNER:
                yield f"{door}.{name}", inspect.unwrap(thing)


def test_the_walk_is_over_all_that_is_public(things):
    called = [function for function, _ in public_calls.rights(things).values()]
    known = {id(inspect.unwrap(getattr(function, "__func__", function))) for function in called}
    assert [name for name, thing in public_things() if id(thing) not in known] == []

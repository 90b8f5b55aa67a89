"""What is of another kind than was expected, names that are taken, and choices that Python would
make, are told in one line that says what was expected, whatever function they are given to.
"""

import math
import pickle

import numpy as np
import pytest

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    Sweep,
    beams,
    bearings,
    best,
    check,
    curve,
    derive,
    elements,
    evaluate,
    export,
    load,
    load_case,
    motion,
    optimise,
    prepare,
    read_designs,
    refine,
    shaking,
    strength,
    sweep,
    table,
    tool_deflection,
    vibration,
)
from lagrange_casadi.errors import (
    DeclarationError,
    LagrangeCasadiError,
    NoComponentError,
    UnknownNameError,
)

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]


@pytest.fixture(scope="module")
def scene():
    m = Mechanism("swing")
    arm = m.link("arm", length=m.parameter("l", 0.5, "m", low=0.0), mass=1.0)
    m.revolute("O", m.ground, arm)
    return Scene(m, {"O": motion.harmonic(0.0, 0.6, 1.0)}, t=(0, 1, 5), wanted=["effort"])


@pytest.fixture(scope="module")
def solution(scene):
    return evaluate(scene, backend="vm", certificate=False)


def sprung(**numbers):
    m = Mechanism("sprung")
    joint = m.revolute("O", m.ground, m.link("arm", length=0.5, mass=1.0))
    return m.torsion_spring("spring", joint, **{"stiffness": 1.0, **numbers})


RECT = beams.rectangle(height=0.03, width=0.01)
STEEL = beams.material("C45+QT")
ONE = {"l": (0.2, 0.3)}
LATE = (0, 4, 5)
WRONG = {
    "open": (lambda s: Sweep.open(None), "open: path: expected a path, got None"),
    "out": (lambda s: sweep(s, ONE, out=3), "sweep: out: expected a path, got 3"),
    "executor": (
        lambda s: sweep(s, {"l": [0.2]}, executor="x"),
        "sweep: executor: expected an Executor, got 'x'",
    ),
    "material": (lambda s: beams.material([]), "material: name: expected a text, got []"),
    "forty digits": (
        lambda s: optimise(s, minimise="l", over=ONE, screen=10**40),
        "expected a whole number from 1 to 16777216, got 1",
    ),
    "derive": (lambda s: derive("swing"), "compile_scene: scene: expected a Scene, got 'swing'"),
    "refine": (lambda s: refine(s, None), "refine: solution: expected a Solution, got None"),
    "tool_deflection": (
        lambda s: tool_deflection(None, "arm"),
        "tool_deflection: scene: expected a Scene, got None",
    ),
    "shaking": (lambda s: shaking("m"), "shaking: mechanism: expected a Mechanism, got 'm'"),
    "about": (
        lambda s: shaking(s.mechanism, about=1.0),
        "shaking: expected a place (x, y) for about, got 1.0",
    ),
    "strength": (
        lambda s: strength.safety(None, "arm"),
        "safety: solution: expected a Solution, got None",
    ),
    "vibration": (lambda s: vibration(s, "arm"), "vibration: solution: expected a Solution, got"),
    "best": (
        lambda s: best("sweep.h5", minimise="l"),
        "best: sweep: expected a Sweep, got 'sweep.h5'",
    ),
    "gears": (lambda s: elements.gears("pair", 1, 2, 3), "gears: mechanism: expected a Mechanism"),
    "plate": (
        lambda s: elements.plate("p", "p", []),
        "plate 'p': mechanism: expected a Mechanism, got 'p'",
    ),
    "fit": (lambda s: bearings.fit("O", None), "fit: mechanism: expected a Mechanism, got 'O'"),
    "load": (lambda s: load(True), "path: expected a path, got True"),
    "check": (lambda s: check(None), "path: expected a path, got None"),
    "load_case": (lambda s: load_case(1), "load_case: path: expected a path, got 1"),
    "read_designs": (lambda s: read_designs(3), "read_designs: path: expected a path, got 3"),
    "read_samples": (lambda s: motion.read_samples(3), "path: expected a path, got 3"),
    "export": (lambda s: export(s, None), "export: out: expected a path, got None"),
    "parameters": (
        lambda s: s.mechanism.values([0.3]),
        "expected values by name, as {'l': 0.25}, got [0.3]",
    ),
    "a sweep's": (
        lambda s: sweep(s, ONE, parameters=3),
        "parameters: expected values by name, as {'l': 0.25}, got 3",
    ),
    "a search's": (
        lambda s: optimise(s, minimise="l", over=ONE, parameters=3),
        "parameters: expected values by name",
    ),
    "limits": (
        lambda s: optimise(s, minimise="l", over=ONE, subject_to=3),
        "subject_to: expected a list of texts, got 3",
    ),
    "starts": (
        lambda s: optimise(s, minimise="l", over=ONE, starts=[0.2]),
        "starts: expected a whole number from 1 to 16777216",
    ),
    "sine": (
        lambda s: optimise(s, minimise="l", over=ONE, transmission="x"),
        "transmission: expected a number, got 'x'",
    ),
    "wanted": (
        lambda s: derive(s, 3.0),
        "wanted: expected a list of output names, got 3.0; valid: all, effort",
    ),
    "a sweep's wanted": (
        lambda s: sweep(s, ONE, wanted=3),
        "wanted: expected a list of output names, got 3; valid: all",
    ),
    "instants": (lambda s: evaluate(s, t={}), "t: expected (start, stop, count), got {}"),
    "flags": (lambda s: prepare(s, flags=None), "flags: expected options of a compiler, got None"),
    "prepared": (
        lambda s: prepare(s)([0.3]),
        "expected values by name, as {'l': 0.25}, got [0.3]",
    ),
    "prepared numbers": (
        lambda s: prepare(s)(0.3, 0.2),
        "expected values by name, as {'l': 0.25}, got 0.3",
    ),
    "a scene's": (
        lambda s: Scene(),
        "Scene: missing a required argument: 'mechanism'; it takes mechanism, motion, wanted",
    ),
    "opened twice": (
        lambda s: Sweep.open("x.h5", "y.h5"),
        "open: too many positional arguments; it takes path",
    ),
    "default": (
        lambda s: Mechanism("m").parameter("l", "long", "m"),
        "parameter 'l': expected a number [m], or a text such as '100 mm', got 'long'",
    ),
    "low": (
        lambda s: Mechanism("m").parameter("l", 1.0, low=None),
        "parameter 'l': low: expected a number or a text, got None",
    ),
    "huge": (
        lambda s: Mechanism("m").point_mass("p", 10**400),
        "must be a number or an expression in parameters, got 1000",
    ),
    "stiffness": (
        lambda s: sprung(stiffness=float("nan")),
        "load 'spring' must be finite, got nan",
    ),
    "damping": (
        lambda s: sprung(damping="much"),
        "load 'spring': expected a finite number [N m s/rad], or a text such as",
    ),
    "a place": (
        lambda s: SpatialMechanism("m").at("arm", 0.0, 0.0, 0.0),
        "place: expected a body, got 'arm'",
    ),
    "table": (
        lambda s: table("x", [0, 1], [0, 1]),
        "table: expected a number or an expression, got 'x'",
    ),
    "samples": (lambda s: motion.samples(1.0, [0, 1]), "expected a row of numbers, got 1.0"),
    "along": (
        lambda s: beams.along(["a", 1], [RECT, RECT]),
        "along: ratios: expected a row of numbers, got ['a', 1]",
    ),
    "stepped": (
        lambda s: beams.stepped(0.5, [RECT, RECT]),
        "stepped: steps: expected a row of numbers, got 0.5",
    ),
    "notches": (
        lambda s: beams.Beam(RECT, STEEL, notches=None),
        "Beam: notches: expected a list, each a Notch, got None",
    ),
    "columns": (
        lambda s: beams.Beam(RECT, STEEL, columns=1.0),
        "beam: expected two effective lengths, positive, got 1.0",
    ),
    "corners": (
        lambda s: beams.polygon([1, 2, 3]),
        "polygon: expected corners (y, z), got [1, 2, 3]",
    ),
    "shapes along": (
        lambda s: beams.along([0, 1], [RECT]),
        "along: expected as many shapes as ratios, two or more, got 2 and 1",
    ),
    "a profile": (
        lambda s: beams.Profile("x", {"width": 1.0}).shape("i_section"),
        "profile 'x': a i_section has the dimensions height, width, web, flange, got width",
    ),
    "a shape": (
        lambda s: beams.Shape("star", {}),
        "'star' is no cross-section with these dimensions",
    ),
    "coefficients": (lambda s: motion.polynomial(), "polynomial: expected at least one"),
    "mixed": (
        lambda s: motion.polynomial("10 mm", "3 deg/s"),
        "polynomial: mixes angles and lengths; expected the unit of one coordinate",
    ),
    "sampled": (
        lambda s: motion.samples(range(4), range(4))(s.mechanism.time),
        "a motion by samples depends on the time alone; expected lagrange_casadi.curve(x, y)",
    ),
    "of a text": (
        lambda s: motion.polynomial(0, 1)("x"),
        "motion: expected a casadi.SX expression, got 'x'",
    ),
    "no number": (
        lambda s: evaluate(Scene(s.mechanism, {"O": motion.expression(lambda t: math.nan)})),
        "the motion of joint 'O' is not a number; use CasADi's functions",
    ),
    "beyond samples": (
        lambda s: evaluate(Scene(s.mechanism, {"O": motion.samples(range(4), range(4))}, t=LATE)),
        "the samples of the motion of joint 'O' cover t from 0 to 3 s, but t from 0 to 4 s was",
    ),
    "of samples": (
        lambda s: motion.samples([[1], [1, 2]], [0, 1]),
        "motion samples: expected two rows of finite numbers, got [[1], [1, 2]] and [0, 1]",
    ),
    "a life": (
        lambda s: prepare(s, wanted=["life:O"]),
        "output 'life:O': prepared scenes have instants, but a life needs a whole cycle",
    ),
    "a number": (
        lambda s: s.mechanism.number("x", {}),
        "number: expected an expression in parameters, got 'x'",
    ),
    "a number's values": (
        lambda s: s.mechanism.number(s.mechanism.parameters["l"].symbol, {}),
        "number: expected values of all parameters, and l have none",
    ),
    "a number of time": (
        lambda s: s.mechanism.number(s.mechanism.time, {"l": 0.3}),
        "number: expected an expression of parameters only, got SX(t)",
    ),
    "t of two": (
        lambda s: evaluate(s, t=(s.mechanism.parameters["l"].symbol, 1)),
        "t: expected (start, stop, count), got (SX(l), 1)",
    ),
    "no range": (
        lambda s: evaluate(s, over=("O", *[s.mechanism.parameters["l"].symbol] * 2, 3)),
        "over: STOP must not be START, got l for both",
    ),
    "near points": (
        lambda s: curve([0, 1e-310, 1, 2], [0, 1, 0, 2]),
        "curve: the points are so close to each other that the slopes overflow",
    ),
    "no path": (lambda s: Sweep.open(""), "open: path: expected a path, got ''"),
}


SLIPS = {
    "attribute": (lambda m: m.links["a"].end, "unknown attribute of Link 'end'; valid: at, base"),
    "mechanism": (lambda m: m.revolut, r"'revolut' \(did you mean 'revolute'\?\)"),
    "key": (lambda m: m.joints["Q"], "^unknown joint 'Q'; valid: O$"),
    "link": (lambda m: m.links["aa"], r"^unknown link 'aa' \(did you mean 'a'\?\); valid: a$"),
    "load": (lambda m: m.loads["Q"], "^unknown load 'Q'; valid: none are declared$"),
    "joint": (lambda m: m.coordinate("O"), r"got 'O'; joints: O; m\.joints\['O'\] is the part"),
    "body": (lambda m: m.place("a"), r"got 'a'; m\.bodies\['a'\] is the part"),
    "point": (lambda m: m.place((0.1, 0.0)), r"as LINK\.at\(0\.1, 0\), got \(0\.1, 0\.0\)"),
    "function": (lambda m: m.torque("t", m.links["a"], lambda t: t), "call the function"),
}


@pytest.mark.parametrize(("slip", "says"), SLIPS.values(), ids=SLIPS)
def test_a_slip_is_told_with_what_was_meant(slip, says):
    m = Mechanism("m")
    m.revolute("O", m.ground, m.link("a", length=0.3, mass=1.0))
    with pytest.raises(LagrangeCasadiError, match=says):
        slip(m)


@pytest.mark.parametrize(("call", "says"), WRONG.values(), ids=WRONG)
def test_what_was_expected_is_said(scene, call, says):
    with pytest.raises(DeclarationError) as caught:
        call(scene)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_component_that_is_in_space_alone_is_told(scene):
    moved = Scene(scene.mechanism, scene.motion, t=(0, 1, 5), wanted=["reaction"])
    solution = evaluate(moved, backend="vm", certificate=False)
    says = "^unknown component of a reaction in a plane '..'.*; valid: fx, fy, mz$"
    for name in ("fz", "mx", "my"):
        with pytest.raises(NoComponentError, match=says):
            getattr(solution.reaction("O"), name)


@pytest.mark.parametrize("name", [None, 3.0, ["O"], {}, np.zeros(2)], ids=str)
def test_what_is_no_name_is_told(solution, name):
    for of in (solution.effort, solution.peak, solution.array, solution.section):
        with pytest.raises(LagrangeCasadiError, match=r"got |unknown "):
            of(name)


MANY = [f"reaction:joint_{k}" for k in range(100)]
UNKNOWN = {
    "unknown link 'crnk' (did you mean 'crank'?); valid: crank, rod": ("crnk", ["crank", "rod"]),
    "unknown link 'q'; valid: none are declared": ("q", []),
    "unknown links 'crnk' (did you mean 'crank'?), 'q'; valid: crank, rod": (
        ["crnk", "q"],
        ["crank", "rod"],
    ),
    "unknown link 'joint_4' (did you mean 'reaction:joint_4'?); `info` lists the 100 there are": (
        "joint_4",
        MANY,
        "`info`",
    ),
    "unknown link ''; `info` lists the 100 there are": ("", MANY, "`info`"),
    f"unknown link 'joint_999' (did you mean 'reaction:joint_99'?); valid: {', '.join(MANY[:15])}"
    " and 85 more": ("joint_999", MANY),
}


@pytest.mark.parametrize("says", UNKNOWN)
def test_a_name_that_nothing_bears_is_told_those_there_are(says):
    error = UnknownNameError("link", *UNKNOWN[says])
    assert str(error) == says
    assert str(pickle.loads(pickle.dumps(error))) == says


BEARERS = {
    "a link": lambda m, name: m.link(name, length=1, mass=1),
    "a point mass": lambda m, name: m.point_mass(name, 1),
    "a joint": lambda m, name: m.weld(
        name, m.links["arm"].tip, m.point_mass(f"end{len(m.bodies)}", 1)
    ),
    "a load": lambda m, name: m.force(name, m.links["arm"], x=1),
    "a constraint": lambda m, name: m.constraint(name, m.coordinate(m.joints["pin"])),
    "a non-holonomic constraint": lambda m, name: m.nonholonomic(
        name, m.rate(m.joints["pin"]), replaces=m.joints["pin"]
    ),
}
TAKERS = {
    kind: BEARERS[f"a {kind}"]
    for kind in ("joint", "load", "constraint", "non-holonomic constraint")
}
TAKERS |= {
    "gear": lambda m, name: m.gear(name, m.joints["pin"], m.joints["pin"], ratio=2),
    "spring": lambda m, name: m.spring(name, m.ground, m.links["arm"].tip, stiffness=1, length=1),
    "torque": lambda m, name: m.torque(name, m.links["arm"], 1),
}
CALLED = {"gear": "constraint", "spring": "load", "torque": "load"}


def machine():
    m = Mechanism("machine")
    m.revolute("pin", m.ground, m.link("arm", length=1, mass=1))
    return m


@pytest.mark.parametrize("taker", TAKERS)
@pytest.mark.parametrize("bearer", BEARERS)
def test_a_taken_name_says_by_what(bearer, taker):
    m = machine()
    BEARERS[bearer](m, "x")
    kind = CALLED.get(taker, taker)
    twice = bearer == f"a {kind}"
    says = (
        "is declared twice in mechanism 'machine'"
        if twice
        else f"the name is taken by {bearer} of mechanism 'machine'"
    )
    with pytest.raises(DeclarationError) as told:
        TAKERS[taker](m, "x")
    assert str(told.value) == f"{kind} 'x'{' ' if twice else ': '}{says}"


@pytest.mark.parametrize("taker", TAKERS)
def test_the_ground_has_its_name(taker):
    with pytest.raises(
        DeclarationError, match="the name is taken by the ground of mechanism 'machine'"
    ):
        TAKERS[taker](machine(), "ground")


CHOICES = {
    "max": lambda x: max(0, x),
    "min": lambda x: min(0.1, x),
    "if": lambda x: x if x > 0 else 0.0,
    "and": lambda x: x > 0 and x,
    "sorted": lambda x: sorted([x, 0.1])[0],
    "clip": lambda x: 0.0 < x < 1.0,
}


def moved(choice):
    m = Mechanism("m")
    m.revolute("O", m.ground, m.link("a", length=0.1, mass=1.0))
    evaluate(Scene(m, {"O": motion.expression(choice)}))


def loaded(choice):
    m = Mechanism("m")
    m.line_load("wind", m.link("a", length=0.1, mass=1.0), y=choice)


@pytest.mark.parametrize("called", [moved, loaded], ids=lambda called: called.__name__)
@pytest.mark.parametrize("choice", CHOICES)
def test_a_function_that_chooses_is_told_what_does(called, choice):
    with pytest.raises(
        LagrangeCasadiError, match=r"casadi\.if_else.* casadi\.fmin and fmax for 'min' and 'max'"
    ):
        called(CHOICES[choice])

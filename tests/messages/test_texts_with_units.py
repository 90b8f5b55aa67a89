"""A text with its unit is the number that it tells, wherever a number with that unit may be
declared, listed or typed.
"""

import json
from decimal import Decimal

import casadi as ca
import pytest
from commands import words
from internals import Values, describe, read_designs, sweep

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    beams,
    bearings,
    elements,
    evaluate,
    optimise,
)
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError
from lagrange_casadi.motion import dwell, harmonic, move, moves, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

STEEL = beams.material("C45+QT")
WORDS = {
    "m": ("mm", 3),
    "kg": ("g", 3),
    "s": ("ms", 3),
    "rad": ("rad", 0),
    "m/s": ("mm/s", 3),
    "rad/s": ("rad/s", 0),
}


def as_number(value, _unit):
    return value


def as_text(value, unit):
    """The same in another word for its unit."""
    word, places = WORDS[unit]
    return f"{Decimal(repr(value)).scaleb(places)} {word}"


def described(m):
    return json.dumps(describe(m, m.values(), ()), default=repr)


def geared(u):
    m = SpatialMechanism("geared")
    wheels = [
        elements.wheel(
            m, n, radius=u(0.03, "m"), bore=u(0.01, "m"), width=u(0.02, "m"), turned=u(0.1, "rad")
        )
        for n in "ab"
    ]
    for wheel, place in zip(wheels, ((0.0, 0.0, 0.0), (0.06, 0.0, 0.0)), strict=True):
        m.revolute(f"J{wheel.name}", m.ground.at(*place), wheel)
    elements.gears(
        m,
        "mesh",
        *wheels,
        radii=(u(0.03, "m"), u(0.03, "m")),
        helix_angle=u(0.2, "rad"),
        offset=u(0.001, "m"),
    )
    return [described(m), *map(str, (c.phi for c in m.constraints.values()))]


def planetary(u):
    m = Mechanism("planetary")
    sun = elements.wheel(m, "sun", radius=0.03, mass=u(0.5, "kg"))
    arm = m.link("arm", length=0.06, mass=1.0, centre=(0.0, 0.0), inertia=1e-3)
    m.revolute("S", m.ground, sun)
    m.revolute("C", m.ground, arm)
    elements.planetary(
        m,
        "set",
        sun,
        arm,
        m.ground,
        teeth=(30, 30, 90),
        module=u(0.002, "m"),
        mass=u(0.3, "kg"),
        pressure_angle=u(0.4, "rad"),
    )
    return described(m)


def belted(u):
    m = Mechanism("belted")
    wheels = [elements.wheel(m, n, radius=0.03, mass=0.5) for n in "ab"]
    for wheel, x in zip(wheels, (0.0, 0.3), strict=True):
        m.revolute(f"J{wheel.name}", m.ground.at(u(x, "m"), 0.0), wheel)
    elements.belt(m, "belt", *wheels, radii=[u(0.03, "m"), u(0.05, "m")], offset=u(0.01, "m"))
    return [described(m), *map(str, (c.phi for c in m.constraints.values()))]


def cylinder(u):
    m = Mechanism("lift")
    boom = m.link("boom", length=u(1.2, "m"), mass=u(8.5, "kg"))
    m.revolute("O", m.ground, boom)
    made = elements.cylinder(
        m, "ram", m.ground.at(0.5, -0.5), boom.at(0.6), closed=u(0.4, "m"), bore=u(0.05, "m"),
            rod=u(0.03, "m"),
        barrel_mass=u(2.5, "kg"), rod_mass=u(1.5, "kg"),
    )  # fmt: skip
    return [described(m), made.cap_area, made.rod_area]


def bent(u):
    m = Mechanism("bent")
    bar = elements.bent_bar(
        m,
        "bar",
        [[u(x, "m") for x in pair] for pair in ((0.0, 0.0), (0.2, 0.0), (0.2, 0.1))],
        mass=u(0.7, "kg"),
    )
    plate = elements.plate(
        m,
        "plate",
        [[u(x, "m") for x in pair] for pair in ((0.0, 0.0), (0.2, 0.0), (0.1, 0.15))],
        mass=u(0.6, "kg"),
    )
    m.revolute("O", m.ground, bar.pieces[0])
    m.weld("W", bar.pieces[-1].tip, plate.link, angle=u(0.3, "rad"))
    return described(m)


def cams(u):
    m = Mechanism("cam")
    disc, stem = m.link("disc", length=0.03, mass=0.6), m.link("stem", length=0.1, mass=0.2)
    main = m.revolute("main", m.ground, disc)
    guide = m.prismatic("guide", m.ground, stem, axis=(0, 1), angle=u(1.5, "rad"))
    parts = [
        move(by=u(0.01, "m"), time=u(0.2, "s")),
        dwell(u(0.1, "s")),
        move(to=u(0.0, "m"), time=u(0.2, "s")),
    ]
    law = moves(parts, start=u(0.0, "m"))
    cam = elements.disc_cam(
        m,
        "cam",
        main,
        guide,
        lambda a: 0.005 * (1 - ca.cos(a)),
        base_radius=u(0.03, "m"),
        roller=u(0.008, "m"),
        width=u(0.01, "m"),
    )
    return [described(m), cam.profile().x.tolist(), str(law.span), str(law.period)]


def rubbing(u):
    m = SpatialMechanism("rubbing")
    arm = m.link("arm", length=u(0.3, "m"), mass=1.0)
    slide = m.link("slide", length=0.1, mass=u(0.5, "kg"))
    pin = m.revolute("O", m.ground, arm)
    way = m.prismatic("S", arm, slide, axis=(1, 0, 0))
    m.friction("pin", pin, mu=0.1, radius=u(0.01, "m"), length=u(0.05, "m"), smooth=u(0.2, "rad/s"))
    m.friction(
        "way",
        way,
        mu=0.1,
        radius=u(0.02, "m"),
        length=u(0.04, "m"),
        static=0.2,
        stribeck=u(0.03, "m/s"),
    )
    m.spring(
        "back",
        m.ground.at(u(0.1, "m"), 0, 0),
        arm.at(u(0.15, "m")),
        stiffness=100.0,
        length=u(0.05, "m"),
    )
    m.line_load("wind", arm, y=10.0, between=(u(0.1, "m"), u(0.2, "m")))
    return described(m)


def thread(u):
    m = SpatialMechanism("thread")
    m.screw(
        "way",
        m.ground,
        m.link("nut", length=0.1, mass=1.0),
        axis=(1, 0, 0),
        lead=u(0.004, "m"),
        turned=[("z", u(0.2, "rad"))],
    )
    return described(m)


def notched(u):
    notches = [
        beams.shoulder(0.3, u(0.03, "m"), u(0.02, "m"), u(0.002, "m")),
        beams.hole(0.6, u(0.03, "m"), u(0.006, "m")),
        beams.Notch(0.5, bending=1.0 + beams.sensitivity(u(0.001, "m"), 7e8)),
    ]
    shapes = [
        beams.rectangle(u(0.03, "m"), u(0.01, "m")), beams.round_bar(u(0.02, "m")),
            beams.tube(u(0.03, "m"), u(0.002, "m")),
        beams.box(u(0.05, "m"), u(0.04, "m"), u(0.003, "m"), u(0.004, "m")),
            beams.ellipse(u(0.05, "m"), u(0.04, "m")),
        beams.i_section(u(0.05, "m"), u(0.04, "m"), u(0.003, "m"), u(0.004, "m")),
        beams.polygon([(u(0.01, "m"), u(-0.01, "m")), (u(0.01, "m"), u(0.01, "m")), (u(-0.01, "m"),
            u(0.0, "m"))]),
    ]  # fmt: skip
    m = Mechanism("notched")
    for number, shape in enumerate(shapes):
        m.revolute(
            f"J{number}",
            m.ground,
            m.link(f"l{number}", length=0.3, beam=beams.Beam(shape, STEEL, notches)),
        )
    return described(m)


def fitted(u):
    m = Mechanism("fitted")
    joint = m.revolute("O", m.ground, m.link("l", length=0.3, mass=1.0))
    pin = bearings.Pin(
        u(0.01, "m"), u(0.02, "m"), u(0.01, "m"), STEEL, pressure=1e8, gap=u(0.001, "m")
    )
    bearings.fit(
        m, joint, pin, bearings.Plain(u(0.01, "m"), u(0.02, "m"), pressure=1e7, speed=u(1.5, "m/s"))
    )
    return described(m)


def moved(u):
    m = Mechanism("moved")
    m.revolute("O", m.ground, m.link("l", length=u(0.3, "m"), mass=u(1.5, "kg")))
    law = harmonic(u(0.2, "rad"), u(0.5, "rad"), 6.0, u(0.1, "rad"))
    return evaluate(Scene(m, {"O": law}, t=(u(0.0, "s"), u(1.5, "s"), 7))).effort("O").tolist()


DECLARED = [
    geared,
    planetary,
    belted,
    cylinder,
    bent,
    cams,
    rubbing,
    thread,
    notched,
    fitted,
    moved,
]


@pytest.mark.parametrize("declared", DECLARED, ids=lambda declared: declared.__name__)
def test_what_is_declared_by_a_text_is_what_its_number_declares(declared):
    assert declared(as_text) == declared(as_number)


@pytest.mark.parametrize("declared", DECLARED, ids=lambda declared: declared.__name__)
def test_a_text_in_another_unit_is_refused(declared):
    """Every place in turn: a length in seconds, anything else in metres."""
    places = []
    declared(lambda value, unit: places.append(unit) or value)
    for wrong, unit in enumerate(places):
        told = iter(range(len(places)))

        def at(value, _unit, told=told, wrong=wrong, unit=unit):
            return (
                (f"{value} s" if unit.startswith("m") else f"{value} m")
                if next(told) == wrong
                else value
            )

        with pytest.raises(DeclarationError, match=r"got .*'|the law is in (m|s|rad), but"):
            declared(at)


def crank(u=as_number):
    m = Mechanism("crank")
    r = m.parameter("r", u(0.1, "m"), "m", low=u(0.02, "m"), high=u(0.3, "m"))
    lean = m.parameter("lean", u(0.25, "rad"), "rad")
    arm = m.link("arm", length=r, mass=m.parameter("mass", u(1.5, "kg"), "kg"))
    hand = m.link("hand", length=0.1, mass=0.5)
    m.revolute("O", m.ground, arm)
    m.weld("fist", arm.tip, hand, angle=lean)
    m.prismatic("S", arm, m.point_mass("p", 0.1), axis=(1, 0))
    return Scene(
        m,
        {"O": polynomial(0.0, 2.0), "S": harmonic(0.05, 0.02, 6.0)},
        t=(0, 1, 5),
        wanted=["effort"],
    )


def lists(u, folder):
    """Designs and where a search may go, in every way in which they are listed."""
    folder.mkdir()
    (folder / "designs.csv").write_text(
        f"r,lean\n{u(0.05, 'm')},{u(0.5, 'rad')}\n{u(0.07, 'm')},{u(0.25, 'rad')}\n"
    )
    grids = [
        {"r": [u(0.05, "m"), u(0.07, "m")], "lean": (u(0.1, "rad"), u(0.3, "rad"), 3)},
        {"r": Values((u(0.05, "m"), u(0.07, "m")))},
        read_designs(folder / "designs.csv"),
    ]
    found = [
        sweep(crank(), grid, out=folder / f"{k}.h5", parameters={"mass": u(2.5, "kg")})
        for k, grid in enumerate(grids)
    ]
    best = optimise(
        crank(),
        minimise="peak:effort:O",
        over={"r": (u(0.05, "m"), u(0.2, "m"))},
        parameters={"lean": u(0.1, "rad")},
        starts=1,
        screen=2,
    )
    columns = [one["peak:effort:O"].tolist() for one in found]
    chosen = found[0].select(r=u(0.07, "m"))["peak:effort:O"].tolist()
    return [
        columns,
        chosen,
        best.values,
        evaluate(crank(u), parameters={"r": u(0.05, "m")}).effort("O").tolist(),
    ]


def test_what_is_listed_by_texts_is_what_its_numbers_list(tmp_path):
    assert lists(as_text, tmp_path / "texts") == lists(as_number, tmp_path / "numbers")


COMMANDS = {
    "run": lambda u: [
        "--no-figures",
        "--set",
        f"r={u(0.05, 'm')}",
        "--set",
        f"mass={u(2.5, 'kg')}",
    ],
    "run over": lambda u: ["--no-figures", "--over", f"O={u(0.0, 'rad')}:{u(1.5, 'rad')}:5"],
    "run t": lambda u: ["--no-figures", "--t", f"{u(0.0, 's')}:{u(0.5, 's')}:5"],
    "sweep": lambda u: [
        "--grid",
        f"r={u(0.05, 'm')}:{u(0.2, 'm')}:3",
        "--grid",
        f"lean={u(0.1, 'rad')},{u(0.3, 'rad')}",
        "--quiet",
    ],
    "optimise": lambda u: [
        *words("--minimise peak:effort:O --over"),
        f"r={u(0.05, 'm')}:{u(0.2, 'm')}",
        "--set",
        f"lean={u(0.5, 'rad')}",
    ],
    "drive": lambda u: ["--drive", "S", "--lead", str(u(0.005, "m"))],
    "tolerances": lambda u: [
        "--tolerance",
        f"r={u(0.001, 'm')}",
        *words("--samples 20 --csv x.csv"),
    ],
}


@pytest.mark.parametrize("command", COMMANDS)
def test_an_option_takes_a_text_as_its_number(command, tmp_path, capsys, monkeypatch):
    (tmp_path / "crank").mkdir()
    (tmp_path / "crank" / "case.py").write_text(
        "from test_texts_with_units import crank as scene\n"
    )
    found = []
    for u in (as_number, as_text):
        folder = tmp_path / u.__name__
        folder.mkdir()
        monkeypatch.chdir(folder)
        assert main([command.split()[0], str(tmp_path / "crank"), *COMMANDS[command](u)]) == 0, (
            capsys.readouterr().err
        )
        found.append(
            (capsys.readouterr().out, {path.name: path.read_bytes() for path in folder.iterdir()})
        )
    assert found[0] == found[1]

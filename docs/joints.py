"""Pictures of the joints in motion: ``python docs/joints.py`` writes them to ``docs/joints``."""

import re
from pathlib import Path

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, evaluate
from lagrange_casadi.animation import Film, write_animation
from lagrange_casadi.motion import harmonic, polynomial

FOLDER = Path(__file__).parent / "joints"
FILM = Film(width=400, rate=8, seconds=3.0, names=False)
SLIDE, TURN = 0.08, 0.5
"""How far coordinates swing [m and rad]."""
ACROSS = {"axis": (0, 0, 1), "second": (1, 0, 0)}
JOINTS = {
    ("revolute", "plane"): ({}, [TURN]),
    ("prismatic", "plane"): ({"axis": (1, 0), "angle": 0.6}, [SLIDE]),
    ("weld", "plane"): ({"angle": 0.6}, []),
    ("revolute", "space"): ({"axis": (0, 0, 1)}, [TURN]),
    ("prismatic", "space"): ({"axis": (1, 0, 0)}, [SLIDE]),
    ("cylindrical", "space"): ({"axis": (1, 0, 0)}, [SLIDE, TURN]),
    ("screw", "space"): ({"axis": (1, 0, 0), "lead": 0.2}, [3 * TURN]),
    ("universal", "space"): (ACROSS, [TURN, TURN]),
    ("spherical", "space"): ({}, [TURN, TURN, TURN]),
    ("planar", "space"): (ACROSS, [SLIDE, SLIDE, TURN]),
    ("slot", "space"): ({"axis": (1, 0, 0)}, [SLIDE, TURN, TURN, TURN]),
    ("weld", "space"): ({}, []),
    ("free", "space"): ({}, [SLIDE, SLIDE, SLIDE, TURN, TURN, TURN]),
}
"""Of each joint its arguments, and how far its coordinates swing."""


def scene(kind, where, arguments, swings):
    """A lever on a carrier, by the joint; each coordinate swings at a frequency of its own."""
    m = (Mechanism if where == "plane" else SpatialMechanism)(kind)
    carrier, lever = (
        m.link("carrier", length=0.5, mass=1.0),
        m.link("lever", length=0.3, mass=1.0),
    )
    if where == "plane":
        m.revolute("stand", m.ground, carrier)
    else:
        m.revolute("stand", m.ground, carrier, axis=(0, 0, 1))
        arguments = arguments | {"turned": [("z", 1.0)]}
    getattr(m, kind)("joint", carrier.at(0.25), lever, **arguments)
    laws = tuple(harmonic(0.0, swing, k) for k, swing in enumerate(swings, 1))
    if not laws:
        return Scene(m, {"stand": harmonic(0.0, TURN, 1)}, t=(0, 1, 49))
    moved = {"joint": laws if laws[1:] else laws[0]}
    return Scene(m, {"stand": polynomial(0.0)} | moved, t=(0, 1, 49))


def slot():
    """A pin of a crank in the slot of a carrier, in the plane."""
    m = Mechanism("slot")
    carrier, crank = (
        m.link("carrier", length=0.5, mass=1.0),
        m.link("crank", length=0.1, mass=1.0),
    )
    m.revolute("stand", m.ground, carrier)
    m.revolute("pin", m.ground.at(0.3, 0.0), crank)
    m.slot("joint", carrier, crank.tip, axis=(1, 0))
    return Scene(
        m, {"pin": polynomial(0, 6.28318530718)}, t=(0, 1, 49), posture={"carrier": 0.0}
    )


def closer(svg):
    """The picture without the ends of its bodies, as wide as before."""
    width, height = map(int, re.search(r'viewBox="0 0 (\d+) (\d+)"', svg).groups())
    box = 0.2 * width, 0.15 * height, 0.6 * width, 0.77 * height
    size = f'width="{width}" height="{width * box[3] / box[2]:.0f}"'
    seen = f'viewBox="{" ".join(f"{number:g}" for number in box)}"'
    return re.sub(
        r'width="\d+" height="\d+" viewBox="[^"]*"', f"{size} {seen}", svg, count=1
    )


made = {
    f"{kind}_{where}": scene(kind, where, *how) for (kind, where), how in JOINTS.items()
}
for name, moving in (made | {"slot_plane": slot()}).items():
    solution = evaluate(moving, wanted=["motion"], backend="vm")
    picture = FOLDER / f"{name}.svg"
    write_animation(solution, picture, FILM)
    picture.write_text(closer(picture.read_text()))

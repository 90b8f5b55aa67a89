"""Model files from plain numbers: small ones of every format, and large ones of every kind."""

import json
from math import cos, radians, sin

IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def turned(axis, degrees):
    """The rotation about a coordinate axis, by rows."""
    c, s = cos(radians(degrees)), sin(radians(degrees))
    rows = {"x": ((1, 0, 0), (0, c, -s), (0, s, c)), "y": ((c, 0, s), (0, 1, 0), (-s, 0, c))}
    return rows.get(axis, ((c, -s, 0), (s, c, 0), (0, 0, 1)))


ORIGIN = (0.0, 0.0, 0.0)


def _lines(tree, depth=0):
    """Lines of a tree, indented: each part is a word, or a word and the parts inside."""
    for part in tree:
        head, inside = (part, ()) if isinstance(part, str) else part
        yield "\t" * depth + head
        yield from _lines(inside, depth + 1)


def _row(values):
    return "\t".join(repr(float(value)) for value in values)


def _leaves(told):
    return [(key, [str(value)]) for key, value in told.items()]


def _frame(place, rows=IDENTITY):
    return [("Position3D", [_row(place)]), ("RotationMatrix", list(map(_row, rows)))]


def _markers(told):
    points = []
    for name, where in told.items():
        own = _frame(*(where if isinstance(where[0], tuple) else (where,)))
        marker = ("Markers", [("Marker", [*_leaves({"Name": name}), *own])])
        points.append(("RefPoint", [*_frame(ORIGIN), marker]))
    return [("RefPoints", points), "RefCurves", "RefSurfaces"]


def _part(name, mass, centre, moments, own, *where):
    held = [*_leaves({"Name": "MassMarker"}), *_frame(centre), *_leaves({"Mass": repr(mass)})]
    held.append(("MomentOfInertias", [_row(moments)]))
    placed = [*_leaves({"Name": name}), *_frame(*(where or [ORIGIN]))]
    return ("Part", [*placed, "FeatureOrder", ("PrincipalMassMarker", held), *_markers(own)])


def _joint(name, kind, one, other, *told):
    ends = {"Name": name, "MarkerI": f"/Press/{one}", "MarkerJ": f"/Press/{other}"}
    return (kind, _leaves(ends | {key: repr(value) for key, value in told}))


def _motion(name, kind, *told):
    if kind == "GeneralMotion":
        one, other, place, turns = told
        names = [f"rIJI{k}" for k in (1, 2, 3)] + [f"angIJJ{k}" for k in (1, 2, 3)]
        laws = _leaves(dict(zip(names, (*place, *turns), strict=True)))
        return (kind, [*_joint(name, kind, one, other)[1], *laws, ("RotationOrder", ["1\t2\t3"])])
    law = "RotationZ" if kind == "RotationalMotion" else "TranslationZ"
    return (kind, _leaves({"Name": name, "MotionJoint": f"/Press/{told[0]}", law: told[1]}))


def assembly(points, parts, joints, motions, gravity=(0.0, -9.81, 0.0), span=(0.0, 1.0, 0.01)):
    """Return the text of an assembly as FreeCAD writes it.

    ``points`` are markers of the ground: a place, or a place and a rotation by rows. ``parts`` are
    (mass, centre, principal moments, markers) and where they are, by name; ``joints`` (kind, marker
    I, marker J) and numbers, by name; ``motions`` (kind, joint, expression) by name, a general
    motion (kind, marker I, marker J, place, turns).
    """
    sets = [
        ("Joints", [_joint(name, *told) for name, told in joints.items()]),
        ("Motions", [_motion(name, *told) for name, told in motions.items()]),
        "GeneralConstraintSets",
    ]
    inside = [
        ("Notes", ["(Text string: '' runs: (Core.RunArray runs: #() values: #()))"]),
        *_leaves({"Name": "Press"}),
        *_frame(ORIGIN),
        *_markers(points),
        ("Parts", [_part(name, *told) for name, told in parts.items()]),
        "KinematicIJs",
        ("ConstraintSets", sets),
        "ForceTorques",
        ("ConstantGravity", [_row(gravity)]),
        (
            "SimulationParameters",
            _leaves(dict(zip(("tstart", "tend", "hout"), map(repr, span), strict=True))),
        ),
    ]
    return "\n".join(["OndselSolver", *_lines([("Assembly", inside)])]) + "\n"


SPRUNG = (
    "<dynamics><damping>0.1</damping><spring_stiffness>5</spring_stiffness>"
    "<spring_reference>0.1</spring_reference></dynamics>"
)
DAMPED = '<dynamics damping="0.1"/>'


def urdf(*parts, name="robot"):
    return f'<?xml version="1.0"?>\n<robot name="{name}">\n{"".join(parts)}</robot>\n'


def link(name, mass=1.0, centre="0.1 0 0", inertia="0.1 0.2 0.2"):
    xx, yy, zz = inertia.split()
    moments = f'<inertia ixx="{xx}" ixy="0" ixz="0" iyy="{yy}" iyz="0" izz="{zz}"/>'
    inside = f'<origin xyz="{centre}"/><mass value="{mass}"/>{moments}'
    return f'<link name="{name}"><inertial>{inside}</inertial></link>\n'


def joint(name, parent, child, xyz="0 0 0", axis="0 0 1", kind="revolute", more="", rpy="0 0 0"):
    ends = f'<parent link="{parent}"/><child link="{child}"/><origin xyz="{xyz}" rpy="{rpy}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}<axis xyz="{axis}"/>{more}</joint>\n'


def sdf(*parts, world="", version="1.10"):
    inside = f'<model name="robot">\n{"".join(parts)}</model>\n'
    return f'<sdf version="{version}"><world name="w">{world}\n{inside}</world></sdf>\n'


def inertial(mass=1.5, pose="0.1 0 0 0 0 0", inertia="0.1 0.2 0.2"):
    xx, yy, zz = inertia.split()
    moments = f"<inertia><ixx>{xx}</ixx><iyy>{yy}</iyy><izz>{zz}</izz></inertia>"
    return f"<inertial><pose>{pose}</pose><mass>{mass}</mass>{moments}</inertial>"


def sdf_link(name, pose="0 0 0 0 0 0", more="", inside="", centre="0.1 0 0 0 0 0", **told):
    held = inertial(pose=centre, **told) + inside
    return f'<link name="{name}"><pose{more}>{pose}</pose>{held}</link>\n'


def sdf_joint(name, parent, child, axis="0 0 1", kind="revolute", more=""):
    ends = f"<parent>{parent}</parent><child>{child}</child>"
    axis = f"<axis><xyz>{axis}</xyz>{more}</axis>" if axis else more
    return f'<joint name="{name}" type="{kind}">{ends}{axis}</joint>\n'


def mjcf(*parts, more="", compiler=""):
    head = f'<mujoco model="robot"><compiler angle="radian" {compiler}/>'
    return f"{head}\n<worldbody>\n{''.join(parts)}</worldbody>{more}\n</mujoco>\n"


def mjcf_body(name, *parts, pos="0.2 0 0", axis="0 1 0"):
    own = '<inertial pos="0.1 0 0" mass="1" diaginertia="0.1 0.2 0.2"/>'
    inside = f'<joint name="j_{name}" axis="{axis}"/>{own}\n{"".join(parts)}'
    return f'<body name="{name}" pos="{pos}">{inside}</body>\n'


def own(bodies, joints, **more):
    told = {"schema": "lagrange_casadi.model", "version": 1, "name": "machine"}
    return json.dumps(told | {"bodies": bodies, "joints": joints} | more, indent=1)


def own_body(name, place=(0, 0, 0), **more):
    told = {"name": name, "mass": 1.5, "place": place, "centre": [0.1, 0, 0.02]}
    return told | {"inertia": [0.1, 0.2, 0.2]} | more


def own_joint(name, parent, child, at=(0, 0, 0), z=(0, 0, 1), kind="revolute", **more):
    """A joint at a place of its parent, and at the origin of its child."""
    told = {"name": name, "kind": kind, "parent": parent, "child": child}
    return told | {"on_parent": {"place": at, "z": z}, "on_child": {"z": z}} | more


def rod(name, start, end):
    return {"name": name, "mass": 2.0, "rod": [[*start, 0], [*end, 0]]}


def _loop():
    """A parallelogram of rods in the plane."""
    places = {"O": (0, 0), "A": (0, 1), "B": (2, 1), "C": (2, 0)}
    ends = (("O", "ground", "crank"), ("A", "crank", "rod"), ("B", "rod", "rocker"))
    joints = [
        own_joint(name, parent, child, (*places[name], 0), on_child={"place": (*places[name], 0)})
        for name, parent, child in (*ends, ("C", "ground", "rocker"))
    ]
    rods = [rod("crank", places["O"], places["A"]), rod("rod", places["A"], places["B"])]
    return own(
        [*rods, rod("rocker", places["C"], places["B"])],
        joints,
        gravity=[0, -9.81, 0],
        motions={"O": "pi/3*t + 0.2*sin(2*t)^2"},
        time={"start": 0, "stop": 1, "count": 5},
        posture={"A": 0.1},
        drives=["C"],
    )


def _kinds():
    """An open chain of joints of many kinds, with a coupling, laws and samples."""
    kinds = ("revolute", "prismatic", "cylindrical", "spherical", "screw", "planar", "free")
    bodies = [own_body(f"b{k}", (0.2 * k, 0, 0.1 * k)) for k in range(len(kinds) + 1)]
    joints = [
        own_joint(f"j{k}", bodies[k]["name"], bodies[k + 1]["name"], (0.2, 0, 0.1), kind=kind)
        for k, kind in enumerate(kinds)
    ]
    joints[4]["lead"] = 0.01
    joints.append(own_joint("base", "ground", "b0", z=(0, 1, 0)))
    return own(
        [*bodies, {"name": "tip", "mass": 0.3, "point": True, "place": [2, 0, 0]}],
        [*joints, own_joint("last", "b7", "tip", (0.6, 0, -0.7), kind="weld")],
        couplings=[{"name": "gear", "first": "j0", "second": "base", "ratio": 2, "offset": 0.1}],
        motions={
            "j0": "2.0d*pi*time",
            "j1": "0.1*exp(-t)*sin(3*t)",
            "j2:turn": {"times": [0, 0.5, 1, 2], "values": [0, 0.1, 0.3, 0.2]},
        },
        notes=["made by a program"],
    )


def _gears():
    """A crank, a rocker that it drives by a rod of spheres, and two wheels on a carrier."""
    slim = (1e-3, 0.02, 0.02)
    return assembly(
        {"O": (0.0, 0.0, 0.0), "C": (2.0, 0.0, 0.0), "W": (0.0, 0.0, 1.0), "V": (3.0, 0.0, 1.0)},
        {
            "crank": (1.0, (0.0, 0.5, 0.0), slim, {"a": (0.0, 0.0, 0.0), "b": (0.0, 1.0, 0.0)}),
            "rocker": (
                *(1.0, (0.0, 0.5, 0.0), slim, {"a": (0.0, 0.0, 0.0), "b": (0.0, 1.0, 0.0)}),
                (2.0, 0.0, 0.0),
            ),
            "sun": (1.0, (0.0, 0.0, 1.0), (0.1, 0.1, 0.2), {"m": (0.0, 0.0, 1.0)}),
            "wheel": (
                1.0,
                (0.0, 0.0, 0.0),
                (0.1, 0.1, 0.2),
                {"m": (0.0, 0.0, 0.0)},
                (3.0, 0.0, 1.0),
            ),
            "slider": (
                1.0,
                (0.0, 0.0, 0.0),
                (0.1, 0.1, 0.2),
                {"m": ((0.0, 0.0, 0.0), turned("y", 90))},
            ),
        },
        {
            "O": ("RevoluteJoint", "O", "crank/a"),
            "C": ("RevoluteJoint", "C", "rocker/a"),
            "rod": ("SphSphJoint", "crank/b", "rocker/b", ("distanceIJ", 2.0)),
            "S": ("RevoluteJoint", "W", "sun/m"),
            "V": ("RevoluteJoint", "V", "wheel/m"),
            "teeth": ("GearJoint", "sun/m", "wheel/m", ("radiusI", 1.0), ("radiusJ", 2.0)),
            "rack": ("CylindricalJoint", "O", "slider/m"),
        },
        {
            "drive": ("RotationalMotion", "O", "0.3*sin(2.0d*pi*time)"),
            "spin": ("RotationalMotion", "S", "time^2"),
        },
        span=(0.0, 1.0, 0.25),
    )


def _cell(k):
    """The links and joints of a robot that is a parallelogram, which Gazebo closes."""
    yield from (link(f"{name}{k}") for name in ("crank", "rod", "rocker"))
    ends = ("O", "base", f"crank{k}", "0 0 0"), ("A", f"crank{k}", f"rod{k}", "0 1 0")
    for name, parent, child, at in (*ends, ("C", "base", f"rocker{k}", "2 0 0")):
        yield joint(f"{name}{k}", parent, child, at)
    closing = sdf_joint(f"B{k}", f"rod{k}", f"rocker{k}", more=SPRUNG)
    yield f"<gazebo>{closing.replace('<parent', '<pose>0 1 0 0 0 0</pose><parent')}</gazebo>\n"


SMALL = {
    "loop.json": _loop(),
    "kinds.json": _kinds(),
    "gears.asmt": _gears(),
    "arm.urdf": urdf(
        '<link name="base"/>',
        *(link(name) for name in ("one", "two", "three")),
        '<link name="frame"/>',
        joint("j1", "base", "one", more=DAMPED, rpy="0 0.1 0"),
        joint("j2", "one", "two", "0.2 0 0", "0 1 0", more='<mimic joint="j1" multiplier="2"/>'),
        joint("j3", "two", "three", "0.2 0 0", "1 0 0", "prismatic"),
        joint("j4", "three", "frame", kind="fixed"),
        '<link name="lump"><inertial><mass value="0.3"/></inertial></link>\n',
        joint("j5", "three", "lump", "0.1 0 0", kind="fixed"),
        '<gazebo reference="two"><turnGravityOff>true</turnGravityOff></gazebo>\n',
        '<transmission name="t"><joint name="j1"/></transmission>',
    ),
    "loop.urdf": urdf(
        '<link name="base"/>',
        *(link(name) for name in ("crank", "rod", "rocker")),
        joint("O", "base", "crank"),
        joint("A", "crank", "rod", "0 1 0"),
        joint("C", "base", "rocker", "2 0 0"),
        '<loop_joint name="B" type="spherical"><link1 link="rod"><origin xyz="2 0 0"/></link1>'
        '<link2 link="rocker"><origin xyz="0 1 0"/></link2></loop_joint>',
    ),
    "cell.urdf": urdf('<link name="base"/>', *_cell(0)),
    "arm.sdf": sdf(
        sdf_link("one"),
        sdf_link("two", "0.2 0 0 0 0.1 0", inside="<gravity>false</gravity>"),
        sdf_link("three", "0.3 0 0 0 0 0", ' relative_to="f"'),
        '<frame name="f" attached_to="two"><pose>0.1 0 0 0 0 0.2</pose></frame>\n',
        sdf_joint("j1", "world", "one", more=SPRUNG),
        sdf_joint("j2", "one", "two", "0 1 0", "screw", "").replace(
            "</joint>", "<screw_thread_pitch>0.02</screw_thread_pitch></joint>"
        ),
        sdf_joint("j3", "f", "three", more='<mimic joint="j1"><multiplier>2</multiplier></mimic>'),
        sdf_link("four", "0.1 0 0 0 0.1 0", ' relative_to="three"'),
        sdf_joint("j4", "three", "four", "1 0 0", "prismatic", SPRUNG),
        world="<gravity>0 0 -9.81</gravity>",
    ),
    "arm.xml": mjcf(
        mjcf_body("one", mjcf_body("two", mjcf_body("three", axis="0 0 1"))).replace(
            'name="j_three"', 'name="j_three" stiffness="5" damping="0.1" springref="0.1"'
        ),
        more='<equality><joint joint1="j_two" joint2="j_one" polycoef="0 2 0 0 0"/></equality>'
        '<actuator><motor joint="j_one"/></actuator>',
    ),
}
"""A valid file of each format, or two, by their names."""

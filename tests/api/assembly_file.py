"""Assemblies as FreeCAD writes them, from plain numbers."""

IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def turned(axis, degrees):
    """The rotation about a coordinate axis, by rows."""
    from math import cos, radians, sin

    c, s = cos(radians(degrees)), sin(radians(degrees))
    rows = {"x": ((1, 0, 0), (0, c, -s), (0, s, c)), "y": ((c, 0, s), (0, 1, 0), (-s, 0, c))}
    return rows.get(axis, ((c, -s, 0), (s, c, 0), (0, 0, 1)))


def assembly(points, parts, joints, motions, gravity=(0.0, -9.81, 0.0), span=(0.0, 1.0, 0.01)):
    """The text of a file.

    ``points`` are markers of the ground: a place, or a place and a rotation by rows. ``parts`` are
    (mass, centre, principal moments, markers) and where they are, by name; ``joints`` (kind, marker
    I, marker J) and numbers, by name; ``motions`` (kind, joint, expression) by name, a general
    motion (kind, marker I, marker J, place, turns).
    """
    lines = ["OndselSolver", "Assembly"]

    def put(depth, *texts):
        lines.extend("\t" * depth + str(text) for text in texts)

    def numbers(depth, head, values):
        put(depth, head)
        put(depth + 1, "\t".join(repr(float(value)) for value in values))

    def frame(depth, place, rows=IDENTITY):
        numbers(depth, "Position3D", place)
        put(depth, "RotationMatrix")
        for row in rows:
            put(depth + 1, "\t".join(repr(float(value)) for value in row))

    def markers(depth, told):
        put(depth, "RefPoints")
        for name, where in told.items():
            put(depth + 1, "RefPoint")
            frame(depth + 2, (0.0, 0.0, 0.0))
            put(depth + 2, "Markers")
            put(depth + 3, "Marker")
            put(depth + 4, "Name")
            put(depth + 5, name)
            frame(depth + 4, *(where if isinstance(where[0], tuple) else (where,)))
        put(depth, "RefCurves", "RefSurfaces")

    put(1, "Notes", "\t(Text string: '' runs: (Core.RunArray runs: #() values: #()))")
    put(1, "Name", "\tPress")
    frame(1, (0.0, 0.0, 0.0))
    markers(1, points)
    put(1, "Parts")
    for name, (mass, centre, moments, own, *where) in parts.items():
        put(2, "Part")
        put(3, "Name", f"\t{name}")
        frame(3, *(where or [(0.0, 0.0, 0.0)]))
        put(3, "FeatureOrder", "PrincipalMassMarker")
        put(4, "Name", "\tMassMarker")
        frame(4, centre)
        put(4, "Mass", f"\t{mass!r}")
        numbers(4, "MomentOfInertias", moments)
        markers(3, own)
    put(1, "KinematicIJs", "ConstraintSets")
    put(2, "Joints")
    for name, (kind, one, other, *told) in joints.items():
        put(3, kind)
        put(4, "Name", f"\t{name}", "MarkerI", f"\t/Press/{one}", "MarkerJ", f"\t/Press/{other}")
        for key, value in told:
            put(4, key, f"\t{value!r}")
    put(2, "Motions")
    for name, (kind, *told) in motions.items():
        put(3, kind)
        if kind == "GeneralMotion":
            one, other, place, turns = told
            put(
                4, "Name", f"\t{name}", "MarkerI", f"\t/Press/{one}", "MarkerJ", f"\t/Press/{other}"
            )
            for k, law in enumerate((*place, *turns)):
                put(4, f"rIJI{k + 1}" if k < 3 else f"angIJJ{k - 2}", f"\t{law}")
            put(4, "RotationOrder", "\t1\t2\t3")
            continue
        joint, law = told
        put(4, "Name", f"\t{name}", "MotionJoint", f"\t/Press/{joint}")
        put(4, "RotationZ" if kind == "RotationalMotion" else "TranslationZ", f"\t{law}")
    put(2, "GeneralConstraintSets")
    put(1, "ForceTorques")
    numbers(1, "ConstantGravity", gravity)
    put(1, "SimulationParameters")
    for key, value in zip(("tstart", "tend", "hout"), span, strict=True):
        put(2, key, f"\t{value!r}")
    return "\n".join(lines) + "\n"

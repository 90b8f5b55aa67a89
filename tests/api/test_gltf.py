"""glTF: a file that is whole, whose bodies are where the solution has them at every key, and whose
solids are closed.
"""

import json
import struct

import numpy as np
import pytest
from commands import command
from drawn_scenes import every_kind
from internals import (
    Film,
    Spot,
    block,
    cone,
    cylinder,
    joint_shapes,
    load_shapes,
    prism,
    shapes,
    sphere,
    upright,
    write_animation,
)
from internals import places_placed as placed
from reports import hostile, press, solved

from lagrange_casadi import save
from lagrange_casadi.errors import DeclarationError

WIDE = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}


def read(path):
    """What a file tells, and its arrays by number."""
    data = path.read_bytes()
    magic, version, size, length, kind = struct.unpack_from("<4sIIII", data)
    assert (magic, version, size, kind) == (b"glTF", 2, len(data), 0x4E4F534A)
    told = json.loads(data[20 : 20 + length])
    body, kind = struct.unpack_from("<II", data, 20 + length)
    assert (length % 4, body % 4, kind, 28 + length + body) == (0, 0, 0x004E4942, size)
    held = data[28 + length :]
    assert 0 <= len(held) - told["buffers"][0]["byteLength"] < 4

    def array(number):
        accessor = told["accessors"][number]
        view = told["bufferViews"][accessor["bufferView"]]
        assert view["byteOffset"] % 4 == 0
        values = np.frombuffer(
            held,
            {5126: "<f4", 5125: "<u4"}[accessor["componentType"]],
            view["byteLength"] // 4,
            view["byteOffset"],
        )
        values = values.reshape(accessor["count"], WIDE[accessor["type"]])
        for end, found in (("min", values.min(axis=0)), ("max", values.max(axis=0))):
            if end in accessor:
                assert accessor[end] == found.tolist()
        return values.astype(float)

    return told, array


def turned(quaternions, places):
    """Places (3,) turned by quaternions x, y, z, w (n, 4)."""
    axis, w = quaternions[:, :3], quaternions[:, 3:]
    once = 2.0 * np.cross(axis, places)
    return places + w * once + np.cross(axis, once)


def moved(told, array, name):
    """Where the node with a name takes a place at every key: a function of the place."""
    (number,) = [
        k for k, node in enumerate(told["nodes"]) if node["name"] == name and k in targets(told)
    ]
    paths = {
        channel["target"]["path"]: array(
            told["animations"][0]["samplers"][channel["sampler"]]["output"]
        )
        for channel in told["animations"][0]["channels"]
        if channel["target"]["node"] == number
    }
    turns = paths.get("rotation", np.array([[0.0, 0.0, 0.0, 1.0]]))
    return lambda place: (
        turned(turns, np.asarray(place) * paths.get("scale", 1.0)) + paths["translation"]
    )


def targets(told):
    return {channel["target"]["node"] for channel in told["animations"][0]["channels"]}


CASES = {
    name: lambda name=name: solved(name) for name in ("quick_return", "excavator", "rssr", "delta")
} | {"every kind": every_kind}


@pytest.mark.sampled(5)
@pytest.mark.parametrize("what", CASES)
def test_bodies_are_where_the_solution_has_them(tmp_path, what):
    solution = CASES[what]()
    write_animation(solution, tmp_path / "a.glb", Film(rate=25, seconds=3.0))
    told, array = read(tmp_path / "a.glb")
    assert told["animations"][0]["samplers"][0]["interpolation"] == "LINEAR"
    keys = array(told["animations"][0]["samplers"][0]["input"])[:, 0]
    assert (keys[0], keys[-1]) == (0.0, 3.0)
    chosen = np.abs(solution.t[:, None] - (solution.t[0] + keys / 3.0 * np.ptp(solution.t))).argmin(
        axis=0
    )
    size = np.ptp(
        np.concatenate(
            [placed(solution, Spot(s.name, (0.0, 0.0, 0.0))) for s in shapes(solution.description)]
        ),
        axis=0,
    ).max()
    for shape in shapes(solution.description):
        own = [
            joint.child.at
            for joint in joint_shapes(solution.description)
            if joint.child.body == shape.name
        ]
        for place in [(0.0, 0.0, 0.0), *shape.axis, *own]:
            exact = placed(solution, Spot(shape.name, place))[chosen]
            np.testing.assert_allclose(
                moved(told, array, shape.name)(place), exact, rtol=0, atol=3e-6 * size
            )
    for load in load_shapes(solution.description):
        if load.kind == "spring":
            for end, spot in zip(((0, 0, 0), (1, 0, 0)), load.spots, strict=True):
                exact = placed(solution, spot)[chosen]
                np.testing.assert_allclose(
                    moved(told, array, load.name)(end), exact, rtol=0, atol=3e-6 * size
                )
    (top,) = told["scenes"][0]["nodes"]
    if len(solution.description["gravity"]) > 2:
        up = turned(
            np.array([told["nodes"][top]["rotation"]]), upright(solution.description["gravity"])[2]
        )
        np.testing.assert_allclose(up, [[0.0, 1.0, 0.0]], atol=1e-12)
    for channel in told["animations"][0]["channels"]:
        if channel["target"]["path"] == "rotation":
            turns = array(told["animations"][0]["samplers"][channel["sampler"]]["output"])
            np.testing.assert_allclose(np.linalg.norm(turns, axis=1), 1.0, atol=1e-6)
            assert (np.sum(turns[1:] * turns[:-1], axis=1) > 0.0).all()


@pytest.mark.parametrize("name", ["excavator", "rssr"])
def test_arrows_are_forces_at_their_places_to_the_scale_that_is_told(tmp_path, name):
    """Reactions begin at their joint's point on the child, loads end at theirs; a moment's arrow is
    along its axis.
    """
    solution = solved(name)
    solution.animate(tmp_path / "a.glb", Film(rate=25, seconds=2.0, forces=True))
    told, array = read(tmp_path / "a.glb")
    keys = array(told["animations"][0]["samplers"][0]["input"])[:, 0]
    chosen = np.abs(solution.t[:, None] - (solution.t[0] + keys / 2.0 * np.ptp(solution.t))).argmin(
        axis=0
    )
    extras = {node["name"]: node["extras"] for node in told["nodes"] if "extras" in node}
    size = max(moved(told, array, one)((1, 0, 0)).max() for one in extras)

    def vector(kind, part):
        members = (
            ("fx", "fy", "fz")
            if solution.pose(next(iter(solution.description["bodies"]))).z is not None
            else ("fx", "fy")
        )
        found = [solution.array(f"{kind}:{part}:{member}")[chosen] for member in members]
        return np.column_stack([*found, *[0 * found[0]] * (3 - len(found))])

    expected = {
        f"reaction {joint.name}": (joint.child, vector("reaction", joint.name), 0.0)
        for joint in joint_shapes(solution.description)
    }
    for load in load_shapes(solution.description):
        expected[f"load {load.name}"] = (load.spots[0], vector("load", load.name), 1.0)
    assert {one for one in extras if not one.startswith("effort ")} == set(expected)
    for one, (spot, force, share) in expected.items():
        assert extras[one]["unit"] == "N"
        assert extras[one]["largest"] == pytest.approx(
            np.linalg.norm(force, axis=1).max(), rel=1e-12
        )
        tail, tip = (moved(told, array, one)(place) for place in ((0, 0, 0), (1, 0, 0)))
        np.testing.assert_allclose(
            tip - tail, extras[one]["metres_per_unit"] * force, rtol=0, atol=1e-5 * size
        )
        np.testing.assert_allclose(
            tail + share * (tip - tail), placed(solution, spot)[chosen], rtol=0, atol=1e-5 * size
        )
    efforts = [one for one in extras if one.startswith("effort ")]
    assert len(efforts) == len([name for name in solution.outputs if name.group == "effort"])
    for one in efforts:
        tail, tip = (moved(told, array, one)(place) for place in ((0, 0, 0), (1, 0, 0)))
        found = np.linalg.norm(tip - tail, axis=1) / extras[one]["metres_per_unit"]
        exact = np.abs(solution.effort(one.removeprefix("effort "))[chosen])
        np.testing.assert_allclose(found, exact, rtol=0, atol=1e-4 * exact.max())


@pytest.mark.parametrize(
    ("mesh", "volume"),
    [
        (
            cylinder(np.array([1.0, 2.0, 3.0]), np.array([1.0, 5.0, 7.0]), 0.5),
            12 * np.sin(np.pi / 12) * 0.25 * 5.0,
        ),
        (
            cone(np.array([1.0, 2.0, 3.0]), np.array([1.0, 5.0, 7.0]), 0.5),
            12 * np.sin(np.pi / 12) * 0.25 * 5.0 / 3,
        ),
        (sphere(np.array([1.0, 0.0, 2.0]), 2.0), None),
        (block(np.array([1.0, 0.0, 2.0]), np.eye(3)[[1, 2, 0]], [1.0, 2.0, 3.0]), 6.0),
        (block(np.array([1.0, 0.0, 2.0]), np.diag([1.0, 1.0, -1.0]), [1.0, 2.0, 3.0]), 6.0),
        (
            prism(
                np.array([[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.0, 1.0, 1.0], [0.0, 1.0, 1.0]]), 0.5
            ),
            1.0,
        ),
        (prism(np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [2.0, 0.0, 1.0]]), 0.5), 0.5),
        (  # a hollow edge, which its first corner does not see
            prism(np.array([[0, 0, 1], [1, 0.4, 1], [2, 0, 1], [2, 2, 1], [0, 2, 1]], float), 0.5),
            1.8,
        ),
    ],
)
def test_solids_are_closed_and_seen_from_outside(mesh, volume):
    """Every edge is passed once each way, normals point outward, and the divergence theorem gives
    the volume.
    """
    _, places = np.unique(mesh.places.round(9), axis=0, return_inverse=True)
    corners = places.ravel()[mesh.corners]
    edges = {tuple(edge) for k in range(3) for edge in corners[:, [k, (k + 1) % 3]]}
    assert len(edges) == 3 * len(corners)
    assert all((b, a) in edges for a, b in edges)
    a, b, c = (mesh.places[mesh.corners[:, k]] for k in range(3))
    found = np.sum(np.cross(a, b) * c) / 6.0
    assert found == pytest.approx(
        volume if volume else 4 / 3 * np.pi * 8.0, rel=1e-12 if volume else 0.04
    )
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-12)
    faces = np.cross(b - a, c - a)
    assert (np.sum(faces[:, None] * mesh.normals[mesh.corners], axis=2) > 0.0).all()


def test_the_command_writes_it_twice_alike_and_says_what_it_cannot_show(tmp_path, capsys):
    save(press(), tmp_path / "press.h5")
    for name in ("a", "b"):
        assert command("animate", tmp_path / "press.h5", "--out", tmp_path / f"{name}.glb") == 0
    assert (tmp_path / "a.glb").read_bytes() == (tmp_path / "b.glb").read_bytes()
    capsys.readouterr()
    asked = ("animate --section bending", tmp_path / "press.h5", "--out", tmp_path / "c.glb")
    assert command(*asked) == 2
    assert "a .glb has no section forces; they are in .gif, .mp4, .svg" in capsys.readouterr().err
    assert not (tmp_path / "c.glb").exists()
    with pytest.raises(DeclarationError, match="there is 1 instant; ask for more"):
        press(t=(0.1, 0.1, 1)).animate(tmp_path / "c.glb")
    hostile().animate(tmp_path / "hostile.glb")
    told, _ = read(tmp_path / "hostile.glb")
    assert told["scenes"][0]["name"] == hostile().case

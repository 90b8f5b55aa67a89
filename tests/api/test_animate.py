"""Animations: as many frames as are told, of the time that is told; bodies and arrows are where the
solution has them, in glTF at every key; no name of a user is markup.
"""

import itertools
import json
import struct
import sys
import xml.etree.ElementTree as ElementTree
from base64 import b64encode
from dataclasses import replace

import numpy as np
import pytest
from commands import command
from drawn_scenes import every_kind
from PIL import Image
from reports import HOSTILE, hostile, press, solved

from lagrange_casadi import load, save
from lagrange_casadi.animation import Film

SVG = "{http://www.w3.org/2000/svg}"


TURN = (0, 2 * np.pi / 10, 41)


SMALL = {"width": 160, "rate": 5, "seconds": 2.0}


FFMPEG = f"""#!{sys.executable}
import sys, pathlib
told = sys.argv[1:]
if pathlib.Path(__file__).with_name("fails").exists():
    print("of two lines", "no such encoder", sep="\\n", file=sys.stderr)
    sys.exit(7)
size = [int(side) for side in told[told.index("-s") + 1].split("x")]
film = sys.stdin.buffer.read()
pathlib.Path(told[-1]).write_text(f"{{told[told.index('-r') + 1]}} {{len(film) / (3 * size[0] * size[1]):g}}")
"""  # noqa: E501


def test_a_film_is_made_by_ffmpeg(here, capsys, monkeypatch):
    program = here / "programs" / "ffmpeg"
    program.parent.mkdir()
    program.write_text(FFMPEG)
    program.chmod(0o755)
    save(press(TURN), "press.h5")
    monkeypatch.setenv("PATH", str(program.parent))
    line = "animate press.h5 --out a.mp4 --width 160 --rate 5 --seconds 1"
    assert command(line) == 0
    program.with_name("fails").touch()
    assert command(line) == 1
    assert capsys.readouterr().err == "error: ffmpeg failed: no such encoder\n"
    assert (here / "a.mp4").read_text() == "5 5"
    monkeypatch.setenv("PATH", "")
    assert command(line) == 2
    told = "by ffmpeg, which is not found; install it, or write a .gif or an .svg"
    assert told in capsys.readouterr().err
    assert sorted(path.name for path in here.iterdir()) == ["a.mp4", "press.h5", "programs"]


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


def written(solution, path, film=None, **more):
    solution.animate(path, film or Film(**(SMALL | more)))
    return path


def test_a_gif_has_the_frames_and_the_time_that_are_told(tmp_path):
    """At a rate that does not divide its hundredths of a second too."""
    for rate, seconds, frames in ((5, 2.0, 10), (7.0, 1.0, 7)):
        path = written(press(TURN), tmp_path / "a.gif", rate=rate, seconds=seconds)
        times, pixels = [], []
        with Image.open(path) as image:
            assert (image.size[0], image.n_frames, image.info["loop"]) == (160, frames, 0)
            for k in range(frames):
                image.seek(k)
                times.append(image.info["duration"])
                pixels.append(np.asarray(image.convert("RGB")))
        assert sum(times) == 1000 * seconds
        assert all((one != other).any() for one, other in itertools.pairwise(pixels))


def drawn(path):
    """The root of an SVG, and the values that its elements take, one list for each."""
    root = ElementTree.parse(path).getroot()
    kinds = (f"{SVG}animate", f"{SVG}animateTransform")
    return root, [one.get("values").split(";") for kind in kinds for one in root.iter(kind)]


def test_an_svg_moves_by_itself_and_tells_the_peaks(tmp_path):
    """A cycle ends where it begins; a motion that does not come back does not glide back; there are
    no more frames than instants.
    """
    for t, count, turns in ((TURN, 11, True), ((0, 0.3, 41), 10, False), ((0, 0.3, 2), 2, False)):
        root, lists = drawn(written(press(t), tmp_path / "a.svg"))
        assert {len(values) for values in lists} == {count}
        assert all((values[0] == values[-1]) is turns for values in lists)
        assert {one.get("dur") for one in root.iter(f"{SVG}animate")} == {"2s"}
    solution = press(TURN)
    film = Film(rate=10, seconds=4.0, forces=True, section="bending")
    root, _ = drawn(written(solution, tmp_path / "b.svg", film))
    quantities = (
        [f"reaction:{joint}:resultant" for joint in ("O", "A", "B", "guide")],
        ["effort:O"],
        [f"section:{link}:bending" for link in ("crank", "rod")],
    )
    most = [max(abs(solution.peak(name).value) for name in names) for names in quantities]
    shown = solution.animate(tmp_path / "b.svg", film)._repr_html_()
    assert b64encode((tmp_path / "b.svg").read_bytes()).decode() in shown
    texts = [one.text for one in root.iter(f"{SVG}text")]
    assert texts[-1] == (
        f"arrows: up to {most[0]:.3g} N \N{MIDDLE DOT} drive torques: up to {most[1]:.3g} N m"
        f" \N{MIDDLE DOT} bending: up to {most[2]:.3g} N m"
    )


def test_arrows_of_an_svg_have_the_directions_and_one_scale_of_the_solution(tmp_path):
    """At the frames' own instants; y is up, and each ends in the first corner of its head."""
    solution = press(TURN)
    film = Film(rate=10, seconds=4.0, forces=True)
    root, _ = drawn(written(solution, tmp_path / "a.svg", film))

    def starts(kind, colour):
        for one in root.iter(f"{SVG}{kind}"):
            if colour in (one.get("stroke"), one.get("fill")):
                (way,) = one.iter(f"{SVG}animate")
                values = way.get("values").replace(",", " ").split(";")
                yield np.array([list(map(float, each.split()[:2])) for each in values])

    scales = []
    arrows = zip(starts("polyline", "#c2304a"), starts("polygon", "#c2304a"), strict=True)
    for joint, (tail, tip) in zip(("O", "A", "B", "guide"), arrows, strict=True):
        reaction, way = solution.reaction(joint), (tip - tail) * [1, -1]
        force = np.column_stack([reaction.fx, reaction.fy])
        scales.append(np.sum(way * force) / np.sum(force * force))
        np.testing.assert_allclose(way, scales[-1] * force, rtol=0, atol=0.2)
    np.testing.assert_allclose(scales, scales[0], rtol=1e-2)
    assert scales[0] > 0.0


def test_no_name_is_markup(tmp_path):
    """Letters that no font has are not the end of it."""
    odd = replace(hostile(), case="a\x00b\x1b$x_1^$")
    root, _ = drawn(written(hostile(), tmp_path / "a.svg", forces=True))
    kinds = ("svg", "title", "rect", "g", "polyline", "polygon", "circle", "text", "animate")
    found = {element.tag.removeprefix(SVG) for element in root.iter()}
    assert found <= {*kinds, "animateTransform"}
    words = "".join(root.itertext())
    assert HOSTILE[0] in words
    assert HOSTILE[1] in words
    root, _ = drawn(written(odd, tmp_path / "b.svg"))
    assert root.find(f"{SVG}title").text == "a\ufffdb\ufffd$x_1^$"
    written(odd, tmp_path / "b.gif")
    told, _ = read(written(hostile(), tmp_path / "c.glb"))
    assert told["scenes"][0]["name"] == hostile().case


def test_the_same_solution_gives_the_same_bytes(here):
    save(press(TURN), "press.h5")
    for ending in ("gif", "svg", "glb"):
        written(press(TURN), f"a.{ending}")
        written(load("press.h5"), f"b.{ending}")
        assert (here / f"a.{ending}").read_bytes() == (here / f"b.{ending}").read_bytes()


def at_keys(solution, told, array, seconds):
    """The instants of the keys of a film of so many seconds."""
    keys = array(told["animations"][0]["samplers"][0]["input"])[:, 0]
    assert (keys[0], keys[-1]) == (0.0, seconds)
    times = solution.t[0] + keys / seconds * np.ptp(solution.t)
    return np.abs(solution.t[:, None] - times).argmin(axis=0)


def places_of(solution, body, place):
    """Where a place of a body is at every instant: from its pose, in the plane or in space."""
    x, y = place[:2]
    if body == "ground":
        return np.broadcast_to(np.resize([*place, 0.0], 3), (solution.t.size, 3))
    pose = solution.pose(body)
    if pose.z is not None:
        base = np.column_stack([pose.x, pose.y, pose.z])
        if pose.axes is None:  # of a point, which is at its only place
            assert not any(place)
            return base
        return base + np.einsum("j,njk->nk", np.resize([*place, 0.0], 3), pose.axes)
    angle = 0.0 if pose.angle is None else pose.angle
    moved_to = pose.x + 1j * pose.y + (x + 1j * y) * np.exp(1j * angle)
    return np.column_stack([moved_to.real, moved_to.imag, 0 * moved_to.real])


@pytest.mark.sampled(5)
@pytest.mark.parametrize("name", ["quick_return", "excavator", "rssr", "delta", "every"])
def test_bodies_are_where_the_solution_has_them(tmp_path, name):
    """At every key, by the nodes of a glTF; its top turns what is up to y."""
    solution = every_kind() if name == "every" else solved(name)
    told, array = read(written(solution, tmp_path / "a.glb", Film(rate=25, seconds=3.0)))
    chosen = at_keys(solution, told, array, 3.0)
    size = max(np.ptp(places_of(solution, body, (0, 0, 0))) for body in solution.description.bodies)
    for joint in solution.description.joints.values():
        for end in (joint.child, joint.parent):
            if end.body != "ground":
                exact = places_of(solution, end.body, end.at)[chosen]
                found = moved(told, array, end.body)(end.at)
                np.testing.assert_allclose(found, exact, rtol=0, atol=1e-5 * size)
    (top,) = told["scenes"][0]["nodes"]
    if solution.description.space:
        gravity = np.array(solution.description.gravity)
        up = turned(np.array([told["nodes"][top]["rotation"]]), -gravity / np.linalg.norm(gravity))
        np.testing.assert_allclose(up, [[0.0, 1.0, 0.0]], atol=1e-12)
    for channel in told["animations"][0]["channels"]:
        if channel["target"]["path"] == "rotation":
            turns = array(told["animations"][0]["samplers"][channel["sampler"]]["output"])
            np.testing.assert_allclose(np.linalg.norm(turns, axis=1), 1.0, atol=1e-6)
            assert (np.sum(turns[1:] * turns[:-1], axis=1) > 0.0).all()


@pytest.mark.parametrize("name", ["excavator", "rssr"])
def test_arrows_are_forces_at_their_places_to_the_scale_that_is_told(tmp_path, name):
    """Reactions begin at their joint's point on the child; a moment's arrow is along its axis."""
    solution = solved(name)
    film = Film(rate=25, seconds=2.0, forces=True)
    told, array = read(written(solution, tmp_path / "a.glb", film))
    chosen = at_keys(solution, told, array, 2.0)
    extras = {node["name"]: node["extras"] for node in told["nodes"] if "extras" in node}
    joints, bodies = solution.description.joints, solution.description.bodies
    size = max(np.ptp(places_of(solution, body, (0, 0, 0))) for body in bodies)
    assert {one for one in extras if one.startswith("reaction ")} == {
        f"reaction {j}" for j in joints
    }
    for joint, described in joints.items():
        end, one = described.child, f"reaction {joint}"
        found = solution.reaction(joint)
        parts = [found.fx, found.fy, 0 * found.fx if name == "excavator" else found.fz]
        force = np.column_stack(parts)[chosen]
        largest = np.linalg.norm(force, axis=1).max()
        assert extras[one]["unit"] == "N"
        assert extras[one]["largest"] == pytest.approx(largest, rel=1e-12)
        tail, tip = (moved(told, array, one)(place) for place in ((0, 0, 0), (1, 0, 0)))
        scaled = extras[one]["metres_per_unit"] * force
        np.testing.assert_allclose(tip - tail, scaled, rtol=0, atol=1e-5 * size)
        exact = places_of(solution, end.body, end.at)[chosen]
        np.testing.assert_allclose(tail, exact, rtol=0, atol=1e-5 * size)
    for one in (one for one in extras if one.startswith("effort ")):
        tail, tip = (moved(told, array, one)(place) for place in ((0, 0, 0), (1, 0, 0)))
        found = np.linalg.norm(tip - tail, axis=1) / extras[one]["metres_per_unit"]
        exact = np.abs(solution.effort(one.removeprefix("effort "))[chosen])
        np.testing.assert_allclose(found, exact, rtol=0, atol=1e-4 * exact.max())

"""Animations: as many frames as are told, of the time that is told, sharp and whole; no name of a
user is markup.
"""

import io
import stat
import sys
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from commands import command, words
from drawn_scenes import every_kind
from internals import Film, Line, gif, picture_of, svg, write_animation
from PIL import Image
from reports import HOSTILE, hostile, press, solved, to_polygon

from lagrange_casadi import Mechanism, Scene, evaluate, load, save
from lagrange_casadi.cli import main
from lagrange_casadi.elements import disc_cam
from lagrange_casadi.errors import DeclarationError, PathError
from lagrange_casadi.motion import polynomial

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


def moved(text, name):
    """The places that every element of a name takes in an SVG, one list for each."""
    lists = [one.get("values").split(";") for one in ElementTree.fromstring(text).iter(name)]
    return [values for values in lists if values]


def test_a_gif_has_the_frames_and_the_time_that_are_told():
    picture = picture_of(press(TURN), Film(**SMALL))
    image = Image.open(io.BytesIO(gif(picture, 2.0)))
    assert image.size == (picture.width, picture.height)
    assert image.size[0] == 160
    assert image.n_frames == 10
    assert image.info["loop"] == 0
    times, pixels = [], []
    for k in range(image.n_frames):
        image.seek(k)
        times.append(image.info["duration"])
        pixels.append(np.asarray(image.convert("RGB")))
        assert (pixels[-1][0] == 255).all()
        assert (pixels[-1] < 128).any()
    assert sum(times) == 2000
    assert all(
        (one != other).any() for one, other in zip(pixels, pixels[1:] + pixels[:1], strict=True)
    )


def test_odd_rates_keep_the_time_of_the_cycle():
    image = Image.open(io.BytesIO(gif(picture_of(press(TURN), Film(160, 7.0, 1.0)), 1.0)))
    times = []
    for k in range(image.n_frames):
        image.seek(k)
        times.append(image.info["duration"])
    assert len(times) == 7
    assert sum(times) == 1000


def test_bodies_are_where_the_solution_has_them():
    """The crank, one thick line of the sheet, has its length and its angle at every frame; x to the
    right, y up.
    """
    solution = press(TURN)
    picture = picture_of(solution, Film(rate=10, seconds=4.0))
    assert picture.closed
    assert picture.frames == 40
    crank = next(
        thing for thing in picture.things if isinstance(thing, Line) and thing.width == 8.0
    )
    way = crank.points[:, 1] - crank.points[:, 0]
    np.testing.assert_allclose(np.hypot(*way.T), np.hypot(*way[0]), rtol=1e-12)
    np.testing.assert_allclose(
        np.unwrap(np.arctan2(-way[:, 1], way[:, 0])), solution.pose("crank").angle[:-1], atol=1e-12
    )


@pytest.mark.parametrize(
    "name", ["rssr", "quick_return", "spatial_slider_crank", "andrews_squeezer"]
)
def test_everything_is_on_the_sheet_at_all_times(name):
    section = {"quick_return": "bending", "andrews_squeezer": ""}.get(name, "bending_z")
    picture = picture_of(solved(name), Film(forces=True, section=section))
    for thing in picture.things:
        assert np.isfinite(thing.points).all()
        assert (thing.points >= 0).all()
        assert (thing.points <= [picture.width, picture.height]).all()
    assert picture.height % 2 == 0


def picture_size(solution):
    """The larger side of all places between which something is drawn, over the whole cycle [m]:
    here joints, at all frames.
    """
    x = [0.0, *(solution.pose(body).x[:-1] for body in ("crank", "rod", "ram"))]
    y = [0.0, *(solution.pose(body).y[:-1] for body in ("crank", "rod", "ram"))]
    return max(np.ptp(np.concatenate([np.atleast_1d(one) for one in side])) for side in (x, y))


def test_arrows_and_ribbons_have_the_signs_of_the_solution():
    """Against the solution at the frames' own instants: y is up, ordinates go to the side of n,
    turns are counter-clockwise.
    """
    solution = press(TURN)
    picture = picture_of(solution, Film(rate=10, seconds=4.0, forces=True, section="bending"))
    lines = [thing for thing in picture.things if isinstance(thing, Line)]
    scales = []
    heads = [line for line in lines if line.colour == "#c2304a" and line.closed]
    shafts = [line for line in lines if line.colour == "#c2304a" and not line.closed]
    for joint, shaft, head in zip(("O", "A", "B", "guide"), shafts, heads, strict=True):
        reaction, way = solution.reaction(joint), (head.points[:, 0] - shaft.points[:, 0]) * [1, -1]
        force = np.column_stack([reaction.fx, reaction.fy])[:-1]
        np.testing.assert_allclose(
            way[:, 0] * force[:, 1],
            way[:, 1] * force[:, 0],
            atol=1e-9 * np.abs(way).max() * np.abs(force).max(),
        )
        scales.append(np.sum(way * force) / np.sum(force * force))
    np.testing.assert_allclose(scales, scales[0], rtol=1e-9)
    assert scales[0] > 0

    largest = max(abs(solution.peak(f"section:{link}:bending").value) for link in ("crank", "rod"))
    widest = (
        0.2
        * np.hypot(*(shafts[0].points[0, 0] - shafts[1].points[0, 0]))
        / 0.1
        * picture_size(solution)
    )
    for link, both in (("crank", lines[:2]), ("rod", lines[2:4])):
        angle = solution.pose(link).angle[:-1]
        values = solution.section(link).law.on_grid("bending", np.linspace(0, 1, 41))[:-1]
        n = np.column_stack([-np.sin(angle), -np.cos(angle)])[:, None]
        for line, kept in zip(both, (np.maximum(values, 0), np.minimum(values, 0)), strict=True):
            ordinates = np.sum((line.points[:, :40:-1] - line.points[:, :41]) * n, axis=-1)
            np.testing.assert_allclose(ordinates, widest * kept / largest, atol=1e-9 * widest)

    arc, head = (line.points for line in lines if line.colour == "#6d3fc0")
    centre = lines[[line.width for line in lines].index(8.0)].points[:, :1]
    turned = np.unwrap(np.arctan2(-(arc - centre)[..., 1], (arc - centre)[..., 0]), axis=1)
    effort = solution.effort("O")[:-1]
    np.testing.assert_allclose(
        turned[:, -1] - turned[:, 0],
        1.5 * np.pi * effort / np.abs(solution.effort("O")).max(),
        atol=1e-9,
    )
    ahead, last = head[:, 0] - head[:, 1:].mean(axis=1), arc[:, -1] - arc[:, -2]
    assert (np.sum(ahead * last, axis=1) >= 0).all()


def test_gears_turn_and_have_room():
    """Of the rim of a disc the spoke is a radius; it goes round as the body does."""
    m = Mechanism("rotor")
    rotor = m.link("rotor", length=0.3, mass=1.0, centre=(0, 0), inertia=0.1)
    m.revolute("O", m.ground, rotor)
    solution = evaluate(
        Scene(m, {"O": polynomial(0, 1)}, t=(0, 2 * np.pi, 41), wanted=["all"]), backend="vm"
    )
    picture = picture_of(solution, Film(rate=10, seconds=4.0))
    rim, spoke = (
        thing.points for thing in picture.things if isinstance(thing, Line) and thing.width == 2.4
    )
    assert (rim >= 0).all()
    assert (rim <= [picture.width, picture.height]).all()
    radius = spoke[:, 1] - spoke[:, 0]
    np.testing.assert_allclose(
        np.hypot(*(rim - spoke[:, :1]).transpose(2, 0, 1)), np.hypot(*radius[0]), rtol=1e-9
    )
    turned = np.unwrap(np.arctan2(-radius[:, 1], radius[:, 0]))
    np.testing.assert_allclose(turned - turned[0], solution.motion("O").value[:-1], atol=1e-9)


@pytest.mark.parametrize("values", [{}, {"base": 0.06, "wheel": 0.02, "aside": -0.01}])
def test_rollers_touch_the_cams_that_are_drawn(values):
    """Two cams on one body, which turns about a point beside its base, and their followers: rods of
    no sections, and with sections.
    """
    m = Mechanism("two_cams")
    base, wheel = m.parameter("base", 0.04, "m"), m.parameter("wheel", 0.012, "m")
    aside = m.parameter("aside", 0.005, "m")
    disc = m.link("disc", length=0.03, mass=1.0, centre=(0, 0), inertia=1e-3)
    shaft = m.revolute("shaft", m.ground.at(0.1, 0.0), disc.at(0.004, -0.003))
    rods = m.link("up", length=0.1, mass=0.2), m.link("down", length=0.1, mass=0.2)
    for rod, up, waves in zip(rods, (1, -1), (1, 2), strict=True):
        ground = m.ground.at(0.1 + aside, 0.0)
        guide = m.prismatic(f"{rod.name}_guide", ground, rod, axis=(0, up), angle=up * np.pi / 2)
        point = rod.at(0.01)
        lift = lambda x, waves=waves: 0.006 * (1 - ca.cos(waves * x))  # noqa: E731
        disc_cam(
            m, f"{rod.name}_cam", shaft, guide, lift, base_radius=base, point=point, roller=wheel
        )
    scene = Scene(
        m, {"shaft": polynomial(0.2, 10.0)}, t=TURN, posture={"up_guide": 0.05, "down_guide": 0.05}
    )
    picture = picture_of(evaluate(scene, parameters=values, wanted=["all"], backend="vm"), Film())
    drawn = [one.points for one in picture.things if isinstance(one, Line) and one.width == 2.0]
    assert [points.shape for points in drawn] == [(40, n, 2) for n in (240, 240, 48, 48)]
    for profile, roller in zip(drawn[:2], drawn[2:], strict=True):
        assert (profile >= 0).all()
        assert (profile <= [picture.width, picture.height]).all()
        centre = roller.mean(axis=1)
        radius = np.hypot(*(roller - centre[:, None]).transpose(2, 0, 1))
        for place, corners, size in zip(centre, profile, radius, strict=True):
            np.testing.assert_allclose(size, size[0], rtol=1e-9)
            assert to_polygon(place, corners) == pytest.approx(size[0], rel=1e-3)


def test_joints_of_every_kind_are_drawn():
    picture = picture_of(every_kind(), Film(**SMALL))
    assert all(np.isfinite(thing.points).all() for thing in picture.things)
    ElementTree.fromstring(svg(picture, 2.0))


def test_the_longest_arrow_and_the_widest_ribbon_tell_the_peaks():
    solution = press(TURN)
    picture = picture_of(solution, Film(rate=10, seconds=4.0, forces=True, section="bending"))
    texts = [one.text for one in ElementTree.fromstring(svg(picture, 4.0)).iter(f"{SVG}text")]
    force = max(
        solution.peak(f"reaction:{joint}:resultant").value for joint in ("O", "A", "B", "guide")
    )
    bending = max(abs(solution.peak(f"section:{link}:bending").value) for link in ("crank", "rod"))
    effort = abs(solution.peak("effort:O").value)
    assert (
        texts[-1]
        == f"arrows: up to {force:.3g} N · drive torques: up to {effort:.3g} N m · bending: up to"
        f" {bending:.3g} N m"
    )


def test_an_svg_moves_by_itself():
    """A cycle ends where it begins; a motion that does not come back does not glide back."""
    for t, count in ((TURN, 11), ((0, 0.3, 41), 10)):
        picture = picture_of(press(t), Film(**SMALL))
        text = svg(picture, 2.0)
        found = moved(text, f"{SVG}animate") + moved(text, f"{SVG}animateTransform")
        assert found
        assert {len(values) for values in found} == {count}
        assert all((values[0] == values[-1]) == (count == 11) for values in found)
        assert {one.get("dur") for one in ElementTree.fromstring(text).iter(f"{SVG}animate")} == {
            "2s"
        }
        assert "href" not in text


def test_no_name_is_markup():
    picture = picture_of(hostile(), Film(**SMALL, forces=True))
    root = ElementTree.fromstring(svg(picture, 2.0))
    kinds = {
        "svg",
        "title",
        "rect",
        "polyline",
        "polygon",
        "circle",
        "text",
        "animate",
        "animateTransform",
    }
    assert {element.tag.removeprefix(SVG) for element in root.iter()} <= kinds
    words = "".join(root.itertext())
    assert HOSTILE[0] in words
    assert HOSTILE[1] in words
    assert gif(picture, 2.0)  # and letters that no font has are not the end of it
    odd = replace(hostile(), case="a\x00b\x1b$x_1^$")
    assert (
        ElementTree.fromstring(svg(picture_of(odd, Film(**SMALL)), 2.0)).find(f"{SVG}title").text
        == "a\ufffdb\ufffd$x_1^$"
    )


@pytest.mark.parametrize("ending", ["gif", "svg"])
def test_the_same_solution_gives_the_same_bytes(here, ending):
    save(press(TURN), "press.h5")
    write_animation(press(TURN), f"a.{ending}", Film(**SMALL))
    write_animation(load("press.h5"), f"b.{ending}", Film(**SMALL))
    assert (here / f"a.{ending}").read_bytes() == (here / f"b.{ending}").read_bytes()


def test_no_more_frames_than_instants():
    assert picture_of(press((0, 2 * np.pi / 10, 9)), Film()).frames == 8
    assert picture_of(press((0, 0.3, 2)), Film()).frames == 2


def test_what_stands_still_is_drawn():
    m = Mechanism("still")
    m.revolute("O", m.ground, m.link("bar", length=1.0, mass=1.0))
    solution = evaluate(Scene(m, {"O": polynomial(0.3)}, t=(0, 1, 5), wanted=["all"]), backend="vm")
    picture = picture_of(solution, Film(**SMALL, forces=True, section="bending"))
    assert all(np.isfinite(thing.points).all() for thing in picture.things)
    assert "<animate" not in svg(picture, 2.0)


def put_ffmpeg(folder, monkeypatch):
    folder.mkdir()
    program = folder / "ffmpeg"
    program.write_text(FFMPEG)
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", str(folder))


def test_a_film_is_made_by_ffmpeg(here, capsys, monkeypatch):
    put_ffmpeg(here / "programs", monkeypatch)
    save(press(TURN), "press.h5")
    arguments = words("animate press.h5 --out a.mp4 --width 160 --rate 5 --seconds 2")
    assert main(arguments) == 0
    assert (here / "a.mp4").read_text() == "5 10"
    (here / "programs" / "fails").touch()
    assert main(arguments) == 1
    assert capsys.readouterr().err == "error: ffmpeg failed: no such encoder\n"
    assert (here / "a.mp4").read_text() == "5 10"
    assert sorted(path.name for path in here.iterdir()) == ["a.mp4", "press.h5", "programs"]


def test_the_command_shows_a_file_and_a_case(here, capsys):
    save(press(TURN), "press.h5")
    assert command("animate press.h5 --forces --section bending --width 160 --rate 5") == 0
    assert (
        main(["animate", "four_bar", "--out", "b.svg", "--forces", "--no-names", "--t", "0:0.5:21"])
        == 0
    )
    assert capsys.readouterr().out == "wrote press.gif\nwrote b.svg\n"
    with Image.open("press.gif") as image:
        assert image.n_frames == 20
    root = ElementTree.parse("b.svg").getroot()
    assert [one.text.split(":")[0] for one in root.iter(f"{SVG}text")] == ["arrows"]


@pytest.mark.sampled(4)
@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (
            ["all.h5", "--out", "a.png"],
            "animation a.png: expected a name that ends in .gif, .mp4, .svg or .glb",
        ),
        (
            ["all.h5", "--out", "nowhere/a.gif"],
            "cannot write nowhere/a.gif: folder nowhere does not exist",
        ),
        (
            ["all.h5", "--out", "a.mp4"],
            "an MP4 is made by ffmpeg, which is not found; install it, or write a .gif or an .svg",
        ),
        (
            ["effort.h5"],
            (
                "an animation shows the mechanism in motion, and there is no motion of 'crank',"
                " 'rod', 'ram'; want motion too"
            ),
        ),
        (
            ["motion.h5", "--forces"],
            "there is no reaction, effort or load to be shown; want reaction too",
        ),
        (
            ["motion.h5", "--section", "bending"],
            "there is no section force to be shown; want section too",
        ),
        (
            ["all.h5", "--section", "torsion"],
            "unknown section force 'torsion'; valid: axial, shear, bending",
        ),
        (["one.h5"], "an animation shows a motion, and there is 1 instant; ask for more"),
        (
            ["all.h5", "--width", "81"],
            "width: expected an even number of pixels from 80 to 3840, got 81",
        ),
        (["all.h5", "--rate", "0"], "rate: expected frames a second above 0, got 0.0"),
        (["all.h5", "--rate", "51"], "rate: expected 50 frames a second at most, got 51.0"),
        (["all.h5", "--seconds", "nan"], "seconds: expected seconds a cycle above 0, got nan"),
        (
            ["all.h5", "--seconds", "1e9"],
            "rate and seconds: expected 3000 frames at most, got 2.5e+10",
        ),
        (["all.h5", "--t", "0:1:5"], "--set, --t and --over go with a case, not with a file"),
        (["nothing.h5"], "nothing.h5: no such file"),
    ],
)
def test_a_mistake_is_one_line(here, capsys, monkeypatch, arguments, told):
    monkeypatch.setenv("PATH", "")
    save(press(TURN), "all.h5")
    save(press(TURN, ("effort",)), "effort.h5")
    save(press(TURN, ("motion",)), "motion.h5")
    save(press((0, 0, 1)), "one.h5")
    before = sorted(here.iterdir())
    assert main(["animate", *arguments]) == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1
    assert sorted(here.iterdir()) == before


def test_an_animation_is_replaced_whole_or_not_at_all(here):
    (here / "a.gif").mkdir()
    with pytest.raises(PathError, match="it is a folder"):
        write_animation(press(TURN), "a.gif", Film(**SMALL))
    with pytest.raises(DeclarationError, match=r"write_animation: (solution|path): expected a"):
        write_animation("press.h5", "b.gif")
    assert [path.name for path in here.iterdir()] == ["a.gif"]

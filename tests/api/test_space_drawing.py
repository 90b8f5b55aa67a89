"""Drawings of mechanisms in space: four views to one scale, each instant where the poses put it,
names apart.
"""

import io
import json
from dataclasses import replace

import h5py
import numpy as np
import pytest
from drawn_scenes import CASES, every_kind, moved
from internals import (
    MechanismDrawing,
    default_figures,
    draw,
    draw_postures,
    dump_specs,
    parse_specs,
    place_of,
    views,
)
from matplotlib.backends.backend_agg import FigureCanvasAgg

from lagrange_casadi.case import load_case
from lagrange_casadi.cli import main


def drawn(solution, **asked):
    """A drawing, laid out as it will be seen."""
    figure = MechanismDrawing(**asked).draw(solution)
    file = io.BytesIO()
    figure.savefig(file, dpi=120)
    return figure, file.getvalue()


def lines(axes, label):
    return [line for line in axes.get_lines() if line.get_label() == label]


def within(box, frame):
    return frame.x0 <= box.x0 <= box.x1 <= frame.x1 and frame.y0 <= box.y0 <= box.y1 <= frame.y1


def test_links_are_where_their_poses_put_them_in_every_view():
    solution = moved("rssr")
    figure, _ = drawn(solution)
    ends = [place_of(solution, {"body": "coupler", "x": x, "y": 0.0, "z": 0.0}) for x in (0.0, 0.4)]
    for axes, one in zip(figure.axes, views((0, -9.81, 0), -60, 25), strict=True):
        (strong,) = lines(axes, "coupler")
        np.testing.assert_allclose(
            strong.get_xydata(), [one.on_page(end[0]) for end in ends], atol=1e-12
        )
        faint = [
            line
            for line in axes.get_lines()
            if line.get_alpha() not in (None, 1.0) and line.get_color() == strong.get_color()
        ]
        expected = [[one.on_page(end[k]) for end in ends] for k in (6, 4, 2)]
        np.testing.assert_allclose([line.get_xydata() for line in faint], expected, atol=1e-12)
        assert all(line.get_zorder() < strong.get_zorder() for line in faint)


@pytest.mark.sampled(7)
@pytest.mark.parametrize("solution", [*CASES, every_kind], ids=[*CASES, "every_kind"])
def test_names_are_apart_and_scales_are_one(solution):
    solution = solution() if callable(solution) else moved(solution)
    figure, _ = drawn(solution)
    renderer, scales = FigureCanvasAgg(figure).get_renderer(), []
    for axes in figure.axes:
        zero, one = axes.transData.transform([(0.0, 0.0), (1.0, 1.0)])
        scales += list(one - zero)
    np.testing.assert_allclose(scales, scales[0], rtol=1e-6)
    axes = figure.axes[1]
    texts = [text for text in axes.texts if text.get_text()]
    boxes = [text.get_window_extent(renderer) for text in texts]
    frame = axes.get_window_extent(renderer)
    told = {name for text in texts for name in text.get_text().replace("\n", " ").split(", ")}
    assert told >= {
        *solution.description["joints"],
        *solution.description.get("paths", {}),
        "x",
        "y",
        "z",
    }
    for k, box in enumerate(boxes):
        assert within(box, frame), texts[k]
        for j in range(k):
            assert not box.overlaps(boxes[j]), (texts[j], texts[k])
    outside = [figure.legends[0], figure._suptitle]
    page = figure.bbox
    for one in outside:
        box = one.get_window_extent(renderer)
        assert within(box, page)
        assert not any(box.overlaps(axes.get_tightbbox(renderer)) for axes in figure.axes)


def test_everything_drawn_is_in_the_pictures():
    """Of solid lines, at every instant: dashed ones show where slides lead."""
    for axes in drawn(moved("delta"))[0].axes:
        (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
        for line in axes.get_lines():
            x, y = line.get_xydata().T
            assert x0 <= x.min() <= x.max() <= x1
            assert y0 <= y.min() <= y.max() <= y1


def test_the_page_says_what_it_shows():
    figure, _ = drawn(moved("cardan_shaft"), azimuth=30.0, elevation=40.0)
    told = figure.get_suptitle().replace("\n", " ")
    assert told.startswith(
        "cardan_shaft: t = 0 s (bearing = 0 deg), and faint 0.025 s (bearing = 90 deg), "
    )
    assert told.endswith("orthographic, all views to one scale")
    titles = [axes.get_title() for axes in figure.axes]
    assert titles == [
        "from above (+z)",
        "azimuth 30°, elevation 40°, z up",
        "from the front (-y)",
        "from the right (+x)",
    ]
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    assert legend == [
        "shaft",
        "tube",
        "output",
        "revolute joint",
        "universal joint",
        "cylindrical joint",
    ]


def test_numbers_on_an_axis_that_runs_backward_are_those_of_its_coordinate():
    """Where y is up, z runs to the left as seen from the right."""
    axes = drawn(moved("rssr"))[0].axes[3]
    assert axes.get_xlabel() == "z [mm]"
    for tick in axes.get_xticks():
        told = axes.xaxis.get_major_formatter()(tick, 0).replace("\N{MINUS SIGN}", "-")
        assert float(told) == pytest.approx(-1e3 * tick, abs=1e-9)


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("count", "faint"), [(1, 0), (2, 1), (4, 3)])
def test_as_many_instants_as_asked_for(count, faint):
    solution = moved("rssr")
    axes = drawn(solution, count=count)[0].axes[0]
    colour = lines(axes, "coupler")[0].get_color()
    found = [line for line in axes.get_lines() if line.get_color() == colour]
    assert len(found) == faint + 1


def test_one_instant_is_drawn_once():
    solution = moved("rssr").during(slice(0, 1))
    figure, _ = drawn(solution)
    assert "faint" not in figure.get_suptitle()
    assert len([line for line in figure.axes[0].get_lines() if line.get_linewidth() == 3.2]) == 3


@pytest.mark.long
def test_the_same_solution_gives_the_same_bytes():
    assert drawn(every_kind())[1] == drawn(every_kind())[1]


def test_it_is_among_the_usual_figures_and_every_name_is_a_files(tmp_path):
    """Of joints with several coordinates too."""
    solution = moved("stewart_gough")
    specs = default_figures(solution)
    assert specs[-1] == MechanismDrawing()
    few = [spec for spec in specs if spec.name in ("motion_pose-slide_1", "motion_P0", "mechanism")]
    assert [path.name for _, path in draw(solution, few, tmp_path)] == [
        f"{spec.name}.png" for spec in few
    ]
    assert len(few) == 3
    list(draw(solution, specs[:1], tmp_path))


def test_the_view_survives_the_file():
    specs = (MechanismDrawing(azimuth=20.0, elevation=-5.0),)
    assert parse_specs(dump_specs(specs)) == specs
    before = json.dumps([{"kind": "drawing", "name": "mechanism", "count": 4}])
    assert parse_specs(before) == (MechanismDrawing(),)


def test_a_pose_that_was_not_wanted_is_not_drawn(tmp_path):
    solution = moved("rssr")
    without = replace(
        solution, outputs={o: v for o, v in solution.outputs.items() if o.group != "pose"}
    )
    assert [path for _, path in draw(without, [MechanismDrawing()], tmp_path)] == [None]


def test_ways_to_assemble_in_space_are_drawn_in_space(tmp_path, monkeypatch, capsys):
    """The rocker's end is where each way puts it, not where its x and y alone would."""
    scene = replace(load_case("rssr").scene, posture={})
    file = io.BytesIO()
    postures = ["posture={'Q': '-4.60823 deg'}", "posture={'Q': '171.728 deg'}"]
    assert draw_postures(scene, file) == (postures, True)
    assert file.getvalue().startswith(b"\x89PNG")
    figures = []
    monkeypatch.setattr(
        "matplotlib.figure.Figure.savefig", lambda figure, *_, **__: figures.append(figure)
    )
    draw_postures(scene, io.BytesIO())
    texts = [text.get_text() for text in figures[0].texts]
    assert [text for text in texts if text.startswith("posture")] == postures
    for number, (axes, angle) in enumerate(
        zip(figures[0].axes, (-4.60823, 171.728), strict=True), 1
    ):
        assert axes.get_title(loc="left") == str(number)
        (x0, y0), (x1, y1) = lines(axes, "coupler")[0].get_xydata()
        assert not np.allclose((x1 - x0, y1 - y0), 0.0)
        (base, tip) = lines(axes, "rocker")[0].get_xydata()
        axis, along, c, s = (
            np.array([0.48, 0.8, 0.36]),
            np.array([0.6, 0.0, -0.8]),
            *(f(np.radians(angle)) for f in (np.cos, np.sin)),
        )
        place = np.array([0.3, -0.1, 0.2]) + 0.25 * (c * along + s * np.cross(axis, along))
        expected = views((0, -9.81, 0), -60, 25)[1].on_page(np.array([[0.3, -0.1, 0.2], place]))
        np.testing.assert_allclose([base, tip], expected, atol=1e-5)


def test_run_and_plot_draw_it(here, capsys):
    asked = ["--want", "motion", "--t", "0:0.6:9", "--backend", "vm", "--no-certificate"]
    assert main(["run", "rssr", *asked]) == 0
    assert main(["plot", "rssr.h5", "--out", "again"]) == 0
    first, again = (here / folder / "mechanism.png" for folder in ("rssr_figures", "again"))
    assert first.read_bytes() == again.read_bytes()
    with h5py.File("rssr.h5") as file:
        assert "pose" in file

"""Pictures of strength: which are drawn, and what they show."""

import numpy as np
import pytest
import strong
from internals import draw_strength, draw_utilisation

from lagrange_casadi import beams, evaluate, figures

pytestmark = pytest.mark.usefixtures("interpreted")


@pytest.fixture(scope="module")
def pressed():
    return evaluate(
        strong.press(beams.rectangle(0.012, 0.006), t=(0, 0.2, 41)),
        xi=(0, 1, 21),
        certificate=False,
    )


def test_links_with_a_beam_have_pictures(pressed, tmp_path):
    names = [spec.name for spec in figures.default_figures(pressed)]
    assert {"strength_rod", "utilisation"} <= set(names)
    assert "strength_crank" not in names
    specs = [
        figures.StrengthPlot("strength_rod", "rod"),
        figures.UtilisationPlot("utilisation", ("rod",)),
    ]
    drawn = list(figures.draw(pressed, specs, tmp_path))
    assert all(path is not None and path.stat().st_size > 2000 for _, path in drawn)
    from internals import dump_specs, parse_specs

    assert list(parse_specs(dump_specs(specs))) == specs


def test_the_map_and_the_diagram_show_what_is_told(pressed):
    figure = draw_strength(pressed, "rod", pressed.t, "t [s]")
    mapped, diagram = figure.axes[0], figure.axes[1]
    values = mapped.collections[0].get_array()
    np.testing.assert_allclose(
        np.ravel(values), pressed.stress("rod").grid("von_mises").T.ravel() / 1e6
    )
    assert (
        f"peak {pressed.stress('rod').peak('von_mises').value / 1e6:.4g} MPa" in mapped.get_title()
    )
    line = {l.get_label(): l.get_xydata() for l in diagram.get_lines()}
    assert line["Goodman"].tolist() == [[0.0, 350.0], [700.0, 0.0]]
    mean, amplitude = line["swings, every fibre"].T
    least = pressed.safety("rod").against("fatigue")
    assert 1 / (amplitude / 350 + mean / 700).max() == pytest.approx(least, rel=0.01)
    assert f"fatigue: least factor {least:.4g} at" in diagram.get_title()


def test_the_diagram_shows_what_notches_do():
    notch = beams.Notch(0.5, axial=3.0, bending=3.0)
    scene = strong.press(beams.rectangle(0.012, 0.006), [notch], t=(0, 0.2, 21))
    solution = evaluate(scene, certificate=False)
    diagram = draw_strength(solution, "rod", solution.t, "t [s]").axes[1]
    line = {l.get_label(): l.get_xydata() for l in diagram.get_lines()}
    used = {
        name: (line[name] @ [1 / 700, 1 / 350]).max()
        for name in ("swings, every fibre", "in notches")
    }
    assert used["in notches"] == pytest.approx(
        1 / solution.safety("rod").against("fatigue"), rel=1e-12
    )
    assert used["in notches"] > 2 * used["swings, every fibre"]
    assert "in the notch at $\\xi/l$ = 0.500" in diagram.get_title()


def test_bars_are_utilisations(pressed):
    (axes,) = draw_utilisation(pressed, ["rod"]).axes
    widths = [bar.get_width() for bar in axes.patches]
    assert widths == [1 / verdict.factor for verdict in pressed.safety("rod").verdicts]


def test_without_an_endurance_limit_there_is_the_map_alone():
    solution = evaluate(
        strong.press(
            beams.round_bar(0.02), material=beams.material("EN AW-6082-T6"), t=(0, 0.2, 21)
        ),
        certificate=False,
    )
    assert (
        len(draw_strength(solution, "rod", solution.t, "t [s]").axes) == 2
    )  # with its scale of colours

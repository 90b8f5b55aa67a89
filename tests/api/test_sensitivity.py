"""Derivatives of outputs by parameters: beside differences in 50 digits, forward beside backward,
in files and tables, and what has none.
"""

import itertools
import math
import re
from dataclasses import replace

import casadi as ca
import h5py
import numpy as np
import pytest
from balance import columns_at
from conftest import CASES, PLANAR, SPATIAL
from forging import edit
from mechanisms import slider_crank
from parametric import declared
from precise import precise
from reports import wound
from stepped import iterated
from truth import truth

from lagrange_casadi import (
    Mechanism,
    Scene,
    check,
    derive,
    evaluate,
    load,
    load_case,
    prepare,
    save,
    sensitivities,
)
from lagrange_casadi.cli import main
from lagrange_casadi.density import polynomial as density
from lagrange_casadi.errors import DeclarationError, UnknownNameError
from lagrange_casadi.motion import harmonic

OWN = {
    "beam_pump": ["r", "counterweight", "fluid"],
    "jansen_leg": ["push"],
    "roller_cam": ["lift", "base", "offset", "stiffness"],
}
"""Cases of which the oracle knows some lengths by number, as where a spring acts: parameters of
theirs that change no drive.
"""


def with_parameters():
    """The cases in space that have parameters; Bricard's loop closes for
    its own proportions alone.
    """
    return [
        name
        for name in SPATIAL
        if name != "bricard" and load_case(CASES / name).scene.mechanism.parameters
    ]


RATIOS = (0.1234567, 0.9034567)
STEP = 2.0**-20


def made(scene, t, parameters=None, count=20):
    """The sensitivities of all that a scene has, loops followed to a time, sections at ratios."""
    solution = evaluate(
        scene,
        parameters=parameters,
        t=(scene.span[0], t, count),
        xi=(*RATIOS, 2),
        wanted=["all"],
        backend="vm",
        certificate=False,
    )
    return sensitivities(scene, solution, backend="vm")


def told_by(found, name):
    """Numbers of a quantity: one, or of a section force one at each ratio."""
    return [found[name](xi) for xi in RATIOS] if callable(found[name]) else [found[name]]


def quantities(changes, found):
    """The quantities of a solution that another way tells too, and equilibrium determines."""
    solution = changes.solution
    names = [name for name in solution.names() if name in found and solution.determined(name)]
    assert len(names) >= 4
    return names


def unit(name):
    group, _, *member = name.split(":")
    return (group, *(m for m in member if group in ("reaction", "section")))


def sizes_of(rows):
    """The largest number of each kind of quantity."""
    found = {}
    for name, values in rows.items():
        found[unit(name)] = max(found.get(unit(name), 0.0), float(np.abs(values).max()))
    return found


def slopes_in_digits(values_at, x, share=STEP):
    """Derivatives of all that ``values_at`` a number tells: by four values at doubles exactly as
    far apart.
    """
    step = math.ldexp(share, math.frexp(x)[1])
    four = {}
    for k in (-2, -1, 1, 2):
        assert (x + k * step - x) / k == step
        four[k] = values_at(x + k * step)
    return {
        name: np.array(
            [
                float((8 * (b - a) - (d - c)) / (12 * step))
                for c, a, b, d in zip(*(told_by(x, name) for x in four.values()), strict=True)
            ]
        )
        for name in four[1]
        if all(name in found for found in four.values())
    }


def of_declaration(name):
    """A case whose numbers are parameters, and some of these."""
    if name in OWN:
        return load_case(CASES / name).scene, OWN[name]
    scene = declared(CASES / name)
    parameters = list(scene.mechanism.parameters)
    return scene, parameters[:: max(1, len(parameters) // 2)]


@pytest.mark.sampled(11)
@pytest.mark.parametrize("name", PLANAR)
def test_slopes_are_those_of_differences_in_50_digits(name):
    """Of every force and every place, by numbers of the declaration: lengths, masses, densities,
    places, gravity.
    """
    scene, parameters = of_declaration(name)
    t = scene.span[0] + 0.37 * (scene.span[1] - scene.span[0])
    changes, values = made(scene, t), scene.mechanism.values()
    _, held = columns_at(derive(scene, ["all"]), t, values)
    sizes = sizes_of(
        {
            name: [np.abs(changes.array(name, one)[-1] * x).max() for one, x in values.items()]
            for name in changes.solution.names()
            if changes.solution.determined(name)
        }
    )
    for parameter in parameters:
        x = values[parameter]

        def at(moved, parameter=parameter):
            return precise(scene, t, held, parameters={**values, parameter: moved})

        exact = slopes_in_digits(at, x)
        names = quantities(changes, exact)
        own = {name: np.atleast_1d(changes.array(name, parameter)[-1]) for name in names}
        most = sizes_of({name: changes.solution.array(name)[-1] for name in names})
        for name in names:
            gap = np.abs(own[name] - exact[name]).max() * abs(x)
            size = max(sizes[unit(name)], 1e-3 * most[unit(name)])
            assert gap <= 1e-10 * size, (name, parameter)


@pytest.mark.sampled(5)
@pytest.mark.parametrize("name", ["arm", "engine", "four_bar", "quick_return", "rrr3"])
def test_second_derivatives_too(name):
    """By two parameters at once, at a time and a place that stand still, beside differences of four
    values in 50 digits.
    """
    scene, _ = of_declaration(name)
    t = scene.span[0] + 0.37 * (scene.span[1] - scene.span[0])
    changes, values = made(scene, t, count=5), scene.mechanism.values()
    one, other = [k for k, x in values.items() if x != 0.0][-2:]
    _, held = columns_at(derive(scene, ["all"]), t, values)
    steps = [math.ldexp(STEP, math.frexp(values[name])[1]) for name in (one, other)]
    v = {}
    for a, b in itertools.product((-1, 1), (-1, 1)):
        at = {**values, one: values[one] + a * steps[0], other: values[other] + b * steps[1]}
        v[a, b] = precise(scene, t, held, parameters=at)
    names = quantities(changes, v[1, 1])
    scale = abs(values[one] * values[other])
    found = {name: np.atleast_1d(changes.curvature(name, one, other)[-1]) for name in names}
    most = sizes_of({name: changes.solution.array(name)[-1] for name in names})
    sizes = sizes_of({name: rows * scale for name, rows in found.items()})
    for name, rows in found.items():
        corners = zip(*(told_by(one, name) for one in v.values()), strict=True)
        exact = [float((p - q - r + s) / (4 * steps[0] * steps[1])) for p, q, r, s in corners]
        gap = np.abs(rows - exact).max() * scale
        assert gap <= 1e-10 * max(sizes[unit(name)], most[unit(name)]) + 1e-14, name
        np.testing.assert_allclose(
            rows * scale,
            np.atleast_1d(changes.curvature(name, other, one)[-1]) * scale,
            rtol=0,
            atol=1e-11 * max(sizes[unit(name)], most[unit(name)]),
        )


@pytest.mark.sampled(6)
@pytest.mark.parametrize("name", with_parameters())
def test_in_space_too(name):
    """Beside differences of the graph itself in 50 digits: of loops that are closed anew."""
    scene = load_case(CASES / name).scene
    t = scene.span[0] + 0.37 * (scene.span[1] - scene.span[0])
    changes, values = made(scene, t, count=40), scene.mechanism.values()
    for parameter, x in values.items():
        if x == 0.0:  # it gives steps no size
            continue

        def at(moved, parameter=parameter):
            return truth(scene, [t], {parameter: moved}).sides[0][0]

        exact = slopes_in_digits(at, x)
        names = quantities(changes, exact)
        own = {name: np.atleast_1d(changes.array(name, parameter)[-1]) * x for name in names}
        sizes, most = sizes_of(own), sizes_of({n: changes.solution.array(n)[-1] for n in names})
        for name in names:
            gap = np.abs(own[name] - exact[name] * x).max()
            size = max(sizes[unit(name)], 1e-3 * most[unit(name)])
            assert gap <= 1e-10 * size + 1e-15 * max(most.values()), (name, parameter)


@pytest.mark.parametrize("share", [1e-3, 1e-6])
def test_near_a_dead_centre(share):
    """The rod is longer than the crank by a share; where the crank is across, the sine of the
    transmission angle is its root.
    """
    scene = load_case(CASES / "slider_crank").scene
    angle = evaluate(scene, wanted=["motion"], certificate=False).array("motion:O")
    t = float(np.linspace(*scene.t)[np.abs(np.sin(angle)).argmax()])
    values = scene.mechanism.values({"r": 0.1, "l": 0.1 * (1.0 + share)})
    changes, (_, held) = made(scene, t, values), columns_at(derive(scene, ["all"]), t, values)
    for parameter in ("r", "l", "m3"):

        def at(moved, parameter=parameter):
            return precise(scene, t, held, parameters={**values, parameter: moved})

        exact = slopes_in_digits(at, values[parameter], share=2.0**-40)
        names = quantities(changes, exact)
        largest = max(np.abs(exact[name]).max() for name in names)
        assert largest > (1e3 if parameter != "m3" else 1.0)
        for name in names:
            gap = np.abs(np.atleast_1d(changes.array(name, parameter)[-1]) - exact[name])
            size = np.maximum(np.abs(exact[name]), 1e-6 * largest)
            assert (gap <= 1e-7 * size).all(), (parameter, name)


def loaded():
    """A beam that swings: its length, its taper, its motion, a load that stands along it and one at
    a station are parameters.
    """
    m = Mechanism("loaded")
    l = m.parameter("l", 1.2, "m")
    taper = m.parameter("taper", -2.0, "kg/m")
    swing = m.parameter("swing", 0.6, "rad")
    push, place = m.parameter("push", 40.0, "N/m"), m.parameter("place", 0.7, "m")
    beam = m.link("beam", length=l, density=density(5.0, taper))
    m.revolute("O", m.ground, beam)
    m.line_load("snow", beam, y=(push, 2 * push), between=(0.2, place))
    m.force("hook", beam.at(place / 2), y=-30.0)
    return Scene(m, {"O": harmonic(0.1, swing, 0.5)}, t=(0, 2, 25), xi=(0, 1, 8))


def differences(make, name, parameter, at):
    """Those of a quantity of whole solutions, by four values."""
    step = 1e-4 * abs(at)
    four = {k: make(at + k * step).array(name) for k in (-2, -1, 1, 2)}
    return (8 * (four[1] - four[-1]) - (four[2] - four[-2])) / (12 * step)


@pytest.mark.parametrize("parameter", ["l", "taper", "swing", "push", "place"])
def test_series_and_sections_are_those_of_differences(parameter):
    scene = loaded()
    solution = evaluate(scene, certificate=False, backend="vm")
    changes = sensitivities(scene, solution, backend="vm")

    def make(value):
        return evaluate(scene, parameters={parameter: value}, certificate=False, backend="vm")

    at = scene.mechanism.values()[parameter]
    for name in (
        "effort:O",
        "reaction:O:fx",
        "motion:O_rate",
        "section:beam:axial",
        "section:beam:shear",
        "section:beam:bending",
    ):
        found, exact = changes.array(name, parameter), differences(make, name, parameter, at)
        assert found.shape == solution.array(name).shape
        size = np.abs(exact).max() + np.abs(solution.array(name)).max() / abs(at)
        np.testing.assert_allclose(found, exact, rtol=0, atol=1e-9 * size, err_msg=name)


@pytest.mark.sampled(2)
def test_means_and_peaks():
    scene = load_case(CASES / "four_bar").scene
    solution = evaluate(scene, t=(*scene.t[:2], 101), certificate=False)
    changes = sensitivities(scene, solution)
    for parameter in ("a", "c"):
        x = scene.mechanism.values()[parameter]
        step = 1e-5 * x
        two = [
            evaluate(
                scene,
                t=solution_span(scene),
                parameters={parameter: x + k * step},
                certificate=False,
            ).statistics("effort:O")
            for k in (1, -1)
        ]
        for word in ("mean", "rms"):
            found = getattr(changes, word)("effort:O")
            size = solution.statistics("effort:O").rms  # a mean may be nothing
            assert found.value == pytest.approx(
                getattr(solution.statistics("effort:O"), word), rel=1e-12, abs=1e-12 * size
            )
            exact = (getattr(two[0], word) - getattr(two[1], word)) / (2 * step)
            assert found.slopes[parameter] == pytest.approx(exact, rel=1e-6, abs=1e-6 * size / x)
    gradient = prepare(scene, t=solution_span(scene)).gradient()
    for name in ("effort:O", "section:coupler:bending", "reaction:O:fx"):
        peak = changes.peak(name)
        assert peak.kind == 0, "smooth"
        assert peak.value == pytest.approx(
            gradient.value[gradient.quantities.index(name)], rel=1e-11
        )
        for parameter, slope in gradient[name].items():
            assert peak.slopes[parameter] == pytest.approx(
                slope, rel=1e-6, abs=1e-6 * abs(peak.value)
            )


def solution_span(scene):
    return (*scene.t[:2], 101)


def test_mistakes():
    scene = loaded()
    solution = evaluate(scene, certificate=False, backend="vm")
    changes = sensitivities(scene, solution, backend="vm")
    with pytest.raises(UnknownNameError, match="parameter"):
        changes.array("effort:O", "r")
    with pytest.raises(UnknownNameError, match="quantity"):
        changes.array("effort:X", "l")
    with pytest.raises(DeclarationError, match="a section force has a mean at every ratio"):
        changes.mean("section:beam:bending")
    with pytest.raises(DeclarationError, match="scene: expected a Scene, got"):
        sensitivities(solution, scene)
    for other in (
        load_case(CASES / "four_bar").scene,
        replace(loaded(), motion={"O": harmonic(0.1, 0.3, 0.5)}),
    ):
        with pytest.raises(DeclarationError, match="is not one of this scene"):
            sensitivities(other, solution, backend="vm")


def test_what_equilibrium_leaves_open_has_no_slope():
    scene = load_case(CASES / "bricard").scene
    solution = evaluate(scene, t=(*scene.t[:2], 9), certificate=False, backend="vm")
    changes = sensitivities(scene, solution, backend="vm")
    with pytest.raises(DeclarationError, match="equilibrium does not determine it"):
        changes.array(
            solution.undetermined[0], changes.parameters[0] if changes.parameters else "x"
        )


SHORT = (0.001, 0.08, 7)


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("make", "asked"),
    [
        (slider_crank, {"t": SHORT, "xi": (0, 1, 4)}),
        (iterated, {"t": SHORT, "xi": (0, 1, 4), "newton": 3, "backend": "vm"}),
        (loaded, {}),
        (loaded, {"backend": "vm"}),
        (wound, {"backend": "c"}),
    ],
)
def test_they_are_those_made_backwards(make, asked):
    """Forward, by the law of a section, beside backwards, by each force at each ratio."""
    scene = make()
    solution = evaluate(scene, wanted=["all", "sensitivity"], certificate=False, **asked)
    assert solution.sensitivities.parameters == tuple(scene.mechanism.parameters)
    assert solution.sensitivities.quantities == tuple(solution.names())
    changes = sensitivities(scene, solution, backend="vm")
    for parameter, of in scene.mechanism.parameters.items():
        for name in solution.names():
            found = solution.sensitivities.array(name, parameter)
            exact = changes.array(name, parameter)
            assert found.shape == solution.array(name).shape
            size = np.abs(exact).max() + np.abs(solution.array(name)).max() / abs(of.default)
            np.testing.assert_allclose(
                found, exact, rtol=0, atol=1e-12 * size + 1e-15, err_msg=f"{name} by {parameter}"
            )


@pytest.fixture(scope="module")
def solution():
    return evaluate(
        slider_crank(), wanted=["effort", "section:rod", "sensitivity"], t=SHORT, xi=(0, 1, 5)
    )


def test_a_file_has_them(tmp_path, capsys, solution):
    assert solution.certified
    file = tmp_path / "with.h5"
    save(solution, file)
    assert check(file) == []
    again = load(file)
    assert again.sensitivities.parameters == ("r", "l", "m1", "m2", "m3")
    assert again.sensitivities.quantities == (
        "effort:O",
        "section:rod:axial",
        "section:rod:shear",
        "section:rod:bending",
    )
    for name in again.sensitivities.quantities:
        found, told = (one.sensitivities.array(name, "m2") for one in (solution, again))
        np.testing.assert_array_equal(found, told)
    with h5py.File(file) as h:
        dataset = h["sensitivity/l/section/rod/bending"]
        assert dataset.shape == (7, 5)
        assert dataset.attrs["units"] == "N m/m"
        assert dataset.attrs["long_name"] == "bending moment: derivative by l"
        assert h["sensitivity/m3/effort/O"].attrs["units"] == "N m/kg"
    assert main(["info", str(file)]) == 0
    assert "sensitivities: of 4 quantities by r, l, m1, m2, m3\n" in capsys.readouterr().out


def test_tables_have_them(solution):
    frame = solution.to_pandas()
    np.testing.assert_array_equal(
        frame["sensitivity:m3:effort:O [N m/kg]"], solution.sensitivities.array("effort:O", "m3")
    )
    column = frame["sensitivity:l:section:rod:shear xi/l=0.25 [N/m]"]
    np.testing.assert_array_equal(
        column, solution.sensitivities.array("section:rod:shear", "l")[:, 1]
    )
    data = solution.to_xarray()["sensitivity:r:section:rod:axial"]
    assert data.dims == ("t", "xi")
    assert data.attrs["units"] == "N/m"


def test_run_writes_them(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    asked = ["run", "slider_crank", "--t", "0:0.08:9", "--no-figures", "--out", "a.h5"]
    assert main([*asked, "--want", "effort,sensitivity:r", "--csv", "a.csv"]) == 0
    told = capsys.readouterr().out
    assert re.search(r"derivatives of peaks.*\n +r \[m\]\n  effort:O +212\.\d+\n", told)
    assert re.search(
        r"derivatives of means over time.*\n  mean:effort:O +-?\d.*\n  rms:effort:O +[1-9]", told
    )
    assert load("a.h5").sensitivities.parameters == ("r",)
    assert "sensitivity:r:effort:O [N m/m]" in (tmp_path / "a.csv").read_text().splitlines()[0]
    capsys.readouterr()
    assert main([*asked, "--want", "sensitivity:r"]) == 2
    assert (
        "sensitivities need other outputs; add some to wanted, such as effort"
        in capsys.readouterr().err
    )


def test_check_looks_at_them(tmp_path, solution):
    save(solution, tmp_path / "a.h5")

    def change(h):
        h["sensitivity/l/effort/O"][3] = math.nan
        h["sensitivity/r/effort/O"].attrs["units"] = "N"

    edit(tmp_path / "a.h5", change)
    assert check(tmp_path / "a.h5") == [
        "sensitivity/r/effort/O: units differs from the schema",
        "sensitivity/l/effort/O: values that are not finite",
    ]


def test_a_derivative_that_is_none_is_told(tmp_path):
    """The root of an angle that begins at nothing grows without bound there, and so does its
    derivative by the swing.
    """
    m = Mechanism("root")
    arm = m.link("arm", length=1.0, mass=1.0)
    swing = m.parameter("swing", 0.5, "rad")
    m.revolute("O", m.ground, arm)
    m.torque("spring", arm, -ca.sqrt(ca.fabs(m.direction(arm))))
    scene = Scene(m, {"O": harmonic(0.0, swing, 0.5)}, t=(0, 0.5, 6))
    solution = evaluate(scene, wanted=["effort", "sensitivity"], backend="vm", certificate=False)
    assert np.isfinite(solution.effort("O")).all()
    slopes = solution.sensitivities.array("effort:O", "swing")
    assert not np.isfinite(slopes[0])
    assert np.isfinite(slopes[1:]).all()
    assert solution.notes == (
        "the derivative of effort:O by swing is not finite at 1 of 6 instants",
    )
    save(solution, tmp_path / "a.h5")
    assert check(tmp_path / "a.h5") == ["sensitivity/swing/effort/O: values that are not finite"]


def test_outputs_that_have_none():
    with pytest.raises(UnknownNameError, match=r"unknown output 'sensitivity:x'"):
        slider_crank(wanted=["effort", "sensitivity:x"])
    m = Mechanism("bare")
    m.revolute("O", m.ground, m.link("arm", length=1.0, mass=1.0))
    with pytest.raises(
        DeclarationError, match="output 'sensitivity': not an output of mechanism 'bare'"
    ):
        Scene(m, {"O": harmonic(0.0, 1.0, 1.0)}, ["effort", "sensitivity"])

"""Sensitivities wanted as other outputs are: beside those that are made backwards, in files, as
tables, and what is refused.
"""

import math
import re

import casadi as ca
import h5py
import numpy as np
import pytest
from forging import edit
from internals import by_parameters, derivatives, others, quotient, total
from mechanisms import slider_crank
from reports import wound
from stepped import iterated

from lagrange_casadi import Mechanism, Scene, check, derive, evaluate, load, save, sensitivities
from lagrange_casadi.cli import main
from lagrange_casadi.density import polynomial as density
from lagrange_casadi.errors import DeclarationError, StoreError, UnknownNameError
from lagrange_casadi.motion import harmonic, samples

pytestmark = pytest.mark.quick

SHORT = (0.001, 0.08, 7)


def two_drives():
    """One drive by samples that are numbers, one by a law; a beam of any taper, with a load along
    it and one at a station.
    """
    m = Mechanism("drives")
    l = m.parameter("l", 1.2, "m")
    taper = m.parameter("taper", -2.0, "kg/m")
    swing = m.parameter("swing", 0.6, "rad")
    place = m.parameter("place", 0.7, "m")
    beam = m.link("beam", length=l, density=density(5.0, taper))
    arm = m.link("arm", length=0.4, mass=1.0)
    m.revolute("O", m.ground, beam)
    m.revolute("A", beam.tip, arm)
    m.line_load("snow", beam, y=(40.0, 80.0), between=(0.2, place))
    m.force("hook", beam.at(place / 2), y=-30.0)
    times = np.linspace(0, 2, 9)
    law = samples(times, (0.3 * np.sin(times) ** 2).tolist())
    return Scene(m, {"O": harmonic(0.1, swing, 0.5), "A": law}, t=(0, 2, 9), xi=(0, 1, 6))


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("make", "asked"),
    [
        (slider_crank, {"t": SHORT, "xi": (0, 1, 4)}),
        (iterated, {"t": SHORT, "xi": (0, 1, 4), "newton": 3, "backend": "vm"}),
        (two_drives, {}),
        (two_drives, {"backend": "vm"}),
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


def test_few_rows_are_made_backwards():
    """As a gradient is: one row by five parameters takes a sweep, not five."""
    program = derive(slider_crank(), ["effort", "motion"])
    row = [k for output, k in program.outputs.items() if str(output) == "effort:O"]
    every = list(range(5))
    backwards = total(program, row, every)
    forward = total(program, list(program.outputs.values()), every)
    singles = sum(total(program, row, [k]).n_instructions() for k in every)
    assert backwards.n_instructions() < 0.6 * singles
    given = [0.01, *program.motion(0.01, (values := [0.1, 0.2, 0.1, 0.1, 0.1])), [], values]
    place = [*program.outputs.values()].index(row[0])
    np.testing.assert_allclose(
        backwards(*given).full()[:, 0], forward(*given).full()[:, place], rtol=1e-13, atol=1e-15
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
    for found, told in zip(derivatives(solution), derivatives(again), strict=True):
        np.testing.assert_array_equal(found.values, told.values)
        assert (found.name, found.unit) == (told.name, told.unit)
    with h5py.File(file) as h:
        dataset = h["sensitivity/l/section/rod/bending"]
        assert dataset.shape == (7, 5)
        assert dataset.attrs["units"] == "N m/m"
        assert dataset.attrs["long_name"] == "bending moment: derivative by l"
        assert h["sensitivity/m3/effort/O"].attrs["units"] == "N m/kg"
    assert main(["info", str(file)]) == 0
    assert "sensitivities: of 4 quantities by r, l, m1, m2, m3\n" in capsys.readouterr().out


def test_what_is_not_wanted_costs_nothing(tmp_path, solution):
    scene = slider_crank()
    assert derive(scene, ["effort", "sensitivity"]) is derive(scene, ["effort"])
    plain = evaluate(scene, wanted=["effort", "section:rod"], t=SHORT, xi=(0, 1, 5))
    assert not plain.sensitivities.by
    assert not evaluate(scene, wanted=["all"], t=SHORT).sensitivities.by
    for name in plain.names():
        np.testing.assert_array_equal(plain.array(name), solution.array(name))
    save(plain, tmp_path / "plain.h5")
    with h5py.File(tmp_path / "plain.h5") as h:
        assert "sensitivity" not in h


def test_some_parameters(tmp_path, solution):
    one = evaluate(slider_crank(), wanted=["effort", "sensitivity:l"], t=SHORT)
    assert one.sensitivities.parameters == ("l",)
    np.testing.assert_allclose(
        one.sensitivities.array("effort:O", "l"),
        solution.sensitivities.array("effort:O", "l"),
        rtol=1e-12,
    )
    part = one.during(slice(2, 4))
    np.testing.assert_array_equal(
        part.sensitivities.array("effort:O", "l"), one.sensitivities.array("effort:O", "l")[2:4]
    )
    save(one, tmp_path / "one.h5")
    assert load(tmp_path / "one.h5").sensitivities.parameters == ("l",)
    with pytest.raises(
        UnknownNameError, match="unknown parameter with sensitivities 'r'; valid: l"
    ):
        one.sensitivities.array("effort:O", "r")
    with pytest.raises(
        UnknownNameError,
        match="unknown quantity with sensitivities 'reaction:O:fx'; valid: effort:O",
    ):
        one.sensitivities.array("reaction:O:fx", "l")


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


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (
            lambda h: h["sensitivity/l"].__delitem__("effort"),
            "the sensitivities are not of all quantities",
        ),
        (
            lambda h: h["sensitivity"].move("l", "length"),
            "there are sensitivities by names that are not parameters",
        ),
        (
            lambda h: h["sensitivity/l"].__setitem__("more", [1.0]),
            "the sensitivities are not of all quantities",
        ),
        (
            lambda h: h["sensitivity/l"].move("effort", "efforts"),
            "the sensitivities are not of all quantities",
        ),
    ],
)
def test_a_damaged_file_is_refused(tmp_path, solution, change, says):
    save(solution, tmp_path / "a.h5")
    edit(tmp_path / "a.h5", change)
    with pytest.raises(StoreError, match=f"damaged: {says}"):
        load(tmp_path / "a.h5")


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


def test_names():
    mechanism = slider_crank().mechanism
    assert by_parameters(mechanism.parameters, ["all", "effort"]) == ()
    assert by_parameters(mechanism.parameters, ["sensitivity:m2", "sensitivity:r"]) == ("r", "m2")
    assert by_parameters(mechanism.parameters, ["sensitivity"]) == ("r", "l", "m1", "m2", "m3")
    assert others(["effort", "sensitivity", "sensitivity:l"]) == ("effort",)
    with pytest.raises(UnknownNameError, match=r"unknown output 'sensitivity:x'"):
        slider_crank(wanted=["effort", "sensitivity:x"])
    m = Mechanism("bare")
    m.revolute("O", m.ground, m.link("arm", length=1.0, mass=1.0))
    with pytest.raises(
        DeclarationError, match="output 'sensitivity': not an output of mechanism 'bare'"
    ):
        Scene(m, {"O": harmonic(0.0, 1.0, 1.0)}, ["effort", "sensitivity"])


@pytest.mark.parametrize(
    ("unit", "by", "made"),
    [
        ("N m", "m", "N m/m"),
        ("N m", "kg/m", "N m/(kg/m)"),
        ("N", "1", "N"),
        ("1", "rad", "1/rad"),
        ("N", "N m", "N/(N m)"),
    ],
)
def test_units(unit, by, made):
    assert quotient(unit, by) == made

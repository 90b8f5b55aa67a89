"""Solutions that elasticity completed: what of them is told, kept in files, and left to others."""

import json

import numpy as np
import pytest
from elastic_mechanisms import four_bar, held, made, moving, three_cranks

from lagrange_casadi import (
    Mechanism,
    Scene,
    beams,
    check,
    evaluate,
    export,
    load,
    refine,
    save,
    sensitivities,
)
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError, UnknownNameError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


def test_what_equilibrium_determines_is_what_it_was():
    m, solution = moving()
    plain = evaluate(
        Scene(m, {"O": polynomial(0.2, 30.0, 40.0)}, posture={"A": 0.5, "C": 1.5}, t=(0, 8e-3, 9))
    )
    for output, values in plain.outputs.items():
        if output not in plain.indeterminate:
            np.testing.assert_array_equal(values, solution.outputs[output])
    assert plain.indeterminate == solution.elasticity.completed
    assert all(
        name in solution.errors for name in plain.undetermined if name.startswith("reaction")
    )


def test_only_what_is_wanted_is_told():
    scene = held(y=-1000.0)
    solution, whole = evaluate(scene, wanted=["reaction:A"]), evaluate(scene)
    assert set(solution.series) == {name for name in whole.series if name.startswith("reaction:A")}
    np.testing.assert_array_equal(solution.reaction("A").mz, whole.reaction("A").mz)
    assert set(solution.errors) <= set(solution.series)


def test_a_file_keeps_what_elasticity_told(tmp_path):
    solution = evaluate(held(y=-1000.0))
    save(solution, tmp_path / "held.h5")
    back = load(tmp_path / "held.h5")
    assert check(tmp_path / "held.h5") == []
    assert back.elasticity == solution.elasticity
    assert back.notes == solution.notes
    np.testing.assert_array_equal(back.reaction("A").mz, solution.reaction("A").mz)


def test_what_knows_equilibrium_alone_leaves_it_open(tmp_path):
    """Peaks of what is told are those of the instants, and it has no derivatives of peaks: neither
    takes the one for the other.
    """
    _, solution = moving()
    m = four_bar()
    scene = Scene(
        m,
        {"O": polynomial(0.2, 30.0, 40.0)},
        posture={"A": 0.5, "C": 1.5},
        t=(0, 8e-3, 9),
        elastic=True,
    )
    told, known = "reaction:C:mx", "effort:O"
    assert told in map(str, solution.elasticity.completed)
    peaks = {peak.name: peak for peak in refine(scene, solution, [told, known])}
    assert peaks[told] == solution.peak(told)
    assert abs(peaks[known].value) >= abs(solution.peak(known).value)
    assert not solution.by_equilibrium.determined(told)
    assert np.isnan(solution.by_equilibrium.reaction("C").mx).all()
    changes = sensitivities(scene, solution, backend="vm")
    with pytest.raises(DeclarationError, match="reaction:C:mx"):
        changes.peak(told)


def test_exports_leave_open_what_goes_through_a_link_without_a_beam(tmp_path):
    plain = three_cranks(made(beams.round_bar(0.01)), elastic=False)
    elastic = three_cranks(made(beams.round_bar(0.01)))
    for name, scene in (("plain", plain), ("elastic", elastic)):
        export(scene, tmp_path / name, wanted=["effort", "reaction"])
    outputs = [
        json.loads((tmp_path / name / "export.json").read_text())["outputs"]
        for name in ("plain", "elastic")
    ]
    assert outputs[0] == outputs[1]
    assert not any(output["name"].startswith("reaction_B1") for output in outputs[0])


def test_the_command_line_asks_for_it(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.py").write_text(
        "from lagrange_casadi import Mechanism, Scene, beams\ndef scene():\n    m ="
        " Mechanism('held')\n    bar = m.link('bar', length=2.0,"
        " beam=beams.Beam(beams.rectangle(0.05, 0.02), beams.material('S235')))\n    m.weld('A',"
        " m.ground, bar)\n    m.weld('B', m.ground.at(2.0, 0), bar.tip)\n    return Scene(m, {},"
        " t=(0, 0, 1), elastic=['bar'])\n"
    )
    assert main(["info", "case.py"]) == 0
    assert "elastic: bar" in capsys.readouterr().out
    assert main(["run", "case.py", "--elastic", "--no-figures", "--backend", "vm"]) == 0
    said = capsys.readouterr().out
    assert "note: 9 statically indeterminate series are determined by least strain energy" in said
    assert "elasticity" in said


@pytest.mark.parametrize(
    ("elastic", "error", "message"),
    [
        (
            "bar",
            DeclarationError,
            "expected True, or a list of the links that are elastic, got 'bar'",
        ),
        (["rod"], UnknownNameError, "unknown link in elastic 'rod'"),
        (
            ["bare"],
            DeclarationError,
            ("elastic: link 'bare' has no beam=; links with a beam: bar, odd"),
        ),
        (
            ["odd"],
            DeclarationError,
            "material 'odd' has no elasticity, which elastic link 'odd' needs",
        ),
    ],
)
def test_what_has_no_meaning_is_one_line(elastic, error, message):
    m = Mechanism("bad")
    bar = m.link("bar", length=2.0, beam=made(beams.round_bar(0.02)))
    odd = m.link("odd", length=2.0, beam=made(beams.round_bar(0.02), beams.Material("odd", 1e3)))
    m.weld("A", m.ground, bar)
    m.weld("B", bar, odd)
    m.weld("C", bar, m.link("bare", length=1.0, mass=1.0))
    with pytest.raises(error, match=message):
        Scene(m, {}, t=(0, 0, 1), elastic=elastic)


def test_a_table_and_friction_are_refused():
    with pytest.raises(
        DeclarationError, match="a table cannot hold statically indeterminate forces"
    ):
        evaluate(held(y=-1.0), table=1e-6)
    m = Mechanism("guides")
    bar = m.link("bar", length=1.0, beam=made(beams.round_bar(0.02)))
    joint = m.prismatic("G1", m.ground, bar, axis=(1, 0))
    m.prismatic("G2", m.ground.at(1, 0), bar.tip, axis=(1, 0))
    m.friction("rub", joint, mu=0.1, length=0.1)
    with pytest.raises(DeclarationError, match="elastic: cannot be combined with friction 'rub'"):
        evaluate(Scene(m, {"G1": polynomial(0.0, 1.0, 0.5)}, t=(0, 1, 3), elastic=True))

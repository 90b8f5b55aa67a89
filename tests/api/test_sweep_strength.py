"""Least factors of safety, lives and masses of many designs, against those of one solution after
another.
"""

import itertools
import math
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from commands import command
from internals import (
    CRITERIA,
    EvaluationMethod,
    Histories,
    LinkHistories,
    Member,
    Plan,
    Request,
    check_sweep,
    designs_of,
    factor,
    lacking,
    loaded,
    use_score,
)
from internals import fatigue_used as used
from places import FOLDERS
from strong import STEEL, press, robot, slider

from lagrange_casadi import (
    Mechanism,
    Scene,
    SpatialMechanism,
    beams,
    best,
    evaluate,
    optimise,
    sweep,
)
from lagrange_casadi.cli import program
from lagrange_casadi.errors import DeclarationError, NoDesignError
from lagrange_casadi.motion import harmonic, polynomial
from lagrange_casadi.peaks import refine_safety


@pytest.fixture(scope="module")
def swept():
    return sweep(slider(200e6), {"l": [0.3, 0.4], "h": [0.006, 0.02]}, wanted=["safety", "life"])


def compared(scene, link, found, values):
    """The columns of one design against its solution: yielding and buckling between instants
    too.
    """
    solution = evaluate(
        scene, parameters=values, wanted=[f"section:{link}"], certificate=False, backend="vm"
    )
    safety = refine_safety(scene, solution, link)
    columns = {
        verdict.against: float(np.squeeze(found[f"least:{verdict.against}:{link}"]))
        for verdict in safety.verdicts
    }
    assert columns["yield"] == pytest.approx(safety.against("yield"), rel=1e-9)
    assert columns["fatigue"] == pytest.approx(safety.against("fatigue"), rel=1e-9)
    assert columns == pytest.approx(
        {verdict.against: verdict.factor for verdict in safety.verdicts}, rel=1e-3
    )
    assert float(np.squeeze(found[f"least:safety:{link}"])) == min(columns.values())


def test_least_factors_are_those_of_a_solution(swept):
    for l, h, link in ((0.3, 0.006, "rod"), (0.4, 0.02, "crank")):
        compared(slider(200e6), link, swept.select(l=l, h=h), {"l": l, "h": h})


def test_lives_are_those_of_a_solution(swept):
    assert np.isinf(swept.select(h=0.02)["life:rod"]).all()
    scene = slider(5e6)
    found = sweep(scene, {"h": [0.006, 0.05]}, wanted=["life:crank"])
    worn = evaluate(
        scene, parameters={"h": 0.006}, wanted=["life:crank"], certificate=False, backend="vm"
    ).life("crank")
    assert found["life:crank"][0] == pytest.approx(worn.cycles, rel=1e-9)
    assert worn.cycles < math.inf


def test_a_life_that_ends_between_the_places_that_are_looked_at():
    """The rod is worst beside its middle, where solutions look closely: there it is used a little
    above 1, elsewhere below.
    """
    solution = evaluate(slider(50e6), wanted=["section:rod"], certificate=False, backend="vm")
    histories = LinkHistories.of(Member.of(solution, "rod"))
    worst = histories.worst(use_score(STEEL.but(endurance=50e6)))
    swings = loaded(histories.history(worst))
    k = int(np.argmax(used(swings.amplitude, swings.mean, STEEL.but(endurance=50e6))))
    assert np.abs(histories.places(worst.part) - worst.x).min() > 1e-3
    scene = slider(
        float(swings.amplitude[k] / (1.0 - swings.mean[k] / STEEL.ultimate)) * (1.0 - 1e-7)
    )
    solution = evaluate(scene, wanted=["life:rod"], certificate=False, backend="vm")
    assert sweep(scene, {"h": [0.02]}, wanted=["life:rod"], backend="vm")["life:rod"].tolist() == [
        solution.life("rod").cycles
    ]
    assert solution.life("rod").cycles < math.inf


@pytest.mark.parametrize("shape", ["tapered", "sliding"])
def test_no_place_is_used_more_than_the_worst(shape):
    """Against every fibre at both sides of many places, counted without bounds."""
    taper = beams.tapered(beams.rectangle(0.03, 0.012), beams.rectangle(0.012, 0.012))
    sliding = shape == "sliding"
    scene = press(
        beams.rectangle(0.03, 0.012) if sliding else taper, sliding=sliding, t=(0, 0.2, 17)
    )
    solution = evaluate(scene, wanted=["section:rod"], certificate=False, backend="vm")
    stress, material = solution.stress("rod"), STEEL.but(endurance=200e6)
    found = LinkHistories.of(stress.member).worst(use_score(material)).value[0]
    most = 0.0
    for xi in np.linspace(0.0, 1.0, 201):
        for side in ("base", "tip"):
            for values in np.moveaxis(stress.at(xi, side), 1, 0):
                swings = loaded(values)
                most = max(most, float(np.max(used(swings.amplitude, swings.mean, material))))
    assert most <= found * (1 + 2e-5)
    assert most >= found * (1 - 1e-2)


def test_masses(swept):
    l, h = swept["l"][:, None], swept["h"][None]
    np.testing.assert_allclose(swept["mass:rod"], 7850.0 * 0.012 * h * l)
    np.testing.assert_allclose(swept["mass:all"], 15.0 + 7850.0 * 0.012 * h * (l + 0.1))


def test_the_lightest_that_is_safe_is_chosen(swept):
    rows = [
        (swept["mass:all"][i, j], i, j)
        for i in range(2)
        for j in range(2)
        if swept["least:safety:crank"][i, j] >= 2.0
    ]
    (chosen,) = best(swept, minimise="mass:all", where="least:safety:crank>=2")
    assert chosen.number == 2 * min(rows)[1] + min(rows)[2]


@pytest.mark.long
@pytest.mark.parametrize("name", ["sliding", "notched", "space"])
def test_links_of_every_kind(name):
    """Loads that travel are looked at one design after another; in space
    most fibres are sheared.
    """
    notches = [beams.Notch(0.6, bending=2.5, sensitivity=0.8)]
    scene, link = {
        "sliding": lambda: (
            press(beams.rectangle(0.03, 0.012), sliding=True, t=(0, 0.2094395, 41)),
            "rod",
        ),
        "notched": lambda: (
            press(beams.i_section(0.04, 0.03, 0.004, 0.005), notches, t=(0, 0.2094395, 41)),
            "rod",
        ),
        "space": lambda: (robot(beams.rectangle(0.03, 0.02)), "upper"),
    }[name]()
    (name, value), *_ = scene.mechanism.values().items()
    compared(scene, link, sweep(scene, {name: [value]}, wanted=[f"safety:{link}"]), {})


def test_bounds_leave_out_no_swing():
    """The worst of random histories, bounded and counted, against every fibre counted."""
    rng = np.random.default_rng(5)
    for trial in range(20):
        normal = rng.normal(size=(1, 6, 30)).cumsum(axis=2) * 1e7
        sheared = np.array([1, 3, 4])
        shears = rng.normal(size=(1, 2, 3, 30)) * 10.0 ** rng.uniform(5, 8)
        axes = ((0, 1), (0,), (1,))[trial % 3]
        shears[:, [axis for axis in (0, 1) if axis not in axes]] = 0.0
        material = STEEL.but(endurance=200e6 if trial % 2 else 600e6)
        histories = Histories(normal, shears[:, list(axes)], sheared, axes)
        score = use_score(material)
        bound = score.bound(histories)[0, :, 0]
        found = max(score.of(histories.at(0, k))[0] if k in sheared else bound[k] for k in range(6))
        assert found == pytest.approx(max(score.of(histories.at(0, k))[0] for k in range(6)))
        assert all(score.of(histories.at(0, k))[0] <= bound[k] * (1 + 1e-12) for k in range(6))
        every = []
        for k in range(6):
            own = shears[0, :, list(sheared).index(k)] if k in sheared else np.zeros((2, 30))
            swings = loaded(np.vstack([normal[0, k], own]))
            every.append(np.max(1.0 / factor(swings.amplitude, swings.mean, material, "goodman")))
        assert found == pytest.approx(max(every), rel=1e-12)


def at_once(scene, link):
    """Utilisation against fatigue of a link of one design as sweeps tell it, and as its solution
    does.
    """
    (name, value), *_ = scene.mechanism.values().items()
    found = sweep(scene, {name: [value]}, wanted=[f"safety:{link}"], backend="vm")
    solution = evaluate(scene, backend="vm", certificate=False)
    return 1.0 / found[f"least:fatigue:{link}"][0], 1.0 / solution.safety(link).against("fatigue")


@pytest.mark.parametrize("law", [harmonic(0.2, 0.6, 2.0), polynomial(0.3)], ids=["swings", "rests"])
def test_what_acts_along_a_link_and_stands_still_is_told_of_all_designs_at_once(law):
    """Where a force and a load along the link act is no force itself: at rest, too, nothing may
    come of it.
    """
    m = Mechanism("arm")
    arm = m.link(
        "arm",
        length=m.parameter("l", 0.5, "m"),
        beam=beams.Beam(beams.rectangle(0.02, 0.012), STEEL.but(endurance=2e8)),
    )
    m.revolute("O", m.ground, arm)
    m.force("push", arm.at(0.3), y=-400.0)
    m.line_load("wind", arm, y=(-500.0, -900.0), between=(0.1, 0.35), turning=True)
    found, told = at_once(Scene(m, {"O": law}, t=(0, 0.5, 17), wanted=["section:arm"]), "arm")
    assert found == pytest.approx(told, rel=1e-9)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(16))
def test_drawn_loads_are_told_of_all_designs_at_once(seed):
    """Any that stand still, on any beam, in the plane and in space; a solution looks at more
    ratios.
    """
    rng = np.random.default_rng(seed)
    space = seed % 2 == 1
    m = SpatialMechanism("arm") if space else Mechanism("arm")
    wide, narrow = rng.uniform(0.015, 0.03, 2)
    course = [
        beams.rectangle(wide, 0.012),
        beams.tapered(beams.round_bar(wide), beams.round_bar(narrow)),
        beams.tube(wide, 0.003),
    ]
    course += [beams.stepped([0.4], [beams.rectangle(wide, 0.012), beams.rectangle(narrow, 0.012)])]
    notches = [beams.Notch(rng.uniform(0.1, 0.9), bending=1.8, shear=1.4, sensitivity=0.8)][
        : seed % 3
    ]
    beam = beams.Beam(course[seed % 4], STEEL.but(endurance=2e8), notches)
    arm = m.link("arm", length=m.parameter("l", 0.5, "m"), beam=beam)
    m.revolute("O", m.ground, arm, **({"axis": tuple(rng.normal(size=3))} if space else {}))
    axes = "xyz" if space else "xy"
    for k in range(rng.integers(1, 4)):
        place = arm.at(float(rng.uniform(0.0, 0.5)), 0.01)
        m.force(
            f"push{k}",
            place,
            **dict(zip(axes, rng.normal(0.0, 300.0, 3).tolist(), strict=False)),
            turning=bool(rng.integers(2)),
        )
    for k in range(rng.integers(0, 3)):
        between = tuple(np.sort(rng.uniform(0.0, 0.5, 2)).tolist())
        m.line_load(
            f"wind{k}",
            arm,
            y=tuple(rng.normal(0.0, 900.0, 2).tolist()),
            between=between,
            turning=bool(rng.integers(2)),
        )
    law = polynomial(0.3) if seed % 5 == 0 else harmonic(0.2, 0.6, 2.0)
    found, told = at_once(Scene(m, {"O": law}, t=(0, 0.5, 17), wanted=["section:arm"]), "arm")
    assert found == pytest.approx(told, rel=1e-9)


@pytest.mark.long
def test_from_the_command_line(tmp_path):
    run = CliRunner().invoke
    file = str(tmp_path / "a.h5")
    grid = ["--grid", "height=0.03:0.04:3", "--t", "0:0.07:41"]
    done = run(
        program,
        ["sweep", "connecting_rod", *grid, "--want", "safety:rod", "--out", file, "--quiet"],
    )
    assert done.exit_code == 0, done.output
    done = run(
        program, ["best", file, "--minimise", "mass:rod", "--where", "least:safety:rod>=4.6"]
    )
    assert done.exit_code == 0, done.output
    assert "mass:rod" in done.output


def test_a_parameter_may_be_called_as_a_column_is_where_there_is_none():
    m = Mechanism("arm")
    mass = m.parameter("mass", 1.0, "kg", low=0.0)
    m.revolute("O", m.ground, m.link("arm", length=0.4, mass=mass))
    found = sweep(
        Scene(m, {"O": harmonic(0.0, 0.6, 2.0)}, t=(0, 0.5, 21)),
        {"mass": [1.0, 2.0]},
        wanted=["effort"],
    )
    assert found["mass"].tolist() == [1.0, 2.0]


def test_strength_is_kept_beside_all():
    """As evaluations tell it: ``all`` leaves out what is wanted by name, unless it is."""
    m = Mechanism("arm")
    m.revolute(
        "O",
        m.ground,
        m.link(
            "arm",
            length=m.parameter("l", 0.4, "m"),
            beam=beams.Beam(beams.rectangle(0.02, 0.01), STEEL),
        ),
    )
    scene = Scene(
        m, {"O": harmonic(0.0, 0.6, 2.0)}, t=(0, 0.5, 9), wanted=["all", "safety", "deflection:arm"]
    )
    plan = Plan.of(scene, designs_of({"l": [0.4]}), Request(method=EvaluationMethod("vm")))
    kept = {column.name for column in plan.columns}
    for name in evaluate(scene, backend="vm", certificate=False).names():
        assert (f"peak:{name}" in kept) == (not name.startswith(("motion:", "pose:"))), name
    assert "least:yield:arm" in kept


def test_strength_that_is_open_has_no_number(tmp_path):
    """Of bars side by side equilibrium leaves the axial forces open, as evaluations say; one that
    nothing holds is told.
    """
    m = Mechanism("bars")
    beam = beams.Beam(beams.rectangle(0.02, 0.01), STEEL.but(endurance=200e6))
    bar = m.link("bar", length=m.parameter("l", 1.0, "m"), mass=1.0)
    arm = m.link("arm", length=0.3, beam=beam)
    for k, place in enumerate((bar.base, bar.at(0.5), bar.at(0.9))):
        m.revolute(
            f"G{k}",
            m.ground.at((0.0, 0.5, 0.9)[k], 0.0),
            one := m.link(f"a{k}", length=0.2, beam=beam),
        )
        m.revolute(f"B{k}", one.tip, place)
    m.weld("held", bar.tip, arm)
    posture = {"a0": 1.2, "a1": 1.2, "a2": 1.2, "bar": 0.0, "arm": 0.0}
    scene = Scene(
        m,
        {"G0": harmonic(1.2, 0.3, 1.0)},
        t=(0, 1, 5),
        posture=posture,
        wanted=["safety:a0", "life:a1", "section:arm"],
    )
    with pytest.raises(
        DeclarationError,
        match="equilibrium does not determine axial, so its strength is not evaluated",
    ):
        evaluate(scene, backend="vm", certificate=False).safety("a0")
    found = sweep(scene, {"l": [1.0, 1.1]}, backend="vm", out=tmp_path / "bars.h5")
    assert check_sweep(tmp_path / "bars.h5") == []
    for name in ("least:safety:a0", "least:yield:a0", "least:fatigue:a0", "life:a1"):
        assert np.isnan(found[name]).all(), name
    assert np.isfinite(found["peak:section:arm:bending"]).all()
    with pytest.raises(
        NoDesignError,
        match="no design within the bounds has a result: section:a0:axial is indeterminate for all"
        " of them",
    ):
        optimise(scene, minimise="peak:utilisation:a0:fatigue", over={"l": (0.95, 1.1)}, screen=4)


def test_what_rounding_leaves_at_a_free_end_buckles_nothing():
    """A swinging arm is pulled outward: at its free end it feels nothing, but for rounding, which
    may be compression.
    """
    m = Mechanism("swinging")
    m.set_gravity(0.0, 0.0)
    height = m.parameter("h", 0.02, "m", low=0.0)
    arm = m.link("arm", length=0.5, beam=beams.Beam(beams.rectangle(height, 0.012), STEEL))
    m.revolute("O", m.ground, arm)
    scene = Scene(m, {"O": harmonic(0.0, 0.6, 2.0)}, t=(0, 0.5, 33))
    found = sweep(scene, {"h": [0.01, 0.02]}, wanted=["safety:arm"])
    assert found["status"].tolist() == [0, 0]
    assert found["least:buckling:arm"].tolist() == [math.inf, math.inf]
    assert (
        evaluate(scene, certificate=False, backend="vm").safety("arm").against("buckling")
        == math.inf
    )


LACKING = [
    names
    for count in range(3)
    for names in itertools.combinations(("endurance", "ultimate"), count)
]


def without(*names):
    return press(
        beams.rectangle(0.03, 0.012), material=STEEL.but(**dict.fromkeys(names)), t=(0, 0.2, 5)
    )


@pytest.mark.parametrize("names", LACKING, ids=" ".join)
def test_fatigue_is_open_alike_in_solutions_and_sweeps(names):
    """It is left out by name where the material lacks a number, and the other factors stay."""
    safety = evaluate(without(*names), certificate=False, backend="vm").safety("rod")
    found = sweep(without(*names), {"r": [0.1]}, wanted=["safety:rod"], backend="vm")
    why = f"material 'C45+QT' has no {' and no '.join(names)}"
    assert safety.not_evaluated == ((f"fatigue: {why}",) if names else ())
    assert ("least:fatigue:rod" in found.columns) == (not names)
    assert {f"least:{verdict.against}:rod" for verdict in safety.verdicts} == set(found.columns) & {
        f"least:{way}:rod" for way in ("yield", "buckling", "fatigue")
    }
    if names:
        with pytest.raises(DeclarationError, match=re.escape(why)):
            optimise(
                without(*names),
                minimise="r",
                over={"r": (0.05, 0.1)},
                subject_to=["least:fatigue:rod >= 2"],
            )
        with pytest.raises(
            DeclarationError, match=r"'C45.QT' has no .*, which output 'life:rod' needs"
        ):
            sweep(without(*names), {"r": [0.1]}, wanted=["life:rod"], backend="vm")


def test_the_command_says_what_factor_it_does_not_keep(here, capsys):
    names = ("endurance", "ultimate")
    Path("case.py").write_text(
        "import sys\n"
        f"sys.path[:0] = {FOLDERS!r}\n"
        "from test_sweep_strength import without\n"
        f"def scene():\n    return without(*{names!r})\n"
    )
    assert command("sweep case.py --backend vm --grid r=0.1:0.11:2 --want safety:rod --quiet") == 0
    why = "no factor against fatigue of 'rod' is kept: material 'C45+QT' has no endurance and no"
    assert capsys.readouterr().out.count(f"note: {why} ultimate") == 1


@pytest.mark.parametrize(
    "names", itertools.product(["endurance", "ultimate", "yield_strength"], repeat=2), ids=" ".join
)
@pytest.mark.parametrize("criterion", CRITERIA)
def test_fatigue_is_open_where_it_cannot_be_computed(criterion, names):
    material = STEEL.but(**dict.fromkeys(names))
    try:
        factor(1e8, 1e8, material, criterion)
        missing = ""
    except DeclarationError as error:
        missing = str(error).partition(",")[0]
    told = lacking(material, criterion).partition(": ")[2]
    assert bool(told) == bool(missing)
    assert told.startswith(missing)

"""A flat bar between two spherical joints: all that follows from its section forces is about the
axes that beside tells.
"""

import dataclasses

import numpy as np
import pytest
from exported import by_c99, exported, instants
from internals import Output, certify
from reports import held
from spatial_oracle import SECTION

from lagrange_casadi import (
    Scene,
    SpatialMechanism,
    beams,
    evaluate,
    load,
    save,
    size,
    sweep,
    tool_deflection,
    vibration,
)
from lagrange_casadi.beams import Profile
from lagrange_casadi.errors import AssemblyError, DeclarationError
from lagrange_casadi.motion import harmonic, polynomial
from lagrange_casadi.peaks import refine_safety, refine_stress

pytestmark = pytest.mark.usefixtures("interpreted")

STEEL = beams.material("C45+QT").but(endurance=5e4)
UP, ACROSS, EDGE, FLAT = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), 0.03, 0.01
BENT = {EDGE: 1.9252125e6, FLAT: 5.7756375e6}
"""w l^2/8 c/I of a bar of steel, 1 m long, 30 x 10 mm, by what stands upright of it."""


def bar(
    beside=UP,
    height=EDGE,
    width=FLAT,
    *,
    swing=0.0,
    shape=beams.rectangle,
    hard=True,
    push=0.0,
    wanted=("all",),
):
    """A bar that lies level between a crank and a rocker, which swing."""
    m = SpatialMechanism("bar")
    h, w = m.parameter("h", height, "m", low=0.001), m.parameter("w", width, "m", low=0.001)
    told = {} if beside is None else {"beside": beside}
    rod = m.link("rod", between=((0, 0, 0), (1, 0, 0)), beam=beams.Beam(shape(h, w), STEEL), **told)
    crank = m.link("crank", between=((0, -0.2, 0), (0, 0, 0)), mass=0.4)
    rocker = m.link("rocker", between=((1, -0.2, 0), (1, 0, 0)), mass=0.4)
    m.revolute("O", m.ground, crank, at=(0, -0.2, 0), axis=(0, 0, 1))
    m.revolute("Q", m.ground, rocker, at=(1, -0.2, 0), axis=(0, 0, 1))
    m.force("push", rocker.tip, x=push)
    if hard:
        m.spherical("A", crank, rod, at=(0, 0, 0))
        m.spherical("B", rod, rocker, at=(1, 0, 0))
    else:
        m.spherical("A", crank.tip, rod)
        m.spherical("B", rod.tip, rocker.tip)
    return Scene(m, {"O": harmonic(0.0, swing, 2.0)}, t=(0, 0.5, 9), wanted=wanted)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("hard", [True, False])
@pytest.mark.parametrize(
    ("beside", "upright"),
    [(UP, "h"), (ACROSS, "w"), ((0.7, 0.0, 0.2), "h"), ((0.3, -2.0, 0.0), "w")],
)
@pytest.mark.parametrize("height", [EDGE, FLAT])
def test_a_bar_under_its_own_weight(beside, upright, height, hard):
    width = FLAT if height == EDGE else EDGE
    solution = evaluate(bar(beside, height, width, hard=hard))
    expected = BENT[height if upright == "h" else width]
    assert solution.certified
    assert abs(solution.stress("rod").peak("normal").value) == pytest.approx(expected, rel=1e-9)


def lopsided(h, w):
    """A section of the same size as a rectangle, whose main axes lean."""
    sides = {"top": h / 2, "side": w / 2, "iyz": 0.3 * (h * w) ** 2 / 12}
    return beams.given(
        h * w, w * h**3 / 12, h * w**3 / 12, **sides, torsion=1e-9, torsion_modulus=1e-6
    )


@pytest.mark.parametrize("shape", [beams.rectangle, lopsided])
def test_stresses_about_both_axes_make_up_the_forces(shape):
    solution = evaluate(bar((0.0, 1.0, 2.0), shape=shape, swing=0.3, push=-200.0))
    stress, law = solution.stress("rod"), solution.section("rod").law
    forces = np.array([law.on_grid(name, np.array([0.25]))[:, 0] for name in SECTION])
    cross = stress.member.cross.properties(0, 0.25)
    normal, along_y, along_z = stress.at(0.25)
    fibres = {fibre.name: k for k, fibre in enumerate(cross.fibres)}
    places = np.array([(1.0, fibre.y, fibre.z) for fibre in cross.fibres])
    even, a, b = np.linalg.lstsq(places, normal, rcond=None)[0]
    found = [even * cross.area, a * cross.iyz + b * cross.iy, -(a * cross.iz + b * cross.iyz)]
    for own, force in zip(found, forces[[0, 4, 5]], strict=True):
        np.testing.assert_allclose(own, force, rtol=0, atol=1e-12 * np.abs(forces).max())
    if shape is beams.rectangle:
        middle = np.array([along_y, along_z])[:, fibres["centre"]]
        np.testing.assert_allclose(middle, 1.5 * forces[1:3] / cross.area, rtol=1e-12)


def evaluated(scene, folder):
    """What a solution tells, and what is sought between its instants."""
    solution = evaluate(scene)
    peaks = [
        solution.stress("rod").peak("von_mises"),
        solution.deflection("rod").peak(),
        refine_stress(scene, solution, "rod", "normal"),
    ]
    verdicts = solution.safety("rod").verdicts + refine_safety(scene, solution, "rod").verdicts
    found = [peak.value for peak in peaks] + [verdict.factor for verdict in verdicts]
    return [*found, solution.life("rod").cycles, vibration(solution, "rod").excess or 0.0]


def swept(scene, folder):
    height = scene.mechanism.parameters["h"].default
    found = sweep(scene, {"h": [height]}, wanted=["safety", "life"])
    least = [f"least:{limit}:rod" for limit in ("yield", "buckling", "fatigue")]
    return [float(np.squeeze(found[name])) for name in (*least, "life:rod")]


def sized(scene, folder):
    tall = scene.mechanism.parameters["h"].default == EDGE
    sides = [(x, 0.01) if tall else (0.01, x) for x in (0.02, 0.03, 0.04)]
    profiles = [Profile(f"{h} x {w}", {"height": h, "width": w}) for h, w in sides]
    return [v.factor for v in size(scene, profiles, safety=0.01).links[0].safety.verdicts]


def written(scene, folder):
    """A file, and a report."""
    solution = evaluate(scene)
    save(solution, folder / "bar.h5")
    solution.report(folder / "bar.html")
    contents, array = held((folder / "bar.html").read_text())
    shown = {one["name"]: array(one["values"]).max() for one in contents["maps"]}
    kept = load(folder / "bar.h5").stress("rod").peak("von_mises").value
    return [shown["stress:rod"], shown["deflection:rod"], kept]


def exported_c(scene, folder):
    _, told = exported(dataclasses.replace(scene, wanted=["stress:rod", "deflection:rod"]), folder)
    rows = by_c99(folder, told, instants(np.linspace(0.0, 0.5, 5), "double"), ("-O0",))
    names = [row["name"] for row in told["outputs"]]
    chosen = [name.startswith(("stress", "deflection")) for name in names]
    return rows[:, : len(names)][:, chosen]


@pytest.mark.parametrize(
    "asked", [evaluated, swept, sized, written, exported_c], ids=lambda asked: asked.__name__
)
def test_all_that_follows_is_about_the_same_axes(asked, tmp_path):
    """The bar on edge told in two ways."""
    found = []
    for name, told in {"edge": (UP, EDGE, FLAT), "same": (ACROSS, FLAT, EDGE)}.items():
        (tmp_path / name).mkdir()
        scene = bar(*told, swing=0.3, push=-200.0)
        found.append(np.ravel(asked(scene, tmp_path / name)))
    np.testing.assert_allclose(*found, rtol=1e-6)
    assert np.mean(np.isfinite(found) & (np.array(found) != 0.0)) > 0.5


def test_what_is_told_of_a_bar_without_a_direction():
    """Its section forces, as before; its strength if it is round."""
    scene = bar(None)
    solution = evaluate(scene)
    assert solution.section("rod").bending.max() == pytest.approx(7850 * 9.81 * 3e-4 / 8, rel=1e-9)
    round_bar = evaluate(bar(None, shape=lambda d, _: beams.round_bar(d)))
    assert round_bar.stress("rod").peak("normal").value > 1e6
    profile, rod = Profile("thin", {"height": 0.02, "width": 0.01}), scene.mechanism.links["rod"]
    asked = [
        lambda: vibration(solution, "rod"),
        lambda: sweep(scene, {"h": [0.02]}, wanted=["life"]),
        lambda: tool_deflection(scene, rod.at(0.5)),
        lambda: size(scene, [profile], links=["rod"]),
    ]
    for kind in ("stress", "safety", "life", "deflection"):
        asked.append(lambda kind=kind: getattr(solution, kind)("rod"))
        asked.append(lambda kind=kind: evaluate(scene, wanted=[kind]))
    for ask in asked:
        with pytest.raises(DeclarationError, match=r"link 'rod'.* can spin freely"):
            ask()


def test_a_certificate_knows_how_a_bar_is_turned():
    solution = evaluate(bar((0.2, 0.4, 0.8), swing=0.3), wanted=["motion"])
    assert solution.certified
    clean, beyond = certify(solution)["closure"], solution.tolerance
    c, s = np.cos(1e-3), np.sin(1e-3)
    for a, b in ((c, s), (-1.0, 0.0)):
        turned = dict(solution.outputs)
        for component in "xyz":
            y, z = (Output("pose", "rod", axis + component) for axis in "yz")
            turned[y] = a * solution.outputs[y] + b * solution.outputs[z]
            turned[z] = a * solution.outputs[z] - b * solution.outputs[y]
        found = certify(dataclasses.replace(solution, outputs=turned))["closure"].max()
        assert clean.max() < beyond < found


def drag_link(beside):
    """A bar that goes round, as the follower of a drag link in the plane of x and y."""
    m, at = SpatialMechanism("drag"), (0.1, 0.0, 0.0)
    apart, follower, coupler = 0.3, 0.3, 0.35
    along = (follower**2 - coupler**2 + apart**2) / (2 * apart)
    tip = (0.1 + along, float(np.sqrt(follower**2 - along**2)), 0.0)
    crank = m.link("crank", between=((0, 0, 0), (0.4, 0, 0)), mass=0.5)
    rod = m.link("rod", between=((0.4, 0, 0), tip), mass=0.5)
    goes = m.link(
        "bar", between=(at, tip), beside=beside, beam=beams.Beam(beams.rectangle(EDGE, FLAT), STEEL)
    )
    m.revolute("O", m.ground, crank, at=(0, 0, 0), axis=(0, 0, 1))
    m.revolute("A", crank, rod, at=(0.4, 0, 0), axis=(0, 0, 1))
    m.spherical("B", rod, goes, at=tip)
    m.spherical("C", m.ground, goes, at=at)
    return Scene(m, {"O": polynomial(0.0, 6.0)}, t=(0, 1, 37))


def test_a_bar_must_not_lie_along_its_direction():
    assert evaluate(drag_link(UP)).certified
    with pytest.raises(
        AssemblyError,
        match=r"two-force link .bar. passes through its beside= direction after t = .* across it",
    ):
        evaluate(drag_link(ACROSS))
    assert evaluate(drag_link(ACROSS), wanted=["effort"]).certified


def test_a_direction_that_no_joint_takes_is_refused():
    """A joint of points whose other body has no place cannot tell how the link lies; without turned
    it lay along the parent's x.
    """
    for told, says in (
        ({"beside": UP}, "beside= gives its y axis"),
        ({}, "between= gives its position"),
    ):
        m = SpatialMechanism("arm")
        base = m.link("base", length=1.0, mass=1.0)
        arm = m.link("arm", between=((0, 0, 0), (0, 1, 0)), mass=1.0, **told)
        m.revolute("O", m.ground, base)
        m.revolute("A", base.tip, arm, axis=(1, 0, 0))
        with pytest.raises(
            DeclarationError,
            match=f"link 'arm': {says} in the reference posture, but none of its joints",
        ):
            evaluate(Scene(m, {"O": harmonic(0.0, 0.1, 1.0), "A": harmonic(0.0, 0.1, 1.0)}))

"""The cases in space against numbers from elsewhere, closed forms, statics and energies that are
worked out here.
"""

from __future__ import annotations

import dataclasses
import math
import runpy

import casadi as ca
import numpy as np
import pytest
from conftest import CASES
from spatial_reference import Entry

from lagrange_casadi import Scene, SpatialMechanism, evaluate, load_case
from lagrange_casadi.motion import harmonic, polynomial

G = 9.81


UP = np.array([0.0, 0.0, 1.0])


def scene_of(name):
    return load_case(CASES / name).scene


def vm(scene, **keywords):
    return evaluate(scene, backend="vm", certificate=False, **keywords)


def vector(found, group, part, members="xyz"):
    return np.array([found.array(f"{group}:{part}:{member}") for member in members]).T


def along(found, link):
    """The direction of a link's axis, by instant."""
    return vector(found, "pose", link, ("xx", "xy", "xz"))


def test_the_benchmarks_slider_at_its_start():
    slide = vm(scene_of("spatial_slider_crank"), t=(0, 0, 1), wanted=["motion"]).motion("guide")
    assert (slide.value[0], slide.rate[0], slide.acceleration[0]) == pytest.approx(
        (0.2, 0.24, 1.44), abs=1e-14
    )


def test_a_shaft_out_of_phase_pulsates():
    """Hooke's joint twice: without inertia the torque follows the speed, between cos^2 and 1/cos^2
    of the tube's angle.
    """
    square = 1 - (0.15 / 0.5) ** 2
    parameters = {"phase": math.pi / 2}
    slow = vm(
        scene_of("cardan_shaft"), parameters=parameters | {"rpm": 1e-3}, wanted=["effort", "motion"]
    )
    ratio = slow.motion("far:turn").rate / slow.motion("bearing").rate
    assert (ratio.min(), ratio.max()) == pytest.approx((square, 1 / square), rel=1e-12)
    assert np.max(np.abs(slow.effort("bearing") - 80.0 * ratio)) < 1e-7
    assert (slow.effort("bearing").min(), slow.effort("bearing").max()) == pytest.approx(
        (72.8, 80 / 0.91), abs=1e-7
    )
    fast = vm(scene_of("cardan_shaft"), parameters=parameters, wanted=["effort"]).effort("bearing")
    assert np.mean(fast[:-1]) == pytest.approx(80.0, abs=1e-11)
    assert np.ptp(fast) > 4 * np.ptp(slow.effort("bearing"))


def test_a_suspension_at_rest():
    """Six equations of the hub, for the forces along five bars and the effort; half a bar's weight
    is across it at each end.
    """
    found = vm(
        scene_of("five_link_suspension"), parameters={"travel": 0.0}, t=(0, 0, 1), xi=(0, 1, 3)
    )
    told = runpy.run_path(str(CASES / "five_link_suspension" / "case.py"))
    wheel, weight = np.array(told["WHEEL"]), 0.9 * G
    top, low = np.array([0.0, 0.45, 0.75]), wheel - [0.0, 0.08, 0.02]
    distance = np.linalg.norm(top - low)
    bars, across, lengths = [], [], []
    given = [
        (wheel - [0.0, 0.03, 0.0], -18.0 * G * UP),
        (wheel * [1, 1, 0], np.array([0.0, -2500.0, 4000.0])),
    ]
    given.append((low, 30e3 * (distance - 0.62) * (top - low) / distance))
    for inner, outer in told["BARS"].values():
        start, end = np.array(inner), np.array(outer)
        lengths.append(np.linalg.norm(end - start))
        e = (end - start) / lengths[-1]
        across.append(-weight / 2 * (UP - (UP @ e) * e))
        given.append((end, across[-1]))
        bars.append((end, -e))
    matrix = np.array(
        [[*force, *np.cross(place, force)] for place, force in (*bars, (wheel, UP))]
    ).T
    right = -sum(np.array([*force, *np.cross(place, force)]) for place, force in given)
    *forces, effort = np.linalg.solve(matrix, right)
    size = np.max(np.abs(forces))
    assert found.effort("wheel:slide_3")[0] == pytest.approx(effort, abs=1e-12 * size)
    for k, (name, force) in enumerate(zip(told["BARS"], forces, strict=True)):
        section, back = found.section(name), bars[k][1]
        assert section.axial[0, [0, -1]] == pytest.approx(
            [force + weight * (back @ UP), force], abs=1e-12 * size
        ), name
        hub = vector(found, "reaction", f"{name}_hub", ("fx", "fy", "fz"))[0]
        assert np.max(np.abs(hub - (force * back + across[k]))) < 1e-12 * size, name
        level = math.hypot(*np.cross(back, UP))
        assert section.bending[0] == pytest.approx(
            [0, weight * level * lengths[k] / 8, 0], abs=1e-12
        ), name


MASS, GRAVITY = 2.0, 9.81


def bowl(place):
    """z less the height of a bowl that is not round."""
    x, y, z = place
    return z - 0.5 * x**2 - y**2 - 0.2 * x * y


@pytest.mark.quick
def test_a_point_on_a_surface():
    """Its third coordinate follows from the surface; the multiplier times the surface's slopes is
    the force that holds it.
    """
    m = SpatialMechanism("bead")
    ball = m.point_mass("ball", MASS)
    m.free("at", m.ground, ball)
    m.constraint("bowl", bowl(m.place(ball)))
    laws = {"at:slide_1": harmonic(0.1, 0.3, 1.0), "at:slide_2": harmonic(0.0, 0.2, 1.5, 0.7)}
    solution = evaluate(Scene(m, laws, t=(0.0, 1.0, 41), posture={"at:slide_3": 0.0}))
    assert solution.certified

    t = ca.SX.sym("t")
    x, y = (law.graph(t) for law in laws.values())
    z = -bowl((x, y, 0.0))
    place = ca.vertcat(x, y, z)
    acceleration = ca.jacobian(ca.jacobian(place, t), t)
    px, py, pz = (ca.SX.sym(name) for name in "xyz")
    slopes = ca.substitute(
        ca.gradient(bowl((px, py, pz)), ca.vertcat(px, py, pz)), ca.vertcat(px, py, pz), place
    )
    needed = MASS * (acceleration + ca.vertcat(0, 0, GRAVITY))
    held = needed[2] / slopes[2]
    expected = ca.Function(
        "expected",
        [t],
        [ca.vertcat(z, held, needed[0] - held * slopes[0], needed[1] - held * slopes[1])],
    )
    height, multiplier, along, across = (
        row.full().ravel() for row in ca.vertsplit(expected(solution.t[None, :]))
    )
    np.testing.assert_allclose(solution.motion("at:slide_3").value, height, atol=1e-14)
    np.testing.assert_allclose(solution.multiplier("bowl"), multiplier, rtol=1e-12)
    for coordinate, effort in (("at:slide_1", along), ("at:slide_2", across)):
        np.testing.assert_allclose(
            solution.effort(coordinate), effort, atol=1e-12 * np.abs(effort).max()
        )


def rate(values, period):
    """The rates of periodic rows over time (t, ...), without the last instant, from their Fourier
    series.
    """
    wave = 2j * np.pi * np.fft.fftfreq(len(values), period / len(values))
    return np.fft.ifft(
        np.fft.fft(values, axis=0) * wave.reshape(-1, *[1] * (values.ndim - 1)), axis=0
    ).real


REFERENCES = {
    "rssr": ("rssr", (0.0, 0.6, 61), {"drive": "O"}),
    "spatial_slider_crank": ("spatial_slider_crank_slender", (0.25, 1.0, 76), {"drive": "A"}),
    "stewart_gough": ("stewart_6ups", (0.0, 0.95, 96), {f"leg{k}": f"P{k}" for k in range(6)}),
}


@pytest.mark.parametrize("name", REFERENCES)
def test_the_reference_numbers(name):
    """Efforts, reactions, and of sections what does not depend on the axes of the cross-section."""
    entry, t, drives = REFERENCES[name]
    scene, data = scene_of(name), Entry(entry).data
    if name == "rssr":
        scene = dataclasses.replace(scene, motion={"O": polynomial(0.4, 10, 3)})
    found = vm(scene, t=t, xi=(0, 1, 5))
    largest = {"N": 0.0, "N m": 0.0}
    gaps = {"N": [], "N m": []}

    def compare(unit, told, own):
        largest[unit] = max(largest[unit], abs(told))
        gaps[unit].append(abs(told - own))

    for instant in data["instants"]:
        (i,) = np.flatnonzero(np.abs(found.t - float(instant["t"])) < 1e-12)
        for drive, joint in drives.items():
            compare(
                found.unit(f"effort:{joint}"),
                float(instant["efforts"][drive]),
                found.effort(joint)[i],
            )
        for joint, told in instant["reactions"].items():
            own = scene.mechanism.joints[joint]
            sign = 1 if own.child.body.name == data["mechanism"]["joints"][joint]["child"] else -1
            for unit, word, kind in (("N", "force", "f"), ("N m", "moment", "m")):
                for axis, value in zip("xyz", told[word], strict=True):
                    if f"reaction:{joint}:{kind}{axis}" in found.series:
                        compare(
                            unit,
                            sign * float(value),
                            found.series[f"reaction:{joint}:{kind}{axis}"][i],
                        )
                    else:
                        assert float(value) == 0.0
        for link, rows in instant["sections"].items():
            if f"section:{link}" not in {name.rpartition(":")[0] for name in found.names()}:
                continue
            section = found.section(link)
            for row in rows:
                k = round(4 * float(row["xi"]))
                axial, y, z, torsion, about_y, about_z = map(float, row["local"])
                compare("N", axial, section.axial[i, k])
                compare("N", math.hypot(y, z), section.shear[i, k])
                compare("N m", torsion, section.torsion[i, k])
                compare("N m", math.hypot(about_y, about_z), section.bending[i, k])
    for unit, row in gaps.items():
        assert len(row) > 10
        assert max(row) < 1e-12 * largest[unit], unit


@pytest.mark.parametrize(
    ("name", "period"),
    [("rssr", 0.2 * math.pi), ("arm6", 2.0), ("delta", 0.5), ("spatial_slider_crank", None)],
)
def test_over_a_cycle_drives_give_no_work(name, period):
    """All is as it was, and nothing is lost: the brake of the four-bar works on a rocker that
    swings back.
    """
    period = period or math.pi / 3
    scene = scene_of(name)
    found = vm(scene, t=(0, period, 513), wanted=["effort", "motion"])
    drives = list(scene.drives or scene.motion)
    powers = [(found.effort(drive) * found.motion(drive).rate)[:-1] for drive in drives]
    assert abs(np.mean(np.sum(powers, axis=0))) < 1e-12 * np.max(np.abs(powers))


def test_bricards_loop_moves_and_one_force_is_open():
    scene = scene_of("bricard")
    found = vm(scene, t=(0, 1, 257))
    angles = [found.motion(f"J{k}").value for k in range(6)]
    first, second = np.cos(angles[0]), np.cos(angles[1])
    for k in range(6):
        assert np.max(np.abs(np.cos(angles[k]) - (first, second)[k % 2])) < 1e-13
    assert np.max(np.abs(first + second + first * second)) < 1e-13
    open_of = {
        str(output).split(":")[1] for output in found.indeterminate if output.group == "reaction"
    }
    assert open_of == {f"J{k}" for k in range(6)}
    assert all(np.isnan(found.outputs[output]).all() for output in found.indeterminate)
    assert np.isnan(found.section("link3").axial).all()
    power, energy = 0.0, 0.0
    for k in range(1, 6):
        base = vector(found, "pose", f"link{k}")[:-1]
        tip = base + 0.5 * along(found, f"link{k}")[:-1]
        v, w = rate(base, 1.0), rate(tip, 1.0)
        energy = (
            energy
            + 1.5 / 6 * np.sum(v * v + v * w + w * w, axis=1)
            + 1.5 * G * (base + tip)[:, 2] / 2
        )
    power = (found.effort("J0") * found.motion("J0").rate)[:-1]
    assert np.max(np.abs(power - rate(energy, 1.0))) < 1e-10 * np.max(np.abs(power))


def test_an_arm_at_rest_holds_the_weights_beyond_each_joint():
    scene = scene_of("arm6")
    angles = dict(zip(scene.motion, (0.4, 0.9, -1.3, 0.7, 1.1, -0.5), strict=True))
    found = vm(
        dataclasses.replace(
            scene, motion={joint: polynomial(angle) for joint, angle in angles.items()}
        ),
        t=(0, 0, 1),
    )
    constants = runpy.run_path(str(CASES / "arm6" / "case.py"))
    place = [vector(found, "pose", f"link{k}")[0] for k in range(1, 7)]
    centres = [
        place[k] + length / 2 * along(found, f"link{k + 1}")[0]
        for k, length in enumerate(constants["LENGTHS"])
    ]
    R = vector(found, "pose", "tool", [f"{a}{b}" for a in "xyz" for b in "xyz"])[0].reshape(3, 3)
    centres.append(vector(found, "pose", "tool")[0] + np.array([0.05, 0.01, 0.0]) @ R)
    masses = (*constants["MASSES"], 5.0)
    axes = [UP, *(vector(found, "pose", f"link{k}", ("zx", "zy", "zz"))[0] for k in (1, 2))]
    axes += [
        along(found, "link3")[0],
        vector(found, "pose", "link4", ("zx", "zy", "zz"))[0],
        along(found, "link5")[0],
    ]
    for k, joint in enumerate(angles):
        beyond = sum(
            np.cross(c - place[k], m * G * UP) for c, m in zip(centres[k:], masses[k:], strict=True)
        )
        assert found.effort(joint)[0] == pytest.approx(axes[k] @ beyond, abs=1e-12 * 200), joint


def test_a_delta_at_rest_holds_its_weights():
    """In the middle each motor's effort is a third of the rise of the weights' energy with the
    arms' angle.
    """
    scene = scene_of("delta")
    laws = {f"tool:slide_{k}": polynomial(place) for k, place in ((1, 0.0), (2, 0.0), (3, -0.62))}
    found = vm(dataclasses.replace(scene, motion=laws), t=(0, 0, 1), wanted=["effort", "motion"])
    upper = 0.3
    angle = found.motion("motor0").value[0]
    masses = {"arm": 0.4, "bar": 0.12, "platform": 0.5}
    out, down = 0.2 + upper * math.cos(angle) - 0.06, -0.62 + upper * math.sin(angle)
    assert math.hypot(out, down) == pytest.approx(0.65, abs=1e-14)
    # out^2 + down^2 stays what it is.
    knee = -upper * math.cos(angle)
    platform = (out * upper * math.sin(angle) - down * upper * math.cos(angle)) / down
    rise = (
        3 * masses["arm"] * knee / 2
        + 6 * masses["bar"] * (knee + platform) / 2
        + masses["platform"] * platform
    )
    for k in range(3):
        assert found.effort(f"motor{k}")[0] == pytest.approx(G * rise / 3, abs=1e-12)

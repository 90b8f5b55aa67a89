"""Mechanisms in space: the graphs give what vector Newton-Euler on free bodies gives, of any
joints, loops, bars and platforms.
"""

import numpy as np
import pytest
from spatial_bodies import GROUND, Rod
from spatial_bridge import coordinate, declared, instants, plain
from spatial_mechanisms import FAMILIES
from spatial_oracle import REACTION, SECTION
from spatial_wheels import wheel

CASES = (
    [("tree", seed) for seed in range(40)]
    + [("loop", seed) for seed in range(12)]
    + [("arm", seed) for seed in range(2)]
)
CASES += [
    (name, seed) for name in FAMILIES if name not in ("tree", "loop", "arm") for seed in range(3)
]
CASES += [("wheel", seed) for seed in range(30)]
RATIOS = (0.0, 0.1234, 0.5012, 0.9034, 1.0)
ROUNDING = 1e-12


@pytest.mark.parametrize("case", CASES, ids=lambda case: "-".join(map(str, case)))
@pytest.mark.sampled(37)
def test_efforts_reactions_and_sections(case):
    name, seed = case
    drawn = plain((FAMILIES | {"wheel": wheel})[name](seed))
    t = 0.4 * drawn.span
    scene = declared(drawn, t)
    found = {key: row[0] for key, row in instants(scene, [t]).items()}
    true = drawn.solve(t)
    force = max(1.0, *(np.abs(r[:3].astype(float)).max() for r in true.reactions.values()))
    moment = max(
        force * true.size, *(np.abs(r[3:].astype(float)).max() for r in true.reactions.values())
    )
    for body, pose in true.poses.items():
        if body != GROUND:
            for k, place in enumerate("xyz"):
                assert found[f"pose:{body}:{place}"] == pytest.approx(float(pose.r[k]), abs=1e-12)
    for (joint, k), effort in true.efforts.items():
        own = found[f"effort:{coordinate(drawn.mechanism.joint(joint), k)}"]
        assert abs(own - float(effort)) < ROUNDING * moment, (joint, k)
    for name, multiplier in true.multipliers.items():
        assert abs(found[f"multiplier:{name}"] - float(multiplier)) < ROUNDING * moment, name
    for joint, reaction in true.reactions.items():
        for k, member in enumerate(REACTION):
            if (joint, member) not in true.open:
                own = found.get(f"reaction:{joint}:{member}", 0.0)
                assert abs(own - float(reaction[k])) < ROUNDING * (force if k < 3 else moment), (
                    joint,
                    member,
                )
    for rod in (body for body in drawn.mechanism.bodies if isinstance(body, Rod)):
        for u in RATIOS:
            own, told = section(found, rod, u), true.sections[rod.name].at(u).astype(float)
            if drawn.idle and rod.name.startswith(("coupler", "bar")):
                # A bar's cross-section has axes of its own: its spin is anyone's.
                own, told = spun(own), spun(told)
                left_open = (False,) * 4
            else:
                left_open = true.open_section(rod.name, u)
            sizes = (
                (force, force, force, moment, moment, moment)
                if len(own) > 4
                else (force, force, moment, moment)
            )
            for value, other, is_open, size in zip(own, told, left_open, sizes, strict=True):
                assert is_open or abs(value - other) < ROUNDING * size, (rod.name, u)


def along(found, name, l, u):
    """What a section feels of a load along the rod, or of its slices' couples: the integrals of
    what is beyond it.
    """
    width, end = found[f"{name}:width"], found[f"{name}:end"]
    low = max(u, end - width)
    nodes, weights = np.polynomial.legendre.leggauss(8)
    places = (low + end) / 2 + (end - low) / 2 * nodes
    shares = weights * l * (end - low) / 2 if low < end else np.zeros_like(nodes)
    n, fy, fz, cx, cy, cz = (
        sum(found.get(f"{name}:{q}{j}", 0.0) * ((end - places) / width) ** j for j in range(8))
        + 0.0 * places
        for q in ("qn", "qfy", "qfz", "cx", "cy", "cz")
    )
    arms = (places - u) * l
    sums = {
        "axial": n,
        "shear_y": fy,
        "shear_z": fz,
        "torsion": cx,
        "bending_z": arms * fy + cz,
        "bending_y": cy - arms * fz,
    }
    return {member: float(np.sum(shares * values)) for member, values in sums.items()}


def spun(forces):
    """What of a section's forces a spin about the axis does not change."""
    axial, y, z, torsion, about_y, about_z = forces
    return np.array([axial, np.hypot(y, z), torsion, np.hypot(about_y, about_z)])


def section(found, rod, u):
    """The six forces at a ratio, by the law's coefficients and the moments of the material beyond,
    written down once more.
    """
    l, density = float(rod.length), [rod.density(0.5)] if callable(rod.density) else rod.density
    moments = [
        sum(float(c) * (1 - u ** (k + j + 1)) / (k + j + 1) for k, c in enumerate(density))
        * l ** (j + 1)
        for j in range(3)
    ]
    mu0, mu1, mu2 = moments
    law = {
        name.split(":")[3]: value
        for name, value in found.items()
        if name.startswith(f"section:{rod.name}:law:")
    }
    x = u * l
    bend = (l - x, mu1 - x * mu0, mu2 - x * mu1)
    values = dict.fromkeys(SECTION, 0.0)
    values["axial"] = law["n0"] + law["n1"] * mu0 + law["n2"] * mu1
    values["shear_y"] = law["fy0"] + law["fy1"] * mu0 + law["fy2"] * mu1
    values["shear_z"] = law["fz0"] + law["fz1"] * mu0 + law["fz2"] * mu1
    values["torsion"] = law["mx0"]
    values["bending_z"] = law["mz0"] + sum(law[f"fy{k}"] * bend[k] for k in range(3))
    values["bending_y"] = law["my0"] - sum(law[f"fz{k}"] * bend[k] for k in range(3))
    acting = {key.split(":")[2] for key in found if key.startswith(f"section:{rod.name}:")} - {
        "law"
    }
    for name in acting:
        if f"section:{rod.name}:{name}:width" in found:
            for member, value in along(found, f"section:{rod.name}:{name}", l, u).items():
                values[member] += value
            continue
        n, fy, fz, mx, my, mz, place = (
            found[f"section:{rod.name}:{name}:{member}"]
            for member in ("n", "fy", "fz", "mx", "my", "mz", "station")
        )
        if u < place or (u >= 1.0 and place >= 1.0 - 1e-12):
            arm = (place - u) * l
            added = {
                "axial": n,
                "shear_y": fy,
                "shear_z": fz,
                "torsion": mx,
                "bending_z": mz + arm * fy,
                "bending_y": my - arm * fz,
            }
            values = {member: value + added[member] for member, value in values.items()}
    return np.array([values[member] for member in SECTION])

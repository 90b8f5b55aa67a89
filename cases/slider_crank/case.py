"""The slider-crank of Nguyen, Petre and Stroe, with the motion of their eq.

(22) and the figures of their section 3.
"""

from math import pi

from lagrange_casadi import Mechanism, Scene
from lagrange_casadi.figures import MechanismDrawing, SectionMaps, SpanPlot, Spec, TimePlot
from lagrange_casadi.motion import polynomial

INSTANT = 0.03
RATIOS = (0.25, 0.5, 0.75)


def scene() -> Scene:
    m = Mechanism("slider_crank")
    r = m.parameter("r", 0.1, "m", low=0.0)
    l = m.parameter("l", 0.2, "m", low=0.0)
    crank = m.link("crank", length=r, mass=m.parameter("m1", 0.1, "kg", low=0.0))
    rod = m.link("rod", length=l, mass=m.parameter("m2", 0.1, "kg", low=0.0))
    slider = m.point_mass("slider", m.parameter("m3", 0.1, "kg", low=0.0))
    m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    m.revolute("B", rod.tip, slider)
    m.prismatic("guide", m.ground, slider, axis=(1, 0))
    return Scene(
        m,
        motion={"O": polynomial(0, 25 * pi, pi / 200)},
        wanted=["all"],
        t=(0, 0.08, 801),
        xi=(0, 1, 101),
        posture={"rod": 0.0},
    )


def figures() -> list[Spec]:
    """Figs. 6-14 of the paper, in its signs, and what it had no room for."""
    paper = "sign of the paper: the action of the part towards A on the part towards B"
    forces = {
        "axial": (9, 10, "axial force N", f"{paper}, so compression is positive (eq. 21)"),
        "shear": (11, 12, "shearing force F", paper),
        "bending": (13, 14, "bending moment M", paper),
    }
    specs: list[Spec] = [
        TimePlot("fig06_angle", ("motion:O",), r"Fig. 6: rotational angle $\theta$"),
        TimePlot("fig07_torque", ("effort:O",), "Fig. 7: active torque of the crank M"),
        TimePlot(
            "fig08_guide",
            ("reaction:guide:fy",),
            "Fig. 8: constrained force at the end B",
            factor=-1,
            note="sign of the paper: N_B is the action of the slider on the guide (eq. 15)",
        ),
    ]
    for force, (along, over, words, note) in forces.items():
        name = f"section:rod:{force}"
        specs.append(
            SpanPlot(f"fig{along:02}_{force}", name, INSTANT, f"Fig. {along}: {words}", -1, note)
        )
        specs.append(
            TimePlot(f"fig{over:02}_{force}", (name,), f"Fig. {over}: {words}", RATIOS, -1, note)
        )
    return [
        *sorted(specs, key=lambda spec: spec.name),
        SectionMaps("rod_maps", "rod"),
        MechanismDrawing(),
    ]

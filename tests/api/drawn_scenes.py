"""Mechanisms in space to draw, at a few instants, as motions alone."""

import functools
from pathlib import Path

from lagrange_casadi import Scene, SpatialMechanism, evaluate, motion
from lagrange_casadi.studies.case import load_case

CASES = (
    "arm6",
    "bricard",
    "cardan_shaft",
    "delta",
    "five_link_suspension",
    "rssr",
    "spatial_slider_crank",
    "stewart_gough",
)


@functools.cache
def moved(name):
    """A case at eight instants."""
    scene = load_case(Path(__file__).parents[2] / "cases" / name).scene
    many = scene.over is not None
    asked = {"over": (*scene.over[:3], 9)} if many else {"t": (*scene.t[:2], 9)}
    return evaluate(scene, **asked, wanted=["motion"], backend="vm", certificate=False)


@functools.cache
def every_kind():
    """A tree with a joint of every kind, a point mass, a spring and a path."""
    m = SpatialMechanism("every_kind")
    names = ("arm", "sleeve", "nut", "plate", "bead", "cross", "ball", "flyer", "tail")
    arm, sleeve, nut, plate, bead, cross, ball, flyer, tail = (
        m.link(name, length=0.3, mass=1.0) for name in names
    )
    bob = m.point_mass("bob", 0.5)
    slider = m.link("slider", length=0.2, mass=1.0, centre=(0, 0, 0), inertia=(0.01, 0.01, 0.01))
    m.revolute("revolute", m.ground, arm, axis=(0.6, 0.0, 0.8))
    m.prismatic("prismatic", arm.at(0.1, 0.05, 0.0), slider, axis=(0, 1, 0))
    m.cylindrical("cylindrical", m.ground.at(0.0, 0.5, 0.0), sleeve, axis=(0, 0, 1))
    m.screw("screw", sleeve.tip, nut, axis=(1, 0, 0), lead=0.1)
    m.planar("planar", m.ground.at(0.5, 0.0, 0.0), plate, axis=(0, 0, 1))
    m.slot("slot", plate, bead, axis=(1, 0, 0))
    m.universal(
        "universal",
        arm.tip,
        cross,
        axis=(0, 0, 1),
        second=(0, 1, 0),
        turned=[("x", "40 deg"), ("y", "20 deg")],
    )
    m.spherical("spherical", cross.tip, ball)
    m.revolute("pin", ball.tip, bob)
    m.free("free", m.ground, flyer)
    m.weld("weld", flyer.tip, tail, turned=[("z", "90 deg")])
    m.spring("spring", m.ground.at(0.5, 0.5, 0.5), tail.tip, stiffness=10.0, length=0.3)
    m.path("end", tail.at(0.3))
    laws = {name: motion.harmonic(0.2, 0.1, 0.5, 0.1 * k) for k, name in enumerate(m.coordinates)}
    scene = Scene(m, laws, t=(0.0, 2.0, 9), wanted=["motion"])
    return evaluate(scene, backend="vm", certificate=False)

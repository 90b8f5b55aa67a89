"""Mechanisms that are over-constrained, of links that give way."""

import numpy as np
from internals import Member, moduli_of, nodes, strains_along

from lagrange_casadi import Mechanism, Scene, beams
from lagrange_casadi.motion import harmonic

STEEL = beams.material("S235")


def made(shape, material=STEEL):
    return beams.Beam(shape, material)


def work(first, second, links):
    """Forces of a solution times the strains of another, summed over links, (t,); and a size beside
    it.
    """
    total, size = 0.0, 0.0
    for link in links:
        member = Member.of(first, link, spun=True)
        moduli = moduli_of(member.beam, "test", space=member.space)
        u, weights = nodes(member)
        forces = [Member.of(one, link, spun=True).at(u) for one in (first, second)]
        parts = [force * strains_along(member, moduli, forces[1], u) * weights for force in forces]
        total = total + parts[0].sum(axis=(0, 2))
        size = size + np.abs(parts[1]).sum(axis=(0, 2))
    return total, size


def held(**forces):
    """A beam that is held at both ends, which a force loads beside its middle."""
    m = Mechanism("held")
    m.set_gravity(0.0, 0.0)
    bar = m.link("bar", length=2.0, beam=made(beams.rectangle(0.05, 0.02)))
    m.weld("A", m.ground, bar)
    m.weld("B", m.ground.at(2.0, 0), bar.tip)
    m.force("push", bar.at(0.6), **forces)
    return Scene(m, {}, t=(0, 0, 1), xi=(0, 1, 5), elastic=True)


def three_cranks(beam, bar):
    m = Mechanism("three_cranks")
    cranks = [m.link(name, length=0.2, beam=beam) for name in "abc"]
    bar = m.link("bar", length=1.0, **bar)
    for k, link in enumerate(cranks):
        m.revolute(f"G{k}", m.ground.at(0.5 * k, 0.0), link)
        m.revolute(f"B{k}", link.tip, (bar.base, bar.at(0.5), bar.tip)[k])
    posture = {"a": 1.2, "b": 1.2, "c": 1.2, "bar": 0.0}
    return Scene(m, {"G0": harmonic(1.2, 0.3, 1.0)}, posture=posture, t=(0, 1, 5), elastic=True)

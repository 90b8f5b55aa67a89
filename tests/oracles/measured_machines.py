"""Machines whose parameters are unknown, with true values, and records of them."""

import casadi as ca
import numpy as np
from mechanisms import pins_of

from lagrange_casadi import Measurements, Mechanism, Scene, SpatialMechanism, evaluate
from lagrange_casadi.motion import expression, harmonic


def swinging(middle, *amplitudes, rate=4.0):
    """A law of several sines."""

    def law(t):
        each = enumerate(amplitudes, 1)
        return middle + sum(a * ca.sin(k * rate * t + 0.7 * k * k) for k, a in each)

    return expression(law)


def record(scene, truth, *quantities, noise=0.0, seed=0):
    """Motion and forces of a scene with true parameters, with or without noise."""
    solution = evaluate(scene, parameters=truth, wanted=["all"], certificate=False)
    columns = {}
    for drive in scene.laws:
        for end in ("", "_rate", "_acceleration"):
            columns[f"{drive}{end}"] = solution.array(f"motion:{drive}{end}")
    generator, deviations = np.random.default_rng(seed), {}
    for name in quantities:
        values = solution.array(name)
        columns[name] = values + noise * generator.standard_normal(values.size)
        if noise:
            deviations[name] = noise
    return Measurements(solution.t, columns, deviations)


def two_links(length=0.5):
    """A planar arm in moments about its joints, in which forces are linear."""
    m = Mechanism("arm")
    links = []
    for k, (mass, moment, inertia) in enumerate([(3.0, 0.6, 0.3), (2.0, 0.3, 0.1)], 1):
        mass = m.parameter(f"m{k}", mass, "kg")
        moment = m.parameter(f"h{k}", moment, "kg m")
        inertia = m.parameter(f"J{k}", inertia, "kg m^2")
        centre = (moment / mass, 0.0)
        about = inertia - moment**2 / mass
        links.append(m.link(f"l{k}", length=length, mass=mass, centre=centre, inertia=about))
    first, second = links
    pins_of(m, A=(m.ground, first), B=(first.tip, second))
    motion = {"A": swinging(0.3, 0.5, 0.2), "B": swinging(0.8, 0.4, 0.3, rate=5.0)}
    return Scene(m, motion, t=(0, 3, 301))


ARM = {"m1": 2.5, "h1": 0.5, "J1": 0.25, "m2": 1.7, "h2": 0.4, "J2": 0.16}


def spatial_arm():
    """Three links in space, ten parameters each, about their joints."""
    m = SpatialMechanism("arm3")
    link, axes, truth, motion = m.ground, [(0, 0, 1), (0, 1, 0), (0, 1, 0)], {}, {}
    generator = np.random.default_rng(3)
    for k, axis in enumerate(axes, 1):
        mass = m.parameter(f"m{k}", 4.0 - k, "kg", low=0.0)
        h = [m.parameter(f"h{x}{k}", 0.2, "kg m") for x in "xyz"]
        names = ("xx", "xy", "xz", "yy", "yz", "zz")
        entries = [m.parameter(f"J{n}{k}", 0.5 * (n[0] == n[1]), "kg m^2") for n in names]
        xx, xy, xz, yy, yz, zz = entries
        square = sum(x * x for x in h)
        about = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
        for i in range(3):
            for j in range(3):
                about[i][j] = about[i][j] - ((i == j) * square - h[i] * h[j]) / mass
        inertia = tuple(map(tuple, about))
        body = m.link(
            f"l{k}", length=0.4, mass=mass, centre=tuple(x / mass for x in h), inertia=inertia
        )
        m.revolute(f"q{k}", link if k == 1 else link.tip, body, axis=axis)
        motion[f"q{k}"] = swinging(0.2 * k, 0.5, 0.3, 0.2, rate=3.0 + k)
        link = body
        centre = generator.uniform(0.05, 0.2, 3)
        weight = generator.uniform(1.0, 3.0)
        spread = generator.uniform(0.01, 0.05, (3, 3))
        moments = spread @ spread.T + 0.02 * np.eye(3)
        moments += weight * (centre @ centre * np.eye(3) - np.outer(centre, centre))
        truth |= {
            f"m{k}": weight,
            **{f"h{x}{k}": weight * c for x, c in zip("xyz", centre, strict=True)},
        }
        truth |= {f"J{n}{k}": moments["xyz".index(n[0]), "xyz".index(n[1])] for n in names}
    return Scene(m, motion, t=(0, 4, 401)), truth


def rubbing():
    """A four-bar with a spring, friction by speed, by a torque, and by a pin's load."""
    m = Mechanism("rubbing")
    given = {"mass": (2.0, "kg"), "k": (100.0, "N/m"), "preload": (20.0, "N"), "c": (3.0, "N s/m")}
    given |= {"dry": (0.2, "N m"), "mu": (0.1, "1"), "rotor": (0.02, "kg m^2")}
    p = {name: m.parameter(name, value, unit) for name, (value, unit) in given.items()}
    crank = m.link("crank", length=0.1, mass=1.0, centre=(0.05, 0.0), inertia=0.01 + p["rotor"])
    coupler, rocker = (
        m.link("coupler", length=0.4, mass=p["mass"]),
        m.link("rocker", length=0.3, mass=1.0),
    )
    o, *_ = pins_of(m, O=(m.ground, crank), A=(crank.tip, coupler), B=(coupler.tip, rocker.tip))
    c = m.revolute("C", m.ground.at(0.35, 0), rocker)
    length = 0.2 - p["preload"] / p["k"]
    m.spring("s", m.ground.at(0, 0.6), rocker.tip, stiffness=p["k"], length=length, damping=p["c"])
    m.torque("dry", crank, -p["dry"] * ca.sign(m.rate(o)))
    m.friction("pin", c, mu=p["mu"], radius=0.02)
    return Scene(m, {"O": swinging(1.0, 0.6, 0.3)}, t=(0, 2, 402), posture={"coupler": 0.5})


RUBBING = {
    "mass": 2.4,
    "k": 130.0,
    "preload": 24.0,
    "c": 2.0,
    "dry": 0.35,
    "mu": 0.17,
    "rotor": 0.03,
}


def platform():
    """Staicu's kind of robot: three legs, six masses, and loops that are iterated."""
    m = Mechanism("rrr")
    mass = m.parameter("plate", 1.5, "kg")
    plate = m.link(
        "plate", length=0.2, mass=mass, centre=(0.0, 0.0), inertia=m.parameter("J", 0.01, "kg m^2")
    )
    posture, motion = {"plate": 0.0}, {}
    for i in range(3):
        at = 2 * np.pi * i / 3 + np.pi / 6
        upper = m.link(f"u{i}", length=0.28, mass=m.parameter(f"mu{i}", 0.8, "kg"))
        lower = m.link(f"l{i}", length=0.28, mass=m.parameter(f"ml{i}", 0.5, "kg"))
        m.revolute(f"d{i}", m.ground.at(0.5 * np.cos(at), 0.5 * np.sin(at)), upper)
        m.revolute(f"k{i}", upper.tip, lower)
        m.revolute(f"f{i}", lower.tip, plate.at(0.12 * np.cos(at), 0.12 * np.sin(at)))
        posture[f"u{i}"], posture[f"l{i}"] = at + np.pi - 0.8, at + np.pi + 0.8
        motion[f"d{i}"] = harmonic(at + np.pi - 0.8, 0.2, 1.0 + 0.3 * i, i)
    return Scene(m, motion, t=(0, 2, 201), posture=posture)


PLATE = {
    "plate": 1.9,
    "J": 0.013,
    "mu0": 0.7,
    "mu1": 0.9,
    "mu2": 0.85,
    "ml0": 0.4,
    "ml1": 0.55,
    "ml2": 0.6,
}


def combined(result, truth):
    """The true values of base parameters, by their words."""
    found = []
    for parameter in result.base:
        total, sign, factor = 0.0, 1.0, 1.0
        for word in parameter.words.split():
            if word in truth:
                total, sign, factor = total + sign * factor * truth[word], 1.0, 1.0
            elif word in "+-":
                sign = -1.0 if word == "-" else 1.0
            else:
                factor = float(word)
        found.append(total)
    return np.array(found)


def noisy(scene, truth, names, noise, seed=0, **columns):
    found = record(scene, truth, *names, noise=noise, seed=seed)
    return Measurements(found.t, {**found.columns, **columns})

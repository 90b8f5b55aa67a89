"""Frictions of a solution held to their laws, from its own arrays: what is reported to press, and
how fast it slides.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output
from ...model.description import JointNumbers, LoadNumbers
from ..vector_sizes import most
from .instant_vectors import resolve, size, turn
from .placing import Placed
from .reported import Reported

_SLOW = 1e-9
"""Fraction of a joint's fastest rate, or of one that its accelerations lead to, below which the
rate may have either sign.
"""

_BESIDE = {"slide": "turn", "turn": "slide"}

Pressing = Callable[[Array], Array | float]
"""Factor of mu, for signs of the rate."""


def friction_residuals(placed: Placed) -> Array | None:
    """Residuals of frictions against their laws, and between the power they take and that of their
    forces (t,).

    None where there is no friction, or what it takes is not among the outputs. What is open at rest
    is no gap.
    """
    found = [*_of_losses(placed), *_of_laws(placed)]
    return np.fmax.reduce([np.zeros_like(placed.reported.t), *found]) if found else None


def _sliding(
    placed: Placed,
) -> Iterator[tuple[str, LoadNumbers, str, Array, Array | None, bool]]:
    """Each friction whose rate is known: its name, its load and its joint, that rate, the vector of
    which it is the size in a spherical joint, and whether it is of an angle.
    """
    reported, declared = placed.reported, placed.declared
    for name, load, joint in placed.frictions:
        rotates, spin = declared.coordinates[load.coordinate] == "angle", None
        rate = reported.outputs.get(Output("motion", load.coordinate, "rate"))
        if declared.joints[joint].kind == "spherical":
            near, far = placed.ends(joint)
            spin = far.spin[0] - near.spin[0]
            rate = np.broadcast_to(size(spin), reported.t.shape)
        if rate is not None:
            yield name, load, joint, rate, spin, rotates


def _of_losses(placed: Placed) -> Iterator[Array]:
    """Residual of the power of each friction against its force times its rate, relative to the
    largest.
    """
    outputs, (turned, fastest, _) = placed.reported.outputs, placed.rates
    for name, _, _, rate, _, rotates in _sliding(placed):
        value, lost = (
            outputs.get(Output("friction", name, member)) for member in ("along", "loss")
        )
        if value is None or lost is None:
            continue
        blur = placed.reported.coarseness * np.max(turned if rotates else fastest)
        scale = most(value) * (most(rate) + float(blur))
        yield np.abs(lost + value * rate) / (scale or 1.0)


def _of_laws(placed: Placed) -> Iterator[Array]:
    """Residuals of joints' frictions against their laws, relative to those under the largest
    reaction of the cycle.
    """
    outputs = placed.reported.outputs
    for name, load, holder, rate, spin, rotates in _sliding(placed):
        numbers, value = load.friction, outputs.get(Output("friction", name, "along"))
        if numbers is None or value is None or Output("reaction", holder, "fx") not in outputs:
            continue
        constant = numbers.get("coulomb")
        lever = numbers.get("radius", 1.0) if rotates else 1.0
        speed, share = np.abs(rate) * lever, None
        if constant is None and (other := _beside(load.coordinate)) is not None:
            beside = outputs.get(Output("motion", other, "rate"))
            if beside is None:
                continue
            speed = np.hypot(speed, beside * (1.0 if rotates else numbers.get("radius", 1.0)))
            share = np.divide(rate * lever, speed, out=np.zeros_like(rate), where=speed > 0.0)
        pressing = _pressing(placed, holder, numbers, rotates)
        mu = np.full_like(rate, numbers.get("mu", 0.0) if constant is None else constant)
        if "static" in numbers:
            mu += (numbers["static"] - mu) * np.exp(-((speed / numbers["stribeck"]) ** 2))
        steady = -numbers.get("viscous", 0.0) * rate
        sign = (
            np.tanh(rate / numbers["smooth"])
            if "smooth" in numbers
            else np.sign(rate)
            if share is None
            else share
        )
        residual = np.abs(value - steady + mu * sign * pressing(sign))
        if "smooth" not in numbers:
            ends = [
                np.abs(value - steady + one * mu * pressing(one * np.ones_like(rate)))
                for one in (1.0, -1.0)
            ]
            # Where it slides and turns, and both turn back at once, some share of it is along this
            # coordinate.
            slow = (
                np.minimum(*ends)
                if share is None
                else np.maximum(np.abs(value - steady) - mu * pressing(np.sign(rate)), 0.0)
            )
            quick = _quick(placed, load.coordinate, rotates)
            moves = speed > _SLOW * max(float(np.max(speed)), lever * quick)
            residual = np.where(
                moves,
                residual
                if spin is None
                else np.maximum(residual, _aside(placed.reported, name, value, spin)),
                slow,
            )
        most_pressing = lever * _most(outputs, numbers) if constant is None else 1.0
        scale = float(np.max(mu)) * most_pressing + float(np.max(np.abs(steady)))
        yield residual / (scale or 1.0)


def _aside(reported: Reported, name: str, value: Array, spin: Array) -> Array:
    """Residual of a spherical joint's friction couple against one of that size about the axis of
    turning.
    """
    if not all(Output("load", name, member) in reported.outputs for member in ("mx", "my", "mz")):
        return np.zeros_like(value)
    rate = np.broadcast_to(size(spin), value.shape)
    each = np.divide(value, rate, out=np.zeros_like(value), where=rate > 0.0)
    return size(reported.acts("load", name)[1] - each * spin)


def _quick(placed: Placed, coordinate: str, rotates: bool) -> float:
    """A rate that the accelerations of a coordinate lead to: where all instants are ends of
    strokes, the rates are rounding.
    """
    change = placed.reported.outputs.get(Output("motion", coordinate, "acceleration"), np.zeros(1))
    return float(np.sqrt(np.max(np.abs(change)) * (1.0 if rotates else placed.declared.size)))


def _beside(coordinate: str) -> str | None:
    """The other coordinate of a joint that slides and turns; None where there is none."""
    name, _, axis = coordinate.partition(":")
    return f"{name}:{_BESIDE[axis]}" if axis in _BESIDE else None


def _most(outputs: Mapping[Output, Array], numbers: Mapping[str, float]) -> float:
    """The largest reaction of all joints [N], its moment by its arm."""
    force, moment = (
        max(
            (
                most(values)
                for output, values in outputs.items()
                if output.group == "reaction" and output.member[0] == letter
            ),
            default=0.0,
        )
        for letter in "fm"
    )
    return force + 2.0 * moment / numbers.get("length", np.inf)


def _pressing(placed: Placed, name: str, numbers: Mapping[str, float], rotates: bool) -> Pressing:
    """Normal force in a joint, from its reaction on its own axes, the joint's axis first."""
    joint, reported = placed.declared.joints[name], placed.reported
    if "coulomb" in numbers:
        return lambda _: 1.0
    acts = zip((reported.straight, reported.turning), reported.acts("reaction", name), strict=True)
    axes = placed.ends(name)[0].axes
    force, moment = (
        resolve(turn(axes, np.array([*map(components, joint.triad)])), one)
        for components, one in acts
    )
    radius = numbers.get("radius", 0.0)
    if joint.kind == "screw" and "mu" in numbers:
        return _thread(joint, numbers, force[0])
    if joint.kind == "spherical":
        return lambda _: radius * size(force)
    (along, *across), (about, y, z) = force, moment
    halves, turned = np.array(across) / 2, np.array([z, -y]) / numbers.get("length", np.inf)
    pressed = np.hypot(*(halves + turned)) + np.hypot(*(halves - turned))
    if joint.kind == "revolute":
        pressed = pressed + np.abs(along)
    elif joint.kind == "prismatic" and radius:
        pressed = pressed + np.abs(about) / radius
    pressed = pressed * (radius if rotates else 1.0)
    return lambda _: pressed


def _thread(joint: JointNumbers, numbers: Mapping[str, float], force: Array) -> Pressing:
    """Normal force in a screw, by the angles of the thread and of friction.

    The couple of a force is radius tan(angle + phi) of it, and that without friction radius
    tan(angle).
    """
    radius = numbers["radius"]
    angle, phi = np.arctan(joint.pitch / radius), np.arctan(numbers["mu"])

    def pressing(sign: Array) -> Array:
        sense = np.sign(sign) * np.sign(force)
        whole = radius * np.abs(force) * (np.tan(sense * angle + phi) - np.tan(sense * angle))
        half = radius * np.abs(force) * (np.tan(phi - sense * angle) + np.tan(sense * angle))
        return np.asarray(
            ((1 + np.abs(sign)) * whole + (1 - np.abs(sign)) * half) / (2.0 * numbers["mu"] or 1.0)
        )

    return pressing

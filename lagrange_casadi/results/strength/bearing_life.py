"""Pins and bearings: shear, bending and pressure of a pin, pressure and heating of a plain bearing,
life of a rolling one, and its loads for catalogues.

A pin that fits loosely in its eye and its fork is a beam: the eye's load is even over its width,
and each cheek bears in the middle of its own (Wittel, Jannasch, Voßiek and Spura, *Roloff/Matek
Maschinenelemente*, chapter 9, case 1). Shear stress is largest in the middle of its cross-section,
4/3 of the mean (Shigley, *Mechanical Engineering Design*, 9th edition, table 3-2). Rolling bearings
are those of ISO 281: P = X F_r + Y F_a, L_10 = (C/P)^p million turns, with the mean of P^p over the
turns where load and speed change.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, TypeAlias

import numpy as np

from ...base.arguments import Force, Numeric, Positive, Row, public
from ...base.arrays import Array
from ...base.quantities import Output
from ...base.units import Within
from ...errors import DeclarationError, check_known
from ...model.fitted import Fitted, Pin, Plain, Rolling, positive
from ..histories import Histories
from ..statistics import counted, shares
from .safety import Safety, Verdict

Load: TypeAlias = Annotated[Any, Within(0.0, unit="N")]
Speed: TypeAlias = Annotated[Any, Within(0.0, unit="rpm")]


@public
def bending_of_pin(
    force: Annotated[Numeric, "N"],
    eye: Annotated[Numeric, "m"],
    cheek: Annotated[Numeric, "m"],
    gap: Annotated[Numeric, "m"] = 0.0,
) -> Numeric:
    """Return the bending moment in the middle of a pin, F (eye + 2 cheek + 4 gap)/8.

    Parameters
    ----------
    force : float or array
        Force F between eye and fork [N].
    eye, cheek, gap : float or array
        Widths of the eye and of each cheek of the fork, and of the gap on each side [m].

    Returns
    -------
    float or array
        The bending moment [N m].

    Notes
    -----
    The pin fits loosely: Roloff/Matek, *Maschinenelemente*, chapter 9.
    """
    return force * (eye + 2.0 * cheek + 4.0 * gap) / 8.0


@public
def equivalent_load(load: Annotated[Row, "N"], turned: Row, exponent: Positive = 3.0) -> float:
    """Return the constant load with the same life as a sequence of loads (ISO 281).

    Parameters
    ----------
    load : array of float
        The loads (n,) [N].
    turned : array of float
        How long each acts (n,): angles, revolutions or times, in any unit.
    exponent : float
        Exponent p of the life: 3 for balls, 10/3 for rollers.

    Returns
    -------
    float
        (sum of load^p turned / sum of turned)^(1/p) [N].

    Raises
    ------
    DeclarationError
        If the rows differ in length, or have numbers that are negative or not finite.
    """
    loads, lasting = np.asarray(load, float), np.asarray(turned, float)
    if (
        loads.ndim != 1
        or loads.shape != lasting.shape
        or not np.isfinite([loads, lasting]).all()
        or min(0.0, *loads, *lasting) < 0.0
    ):
        raise DeclarationError(
            "equivalent_load: expected two rows of one length, finite and not negative"
        )
    total, most = float(lasting.sum()), float(np.max(loads, initial=0.0))
    if total == 0.0 or most == 0.0:
        return 0.0
    mean = float((lasting * (loads / most) ** exponent).sum()) / total
    return float(most * mean ** (1.0 / exponent))


@public
def rated_hours(
    dynamic: Force,
    load: Load,
    rpm: Speed,
    exponent: Positive = 3.0,
) -> float:
    """Return the life that nine of ten bearings reach, (C/P)^p million revolutions (ISO 281).

    Parameters
    ----------
    dynamic : float
        Dynamic load rating C [N].
    load : float
        Equivalent load P [N].
    rpm : float
        Speed [1/min].
    exponent : float
        Exponent p of the life: 3 for balls, 10/3 for rollers.

    Returns
    -------
    float
        The life [h], infinite without load or rotation.
    """
    if load == 0.0 or rpm == 0.0:
        return math.inf
    try:
        return float((dynamic / load) ** exponent * 1e6 / (60.0 * rpm))
    except OverflowError:
        return math.inf


@public
@dataclass(frozen=True)
class BearingLoads:
    """Loads of a bearing as catalogues ask for them: ``radial`` and ``axial`` [N] even loads that
    wear it as much as those of the cycle, at the mean ``speed`` [1/min]; and the largest of each.
    """

    joint: str
    radial: float
    axial: float
    speed: float
    largest_radial: float
    largest_axial: float
    largest_speed: float


@public
def bearing_loads(solution: Histories, joint: str, exponent: Positive = 3.0) -> BearingLoads:
    """Compute equivalent loads and speeds of a joint for catalogues of bearings.

    Parameters
    ----------
    solution
        A solution with the joint's reaction and motion.
    joint
        Name of the joint.
    exponent
        That of the bearing's life: 3 for balls, 10/3 for rollers.

    Returns
    -------
    BearingLoads
        Loads are weighted by the angle that the joint turns under them; the speed is the mean of
        its size, also of a joint that swings.

    Raises
    ------
    DeclarationError
        For a reaction or a rate that was not evaluated, or is indeterminate.
    """
    across, along = _reaction_sizes(solution, joint)
    rate = _joint_rate(solution, joint, "angle")
    if rate is None:
        raise DeclarationError(f"joint '{joint}' does not turn, or its motion was not evaluated")
    speed = np.abs(rate) * 60.0 / math.tau
    turned = speed * shares(solution.t)
    return BearingLoads(
        joint,
        equivalent_load(across, turned, exponent),
        equivalent_load(along, turned, exponent),
        float(turned.sum()),
        *(float(values.max()) for values in (across, along, speed)),
    )


@public
def joint_safety(solution: Histories, joint: str, parts: Sequence[Fitted] | None = None) -> Safety:
    """Return the factors of safety of the pin and bearings of a joint, over all instants.

    Parameters
    ----------
    solution : Solution
        Has the reaction of the joint, and for bearings its motion.
    joint : str
        Name of the joint.
    parts : sequence of Pin, Plain or Rolling, optional
        Parts in place of those that :func:`.fit` gave the joint.

    Returns
    -------
    Safety
        Factors by which the reaction may grow; against speed and heating, by which these may grow.
        ``not_evaluated`` has what is missing, and why.

    Raises
    ------
    DeclarationError
        If there is no such joint or nothing is fitted to it, if its reaction was not evaluated or
        is indeterminate, or if a number that depends on parameters is not positive.
    """
    joints = solution.description.joints
    if parts is None:
        fitted = joints[joint].fitted if joint in joints else None
        if not fitted:
            having = ", ".join(solution.description.fitted)
            raise DeclarationError(
                f"nothing is fitted to joint '{joint}'; joints with a pin or a bearing:"
                f" {having or 'none'}"
            )
        parts = fitted.parts
    across, along = _reaction_sizes(solution, joint)
    rate, slide = (_joint_rate(solution, joint, kind) for kind in ("angle", "slide"))
    found: list[Verdict | str] = []
    for part in parts:
        _check(joint, part)
        if isinstance(part, Pin):
            found += _pin(part, across, solution.t)
        elif isinstance(part, Plain):
            found += _plain(part, across, rate, slide, solution.t)
        elif rate is None:
            found.append(f"rolling bearing: the motion of joint '{joint}' is not evaluated")
        else:
            found += _rolling(part, across, along, rate, solution.t)
    verdicts = tuple(one for one in found if isinstance(one, Verdict))
    return Safety(joint, verdicts, tuple(one for one in found if isinstance(one, str)))


def _reaction_sizes(solution: Histories, joint: str) -> tuple[Array, Array]:
    """Return the sizes of a reaction across its joint's axis, and along it, each (t,); zero where
    friction at rest leaves it indeterminate.

    Raises :class:`.DeclarationError` for a joint that there is not, and a reaction that was not
    evaluated, or is indeterminate at all instants.
    """
    joints = solution.description.joints
    check_known("joint", [joint], joints)
    members = [o for o in solution.outputs if o.group == "reaction" and o.part == joint]
    if not members:
        raise DeclarationError(
            f"the reaction of joint '{joint}' was not evaluated; add reaction:{joint} too"
        )
    if any(not solution.determined(member) for member in members):
        raise DeclarationError(
            f"the reaction of joint '{joint}' is statically indeterminate, so its strength is not"
            " evaluated"
        )
    # In space reactions are given on the joint's own axes too, of which the first is the one it
    # turns about; in the plane that is z, along which there is no force.
    axes, nothing = "uvw" if solution.description.space else "zxy", np.zeros_like(solution.t)
    u, v, w = (solution.outputs.get(Output("reaction", joint, f"f{x}"), nothing) for x in axes)
    across, along = np.hypot(v, w), np.abs(u)
    if not (counts := counted(np.stack([across, along]))).any():
        raise DeclarationError(
            f"joint '{joint}': friction is at rest at all instants, so its strength is"
            " indeterminate"
        )
    # What does not count is no load: it is below every peak, and loads a bearing over no way.
    return np.where(counts, across, 0.0), np.where(counts, along, 0.0)


def _check(joint: str, part: Fitted) -> None:
    kind = type(part).__name__.lower()
    for name, value in vars(part).items():
        if isinstance(value, float) and not positive(name, value):
            raise DeclarationError(
                f"joint '{joint}': {kind}: {name} must be positive, got {value:g}"
            )


def _joint_rate(solution: Histories, joint: str, kind: str) -> Array | None:
    """The rate at which a joint turns or slides; None if it was not evaluated, or there is none."""
    entry = solution.description.joints[joint]
    name = next((axis.coordinate for axis in entry.axes if axis.kind == kind), None)
    if kind == "angle":
        name = entry.turning or name
    return None if name is None else solution.outputs.get(Output("motion", name, "rate"))


def _verdict(
    against: str, bears: float, size: Array, t: Array, text: str, unit: str, scale: float = 1.0
) -> Verdict:
    k = int(np.argmax(size))
    most = float(size[k])
    return Verdict(
        against,
        bears / most if most else math.inf,
        f"{text} {most / scale:.4g} {unit} at t = {t[k]:.5g} s",
    )


def _pin(pin: Pin, force: Array, t: Array) -> Iterator[Verdict]:
    (strength,) = pin.material.needs("the strength of a pin", "yield_strength")
    d = float(pin.diameter)
    bending = bending_of_pin(force, pin.eye, pin.cheek, pin.gap) / (math.pi * d**3 / 32)
    shear = 4 / 3 * force / 2 / (math.pi * d**2 / 4)
    yield _verdict("bending of pin", strength, bending, t, "bending stress", "MPa", 1e6)
    yield _verdict("shear of pin", strength / math.sqrt(3.0), shear, t, "shear stress", "MPa", 1e6)
    if pin.pressure is not None:
        for name, width in (("eye", float(pin.eye)), ("fork", 2 * float(pin.cheek))):
            yield _verdict(
                f"pressure in {name}", pin.pressure, force / (d * width), t, "pressure", "MPa", 1e6
            )


def _plain(
    bearing: Plain, force: Array, rate: Array | None, slide: Array | None, t: Array
) -> Iterator[Verdict | str]:
    d = float(bearing.bore)
    pressure = force / (d * float(bearing.width))
    if bearing.pressure is not None:
        yield _verdict("pressure", bearing.pressure, pressure, t, "pressure", "MPa", 1e6)
    if bearing.speed is None and bearing.heating is None:
        return
    if rate is None and slide is None:
        yield "plain bearing: its joint's motion is not evaluated"
        return
    speed = np.hypot(0.0 if rate is None else rate * d / 2, 0.0 if slide is None else slide)
    if bearing.speed is not None:
        yield _verdict("speed", bearing.speed, speed, t, "speed of sliding", "m/s")
    if bearing.heating is not None:
        mean = float(pressure * speed @ shares(t))
        factor = bearing.heating / mean if mean else math.inf
        yield Verdict("heating", factor, f"p v {mean / 1e6:.4g} MPa m/s in the mean")


def _rolling(
    bearing: Rolling, across: Array, along: Array, rate: Array, t: Array
) -> Iterator[Verdict]:
    load = bearing.radial * across + bearing.axial * along
    turned = np.abs(rate) * shares(t)
    rpm = float(turned.sum()) * 60 / math.tau
    even = equivalent_load(load, turned, bearing.exponent)
    hours = rated_hours(bearing.dynamic, even, rpm, bearing.exponent)
    factor = math.inf if math.isinf(hours) else (hours / bearing.hours) ** (1.0 / bearing.exponent)
    text = f"P {even:.4g} N, {rpm:.4g} 1/min, L10 {hours:.4g} h of {bearing.hours:.4g} h"
    yield Verdict("life of bearing", factor, text)
    if bearing.static is not None:
        yield _verdict("static load", bearing.static, load, t, "load", "N")

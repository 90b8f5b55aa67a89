"""Requirements of a duty on a motor: temperature rise, torque, speed; and the smallest motor of a
catalogue that meets them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arguments import public
from ...base.arrays import Array
from ...base.brief import Brief
from ...errors import DeclarationError, NoDesignError
from ...results.statistics import shares
from .duty import Duty
from .motor import Motor


@dataclass(frozen=True, eq=False, repr=False)
class Choice(Brief):
    """A motor with a gear ratio and what it does: its ``duty``, and how much of its limits that
    takes, each 1 at most.

    ``refused`` says of each smaller motor why it does not serve.
    """

    motor: Motor
    duty: Duty
    heat: float
    torque: float
    speed: float
    refused: tuple[str, ...]

    @property
    def ratio(self) -> float:
        """The gear ratio."""
        return self.duty.ratio

    @property
    def shares(self) -> dict[str, float]:
        """Used fraction of each limit, by the limit's name."""
        return {"heat": self.heat, f"peak {self.duty.pull}": self.torque, "speed": self.speed}

    @property
    def governs(self) -> str:
        """The limit of which it takes most."""
        return max(self.shares, key=lambda name: self.shares[name])

    @property
    def serves(self) -> bool:
        """True if the motor keeps all limits."""
        return max(self.shares.values()) <= 1.0


@public
def assess(motor: Motor, duty: Duty, refused: tuple[str, ...] = ()) -> Choice:
    """Compare a motor with the requirements of a duty.

    Parameters
    ----------
    motor : Motor
        The motor.
    duty : Duty
        Result of :func:`.duty_of`, with the inertia of this motor.
    refused : tuple of str
        Reasons why other motors were refused, for the result.

    Returns
    -------
    Choice
        Shares of the limits of heat, peak torque and speed; above 1 the motor is not suitable. Heat
        is the root mean square of the torque over the continuous torque at the mean speed, or with
        a ``time_constant`` the root of the largest temperature rise in a repeated cycle.

    Raises
    ------
    DeclarationError
        For a linear motor and a rotary duty, or the reverse.
    """
    if motor.linear != duty.linear:
        kinds = ("a rotary", "a linear")
        raise DeclarationError(
            f"motor '{motor.name}' is {kinds[motor.linear]} one, and the duty of '{duty.joint}' is"
            f" that of {kinds[duty.linear]} one"
        )
    lasting = float(motor.continuous_torque(duty.mean_speed))
    heat = (
        warmest(duty.t, duty.torque, motor.time_constant) / lasting if lasting > 0.0 else math.inf
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        torque = float(np.nanmax(np.abs(duty.torque) / motor.short_time_torque(duty.speed)))
    return Choice(motor, duty, heat, torque, duty.peak_speed / motor.max_speed, refused)


@public
def select(
    motors: Iterable[Motor],
    duty: Callable[[float, float], Duty],
    *,
    ratios: Sequence[float] = (1.0,),
) -> Choice:
    """Choose the smallest suitable motor, with the gear ratio that heats it least.

    Parameters
    ----------
    motors : iterable of Motor
        The motors, as of :func:`.read_motors`.
    duty : callable
        ``duty(ratio, inertia)`` returns the :class:`Duty` of a motor behind a ratio, with the
        inertia of its rotor, as ``lambda ratio, inertia: duty_of(solution, "J", ratio=ratio,
        inertia=inertia)``.
    ratios : sequence of float
        The gear ratios to try.

    Returns
    -------
    Choice
        The motor with the least rated power of which no share, as of :func:`assess`, is above 1.

    Raises
    ------
    NoDesignError
        If no motor is suitable; the message names the nearest.
    DeclarationError
        Without motors or ratios.
    """
    given = sorted(motors, key=lambda motor: (motor.rated_power, motor.name))
    if not given or not list(ratios):
        raise DeclarationError("select: expected motors, and ratios")
    nearest: list[Choice] = []
    for motor in given:
        refused = tuple(f"{one.motor.name}: {_exceeded(one)}" for one in nearest)
        tried = [assess(motor, duty(float(ratio), motor.inertia), refused) for ratio in ratios]
        serving = [choice for choice in tried if choice.serves]
        if serving:
            return min(serving, key=lambda choice: choice.heat)
        nearest.append(min(tried, key=_worst))
    best = min(nearest, key=_worst)
    raise NoDesignError(
        f"no motor of {len(given)} is suitable; nearest is {best.motor.name}: {_exceeded(best)}"
    )


def _worst(choice: Choice) -> float:
    return max(choice.shares.values())


def _exceeded(choice: Choice) -> str:
    """Name the limit that is exceeded most, and by how much."""
    share = 100.0 * choice.shares[choice.governs]
    return f"{choice.governs} {share:.3g} % of its limit, with a ratio of {choice.ratio:g}"


def warmest(t: Array, torque: Array, time_constant: float) -> float:
    """The torque [N m] that would warm for ever as much as a cycle's warmest instant does.

    The losses in the winding go with the square of the torque, and warm it by the law tau w' + w =
    torque^2, straight between instants, w the same at the start of a cycle as at its end. Where tau
    is infinite that is the root of the mean square.
    """
    heat, steps = torque**2, np.diff(t)
    if math.isinf(time_constant):
        return math.sqrt(heat @ shares(t))
    parts = steps / time_constant
    keep, gain = np.exp(-parts), -np.expm1(-parts)
    # The exact solution for heat that goes straight from a to b: w1 = keep w0 + gain a + (1 -
    # gain/part) (b - a).
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = np.where(parts > 1e-6, 1.0 - gain / parts, parts / 2.0)
    added = gain * heat[:-1] + slope * (heat[1:] - heat[:-1])
    # The start of a cycle is its end: w0 = (keep of all) w0 + what a cycle adds.
    end = float(added @ np.exp((t[1:] - t[-1]) / time_constant))
    warm = [end / -math.expm1(-float(parts.sum()))]
    for share, more in zip(keep.tolist(), added.tolist(), strict=True):
        warm.append(share * warm[-1] + more)
    # Between instants it is warmest where the heat that falls meets it.
    start, rate = np.array(warm[:-1]), (heat[1:] - heat[:-1]) / steps
    rises = (rate < 0.0) & (start < heat[:-1])
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        after = time_constant * np.log1p((start - heat[:-1]) / (rate * time_constant))
        reached = np.where(rises & (after < steps), heat[:-1] + rate * after, 0.0)
    return math.sqrt(max(max(warm), float(reached.max())))

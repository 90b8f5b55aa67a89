"""Scales of a sweep's figures: limits of colours and axes, ticks that do not run into each other, numbers in words."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..density import Array

_MIDDLE: Any = ((5, "higher"), (95, "lower"))
_SPAN, _SAME = 20.0, 1e-9


@dataclass(frozen=True)
class Scale:
    """Limits of colours or of an axis, which a few designs near a dead centre do not set.

    They are those of the values; but where some are further from the middle 90 % than twice what it spans, half its span away from
    it. A scale is logarithmic where the middle spans more than 20 times, and there once its span is far. One with ``sides`` begins
    with zero (1) or has zero in its middle (2); up to ``low`` it is linear. ``below`` and ``above`` say that values lie outside,
    ``most`` is the largest.
    """

    low: float
    high: float
    log: bool
    below: bool
    above: bool
    most: float
    sides: int = 0

    @classmethod
    def of(cls, values: Array, sides: int = 0) -> Scale:
        """The scale of sizes of which at least one is finite, or with ``sides`` of what does not exceed them."""
        found = values[np.isfinite(values)]
        least, most = float(found.min()), float(found.max())
        # Of a few values, the least and the largest are never in the middle.
        near, far = (float(np.percentile(found, at, method=way)) for at, way in _MIDDLE) if found.size > 3 else (least, most)
        log = bool(near > 0.0 and far > _SPAN * near)
        turn, back = (np.log, np.exp) if log else (np.positive, np.positive)
        with np.errstate(divide="ignore"):
            first, near, far, last = turn([least, near, far, most])
        reach = far - near or last - first
        away = reach if log else 2 * reach
        low = back(near - reach / 2) if first < near - away else least
        high = back(far + reach / 2) if last > far + away else most
        if high - low <= _SAME * max(abs(high), abs(low)):
            pad = 0.05 * abs(high) or 1.0
            low, high = low - pad, high + pad
        return cls(float(low), float(high), log, least < low, most > high, most, sides)

    @property
    def extend(self) -> str:
        """Where a colour bar has arrows."""
        outside = (self.above and self.sides == 2 if self.sides else self.below, self.above)
        return {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}[outside]

    @property
    def note(self) -> str:
        """How far values go that lie above, in words."""
        return f"beyond: up to {number(self.most)}{' in size' if self.sides == 2 else ''}" if self.above else ""

    def norm(self) -> Any:
        """For colours."""
        from matplotlib.colors import AsinhNorm, LogNorm, Normalize

        if self.sides:
            least = -self.high if self.sides == 2 else 0.0
            return AsinhNorm(self.low, least, self.high) if self.log else Normalize(least, self.high)
        return (LogNorm if self.log else Normalize)(self.low, self.high)

    def mark(self, bar: Any) -> None:
        """Ticks of a short horizontal colour bar."""
        from matplotlib.ticker import MaxNLocator

        if self.sides and self.log:
            powers: list[int] = []
            for power in range(int(np.floor(np.log10(self.high))), int(np.floor(np.log10(self.low))), -1):
                if 10.0**power > 2.0 * self.low and (not powers or powers[-1] - power >= np.log10(self.high / self.low) / 3):
                    powers.append(power)
            words = [f"10{_raised(power)}" for power in powers]
            ticks, labels = [0.0, *(10.0**power for power in powers)], ["0", *words]
            if self.sides == 2:
                ticks = [*(-tick for tick in ticks[1:]), *ticks]
                labels = [*(f"\N{MINUS SIGN}{word}" for word in words), *labels]
            bar.set_ticks(ticks, labels=labels)
            bar.minorticks_off()
        elif self.log:
            even_in_ratios(bar.ax.xaxis)
        else:
            bar.locator = MaxNLocator(4)
            bar.update_ticks()

    def limit(self, axes: Any, axis: str, held: Iterable[float] = (), foot: float = 0.05) -> None:
        """Let axis "x" or "y" of axes have this scale, with room below for ``foot`` of it; values ``held`` are inside."""
        low, high = min([self.low, *held]), max([self.high, *held])
        if self.log:
            limits = low / (high / low) ** foot, high * (high / low) ** 0.05
        else:
            limits = low - foot * (high - low), high + 0.05 * (high - low)
        if self.log:
            axes.set(**{f"{axis}scale": "log"})
        axes.set(**{f"{axis}lim": limits})
        if self.log:
            even_in_ratios(getattr(axes, f"{axis}axis"))


def number(value: float) -> str:
    """A number as figures say it."""
    if value == 0.0 or 1e-3 <= abs(value) < 1e5:
        return (f"{value:.0f}" if abs(value) >= 1e3 else f"{value:.3g}").replace("-", "\N{MINUS SIGN}")
    digits, _, power = f"{abs(value):.2e}".replace(".00", "").partition("e")
    factor = "" if digits == "1" else f"{digits}·"
    return ("" if value > 0.0 else "\N{MINUS SIGN}") + f"{factor}10{_raised(int(power))}"


def _raised(power: int) -> str:
    return str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def even_in_ratios(axis: Any) -> None:
    """Ticks of a logarithmic axis that do not run into each other."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    decades = np.log10(high / low)
    axis.set_major_locator(LogLocator(subs=(1.0,) if decades > 2.5 else (1.0, 3.0) if decades > 1.2 else (1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda x, _: number(x)))
    axis.set_minor_formatter(NullFormatter())


def logarithmic(x: Array) -> bool:
    """Whether values are even in ratios rather than in steps: they span ten times, their median nearer to the geometric mean."""
    low, high = x.min(), x.max()
    if low <= 0.0 or high < 10.0 * low:
        return False
    middle = float(np.median(x))
    return bool(abs(np.log(middle / np.sqrt(low * high))) < abs(np.log(middle / ((low + high) / 2))))


def edges(x: Array, log: bool) -> Array:
    """The edges of cells whose middles are ``x``, ascending, at least two."""
    place = np.log(x) if log else x
    middle = (place[1:] + place[:-1]) / 2
    found = np.concatenate([[2 * place[0] - middle[0]], middle, [2 * place[-1] - middle[-1]]])
    return np.asarray(np.exp(found) if log else found)

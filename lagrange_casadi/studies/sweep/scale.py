"""Scales of a sweep's figures: limits of colours and axes, ticks that do not run into each other,
numbers in words.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...base.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis, XAxis, YAxis
    from matplotlib.colorbar import Colorbar
    from matplotlib.colors import Normalize

_MIDDLE: Any = ((5, "higher"), (95, "lower"))
_SPAN, _LOWEST, _DEPTH, _SAME = 5.0, 0.2, 1e6, 1e-9
_TALL, _WIDE = 0.15, 0.065


@dataclass(frozen=True)
class Scale:
    """Limits of colours or of an axis, which a few designs near a dead centre do not set.

    They are those of the values; but where some are further from the middle 90 % than twice what it
    spans, half its span away from it. A scale is logarithmic where half of the values would be in
    the lowest fifth of it otherwise, and the middle spans more than five times; there spans are
    ratios. One with ``sides`` is that of sizes, and begins with zero (1) or has zero in its middle
    (2); a logarithmic one is linear up to ``low``. ``below`` and ``above`` say that values lie
    outside, ``most`` is the largest.
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
        """The scale of values of which at least one is finite."""
        found = values[np.isfinite(values)]
        found = np.abs(found) if sides else found
        least, most = float(found.min()), float(found.max())
        # Of a few values, the least and the largest are never in the middle.
        near, far = (
            (float(np.percentile(found, at, method=way)) for at, way in _MIDDLE)
            if found.size > 3
            else (least, most)
        )
        low, high = _limits(0.0, 0.0, far, most) if sides else _limits(least, near, far, most)
        middle = float(np.median(found))
        log = (
            middle - low < _LOWEST * (high - low)
            and far > _SPAN * near
            and (least >= 0.0 < near or sides > 0)
        )
        if log:
            # Some sizes are zero, or rounding; a twentieth of the median is little enough.
            near, least = (max(near, middle / 20.0, far / _DEPTH),) * 2 if sides else (near, least)
            low, high = _limits(least, near, far, most, log=True)
        if high - low <= _SAME * max(abs(high), abs(low)):
            pad = 0.05 * abs(high) or 1.0
            low, high = low - pad, high + pad
        return cls(low, high, log, not sides and least < low, most > high, most, sides)

    @property
    def extend(self) -> str:
        """Ends of a colour bar with arrows."""
        outside = (self.above and self.sides == 2 if self.sides else self.below, self.above)
        return {
            (False, False): "neither",
            (True, False): "min",
            (False, True): "max",
            (True, True): "both",
        }[outside]

    @property
    def note(self) -> str:
        """Range of values above the scale, in words."""
        return (
            f"beyond: up to {number(self.most)}{' in size' if self.sides == 2 else ''}"
            if self.above
            else ""
        )

    def norm(self) -> Normalize:
        """Norm for colours."""
        from matplotlib.colors import AsinhNorm, LogNorm, Normalize

        if self.sides:
            least = -self.high if self.sides == 2 else 0.0
            return (
                AsinhNorm(self.low, least, self.high) if self.log else Normalize(least, self.high)
            )
        return (LogNorm if self.log else Normalize)(self.low, self.high)

    def mark(self, bar: Colorbar) -> None:
        """Ticks of a short horizontal colour bar."""
        from matplotlib.ticker import MaxNLocator

        if self.sides and self.log:
            powers: list[int] = []
            for power in range(
                int(np.floor(np.log10(self.high))), int(np.floor(np.log10(self.low))), -1
            ):
                if 10.0**power > 2.0 * self.low and (
                    not powers or powers[-1] - power >= np.log10(self.high / self.low) / 3
                ):
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

    def limit(self, axes: Axes, axis: str, held: Iterable[float] = (), foot: float = 0.05) -> None:
        """Let axis "x" or "y" of axes have this scale, with room below for ``foot`` of it; values
        ``held`` are inside.

        Where one of them is not positive, the axis is linear.
        """
        low, high = min([self.low, *held]), max([self.high, *held])
        log = self.log and low > 0.0
        if log:
            limits = low / (high / low) ** foot, high * (high / low) ** 0.05
        else:
            limits = low - foot * (high - low), high + 0.05 * (high - low)
        if log:
            axes.set(**{f"{axis}scale": "log"})
        axes.set(**{f"{axis}lim": limits})
        if log:
            even_in_ratios(getattr(axes, f"{axis}axis"))


def _limits(
    least: float, near: float, far: float, most: float, log: bool = False
) -> tuple[float, float]:
    """Limits of a colour scale: the values', or the middle's and half of its span if some are far
    from it.
    """
    turn, back = (np.log, np.exp) if log else (np.positive, np.positive)
    with np.errstate(divide="ignore"):
        first, start, end, last = turn([least, near, far, most])
    reach = end - start or last - first
    low = float(back(start - reach / 2)) if first < start - 2 * reach else least
    return low, float(back(end + reach / 2)) if last > end + 2 * reach else most


def number(value: float) -> str:
    """A number as figures say it."""
    if value == 0.0 or 1e-3 <= abs(value) < 1e5:
        return (f"{value:.0f}" if abs(value) >= 1e3 else f"{value:.3g}").replace(
            "-", "\N{MINUS SIGN}"
        )
    digits, _, power = f"{abs(value):.2e}".replace(".00", "").partition("e")
    factor = "" if digits == "1" else f"{digits}·"
    return ("" if value > 0.0 else "\N{MINUS SIGN}") + f"{factor}10{_raised(int(power))}"


def _raised(power: int) -> str:
    return str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def even_in_ratios(axis: Axis) -> None:
    """Ticks of a logarithmic axis that do not run into each other."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    decades = np.log10(high / low)
    axis.set_major_locator(
        LogLocator(
            subs=(1.0,) if decades > 2.5 else (1.0, 3.0) if decades > 1.2 else (1.0, 2.0, 5.0)
        )
    )
    axis.set_major_formatter(FuncFormatter(lambda x, _: number(x)))
    axis.set_minor_formatter(NullFormatter())


def tick(axis: XAxis | YAxis, values: Array, inches: float) -> None:
    """Ticks of an axis of a length at values, ascending, with numbers as far as they do not run
    into each other.
    """
    turn = np.log if axis.get_scale() == "log" else np.positive
    low, high = turn(axis.get_view_interval())
    words, end = [f"{x:.4g}".replace("-", "\N{MINUS SIGN}") for x in values], -np.inf
    for k, middle in enumerate((turn(values) - low) / (high - low) * inches):
        half = (_TALL if axis.axis_name == "y" else _WIDE * (len(words[k]) + 1)) / 2
        if middle - half < end:
            words[k] = ""
        else:
            end = middle + half
    axis.set_ticks(values, words)
    axis.set_ticks([], minor=True)


def logarithmic(x: Array) -> bool:
    """Return whether values are even in ratios rather than in steps: they span ten times, their
    median nearer to the geometric mean.
    """
    low, high = x.min(), x.max()
    if low <= 0.0 or high < 10.0 * low:
        return False
    middle = float(np.median(x))
    return bool(
        abs(np.log(middle / np.sqrt(low * high))) < abs(np.log(middle / ((low + high) / 2)))
    )


def edges(x: Array, log: bool) -> Array:
    """The edges of cells whose middles are ``x``, ascending, at least two."""
    place = np.log(x) if log else x
    middle = (place[1:] + place[:-1]) / 2
    found = np.concatenate([[2 * place[0] - middle[0]], middle, [2 * place[-1] - middle[-1]]])
    return np.asarray(np.exp(found) if log else found)

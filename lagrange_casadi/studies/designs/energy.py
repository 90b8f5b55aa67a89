"""The fluctuation of energy of a drive: the largest swing of the work of its effort beyond the work
of the mean effort, which a flywheel takes up and gives back.

With the effort tau and the rate w of its coordinate the work beyond the mean is

    E(t) = integral of (tau - mean) w dt,    mean = integral of tau w dt / integral of w dt,

over the instants of a design. Integrals are by Simpson's rule, on panels that are halved where it
does not hold, as at the corners and jumps of a load: so E is as smooth in the parameters as it is
in truth. Its extremes are where tau is the mean, and there E changes with parameters as if they
stood still.

R. L. Norton, *Design of Machinery*; J. E. Shigley, *Mechanical Engineering Design*: flywheels.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import casadi as ca
import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output
from ...base.status import Status
from ...base.symbolic import symbolic_property
from ...errors import DeclarationError
from ...results.sensitivity.ends import Ends
from .engine import DesignEngine
from .outcome import KEPT, Results

_CLOSE = {"double": 1e-13, "single": 1e-5}
"""Error of a panel, over the work of all, at which it is not halved, by precision."""

_STILL = 1e-9
"""Share of its way within which a coordinate ends where it began."""

_ROUNDS, _MORE = 30, 64
"""Most halvings of panels; and most nodes for each instant."""


@dataclass(frozen=True, eq=False)
class DriveEnergy:
    """The energy of a ``drive``'s effort in designs by an ``engine``. The design that was sampled
    last is kept, by its parameters: a search asks for the value and for its derivatives.
    """

    engine: DesignEngine
    drive: Output

    def fluctuation(self, p: Array) -> float:
        """Return the fluctuation of energy [J] of a design (parameters,), NaN if it has none."""
        nodes = self._nodes(p.tobytes())
        return np.nan if nodes is None else float(nodes.swing @ nodes.beyond)

    def slopes(self, p: Array) -> Array:
        """Return the derivatives of the fluctuation by all parameters, (parameters,)."""
        nodes = self._nodes(p.tobytes())
        if nodes is None:
            return np.full(p.size, np.nan)
        engine, t, instants = self.engine, nodes.t, self.engine.times.even(p)
        first, last = Ends(engine.program.laws, engine.times.timing, instants, p).slopes
        share, span = ((t - t[0]) / (t[-1] - t[0]))[:, None], t[-1] - t[0]
        moved = (1.0 - share) * first + share * last
        number = np.full(t.size, engine.quantities.index(str(self.drive)), np.intc)
        nowhere, z = np.full_like(t, np.nan), engine.slopes.loops.at(instants, p, t)
        there = engine.slopes.at(t, z, p, number, nowhere)
        rows = np.atleast_2d(self._rate_slopes(t[None], p).full())
        by_time, by_p = rows[0], rows[1:].T
        effort = there.slopes + there.rate[:, None] * moved
        rate = by_p + by_time[:, None] * moved + nodes.rate[:, None] * (last - first) / span
        work = effort * nodes.rate[:, None] + nodes.effort[:, None] * rate
        mean = (nodes.whole @ (work - nodes.mean * rate)) / (nodes.whole @ nodes.rate)
        return np.asarray(
            nodes.swing @ (work - nodes.mean * rate - nodes.rate[:, None] * mean), float
        )

    @symbolic_property
    def _rate_slopes(self) -> ca.Function:
        """Derivatives of the coordinate's rate by the time, and by each parameter."""
        program = self.engine.program
        time, values = ca.SX.sym("t"), ca.SX.sym("p", len(self.engine.parameters))
        _, rates, accelerations = program.motion(time, values)
        row = program.driven.index(self.drive.part)
        found = ca.horzcat(accelerations[row], ca.jacobian(rates[row], values))
        return ca.Function("rate_slopes", [time, values], [ca.densify(found.T)])

    @cached_property
    def _nodes(self) -> Callable[[bytes], _Nodes | None]:
        """Samples of a design by its parameters (parameters,); None without a result."""
        return lru_cache(maxsize=1)(lambda p: self._nodes_of(np.frombuffer(p)))

    def _nodes_of(self, p: Array) -> _Nodes | None:
        engine, instants = self.engine, self.engine.times.even(p)
        path = instants if engine.program.newton is not None else instants[:0]
        t = np.linspace(instants[0], instants[-1], 4 * (-(-(instants.size - 1) // 4)) + 1)
        close, most = _CLOSE[engine.method.precision], _MORE * t.size
        if t.size < 5:
            return None
        fresh, sampled = t, np.empty((2, 0))
        for _ in range(_ROUNDS):
            found = self._sampled(fresh, p, path)
            if found is None:
                return None
            times = fresh if fresh is t else np.concatenate([t, fresh])
            order = np.argsort(times, kind="stable")
            t, sampled = times[order], np.concatenate([sampled, found], axis=1)[:, order]
            power = sampled[0] * sampled[1]
            y = [power[k : power.size - 4 + k : 4] for k in range(4)] + [power[4::4]]
            h = t[4::4] - t[:-4:4]
            coarse = h / 6.0 * (y[0] + 4.0 * y[2] + y[4])
            fine = h / 12.0 * (y[0] + 4.0 * y[1] + 2.0 * y[2] + 4.0 * y[3] + y[4])
            rough = np.abs(fine - coarse) > close * np.sum(h * np.abs(y[2]))
            if not rough.any() or t.size > most:
                break
            fresh = (t[:-1] + t[1:])[np.repeat(rough, 4)] / 2.0
        if not np.isfinite(sampled).all():
            return None
        steps = np.diff(t) * (sampled[1][1:] + sampled[1][:-1])
        if abs(steps.sum()) < _STILL * np.abs(steps).sum():
            raise DeclarationError(
                f"fluctuation of energy: joint '{self.drive.part}' ends where it began, so '"
                f"{self.drive}' has no mean over its coordinate; expected instants over whole turns"
            )
        return _Nodes.of(t, *sampled)

    def _sampled(self, t: Array, p: Array, first: Array) -> Array | None:
        """Effort and rate at times, (2, t), evaluated with the ``first`` times as well, along which
        loops are followed; None without a result.
        """
        engine, program = self.engine, self.engine.program
        path, back = np.unique(np.concatenate([first, t]), return_inverse=True)
        columns = np.empty((1, len(program.columns), path.size))
        status = np.zeros(1, np.int8)
        found: Results = {"status": status, "history": columns} | dict.fromkeys(KEPT)
        engine.library.designs(path[None], np.zeros((1, 0), bool), p[None], found, 1)
        if status[0] != Status.OK:
            return None
        effort = columns[0, program.outputs[self.drive], back[first.size :]]
        rates = np.atleast_2d(program.motion(t[None], p)[1].full())
        return np.array([effort, rates[program.driven.index(self.drive.part)]])


@dataclass(frozen=True, eq=False)
class _Nodes:
    """Effort and rate of a drive at times ``t``, ends and middles of panels in turn.

    ``whole`` are weights of the integral over all of them, and ``swing`` those of the integral from
    where the energy is least to where it is largest; ``mean`` is the mean effort.
    """

    t: Array
    effort: Array
    rate: Array
    whole: Array
    swing: Array
    mean: float

    @classmethod
    def of(cls, t: Array, effort: Array, rate: Array) -> _Nodes:
        """Find the swing."""
        h, panels = t[2::2] - t[:-2:2], (t.size - 1) // 2
        whole = _weights(h, panels, 0.0)
        mean = float(whole @ (effort * rate) / (whole @ rate))
        beyond = (effort - mean) * rate
        a, b, c = effort[:-2:2] - mean, effort[1:-1:2] - mean, effort[2::2] - mean
        # The parabola through the three is a + x u + y u^2; its roots are the extremes inside.
        x, y = -3.0 * a + 4.0 * b - c, 2.0 * (a - 2.0 * b + c)
        with np.errstate(all="ignore"):
            q = -(x + np.copysign(np.sqrt(x * x - 4.0 * a * y), x)) / 2.0
            roots = np.array([q / y, a / q])
        inside = (roots > 0.0) & (roots < 1.0)
        number = np.concatenate([np.arange(panels + 1), np.nonzero(inside)[1]])
        u = np.concatenate([np.zeros(panels + 1), roots[inside]])
        steps = h / 6.0 * (beyond[:-2:2] + 4.0 * beyond[1:-1:2] + beyond[2::2])
        before = np.concatenate([[0.0], np.cumsum(steps)])[number]
        thirds = (slice(0, -2, 2), slice(1, -1, 2), slice(2, None, 2))
        parts = [np.append(beyond[third], 0.0)[number] for third in thirds]
        energy = before + np.append(h, 0.0)[number] * sum(
            w * y for w, y in zip(_shares(u), parts, strict=True)
        )
        least, most = int(np.argmin(energy)), int(np.argmax(energy))
        swing = _weights(h, number[most], u[most]) - _weights(h, number[least], u[least])
        return cls(t, effort, rate, whole, swing, mean)

    @property
    def beyond(self) -> Array:
        """Power beyond that of the mean effort."""
        return np.asarray((self.effort - self.mean) * self.rate)


def _shares(u: Array) -> tuple[Array, Array, Array]:
    """Weights of a parabola's three values in its integral to a share ``u`` of a panel."""
    return (
        u - 1.5 * u**2 + 2.0 / 3.0 * u**3,
        2.0 * u**2 - 4.0 / 3.0 * u**3,
        -(u**2) / 2.0 + 2.0 / 3.0 * u**3,
    )


def _weights(h: Array, panel: int, u: float) -> Array:
    """Weights of nodes in the integral over the panels before one, and to a share of that one."""
    found = np.zeros(2 * h.size + 1)
    for k, weight in enumerate((1.0, 4.0, 1.0)):
        np.add.at(found, 2 * np.arange(panel) + k, h[:panel] / 6.0 * weight)
    if panel < h.size:
        found[2 * panel : 2 * panel + 3] += h[panel] * np.array(_shares(np.float64(u)))
    return found

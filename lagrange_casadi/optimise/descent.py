"""The way from one design to the best near it, by programs whose points grow until no peak between them exceeds a limit."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from .judge import HOLDS, Judge, Judged, scale_of
from .look import Point
from .program import Box, Found, Held

_ROUNDS, _HALVINGS = 40, 12
"""Programs that are solved at most; and how often a step is halved that leads to where loops do not close."""

_CONDITIONS = 1e-6
"""What may be left of the first-order conditions of an optimum."""

_KEEP = 0.7
"""Of the largest: local peaks that a program knows from the beginning."""

_NEAR = 1e-3
"""Of its scale: how near to its limit a local peak is that later programs know too."""

_LITTLE = 0.02
"""Of the largest: how much lower local peaks at instants are that are looked for between them."""

_CLOSED = 12
"""Instants at which a program watches how its loops close, from the beginning."""


@dataclass(eq=False)
class Descent:
    """What searches from several starts share: a ``history`` of designs, and the ``scales`` of the terms."""

    judge: Judge
    box: Box
    progress: Callable[[int, float, float], None] | None
    history: list[list[float]] = field(default_factory=list)
    scales: tuple[float, ...] = ()

    def note(self, start: int, judged: Judged) -> None:
        """Keep a design in the history, and tell of it."""
        row = [float(start), float(judged.values[0]), judged.excess, float(judged.look is not None)]
        self.history.append([*row, *judged.p[list(self.box.places)].tolist()])
        if self.progress is not None:
            self.progress(start, float(judged.values[0]), judged.excess)

    def descend(self, number: int, first: Judged, better: Callable[[Judged, Found | None, str], None]) -> None:
        """Go from a design to the best near it; ``better`` is told every design on the way."""
        self.note(number, first)
        better(first, None, "start")
        look = first.look
        assert look is not None
        # A program is of one scale.
        values = zip(self.judge.constraints, first.values[1:].tolist(), strict=True)
        self.scales = self.scales or (abs(float(first.values[0])) or 1.0, *(scale_of(c, v) for c, v in values))
        held = [Held(self.judge.program.objective, None, self.scales[0])]
        held += [Held(c.term, c.limit, scale, c.least) for c, scale in zip(self.judge.constraints, self.scales[1:], strict=True)]
        near = (look.t[-1] - look.t[0]) / max(look.t.size - 1, 1) * 1e-6
        closures = [look.instant(k) for k in np.unique(np.linspace(0, look.t.size - 1, _CLOSED).astype(int)).tolist()]
        self._learn(held, closures, first, near, everything=True)
        current, tried = first, 0
        averages = look
        for _ in range(_ROUNDS):
            every = [averages.instant(k) for k in range(averages.t.size)] if self.judge.program.averaged else []
            found = self.judge.program.solve(self.box.share(current.p), held, closures, every)
            x = found.x
            if not np.isfinite(x).all():
                better(current, None, "the program has no solution: no derivative where it looked")
                return
            following = self.judge.look(self.box.all(x))
            self.note(number, following)
            back = 0
            while following.look is None and back < _HALVINGS:
                # Loops do not close somewhere between the points: go back until they do, and look there from then on.
                back += 1
                x = (x + self.box.share(current.p)) / 2
                following = self.judge.look(self.box.all(x))
            if following.look is None:
                better(current, None, "loops close nowhere near")
                return
            added = self._learn(held, closures, following, near, everything=back > 0)
            done = not back and self._settled(found, following)
            moved = float(np.abs(self.box.share(following.p) - self.box.share(current.p)).max())
            better(following, found if not back else None, "converged" if done else f"IPOPT: {found.status}")
            if done and found.status == "Solve_Succeeded":
                return
            tried = tried + 1 if moved <= 1e-9 and not added else 0
            current, averages = following, following.look
            if tried >= 2:
                return

    def _settled(self, found: Found, judged: Judged) -> bool:
        """Whether a program's solution is what it says, with all peaks that it did not know."""
        gap = abs(judged.values[0] - found.objective) / (abs(judged.values[0]) or 1.0)
        return judged.excess <= HOLDS and gap <= HOLDS and found.residual <= _CONDITIONS

    def _learn(self, held: Sequence[Held], closures: list[Point], judged: Judged, near: float, *, everything: bool) -> bool:
        """Hold terms at the peaks of a design that programs do not know; whether there were any."""
        added = False
        assert judged.look is not None
        for k, (term, points) in enumerate(zip(held, judged.points, strict=True)):
            if not points:
                continue
            largest = points[0][1] * points[0][0].value
            least = _KEEP * largest if largest > 0.0 else largest / _KEEP
            if not everything:
                # Only what may exceed what the program found.
                level = largest if k == 0 else term.bound
                least = max(least, level - _NEAR * term.scale)
            # Between instants a peak is a little larger.
            high = [(point, sign) for point, sign in points if sign * point.value >= least - _LITTLE * abs(largest)]
            exact = self.judge.exact(term.term, high or points[:1], judged)
            for point, sign in exact:
                if sign * point.value >= least:
                    added |= term.add(point, sign, near)
            if not term.points:
                added |= term.add(*exact[0], near)
        sines = judged.look.closures()
        for row in sines:
            k = int(np.argmin(row))
            point = judged.look.instant(k)
            if row[k] < 4 * self.judge.program.least_closure and all(abs(point.t - other.t) > near for other in closures):
                closures.append(point)
                added = True
        return added

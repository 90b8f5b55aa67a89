"""Use that a motion makes of what drives can do."""

from __future__ import annotations

from dataclasses import dataclass

from ..base.brief import Brief
from ..base.quantities import Output
from .histories import Histories


@dataclass(frozen=True, repr=False)
class Use(Brief):
    """The largest size of an effort [N m or N] or a rate [rad/s or m/s], the output, its ``limit``
    and ``unit``, and when it is there [s].
    """

    name: str
    value: float
    limit: float
    unit: str
    t: float

    @property
    def share(self) -> float:
        """Share of the limit that is used: 1 is all of it."""
        return self.value / self.limit


@dataclass(frozen=True, repr=False)
class DriveUse(Brief):
    """Use of a drive's effort and speed; None where there is no limit, or no result."""

    effort: Use | None
    speed: Use | None


def drives_used(solution: Histories) -> dict[str, DriveUse]:
    """Return the use of each drive that has a limit, by its name."""
    found = {}
    for name, motor in solution.description.motors.items():
        effort = _use(solution, Output("effort", motor.coordinate), motor.effort)
        speed = _use(solution, Output("motion", motor.coordinate, "rate"), motor.speed)
        if effort or speed:
            found[name] = DriveUse(effort, speed)
    return found


def _use(solution: Histories, output: Output, limit: float | None) -> Use | None:
    if limit is None or output not in solution.outputs or not solution.determined(output):
        return None
    found = solution.statistics(output)
    return Use(found.name, abs(found.peak.value), limit, found.unit, found.peak.t)

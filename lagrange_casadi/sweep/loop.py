"""A plain loop over :func:`.evaluate`: one design after another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

import numpy as np

from ..backends import run
from ..density import Array
from ..derive import derive
from ..errors import AssemblyError, ParameterError
from ..evaluate import evaluate
from ..peaks import forces, refine
from ..rung import Rung
from ..scene import Grid, Scene
from ..solution import Solution
from .engine import Outcome

_OK, _NOT_ASSEMBLED, _IMPOSSIBLE = 0, 1, 2


class Loop:
    """An engine of plain evaluations. The resultant of a reaction is sought at the instants alone."""

    def __init__(self, scene: Scene, wanted: Sequence[str], t: Grid, rung: Rung) -> None:
        graph = derive(scene, wanted, iterate=rung.newton is not None)
        self._scene, self._wanted, self._t, self._rung = scene, wanted, t, rung
        mechanism = scene.mechanism
        sample = np.linspace(*t)
        self.provenance = run(graph, sample, np.array(list(mechanism.values().values())), rung)[1]
        self.columns = tuple(name for name in graph.columns if not name.startswith("_")) + graph.undetermined
        self._resultants = [f"reaction:{j}" for j in mechanism.joints if f"reaction:{j}:fx" in self.columns]
        members = [name for name in self.columns if name.startswith(("effort:", "reaction:"))]
        links = dict.fromkeys(name.split(":")[1] for name in self.columns if name.startswith("section:"))
        sections = [f"section:{link}:{force}" for link in links for force in ("axial", "shear", "bending")]
        self.quantities = (*members, *self._resultants, *sections)
        self.efforts = tuple(name for name in members if name.startswith("effort:"))

    def evaluate(self, p: Array, *, threads: int | None = None, histories: bool = False) -> Outcome:
        """One design after another."""
        n, q, e = len(p), len(self.quantities), len(self.efforts)
        status = np.zeros(n, np.int8)
        value, t, xi = (np.full((n, q), np.nan) for _ in range(3))
        mean, rms = (np.full((n, e), np.nan) for _ in range(2))
        series = np.full((n, len(self.columns), self._t[2]), np.nan) if histories else None
        names = list(self._scene.mechanism.parameters)
        for i, row in enumerate(p):
            try:
                solution = evaluate(
                    self._scene,
                    parameters=dict(zip(names, row.tolist(), strict=True)),
                    t=self._t,
                    wanted=self._wanted,
                    threads=1,
                    certificate=False,
                    **asdict(self._rung),
                )
            except (AssemblyError, ParameterError) as error:
                status[i] = _NOT_ASSEMBLED if isinstance(error, AssemblyError) else _IMPOSSIBLE
                continue
            for k, (v, at, place) in enumerate(self._peaks(solution)):
                value[i, k], t[i, k], xi[i, k] = v, at, place
            for k, name in enumerate(self.efforts):
                effort = solution.series[name]
                mean[i, k], rms[i, k] = effort.mean(), np.sqrt(np.mean(effort**2))
            if series is not None:
                series[i] = [solution.series[name] for name in self.columns]
        return Outcome(status, value, t, xi, mean, rms, series)

    def _peaks(self, solution: Solution) -> list[tuple[float, float, float]]:
        refined = {peak.name: peak for peak in refine(self._scene, solution, forces(solution))}
        found = []
        for name in self.quantities:
            if name in self._resultants:
                reaction = solution.reaction(name.partition(":")[2])
                size = np.hypot(reaction.fx, reaction.fy)
                i = int(np.argmax(size))
                found.append((float(size[i]), float(solution.t[i]), np.nan))
            elif name in refined:
                peak = refined[name]
                found.append((peak.value, peak.t, np.nan if peak.xi is None else peak.xi))
            else:
                found.append((np.nan, np.nan, np.nan))
        return found

"""Ways that the workers of a Dask cluster go.

They are sent what is derived and a question, and send back ways in plain numbers.
"""

from __future__ import annotations

import functools
import pickle
import threading
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from ..base.arrays import Json
from ..errors import ClusterError, LagrangeCasadiError
from ..studies.designs.engine import DesignEngine
from ..studies.optimise.search_run import STOPPED, SearchRun
from ..studies.optimise.searching import Progress
from ..studies.optimise.solver import SearchTask, Solver
from ..studies.sweep.blocks import Queue
from .sweeps import Asked, Cluster, check_same

_building = threading.Lock()


@dataclass(frozen=True)
class Workers:
    """The workers of a cluster, each at a way of its own."""

    cluster: Cluster

    def go(
        self, solver: Solver, tasks: Sequence[SearchTask], progress: Progress
    ) -> Iterator[tuple[int, SearchRun]]:
        """Runs of tasks, as they are done; those that an interrupt stopped are left out.

        Raises :class:`ClusterError` where the cluster cannot serve.
        """
        sent = pickle.dumps((solver.engine.program, solver.question))
        words = solver.question.words(solver.engine)
        queue = Queue((k, k + 1) for k in range(len(tasks)))

        def asked(start: int, _stop: int) -> Asked:
            return Asked(_descend, (sent, words, tasks[start]))

        for done in self.cluster.done(asked, queue):
            if done is None:
                continue
            number, _, run = done
            progress(number, run.objective, run.excess)
            yield number, run


def searching(address: str) -> Workers:
    """The workers of the Dask scheduler at an address, for searches.

    Raises :class:`.DeclarationError` for what is no address.
    """
    return Workers(Cluster(address))


def _descend(sent: bytes, words: Mapping[str, Json], task: SearchTask) -> SearchRun:
    """Run a start on a worker."""
    try:
        with _building:  # a finder goes one way at a time
            solver = _built(sent)
            check_same(words, solver.question.words(solver.engine))
            run = solver.descend(task, lambda *_: None)
    except ClusterError:
        raise
    except LagrangeCasadiError as error:
        # Not every error of ours can be sent as what it is.
        raise ClusterError(f"a worker failed: {error}") from None
    if run.ending == STOPPED:
        raise ClusterError("a worker was interrupted")
    return run


@functools.lru_cache(maxsize=4)
def _built(sent: bytes) -> Solver:
    program, question = pickle.loads(sent)
    return Solver.of(question, DesignEngine.compiled(program, question.timing, question.method))

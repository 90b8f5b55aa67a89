"""The workers of a Dask cluster, for sweeps and for searches.

They are sent what is derived, with designs or with starts, and send back columns or runs.
"""

from __future__ import annotations

import asyncio
import functools
import importlib
import logging
import pickle
import re
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, wait
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...base.arrays import Array, Json
from ...errors import ClusterError, DeclarationError, LagrangeCasadiError, one_line, warn
from ..checkpoint import difference
from ..designs.engine import DesignEngine
from ..optimise.search_run import STOPPED, SearchRun
from ..optimise.searching import Progress
from ..optimise.solver import SearchTask, Solver
from ..sweep.blocks import Queue
from ..sweep.columns import Harvest, Task
from ..sweep.plan import Plan
from ..sweep.workers import PATIENCE, PULSE, Blocks, ThreadPool

if TYPE_CHECKING:
    from types import ModuleType

    from distributed import Client

_PATIENCE = 10.0
"""Seconds in which a scheduler must answer."""

_ADDRESS = re.compile(r"(tcp|tls|ws|wss|ucx)://\S+:\d{1,5}/?")
_GLANCE, _ROLL, _PROBED, _GOODBYE = 2e-3, 1.0, 3.0, 0.3
"""Seconds between looks for a block, and between questions who the workers are; in which these must
say what they have; and in which the scheduler learns that all is over."""

_PROBE = "__import__('importlib.util').util.find_spec('lagrange_casadi') is not None"
"""Question to a worker, in words that need nothing of this package."""

_AHEAD = 2
"""Blocks sent out for each thread of the cluster."""

_building, _searching = threading.Lock(), threading.Lock()
"""Held while a worker compiles; and while a solver is at a run, of which it goes one at a time."""


@dataclass(frozen=True)
class Cluster:
    """The workers of the Dask scheduler at ``address``, which are sent what is derived, and compile
    it themselves.

    A block whose worker dies is sent to another one. Nobody waits for what does not answer, a
    scheduler or a worker that is frozen, after an interrupt. Raises :class:`ClusterError` where
    Dask is not installed, the scheduler cannot be reached or is lost, or workers fail, have not
    this package, or other versions.
    """

    address: str

    def __post_init__(self) -> None:
        if not _ADDRESS.fullmatch(self.address):
            raise DeclarationError(
                f"dask: expected an address like tcp://HOST:8786, got '{self.address}'"
            )

    def results(self, plan: Plan, queue: Queue) -> Blocks:
        """Evaluate what is in the queue, in the order in which workers are done."""
        harvest = plan.harvest
        sent = pickle.dumps((harvest.engine.program, harvest.whole))

        def asked(start: int, stop: int) -> Asked:
            designs = plan.block(start, stop)
            return Asked(_evaluate, (sent, harvest.task, harvest.signature, designs, plan.capacity))

        yield from self.done(asked, queue)

    def go(
        self, solver: Solver, tasks: Sequence[SearchTask], progress: Progress
    ) -> Iterator[tuple[int, SearchRun]]:
        """Runs of tasks, as they are done; those that an interrupt stopped are left out."""
        sent = pickle.dumps((solver.engine.program, solver.question))
        words = solver.question.words(solver.engine)
        queue = Queue((k, k + 1) for k in range(len(tasks)))

        def asked(start: int, _stop: int) -> Asked:
            return Asked(_descend, (sent, words, tasks[start]))

        for done in self.done(asked, queue):
            if done is not None:
                number, _, run = done
                progress(number, run.objective, run.excess)
                yield number, run

    def done(
        self, asked: Callable[[int, int], Asked], queue: Queue
    ) -> Iterator[tuple[int, int, Any] | None]:
        """Yield the results of ``asked`` for each block of a queue, in the order in which workers
        finish; None if nothing came for long.
        """
        _dask()
        with _silenced():
            connecting = _connecting(self.address)
            try:
                while not wait([connecting], PULSE).done:
                    yield None
                    if queue.stopped:
                        return
                client = self._connected(connecting)
                yield from self._served(client, _Roll(client), asked, queue)
            finally:
                connecting.add_done_callback(_let_go)

    def _served(
        self, client: Client, roll: _Roll, asked: Callable[[int, int], Asked], queue: Queue
    ) -> Iterator[tuple[int, int, Any] | None]:
        waiting = _dask().as_completed(loop=client.loop)
        blocks: dict[Any, tuple[int, int]] = {}
        end = 0.0

        def send() -> None:
            most = max(1, _AHEAD * roll.threads)
            while len(blocks) < most and (block := queue.take()):
                # As bytes: a scheduler needs to know Dask alone.
                future = client.submit(pickle.loads, pickle.dumps(asked(*block)), pure=False)
                blocks[future] = block
                waiting.add(future)

        def pause() -> bool:
            """True if nothing more is waited for, after an interrupt.

            Raises for what cannot go on.
            """
            nonlocal end
            if client.status != "running" or roll.lost:
                raise self._lost()
            self._refuse(roll)
            end = end or (time.monotonic() + PATIENCE if queue.stopped else 0.0)
            return queue.stopped and (not roll.threads or time.monotonic() > end)

        while not roll.ready:
            yield None
            if pause():
                return
        if not roll.threads:
            warn(f"the scheduler at {self.address} has no workers yet; waiting for some")
        send()
        while blocks:
            future = _first(waiting)
            if future is None:
                yield None
                if pause():
                    return
                continue
            coming = ThreadPool.alone(future.result)
            while not wait([coming], PULSE).done:
                yield None
                if pause():
                    return
            start, stop = blocks.pop(future)
            yield start, stop, self._result(coming, roll, start, stop)
            del future, coming
            if pause():
                return
            send()

    def _connected(self, connecting: Future[Client]) -> Client:
        error = connecting.exception()
        if error is None:
            return connecting.result()
        if isinstance(error, (TimeoutError, asyncio.TimeoutError)):
            why = f"nothing came from there within {_PATIENCE:g} s"
        else:
            known = isinstance(error, (OSError, TypeError, ValueError, RuntimeError))
            why = one_line(error) if known else "what answers there is no scheduler"
        raise ClusterError(f"no Dask scheduler answers at {self.address}: {why}")

    def _result(self, coming: Any, roll: _Roll, start: int, stop: int) -> Any:
        dask = _dask()
        try:
            found = coming.result()
        except ClusterError:
            raise
        except dask.KilledWorker:
            raise ClusterError(
                f"every worker that was sent designs {start} to {stop - 1} has died"
            ) from None
        except (dask.CancelledError, OSError):
            raise self._lost() from None
        except Exception as error:
            roll.settle()
            self._refuse(roll)
            raise ClusterError(
                f"a worker failed: {type(error).__name__}: {one_line(error)}"
            ) from None
        return found

    def _refuse(self, roll: _Roll) -> None:
        """Raise :class:`ClusterError` for workers without this package."""
        if roll.without:
            names = ", ".join(sorted(roll.without))
            raise ClusterError(
                f"no lagrange_casadi on worker{'s' if len(roll.without) > 1 else ''} {names}:"
                " install it there too"
            )

    def _lost(self) -> ClusterError:
        return ClusterError(f"the Dask scheduler at {self.address} was lost")


def _connecting(address: str) -> Future[Client]:
    """A client, made in a thread of its own: what takes its time to answer, or never does, holds
    nobody up.
    """
    client: Future[Any] = Future()

    def connect() -> None:
        try:
            # A client of Dask's waits without end for what accepts a connection and then says
            # nothing of Dask's. It gives up by itself, and says why, where nothing accepts one:
            # that comes first.
            asyncio.run(asyncio.wait_for(_greet(address), _PATIENCE + 1.0))
            client.set_result(_dask().Client(address, timeout=_PATIENCE, set_as_default=False))
        except Exception as error:
            client.set_exception(error)

    threading.Thread(target=connect, daemon=True).start()
    return client


async def _greet(address: str) -> None:
    """Ask what is at an address who it is. Raises ``OSError`` where that is no scheduler."""
    security = _dask().Security().get_connection_args("client")
    line = await importlib.import_module("distributed.comm").connect(
        address, timeout=_PATIENCE, **security
    )
    try:
        await line.write({"op": "identity", "reply": True})
        kind = (await line.read())["type"]
    finally:
        line.abort()
    if kind != "Scheduler":
        raise OSError(f"it is a {kind.lower()}")


class _Roll:
    """List of workers, updated by a thread of its own: one that does not answer delays nobody.

    ``threads`` is how many they have, which come and go; ``without`` are those that have not this
    package.
    """

    def __init__(self, client: Any) -> None:
        self.threads, self.lost = 0, False
        self.without: set[str] = set()
        self._client, self._asked = client, dict[str, Future[Any]]()
        self._known, self._again, self._until = (
            threading.Event(),
            threading.Event(),
            time.monotonic() + _PROBED,
        )
        ThreadPool.alone(self._ask)

    @property
    def ready(self) -> bool:
        """True if the workers and their contents are known, or would be if all answered."""
        return (
            self._known.is_set() and all(map(Future.done, list(self._asked.values())))
        ) or time.monotonic() > self._until

    def settle(self) -> None:
        """Ask once more, and wait a little for what they say."""
        self._known.clear()
        self._again.set()
        self._known.wait(PATIENCE)
        wait(list(self._asked.values()), PATIENCE)

    def _ask(self) -> None:
        while self._client.status == "running":
            try:
                counts = self._client.nthreads()
            except Exception:
                self.lost = self._client.status == "running"
                return
            for address in counts.keys() - self._asked.keys():
                self._asked[address] = ThreadPool.alone(self._probe, address)
            self.threads = sum(counts.values())
            self._known.set()
            self._again.wait(_ROLL)
            self._again.clear()

    def _probe(self, address: str) -> None:
        if (
            self._client.run(eval, _PROBE, workers=[address], on_error="ignore").get(address)
            is False
        ):
            self.without.add(address)


def _let_go(client: Future[Client]) -> None:
    if client.exception() is None:
        wait([ThreadPool.alone(client.result().close, 2)], _GOODBYE)


def _first(waiting: Any) -> Any | None:
    """One that is done, or None where none is after a while."""
    end = time.monotonic() + PULSE
    while not waiting.has_ready():
        if time.monotonic() > end:
            return None
        time.sleep(_GLANCE)
    return next(waiting)


def _dask() -> ModuleType:
    try:
        return importlib.import_module("distributed")
    except ImportError:
        raise ClusterError(
            "a cluster needs Dask; install it with: pip install 'lagrange_casadi[cluster]'"
        ) from None


@contextmanager
def _silenced() -> Iterator[None]:
    """Keep Dask's own log from saying at length what is said here in a line."""
    loggers = [
        logging.getLogger(name)
        for name in list(logging.root.manager.loggerDict)
        if name.startswith("distributed")
    ]
    before = [(logger, logger.disabled) for logger in loggers]
    for logger in loggers:
        logger.disabled = True
    try:
        yield
    finally:
        for logger, disabled in before:
            logger.disabled = disabled


@dataclass(frozen=True)
class Asked:
    """A call that becomes what it comes to where it is read."""

    function: Callable[..., Any]
    arguments: tuple[Any, ...]

    def __reduce__(self) -> tuple[Callable[..., object], tuple[object, ...]]:
        """The call that reading it is."""
        return self.function, self.arguments


def _check_same(asked: Mapping[str, Json], here: Mapping[str, Json]) -> None:
    """Raise :class:`ClusterError` if a worker's inputs ``here`` differ from those asked for."""
    if found := difference(asked, here):
        raise ClusterError(
            f"a Dask worker would give other numbers than this machine: {found} on the worker;"
            " install the same there"
        )


@contextmanager
def _sendable() -> Iterator[None]:
    """Raise :class:`ClusterError` for errors of ours: not every one can be sent as what it is."""
    try:
        yield
    except ClusterError:
        raise
    except LagrangeCasadiError as error:
        raise ClusterError(f"a worker failed: {error}") from None


def _evaluate(
    sent: bytes, task: Task, identity: Mapping[str, Json], p: Array, capacity: int
) -> list[bytes]:
    """Evaluate the columns of a block of designs on a worker."""
    with _sendable():
        with _building:
            harvest = _harvest(sent, task)
        _check_same(identity, harvest.signature)
        return harvest.chunks(p, capacity)


@functools.lru_cache(maxsize=4)
def _harvest(sent: bytes, task: Task) -> Harvest:
    return task.harvest(*pickle.loads(sent))


def _descend(sent: bytes, words: Mapping[str, Json], task: SearchTask) -> SearchRun:
    """Run a start on a worker."""
    with _sendable(), _searching:
        solver = _solver(sent)
        _check_same(words, solver.question.words(solver.engine))
        run = solver.descend(task, lambda *_: None)
    if run.ending == STOPPED:
        raise ClusterError("a worker was interrupted")
    return run


@functools.lru_cache(maxsize=4)
def _solver(sent: bytes) -> Solver:
    program, question = pickle.loads(sent)
    return Solver.of(question, DesignEngine.compiled(program, question.timing, question.method))

"""Who evaluates blocks: the workers of a Dask cluster. They are sent the case and designs, and send back columns."""

from __future__ import annotations

import asyncio
import functools
import importlib
import logging
import re
import tempfile
import threading
import time
import warnings
from collections.abc import Iterator, Mapping
from concurrent.futures import Future, wait
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..case import Case, load_case
from ..density import Array
from ..errors import ClusterError, DeclarationError, LagrangeCasadiError, one_line
from ..scene import Scene
from .blocks import Queue
from .columns import Harvest
from .plan import Plan, Task, difference, signature
from .workers import Blocks

_PATIENCE = 10.0
"""Seconds in which a scheduler must answer."""

_ADDRESS = re.compile(r"(tcp|tls|ws|wss|ucx)://\S+:\d{1,5}/?")
_PULSE, _GLANCE = 1.0, 2e-3
"""Seconds after which whoever waits for a block hears that none came, and between looks."""

_AHEAD = 2
"""Blocks sent out for each thread of the cluster."""

_building = threading.Lock()


@dataclass(frozen=True)
class Source:
    """A case as it is sent: its file's path and content. Where a worker has no such file, the content alone serves."""

    path: str
    content: str

    def load(self) -> Scene:
        """The scene."""
        path = Path(self.path)
        with suppress(OSError, UnicodeDecodeError):
            if path.read_text() == self.content:
                return load_case(path).scene
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder) / path.name
            copy.write_text(self.content)
            return load_case(copy).scene


@dataclass(frozen=True)
class Cluster:
    """The workers of the Dask scheduler at ``address``, all of which load ``case`` themselves.

    A block whose worker dies is sent to another one. Raises :class:`ClusterError` where Dask is not installed, the scheduler cannot
    be reached or is lost, or workers fail or have other versions.
    """

    address: str
    case: Case

    def __post_init__(self) -> None:
        if not _ADDRESS.fullmatch(self.address):
            raise DeclarationError(f"dask: expected an address like tcp://HOST:8786, got '{self.address}'")

    def results(self, plan: Plan, queue: Queue) -> Blocks:
        """Evaluate what is in the queue, in the order in which workers are done."""
        source = Source(str(self.case.path), self.case.path.read_text())
        told = signature(plan.scene, plan.task, plan.harvest.engine.provenance)
        _dask()
        with _silenced():
            connecting = _connecting(self.address)
            try:
                while not wait([connecting], _PULSE).done:
                    yield None
                    if queue.stopped:
                        return
                yield from self._served(self._connected(connecting), plan, queue, source, told)
            finally:
                connecting.add_done_callback(_let_go)

    def _served(self, client: Any, plan: Plan, queue: Queue, source: Source, told: Mapping[str, Any]) -> Blocks:
        waiting = _dask().as_completed(loop=client.loop)
        blocks: dict[Any, tuple[int, int]] = {}

        def send() -> None:
            most = max(1, _AHEAD * self._threads(client))
            while len(blocks) < most and (block := queue.take()):
                future = client.submit(_evaluate, source, plan.task, told, plan.block(*block), plan.room, pure=False)
                blocks[future] = block
                waiting.add(future)

        if not self._threads(client):
            warnings.warn(f"the scheduler at {self.address} has no workers yet; waiting for some", stacklevel=2)
        send()
        while blocks:
            future = _first(waiting)
            if future is None:
                yield None
                if client.status != "running":
                    raise self._lost()
                if queue.stopped and not self._threads(client):
                    return
                continue
            start, stop = blocks.pop(future)
            columns = self._result(future, start, stop)
            yield start, stop, columns
            del future, columns
            if client.status != "running":
                raise self._lost()
            send()

    def _connected(self, connecting: Future[Any]) -> Any:
        error = connecting.exception()
        if error is None:
            return connecting.result()
        if isinstance(error, (TimeoutError, asyncio.TimeoutError)):
            why = f"nothing came from there within {_PATIENCE:g} s"
        else:
            known = isinstance(error, (OSError, TypeError, ValueError, RuntimeError))
            why = one_line(error) if known else "what is there says nothing that a scheduler says"
        raise ClusterError(f"no Dask scheduler answers at {self.address}: {why}")

    def _result(self, future: Any, start: int, stop: int) -> list[bytes]:
        dask = _dask()
        try:
            columns: list[bytes] = future.result()
        except ClusterError:
            raise
        except dask.KilledWorker:
            raise ClusterError(f"every worker that was sent designs {start} to {stop - 1} has died") from None
        except (dask.CancelledError, OSError):
            raise self._lost() from None
        except Exception as error:
            raise ClusterError(f"a worker failed: {type(error).__name__}: {one_line(error)}") from None
        return columns

    def _threads(self, client: Any) -> int:
        """How many threads the workers have; workers come and go."""
        try:
            return sum(client.nthreads().values())
        except (_dask().CancelledError, OSError):
            raise self._lost() from None

    def _lost(self) -> ClusterError:
        return ClusterError(f"the Dask scheduler at {self.address} was lost")


def _connecting(address: str) -> Future[Any]:
    """A client, made in a thread of its own: what takes its time to answer, or never does, holds nobody up."""
    client: Future[Any] = Future()

    def connect() -> None:
        try:
            # A client of Dask's waits without end for what accepts a connection and then says nothing of Dask's. It gives up by
            # itself, and says why, where nothing accepts one: that comes first.
            asyncio.run(asyncio.wait_for(_greet(address), _PATIENCE + 1.0))
            client.set_result(_dask().Client(address, timeout=_PATIENCE, set_as_default=False))
        except Exception as error:
            client.set_exception(error)

    threading.Thread(target=connect, daemon=True).start()
    return client


async def _greet(address: str) -> None:
    """Ask what is at an address who it is. Raises ``OSError`` where that is no scheduler."""
    security = _dask().Security().get_connection_args("client")
    line = await importlib.import_module("distributed.comm").connect(address, timeout=_PATIENCE, **security)
    try:
        await line.write({"op": "identity", "reply": True})
        kind = (await line.read())["type"]
    finally:
        line.abort()
    if kind != "Scheduler":
        raise OSError(f"it is a {kind.lower()}")


def _let_go(client: Future[Any]) -> None:
    if client.exception() is None:
        with suppress(Exception):
            client.result().close(timeout=2)


def _first(waiting: Any) -> Any | None:
    """One that is done, or None where none is after a while."""
    end = time.monotonic() + _PULSE
    while not waiting.has_ready():
        if time.monotonic() > end:
            return None
        time.sleep(_GLANCE)
    return next(waiting)


def _dask() -> Any:
    try:
        return importlib.import_module("distributed")
    except ImportError:
        raise ClusterError("a cluster needs Dask; install it with: pip install 'lagrange_casadi[cluster]'") from None


@contextmanager
def _silenced() -> Iterator[None]:
    """Keep Dask's own log from saying at length what is said here in a line."""
    loggers = [logging.getLogger(name) for name in list(logging.root.manager.loggerDict) if name.startswith("distributed")]
    before = [(logger, logger.disabled) for logger in loggers]
    for logger in loggers:
        logger.disabled = True
    try:
        yield
    finally:
        for logger, disabled in before:
            logger.disabled = disabled


def _evaluate(source: Source, task: Task, told: Mapping[str, Any], p: Array, room: int) -> list[bytes]:
    """On a worker: the columns of a block of designs."""
    try:
        with _building:
            scene, harvest = _built(source, task)
        found = difference(told, signature(scene, task, harvest.engine.provenance))
        if found:
            raise ClusterError(f"a worker would not give the same numbers: {found} there")
        return harvest.chunks(p, room)
    except ClusterError:
        raise
    except LagrangeCasadiError as error:
        # Not every error of ours can be sent as what it is.
        raise ClusterError(f"a worker failed: {error}") from None


@functools.lru_cache(maxsize=4)
def _built(source: Source, task: Task) -> tuple[Scene, Harvest]:
    scene = task.scene(source.load())
    return scene, task.harvest(scene)

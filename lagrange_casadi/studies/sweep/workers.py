"""Blocks handed to threads of this process, or to the workers of an executor.

Workers of an executor are sent what is derived, compile it themselves, and are refused where their
numbers might differ.
"""

from __future__ import annotations

import functools
import pickle
import threading
from collections.abc import Callable, Generator, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, wait
from dataclasses import dataclass, fields
from itertools import islice
from queue import SimpleQueue
from typing import Any, Protocol, runtime_checkable

from ...base.arrays import Array, Json
from ...base.space import cores, memory
from ...errors import ClusterError, LagrangeCasadiError, one_line
from ..checkpoint import difference
from .columns import Harvest
from .design_blocks import Queue
from .plan import Plan

Blocks = Generator[tuple[int, int, list[bytes]] | None, None, None]
"""Blocks as they are done: designs from and to before, and their columns as the file keeps them;
None where nothing was done for a while, so that whoever waits may stop.
"""

_PULSE, _PATIENCE = 0.1, 0.7
"""Seconds after which whoever waits hears that nothing came, and in which blocks that are under way
may still end.
"""

_AHEAD = 128
"""Blocks that an executor is given at a time: for as many workers as it may have."""

making = threading.Lock()
"""Held while a worker compiles what it was sent."""


@runtime_checkable
class Executor(Protocol):
    """Caller of functions elsewhere, as the executors of :mod:`concurrent.futures` do."""

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> Future[Any]:
        """The future of a call."""


Workers = Callable[[Plan, Queue], Blocks]
"""Who evaluates what is in a queue, in any order; what was begun when it is stopped is given if it
ends within patience.
"""


def by_threads(count: int | None, plan: Plan, queue: Queue) -> Blocks:
    """Evaluate a queue by threads of this process, by default one a core, each at a block of its
    own; fewer where memory does not hold as many.
    """
    many = max(1, int(min(count or cores(), memory() / max(1, plan.harvest.engine.capacity))))
    given: SimpleQueue[Callable[[], None] | None] = SimpleQueue()

    def submit(start: int, stop: int) -> Future[Any]:
        future, block = Future[Any](), plan.block(start, stop)
        given.put(functools.partial(_carry_out, future, plan.harvest.chunks, block, plan.capacity))
        return future

    def work() -> None:
        for task in iter(given.get, None):
            task()
            del task  # else what it came to stays until there is another one

    # Python does not wait for such threads at its end, as it does for those of its own executors: a
    # block may take hours.
    for _ in range(many):
        threading.Thread(target=work, daemon=True).start()
    try:
        yield from handed(submit, queue, many + 1)
    finally:
        for _ in range(many):
            given.put(None)


def _carry_out(future: Future[Any], call: Callable[..., Any], *arguments: object) -> None:
    """Let a future be what a call comes to."""
    if future.set_running_or_notify_cancel():
        try:
            future.set_result(call(*arguments))
        except BaseException as error:
            future.set_exception(error)


def by_executor(executor: Executor, count: int | None, plan: Plan, queue: Queue) -> Blocks:
    """Evaluate a queue by the workers of an executor, which has ``count`` blocks at a time."""
    harvest = plan.harvest
    made = pickle.dumps(
        functools.partial(Harvest, *(getattr(harvest, one.name) for one in fields(harvest)))
    )

    def asked(start: int, stop: int) -> Asked:
        designs = plan.block(start, stop)
        return Asked(_evaluate, (made, harvest.signature, designs, plan.capacity))

    yield from by_workers(executor, asked, queue, count)


@dataclass(frozen=True)
class Asked:
    """A call that becomes what it comes to where it is unpickled."""

    function: Callable[..., Any]
    arguments: tuple[Any, ...]

    def __reduce__(self) -> tuple[Callable[..., object], tuple[object, ...]]:
        """The call that unpickling it is."""
        return self.function, self.arguments


def handed(
    submit: Callable[[int, int], Future[Any]], queue: Queue, ahead: int
) -> Iterator[tuple[int, int, Any] | None]:
    """Yield the blocks of a queue with the results of their futures, as they are done; None if
    nothing came for a while.

    So many are under way at a time. When the queue is stopped those that have not begun are
    cancelled.
    """
    pending: dict[Future[Any], tuple[int, int]] = {}
    try:
        while True:
            if not queue.stopped:
                for block in islice(queue.blocks, ahead - len(pending)):
                    pending[submit(*block)] = block
            if not pending:
                return
            if queue.stopped:
                begun = [future for future in pending if not future.cancel()]
                for future in wait(begun, _PATIENCE).done:
                    yield (*pending[future], future.result())
                return
            ended = wait(pending, _PULSE, FIRST_COMPLETED).done
            if not ended:
                yield None
            # Those that come first are written first.
            for future in sorted(ended, key=pending.__getitem__):
                yield (*pending.pop(future), future.result())
    finally:
        for future in pending:
            future.cancel()


def by_workers(
    executor: Executor, asked: Callable[[int, int], Asked], queue: Queue, count: int | None = None
) -> Iterator[tuple[int, int, Any] | None]:
    """Yield what :func:`handed` does, of what workers are ``asked`` for each block.

    Raises :class:`ClusterError` where the executor is lost, or a worker fails or lacks the package.
    """
    # Dask's client has futures of its own, and an executor with those of Python.
    executor = executor.get_executor(pure=False) if hasattr(executor, "get_executor") else executor

    def submit(start: int, stop: int) -> Future[Any]:
        # As bytes: a scheduler needs not know this package.
        return executor.submit(pickle.loads, pickle.dumps(asked(start, stop)))

    try:
        yield from handed(submit, queue, count or _AHEAD)
    except LagrangeCasadiError:
        raise
    except CancelledError:
        raise ClusterError("the executor was shut down, or its scheduler was lost") from None
    except Exception as error:
        package = __name__.partition(".")[0]
        if isinstance(error, ModuleNotFoundError) and package in str(error):
            raise ClusterError(f"a worker has no {package}: install it there too") from None
        words = f"{type(error).__name__}: {one_line(error)}"
        raise ClusterError(f"a worker failed: {words}") from None


def check_same(asked: Mapping[str, Json], here: Mapping[str, Json]) -> None:
    """Raise :class:`ClusterError` if a worker's inputs ``here`` differ from those asked for."""
    if found := difference(asked, here):
        raise ClusterError(
            f"a worker would give other numbers than this machine: {found} on the worker;"
            " install the same there"
        )


@functools.lru_cache(maxsize=4)
def made(call: bytes) -> Any:
    """Object that a pickled call makes, once in a process."""
    return pickle.loads(call)()


def _evaluate(call: bytes, asked: Mapping[str, Json], p: Array, capacity: int) -> list[bytes]:
    """Evaluate the columns of a block of designs on a worker."""
    with making:
        harvest: Harvest = made(call)
    check_same(asked, harvest.signature)
    return harvest.chunks(p, capacity)

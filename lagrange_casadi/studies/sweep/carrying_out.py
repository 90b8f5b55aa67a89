"""A plan carried out: begin or go on, commit what workers give, join, and leave nothing
half-written whatever happens.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing
from itertools import accumulate, islice, pairwise
from pathlib import Path

from ...base.files import reporting, writing
from ...base.interrupts import uninterrupted
from ...errors import ClusterError, PathError, SizeError, StoppedError, StoreError, warn
from ...results.store.opening import VerifiedFile
from ..checkpoint import Checkpoint
from .axes import counted, grouped
from .design_blocks import Queue, blocks_in, designs_in, name_of
from .plan import Plan
from .reading import Sweep
from .sweep_file import check_names, joining
from .workers import Workers

Progress = Callable[[str, float, float], None]
"""Hears what is being done (``designs``, ``stopping`` them, ``file``), how much of it is done, and
of how much.
"""

_CATCHING_UP = 4
"""Parts joined for each that is committed, where there are more."""


def carry_out(
    plan: Plan, target: Path, workers: Workers, *, resume: bool, force: bool, progress: Progress
) -> VerifiedFile | None:
    """Carry out a plan into the file ``target``; what was seen of that, unless it was there
    already.

    ``resume`` goes on with what an earlier sweep left, ``force`` starts anew whatever is there.
    Raises :class:`BusyError`, :class:`PathError` or :class:`StoreError` where the file is another
    sweep's, :class:`StoppedError` after an interrupt.
    """
    check_names(plan)
    folder = Checkpoint.of(target, "sweep")
    with folder.opened(plan.identity, resume=resume, force=force):
        there = folder.target.exists()
        if there and not (resume or force):
            raise PathError(
                f"{target} exists: force=True replaces it, resume=True continues an unfinished"
                " sweep"
            )
        if there and not force and _is_done(folder, plan):
            folder.clear()
            return None
        verified = None
        try:
            with uninterrupted() as breathe:
                verified = _fill(folder, plan, workers, breathe, progress)
        except KeyboardInterrupt:
            if verified:  # it came when there was nothing left to interrupt
                return verified
            raise StoppedError(f"stopped; {_kept(folder, plan)}") from None
        except (StoreError, ClusterError, SizeError) as error:
            raise type(error)(f"{error}; {_kept(folder, plan)}") from None
        except MemoryError as error:
            raise SizeError(
                f"out of memory: {str(error) or 'fewer workers take less'}; {_kept(folder, plan)}"
            ) from None
        return verified


def _is_done(folder: Checkpoint, plan: Plan) -> bool:
    """Return whether the file that is there is that of the plan.

    Raises :class:`StoreError` where it is another, and the sweep was not to replace it.
    """
    try:
        before = Sweep.open(folder.target).identity
        folder.refuse_other(folder.target, before, plan.identity)
    except StoreError:
        if not folder.plan["forced"]:
            raise
        return False
    return True


def _kept(folder: Checkpoint, plan: Plan) -> str:
    kept = designs_in(folder.parts)
    return (
        f"{grouped(kept)} of {counted(plan.size)} are kept in {folder.path}: continue with"
        " resume=True"
        if kept
        else "nothing was done yet"
    )


def _fill(
    folder: Checkpoint,
    plan: Plan,
    workers: Workers,
    breathe: Callable[[], None],
    progress: Progress,
) -> VerifiedFile:
    """Commit what is missing, and meanwhile join what is there into the file."""
    there = blocks_in(folder.parts)
    every = plan.slabs() if there else ()
    stops = {start: stop for start, stop, _ in every if there.get(start) == stop}
    done = sum(stop - start for start, stop in stops.items())
    queue = Queue((start, stop) for start, stop, _ in plan.slabs() if start not in stops)
    with (
        reporting(folder.target),
        closing(workers(plan, queue)) as blocks,
        writing(folder.target, hdf5=True, within=folder.path) as bytes_,
    ):
        size = sum(folder.path_of(name_of(*block)).stat().st_size for block in stops.items())
        _require_space(folder, plan.axes_size)
        if words := plan.takes(done):
            warn(words)
        progress("designs", done, plan.size)
        with ExitStack() as stack:
            append: Callable[[Sequence[bytes]], None] | None = None
            joined = 0
            for block in blocks:
                if block:
                    start, stop, contents = block
                    size += _commit(folder, start, stop, contents)
                    stops[start] = stop
                    done += stop - start
                    progress("designs", done, plan.size)
                    _require_space(folder, size / done * (2 * plan.size - done - joined))
                try:
                    if (block or append) and not queue.stopped:
                        # While the file is laid out, other blocks are evaluated.
                        append = append or stack.enter_context(joining(plan, bytes_, breathe))
                        if block and start == joined:
                            append(contents)
                            joined = stop
                        for here, after in islice(_following(stops, joined), _CATCHING_UP):
                            append(_read(folder, here, after))
                            joined = after
                    breathe()
                except KeyboardInterrupt:
                    if not queue.stopped:
                        progress("stopping", done, plan.size)
                    queue.stopped = True
            breathe()
            append = append or stack.enter_context(joining(plan, bytes_, breathe))
            for here, after in _following(stops, joined):
                append(_read(folder, here, after))
                joined = after
                breathe()
                progress("file", joined, plan.size)
            if joined != plan.size:
                raise StoreError(
                    f"{folder.path}: no part continues after {counted(joined)} of"
                    f" {grouped(plan.size)}"
                )
        verified = VerifiedFile.of(bytes_.fileno())
    folder.clear()
    return verified


def _commit(folder: Checkpoint, start: int, stop: int, contents: Sequence[bytes]) -> int:
    """Make a block a part: a line of its columns' lengths, and the columns; how many bytes these
    take.
    """
    lengths = list(map(len, contents))
    folder.commit(name_of(start, stop), [f"{json.dumps(lengths)}\n".encode(), *contents])
    return sum(lengths)


def _read(folder: Checkpoint, start: int, stop: int) -> list[bytes]:
    """The columns of a block.

    Where its part is not what was committed it is deleted: raises :class:`StoreError`.
    """
    path, content = folder.path_of(name_of(start, stop)), folder.read(name_of(start, stop))
    if content is None:
        path.unlink(missing_ok=True)
        raise StoreError(f"{path} was damaged, and is deleted")
    lengths, _, columns = content.partition(b"\n")
    ends = accumulate(json.loads(lengths), initial=0)
    return [columns[first:last] for first, last in pairwise(ends)]


def _following(stops: Mapping[int, int], after: int) -> Iterator[tuple[int, int]]:
    """The blocks that follow one another, of those that are done."""
    while stop := stops.get(after):
        yield after, stop
        after = stop


def _require_space(folder: Checkpoint, size: float) -> None:
    """Raise :class:`StoreError` where the disk has less room than is still to be written, as parts
    are so far.
    """
    free = shutil.disk_usage(folder.target.parent).free
    if size > free:
        raise StoreError(
            f"cannot write {folder.target}: the rest of the file takes about"
            f" {size / 1e9:.3g} GB, and the disk has {free / 1e9:.3g} GB left"
        )

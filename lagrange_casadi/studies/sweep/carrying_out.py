"""A plan carried out: begin or go on, commit what workers give, join, and leave nothing
half-written whatever happens.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing
from itertools import islice
from pathlib import Path

from ...base.publish import check_writable, reporting, uninterrupted
from ...base.seal import VerifiedFile, seal
from ...errors import (
    ClusterError,
    DeclarationError,
    PathError,
    SizeError,
    StoppedError,
    StoreError,
    warn,
)
from .axes import counted, grouped
from .blocks import Queue
from .file import check_names, joining
from .parts import Folder, Part
from .plan import SCHEMA, Plan, difference
from .reading import Sweep
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
    if resume and force:
        raise DeclarationError(
            "resume and force exclude each other: continue with what is there, or start anew"
        )
    check_names(plan.designs, plan.harvest.axis, plan.columns)
    check_writable(target, hdf5=True)
    folder = Folder.of(target)
    with folder.locked():
        if _settled(folder, plan, resume, force):
            folder.remove()
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


def _kept(folder: Folder, plan: Plan) -> str:
    kept = folder.done()
    return (
        f"{grouped(kept)} of {counted(plan.size)} are kept in {folder.path}: continue with"
        " resume=True"
        if kept
        else "nothing was done yet"
    )


def _settled(folder: Folder, plan: Plan, resume: bool, force: bool) -> bool:
    """Return whether the file is there already; else the folder is ready to be filled, and that of
    another sweep was refused.
    """
    there = folder.target.exists()
    if folder.begun and not (resume or force):
        raise PathError(
            f"{folder.path} holds an unfinished sweep: continue with resume=True, or start anew"
            " with force=True"
        )
    if there and not (resume or force):
        raise PathError(
            f"{folder.target} exists: force=True replaces it, resume=True continues an unfinished"
            " sweep"
        )
    if not (folder.begun or force) and folder.done():
        raise PathError(
            f"{folder.path} holds parts, and no plan.json that describes them: force=True"
            " starts anew"
        )
    if force or not (folder.begun or there):
        folder.begin(plan.identity, forced=force)
        return False
    if folder.begun:
        _refuse_other(folder.path, difference(folder.identity, plan.identity))
        if there and not folder.forced and not _is_whole(folder.target, plan):
            raise PathError(
                f"{folder.target} has appeared since the sweep began: move it, or force=True starts"
                " anew"
            )
        return there and _is_whole(folder.target, plan)
    _refuse_other(folder.target, difference(Sweep.open(folder.target).identity, plan.identity))
    return True


def _is_whole(target: Path, plan: Plan) -> bool:
    """Return whether a kill came between the file and the end of its parts."""
    try:
        return difference(Sweep.open(target).identity, plan.identity) is None
    except StoreError:
        return False


def _refuse_other(place: Path, found: str | None) -> None:
    if found:
        raise StoreError(
            f"{place} is of another sweep: {found}; start anew with force=True, or write another"
            " file"
        )


def _fill(
    folder: Folder, plan: Plan, workers: Workers, breathe: Callable[[], None], progress: Progress
) -> VerifiedFile:
    """Commit what is missing, and meanwhile join what is there; then seal and publish it."""
    parts = {part.start: part for part in _fitting(folder, plan)}
    done, size = (
        sum(part.stop - part.start for part in parts.values()),
        sum(part.size for part in parts.values()),
    )
    queue = Queue((start, stop) for start, stop, _ in plan.slabs() if start not in parts)
    append: Callable[[Sequence[bytes]], None] | None = None
    joined = 0
    with (
        reporting(folder.target),
        closing(workers.results(plan, queue)) as blocks,
        ExitStack() as stack,
    ):
        _require_space(folder, plan.axes_size)
        if words := plan.takes(done):
            warn(words)
        progress("designs", done, plan.size)
        for block in blocks:
            if block:
                start, stop, contents = block
                parts[start] = folder.commit(start, stop, plan.columns, contents)
                done, size = done + stop - start, size + parts[start].size
                progress("designs", done, plan.size)
                _require_space(folder, size / done * (2 * plan.size - done - joined))
            try:
                if (block or append) and not queue.stopped:
                    # While the file is laid out, other blocks are evaluated.
                    append = append or stack.enter_context(joining(plan, folder.joined, breathe))
                    if block and start == joined:
                        append(contents)
                        joined = stop
                    for part in islice(_following(parts, joined), _CATCHING_UP):
                        append(part.read())
                        joined = part.stop
                breathe()
            except KeyboardInterrupt:
                if not queue.stopped:
                    progress("stopping", done, plan.size)
                queue.stop()
        breathe()
        append = append or stack.enter_context(joining(plan, folder.joined, breathe))
        for part in _following(parts, joined):
            append(part.read())
            joined = part.stop
            breathe()
            progress("file", joined, plan.size)
        if joined != plan.size:
            raise StoreError(
                f"{folder.path}: no part continues after {counted(joined)} of {grouped(plan.size)}"
            )
    with reporting(folder.target):
        verified = seal(folder.joined, SCHEMA)
    folder.publish()
    return verified


def _fitting(folder: Folder, plan: Plan) -> Iterator[Part]:
    """The parts that are blocks of a plan; others are removed, and done again."""
    there, columns = list(folder.parts()), tuple(column.name for column in plan.columns)
    starts = {part.start for part in there}
    stops = {start: stop for start, stop, _ in plan.slabs() if start in starts} if there else {}
    for part in there:
        if part.columns == columns and stops.get(part.start) == part.stop:
            yield part
        else:
            part.path.unlink()


def _following(parts: Mapping[int, Part], after: int) -> Iterator[Part]:
    """The parts that follow one another."""
    while part := parts.get(after):
        after = part.stop
        yield part


def _require_space(folder: Folder, size: float) -> None:
    """Raise :class:`StoreError` where the disk has less room than is still to be written, as parts
    are so far.
    """
    free = shutil.disk_usage(folder.target.parent).free
    if size > free:
        raise StoreError(
            f"cannot write {folder.target}: the rest of the file takes about"
            f" {size / 1e9:.3g} GB, and the disk has {free / 1e9:.3g} GB left"
        )

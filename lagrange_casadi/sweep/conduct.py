"""A plan carried out: begin or go on, commit what workers give, join, and leave nothing half-written whatever happens."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

from ..errors import ClusterError, DeclarationError, PathError, StoppedError, StoreError
from ..publish import check_writable, uninterrupted
from .blocks import Cutter
from .file import check_names, join
from .parts import Folder, missing, telling
from .plan import Plan, difference
from .reading import identity_of
from .workers import Workers

Progress = Callable[[str, float, float], None]
"""Hears what is being done (``designs``, ``file``), how much of it is done, and of how much."""


def conduct(plan: Plan, target: Path, workers: Workers, *, resume: bool, force: bool, progress: Progress) -> None:
    """Carry out a plan into the file ``target``.

    ``resume`` goes on with what an earlier sweep left, ``force`` starts anew whatever is there. Raises :class:`BusyError`,
    :class:`PathError` or :class:`StoreError` where the file is another sweep's, :class:`StoppedError` after an interrupt.
    """
    if resume and force:
        raise DeclarationError("resume and force exclude each other: go on with what is there, or start anew")
    check_names(plan.designs)
    check_writable(target)
    folder = Folder(target)
    with folder.locked():
        if _settled(folder, plan, resume, force):
            folder.remove()
            return
        finished = False
        try:
            with uninterrupted() as breathe:
                _fill(folder, plan, workers, breathe, progress)
                finished = True
        except KeyboardInterrupt:
            if finished:  # it came when there was nothing left to interrupt
                return
            raise StoppedError(f"stopped; {_kept(folder, plan)}") from None
        except (StoreError, ClusterError) as error:
            raise type(error)(f"{error}; {_kept(folder, plan)}") from None


def _kept(folder: Folder, plan: Plan) -> str:
    kept = sum(part.stop - part.start for part in folder.parts())
    count = f"{kept:,} of {plan.size:,} designs".replace(",", " ")
    return f"{count} are kept in {folder.path}: go on with resume=True" if kept else "nothing was done yet"


def _settled(folder: Folder, plan: Plan, resume: bool, force: bool) -> bool:
    """Whether the file is there already; else the folder is ready to be filled, and what is another sweep's was refused."""
    there = folder.target.exists()
    if folder.begun and not (resume or force):
        raise PathError(f"{folder.path} holds an unfinished sweep: go on with resume=True, or start anew with force=True")
    if there and not (resume or force):
        raise PathError(f"{folder.target} exists: force=True replaces it, resume=True goes on with a sweep that was not finished")
    if force or not (folder.begun or there):
        folder.begin(plan.identity, forced=force)
        return False
    if folder.begun:
        _refuse_other(folder.path, difference(folder.identity, plan.identity))
        if there and not folder.forced and not _is_whole(folder.target, plan):
            raise PathError(f"{folder.target} is there now, which was not when the sweep began: move it, or force=True starts anew")
        return there and _is_whole(folder.target, plan)
    _refuse_other(folder.target, difference(identity_of(folder.target), plan.identity))
    return True


def _is_whole(target: Path, plan: Plan) -> bool:
    """Whether a kill came between the file and the end of its parts."""
    try:
        return difference(identity_of(target), plan.identity) is None
    except StoreError:
        return False


def _refuse_other(place: Path, found: str | None) -> None:
    if found:
        raise StoreError(f"{place} is of another sweep: {found}; start anew with force=True, or write another file")


def _fill(folder: Folder, plan: Plan, workers: Workers, breathe: Callable[[], None], progress: Progress) -> None:
    parts = folder.parts()
    gaps = missing(parts, plan.size)
    done = plan.size - sum(stop - start for start, stop in gaps)
    _require_room(folder, plan, plan.size - done)
    progress("designs", done, plan.size)
    cutter = Cutter(gaps, plan.harvest.bytes_per_design)
    for block in workers.results(plan, cutter):
        if block is not None:
            start, stop, arrays = block
            folder.commit(start, stop, plan.columns, arrays)
            done += stop - start
            progress("designs", done, plan.size)
        try:
            breathe()
        except KeyboardInterrupt:
            cutter.stop()
    breathe()
    with telling(folder.target):
        join(plan, folder.parts(), folder.joined, breathe, lambda share: progress("file", share, 1.0))
    folder.publish()


def _require_room(folder: Folder, plan: Plan, designs: int) -> None:
    """Raise :class:`StoreError` where the disk has less room than the parts take that are still to come."""
    size = designs * sum(column.width for column in plan.columns)
    free = shutil.disk_usage(folder.target.parent).free
    if size > free:
        raise StoreError(
            f"cannot write {folder.target}: its designs take {size / 1e9:.4g} GB before they are joined, and the disk has "
            f"{free / 1e9:.3g} GB left"
        )

"""Locks of open files and folders, which end with their process."""

from __future__ import annotations

try:
    import fcntl
except ImportError:  # where there is none, nothing keeps two processes apart
    fcntl = None  # type: ignore[assignment]


def lock(number: int, *, shared: bool = False, wait: bool = False) -> bool:
    """Lock what is open under a number, and return whether this machine has locks.

    Raises ``BlockingIOError`` where another process holds it and ``wait`` is not asked for.
    """
    if fcntl is None:
        return False
    fcntl.flock(number, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | (not wait and fcntl.LOCK_NB))
    return True

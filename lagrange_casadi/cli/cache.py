"""``lagrange-casadi cache``: what is kept of what was derived and compiled."""

from __future__ import annotations

import os

from ..base import cache as kept
from ..errors import StoreError
from ..studies.sweep.axes import counted
from .echo import echo


def cache(
    *,
    clear: bool = False,
) -> None:
    """Show the cache of graphs and compiled libraries, or empty it.

    It lists the folder, its size, and the limit of that.

    Parameters
    ----------
    clear
        Remove all graphs and libraries from the cache.
    """
    place, most = kept.place(), kept.limit()
    try:
        entries = list(kept.entries(place).values()) if place.exists() else []
        distrusted = kept.distrusted(place) if place.exists() else ""
    except OSError as error:
        raise StoreError(f"cannot read {place}: {error.strerror}") from None
    names = [os.path.splitext(file)[1] for entry in entries for file in entry.files]
    size = sum(entry.size for entry in entries)
    libraries = counted(names.count(".so"), "library").replace("librarys", "libraries")
    if distrusted:
        echo(f"note: {place} is not used, because {distrusted}", err=True)
    what = f"{counted(names.count('.graph'), 'graph')}, {libraries}, {size / 1e6:.3g} MB"
    if not clear:
        echo(
            f"{place}: {what} in {counted(len(names), 'file')}",
            f"limit: {most / 1e6:g} MB, least recently used files are removed first;"
            f" ${kept.VARIABLE} sets another",
        )
        return
    removed = kept.remove(entries)
    if removed < size:
        raise StoreError(
            f"cannot remove all cached files in {place}: {(size - removed) / 1e6:.3g} MB are left"
        )
    echo(f"{place}: removed {what}")

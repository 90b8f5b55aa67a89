"""Files of an older run that a run replaces, and those that stay."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import suppress
from pathlib import Path

_LISTED = 6


def figures_in(folder: Path | None) -> set[str]:
    """The names of the pictures in a folder; none where there is no folder, or none that can be
    read.
    """
    with suppress(OSError):
        files = folder.iterdir() if folder else ()
        return {path.name for path in files if path.suffix in (".png", ".svg")}
    return set()


def replaced_lines(
    file: Path, replaced: bool, folder: Path | None, before: Collection[str], drawn: Collection[str]
) -> Iterator[str]:
    """Say whether the file was replaced, how many figures were, and which ones ``before`` in the
    folder are older than the file.
    """
    over = [name for name in before if name in drawn]
    what = [str(file)] if replaced else []
    if over:
        what.append(f"{len(over)} figure{'s' if len(over) > 1 else ''} in {folder}/")
    if what:
        yield f"replaced {' and '.join(what)}"
    older = sorted(set(before) - set(drawn))
    if older:
        more = f" and {len(older) - _LISTED} more" if len(older) > _LISTED else ""
        redraw = "" if drawn else f"; lagrange-casadi plot {file} --out {folder} draws them anew"
        yield (
            f"note: figures in {folder}/ that are older than {file}:"
            f" {', '.join(older[:_LISTED])}{more}{redraw}"
        )

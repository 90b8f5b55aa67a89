"""Folders that are filled, and filled again: a manifest lists the files that this package wrote,
with a digest of each.

The manifest is written before the files. For files that are replaced, it also has the old digests,
so all files are known if the process is killed between two of them. When the files are complete,
the manifest lists only these.
"""

from __future__ import annotations

import json
import os
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import PathError
from .files import beside, check_writable, digest, put, refuse_other, reporting, settled, writing


@contextmanager
def filling(folder: Path, first: str = "") -> Iterator[Path]:
    """A temporary folder to fill, which on success becomes ``folder``, or whose files move into it;
    on any failure it is removed.

    Into a folder that is there, the file of the name ``first`` moves before the others.
    """
    check_writable(folder, folder=True)
    place = settled(folder)
    # What is mounted there takes no file from beside it by a new name.
    within = place / place.name if os.path.ismount(place) else place
    with reporting(folder), beside(within) as work:
        draft = work / place.name
        draft.mkdir()
        yield draft
        if not os.path.lexists(place):
            os.rename(draft, place)
            return
        files = sorted(draft.iterdir(), key=lambda file: (file.name != first, file))
        for file in files:
            refuse_other(folder / file.name)
        for file in files:
            put(file, folder / file.name)


@dataclass(frozen=True)
class Manifest:
    """A kind of manifest: its file's name and schema, and in words what is done, what was, and the
    way out.
    """

    name: str
    schema: str
    does: str
    earlier: str
    way_out: str

    def known(self, folder: Path) -> dict[str, tuple[str, ...]]:
        """Files that earlier times wrote, and their digests; none where there is no manifest of
        this kind.
        """
        try:
            content = json.loads((folder / self.name).read_text(encoding="utf-8"))
            files, before = (
                (content["files"], content.get("before", {}))
                if content["schema"] == self.schema
                else ({}, {})
            )
            return {
                str(name): tuple(str(by[name]) for by in (files, before) if name in by)
                for name in files | before
            }
        except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
            return {}

    def check(
        self,
        folder: Path,
        files: Collection[str] = (),
        *,
        beside: bool | None = None,
        changed: bool = False,
        apart: str = "",
    ) -> dict[str, str]:
        """The files that an earlier time wrote and nobody changed, and their digests, if ``files``
        may be written.

        Other files may be there if ``beside``, by default if there is a manifest; hidden ones, and
        the one ``apart``, always. What was changed since may be replaced if ``changed``. Raises
        :class:`PathError` else, and for a name in ``files`` that a file of somebody else has.
        """
        if not folder.exists():
            return {}
        with reporting(folder):
            known = self.known(folder)
            present = {path.name for path in folder.iterdir() if not path.name.startswith(".")}
            present -= {apart, *([self.name] if known else [])}
            files_there = [folder / name for name in present & known.keys()]
            found = {
                path.name: digest(path.read_bytes())
                for path in files_there
                if path.is_file() and not path.is_symlink()
            }
        same = {name: found[name] for name in sorted(found) if found[name] in known[name]}
        foreign = sorted(present - known.keys())
        touched = sorted(present & known.keys() - same.keys())
        refused = f"cannot {self.does} {folder}:"
        for name in foreign:
            if name in files or name == self.name:
                raise PathError(
                    f"{refused} '{name}' there is no file of {self.earlier}; move it, or choose"
                    " another folder"
                )
        if foreign and not (bool(known) if beside is None else beside):
            raise PathError(
                f"{refused} it holds other files, '{foreign[0]}' among them; {self.way_out}"
            )
        if touched and not changed:
            raise PathError(
                f"{refused} it holds {self.earlier} whose '{touched[0]}' was changed since;"
                f" {self.way_out}"
            )
        return same

    def text(
        self,
        files: Mapping[str, str],
        more: Mapping[str, object],
        before: Mapping[str, str] | None = None,
    ) -> bytes:
        """The manifest of files by their digests, with what ``more`` it has, and digests of those
        that go, ``before`` they do.
        """
        content = {
            "schema": self.schema,
            "schema_version": 1,
            **more,
            "files": dict(sorted(files.items())),
            **({"before": dict(sorted(before.items()))} if before else {}),
        }
        return f"{json.dumps(content, indent=1)}\n".encode()

    @contextmanager
    def filling(
        self,
        folder: Path,
        more: Mapping[str, object] | None = None,
        *,
        alone: bool = False,
        **allowed: Any,
    ) -> Iterator[Path]:
        """A temporary folder to fill, as that of :func:`filling`, to whose files the manifest is
        added.

        What is ours in ``folder`` and was not written again stays, and stays known; or goes, where
        what is written is ``alone``. Raises what :meth:`check` does, with what is ``allowed``.
        """
        more = more or {}
        with filling(folder, self.name) as draft:
            yield draft
            written = {
                path.name: digest(path.read_bytes()) for path in draft.iterdir() if path.is_file()
            }
            same = self.check(folder, written, **allowed)
            files = written if alone else same | written
            before = {name: known for name, known in same.items() if files.get(name) != known}
            (draft / self.name).write_bytes(self.text(files, more, before))
        with reporting(folder):
            for name in before.keys() - files.keys():
                (folder / name).unlink()
        # Though nothing went: it removes the draft of one that was killed here.
        with writing(folder / self.name) as file:
            file.write(self.text(files, more))

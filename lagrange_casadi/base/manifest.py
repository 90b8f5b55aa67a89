"""Folders that are written again: a manifest lists the files that this package wrote, with a digest
of each.

The manifest is written before the files. For files that are replaced, it also has the old digests,
so all files are known if the process is killed between two of them. When the files are complete,
the manifest lists only these.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import PathError
from .publish import filling, replacing, reporting


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
                path.name: digest(path)
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
        more: Mapping[str, object] | None = None,
        before: Mapping[str, str] | None = None,
    ) -> str:
        """The manifest of files by their digests, with what ``more`` it has, and digests of those
        that go, ``before`` they do.
        """
        content = {
            "schema": self.schema,
            "schema_version": 1,
            **(more or {}),
            "files": dict(sorted(files.items())),
        }
        return (
            json.dumps(
                content | ({"before": dict(sorted(before.items()))} if before else {}), indent=1
            )
            + "\n"
        )

    @contextmanager
    def filling(
        self,
        folder: Path,
        more: Mapping[str, object] | None = None,
        *,
        alone: bool = False,
        **allowed: Any,
    ) -> Iterator[Path]:
        """A temporary folder to fill, as that of :func:`.publish.filling`, to whose files the
        manifest is added.

        What is ours in ``folder`` and was not written again stays, and stays known; or goes, where
        what is written is ``alone``. Raises what :meth:`check` does, with what is ``allowed``.
        """
        with filling(folder, self.name) as draft:
            yield draft
            written = {path.name: digest(path) for path in draft.iterdir() if path.is_file()}
            same = self.check(folder, written, **allowed)
            files = written if alone else same | written
            before = {name: known for name, known in same.items() if files.get(name) != known}
            _write(draft / self.name, self.text(files, more, before))
        with reporting(folder):
            for name in before.keys() - files.keys():
                (folder / name).unlink()
        with replacing(
            folder / self.name
        ) as draft_folder:  # though nothing went: it removes the draft of one that was killed here
            _write(draft_folder, self.text(files, more))


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8", newline="\n")


def digest(file: Path | bytes) -> str:
    """The SHA-256 of a file, or of bytes. Raises ``OSError``."""
    return hashlib.sha256(file if isinstance(file, bytes) else file.read_bytes()).hexdigest()

"""Tutorials, how-to guides and answers: every block is run, and prints what its page says."""

import contextlib
import io
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).parent.parent / "docs"
PAGES = sorted(
    page.relative_to(DOCS).with_suffix("").as_posix()
    for folder in ("tutorials", "howto", "gallery/questions")
    for page in (DOCS / folder).glob("*.md")
    if page.stem != "index"
)


PAGES.sort(key="howto/cluster".__eq__)  # last: what it builds is built otherwise from there on


def blocks(page):
    """Yield the language, the text and the stated result of each fenced block, but for results."""
    text = (DOCS / f"{page}.md").read_text()
    fences = re.findall(r"^```(\w+)\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)
    for (language, text), following in zip(fences, [*fences[1:], ("", "")], strict=True):
        if language != "text":
            yield language, text, following[1] if following[0] == "text" else ""


def run_python(text, names):
    """Execute a block with the names of the blocks before it, and return what it prints."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(text, "block", "exec"), names)
    return printed.getvalue()


def run_commands(text):
    """Run commands as a shell does; the last one may fail if the page shows an error."""
    folders = [str(Path(sys.executable).parent), os.environ["PATH"]]
    environment = os.environ | {"PATH": os.pathsep.join(folders), "COLUMNS": "120"}
    done = subprocess.run(["bash", "-c", text], capture_output=True, text=True, env=environment)
    assert done.returncode == 0 or "error:" in done.stderr, done.stderr
    return done.stdout + done.stderr


def missing(stated, printed):
    """Return the first stated piece that is not printed; an ellipsis stands for anything."""
    rest = " ".join(printed.split())
    for piece in filter(None, (" ".join(part.split()) for part in stated.split("..."))):
        _, found, rest = rest.partition(piece)
        if not found:
            return f"{piece!r} is not in:\n{printed}"
    return None


@pytest.mark.parametrize("page", PAGES)
def test_pages_run_and_print_what_they_say(page, tmp_path, monkeypatch, request):
    if page == "howto/cluster":  # whose workers want the same flags everywhere
        request.getfixturevalue("released")
    monkeypatch.chdir(tmp_path)
    names = {}
    found = list(blocks(page))
    assert found
    for language, text, stated in found:
        if language == "python":
            printed = run_python(text, names)
        elif language != "sh":  # a source that a command compiles; its first line is its name
            Path(text.partition("\n")[0].removeprefix("// ")).write_text(text)
            continue
        elif (tool := re.match(r"# needs (\S+)", text)) and not shutil.which(tool[1]):
            continue
        else:
            printed = run_commands(text)
        assert missing(stated, printed) is None, missing(stated, printed)

"""Tutorials, how-to guides and answers: every block is run, and prints what its page says. Examples
of other pages are run too.
"""

import contextlib
import io
import itertools
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from commands import missing

from lagrange_casadi.cli import main

DOCS = Path(__file__).parents[2] / "docs"
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


def is_own(line):
    """Whether a line is a command of this package alone, and needs no shell."""
    return re.fullmatch(r"lagrange-casadi [^|<>;&$*`]+", re.sub("'[^']*'", "", line)) is not None


def run_commands(text):
    """Run commands as a shell does; the last one may fail if the page shows an error.

    Our own need no process that imports the package anew.
    """
    folders = [str(Path(sys.executable).parent), os.environ["PATH"]]
    environment, printed = os.environ | {"PATH": os.pathsep.join(folders)}, io.StringIO()
    for own, lines in itertools.groupby(text.replace("\\\n", " ").splitlines(), is_own):
        if own:
            with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
                status = [main(shlex.split(line)[1:]) for line in lines][-1]
        else:
            asked = ["bash", "-c", "\n".join(lines)]
            done = subprocess.run(asked, capture_output=True, text=True, env=environment)
            printed.write(done.stdout + done.stderr)
            status = done.returncode
    assert status == 0 or "error:" in printed.getvalue(), printed.getvalue()
    return printed.getvalue()


@pytest.mark.parametrize("page", PAGES)
def test_pages_run_and_print_what_they_say(page, tmp_path, monkeypatch, request):
    if page == "howto/cluster":  # whose workers want the same flags everywhere
        request.getfixturevalue("released")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "120")
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


EXAMPLES = [
    "README.md",
    "docs/method.md",
    "docs/declaring.md",
    "docs/loads.md",
    "docs/machines.md",
    "docs/models.md",
    "docs/space.md",
    "docs/strength.md",
    "docs/sweeps.md",
    "docs/report.md",
    "docs/animations.md",
    "docs/optimise.md",
    "docs/reference/python.md",
]


@pytest.mark.sampled(2)
@pytest.mark.parametrize("page", EXAMPLES)
def test_examples_run(page, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", (DOCS.parent / page).read_text(), re.DOTALL)
    assert blocks
    for block in blocks:
        exec(compile(block, page, "exec"), {})

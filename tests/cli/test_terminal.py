"""What files hold never reaches a terminal as anything but text: no cursor moves, no colour, no
line that nobody wrote.
"""

import ast
import importlib.util
import json
import random
import re
import shutil
from pathlib import Path

import h5py
import pytest
from commands import command
from forging import attributes, forging

from lagrange_casadi.cli import main
from lagrange_casadi.errors import LagrangeCasadiError

CLI = Path(importlib.util.find_spec("lagrange_casadi.cli").origin).parent
WRITERS = {
    *("click.echo", "click.secho", "click.echo_via_pager"),
    *("print", "sys.stdout.write", "sys.stderr.write"),
}
CONTROLS = "\x1b[2J\x9b31m\r\n\x07\x00\u202e\u2028\ud800"
OBEYED = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u202e\u2028\ud800]")
SOME, MANY = 6, 400
LINES = ("info x.h5", "check x.h5", "table x.h5", "best x.h5 --minimise peak:effort:O")


def test_only_one_place_prints():
    """Whatever prints a line goes by the one function that escapes."""
    for path in CLI.glob("*.py"):
        nodes = ast.walk(ast.parse(path.read_text()))
        called = {ast.unparse(node) for node in nodes if isinstance(node, ast.Attribute | ast.Name)}
        assert called & WRITERS == ({"click.echo"} if path.name == "echo.py" else set()), path.name


def test_an_error_is_a_line_without_control_characters():
    told = str(LagrangeCasadiError(f"a \N{SNOWMAN} é{CONTROLS}b\n c"))
    assert told == "a \N{SNOWMAN} é" + r"\x1b[2J\x9b31m \x07\x00\u202e \ud800b c"


def words(tree):
    """The names and texts of JSON."""
    if isinstance(tree, str):
        yield tree
    elif isinstance(tree, dict | list):
        yield from (name for name in tree if isinstance(tree, dict))
        for below in tree.values() if isinstance(tree, dict) else tree:
            yield from words(below)


def told_by(file):
    """Attributes of a file that are texts: place, name and value."""
    return [found for found in attributes(file) if isinstance(found[2], str)]


def is_tree(text):
    return text[:1] in ("{", "[")


def texts(path):
    """Every word that stands in a file's attributes."""
    with h5py.File(path) as file:
        found = [value for _, _, value in told_by(file)]
    each = (words(json.loads(value)) if is_tree(value) else [value] for value in found)
    return sorted({word for some in each for word in some} - {""})


def respell(path, word, other):
    """Replace a word wherever it stands by itself in attributes of a file."""
    with forging(path) as file:
        for place, name, value in told_by(file):
            if is_tree(value):
                file[place].attrs[name] = value.replace(json.dumps(word), json.dumps(other))
            elif value == word:
                file[place].attrs[name] = other.encode(errors="ignore").decode()


ASKED = "CASE --t 0:0.08:5 --want effort --backend c --out"
MADE = {
    "run": f"run {ASKED} run.h5 --xi 0:1:3 --want section:rod --no-figures",
    "sweep": f"sweep {ASKED} sweep.h5 --grid l=0.2,0.3 --grid r=0.05,0.1 --quiet",
}


@pytest.mark.parametrize("kind", MADE)
@pytest.mark.parametrize("many", [SOME, pytest.param(MANY, marks=pytest.mark.long)])
def test_no_text_of_a_file_reaches_the_terminal_as_it_is(here, capsys, kind, many):
    """Each word of a file in turn with control characters behind it: what is believed and what is
    refused are told as text.
    """
    assert command(MADE[kind]) == 0
    every, shown, path = texts(f"{kind}.h5"), 0, here / "x.h5"
    for word in random.Random(2).sample(every, min(many, len(every))):
        for end in (CONTROLS[:-1].replace("\x00", "").replace("\n", "\nFAKE"), CONTROLS):
            shutil.copy(f"{kind}.h5", path)
            try:
                respell(path, word, word + end)
            except (TypeError, ValueError):  # HDF5 does not take it
                continue
            capsys.readouterr()
            for line in LINES:
                command(line)
            told = "".join(capsys.readouterr())
            assert not OBEYED.search(told), word
            assert "\nFAKE" not in told, word
            shown += r"\x1b[2J\x9b31m" in told
    assert shown


def test_names_of_files_are_escaped(here, capsys):
    (here / "a\x1b[2J.h5").write_bytes(b"x")
    assert main(["check", "a\x1b[2J.h5"]) == 1
    assert capsys.readouterr().err.startswith(r"error: a\x1b[2J.h5: ")
    assert main(["check", "no\x1b]0;x\x07.h5"]) == 2
    assert r"no\x1b]0;x\x07.h5" in capsys.readouterr().err

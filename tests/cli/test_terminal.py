"""What files hold never reaches a terminal as anything but text: no cursor moves, no colour, no
line that nobody wrote.
"""

import ast
import json
import random
import re
from pathlib import Path

import h5py
import pytest
import sweeps
from forging import forging
from internals import sweep

import lagrange_casadi.cli
from lagrange_casadi import evaluate, save
from lagrange_casadi.cli import main
from lagrange_casadi.errors import LagrangeCasadiError, escaped, one_line

CLI = Path(lagrange_casadi.cli.__file__).parent
WRITERS = {
    "click.echo",
    "click.secho",
    "click.echo_via_pager",
    "print",
    "sys.stdout.write",
    "sys.stderr.write",
}
CONTROLS = "\x1b[2J\x9b31m\r\n\x07\x00\u202e\u2028\ud800"
OBEYED = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u202e\u2028\ud800]")
SOME, MANY = 6, 400


def test_only_one_place_prints():
    """Whatever prints a line goes by the one function that escapes."""
    for path in CLI.glob("*.py"):
        nodes = ast.walk(ast.parse(path.read_text()))
        called = {
            ast.unparse(node) for node in nodes if isinstance(node, (ast.Attribute, ast.Name))
        }
        assert called & WRITERS == ({"click.echo"} if path.name == "echo.py" else set()), path.name


def test_control_characters_are_escaped_and_letters_are_not():
    told = r"\x1b[2J\x9b31m\r\n\x07\x00\u202e\u2028\ud800"
    assert escaped(f"\N{SNOWMAN} é{CONTROLS}") == f"\N{SNOWMAN} é{told}"
    assert escaped(told) == told
    for say in (str, one_line):
        for error in (ValueError, LagrangeCasadiError):
            if say is one_line or error is LagrangeCasadiError:
                assert (
                    say(error(f"a{CONTROLS}b\n c")) == r"a\x1b[2J\x9b31m \x07\x00\u202e \ud800b c"
                )


def words(tree):
    """The names and texts of JSON."""
    if isinstance(tree, str):
        yield tree
    elif isinstance(tree, (dict, list)):
        yield from (name for name in tree if isinstance(tree, dict))
        for below in tree.values() if isinstance(tree, dict) else tree:
            yield from words(below)


def attributes(h):
    """Every attribute of a file that is text: what bears it, its name, its value."""
    places = ["/"]
    h.visit(places.append)
    for place in places:
        for name, value in h[place].attrs.items():
            if isinstance(value, str) and name not in ("CLASS", "NAME"):
                yield h[place], name, value


def is_tree(text):
    return text[:1] in ("{", "[")


def texts(path):
    """Every word that stands in a file's attributes."""
    with h5py.File(path) as h:
        found = [value for _, _, value in attributes(h)]
    return sorted(
        {
            word
            for value in found
            for word in (words(json.loads(value)) if is_tree(value) else [value])
        }
        - {""}
    )


def respell(path, word, other):
    """Replace a word wherever it stands by itself in attributes of a file."""
    with forging(path) as h:
        for item, name, value in list(attributes(h)):
            if is_tree(value):
                item.attrs[name] = value.replace(json.dumps(word), json.dumps(other))
            elif value == word:
                item.attrs[name] = other.encode(errors="ignore").decode()


@pytest.fixture(params=["run", "sweep"])
def file(request, slider_crank, monkeypatch, here):
    if request.param == "run":
        save(
            evaluate(
                slider_crank.scene,
                t=(0, 0.08, 5),
                xi=(0, 1, 3),
                wanted=("effort", "section:rod"),
                backend="vm",
            ),
            here / "x.h5",
        )
        return here / "x.h5"
    sweeps.use(monkeypatch)
    return sweep(
        sweeps.scene(), {"l": [0.2, 0.3], "r": [0.05, 0.1]}, out=here / "x.h5", xi=(0, 1, 3)
    ).path


@pytest.mark.parametrize("many", [SOME, pytest.param(MANY, marks=pytest.mark.long)])
def test_no_text_of_a_file_reaches_the_terminal_as_it_is(file, capsys, many):
    """Each word of a file in turn with control characters behind it: what is believed and what is
    refused are told as text.
    """
    original, every, shown = file.read_bytes(), texts(file), 0
    for word in random.Random(2).sample(every, min(many, len(every))):
        for end in (CONTROLS[:-1].replace("\x00", "").replace("\n", "\nFAKE"), CONTROLS):
            file.write_bytes(original)
            try:
                respell(file, word, word + end)
            except (TypeError, ValueError):  # HDF5 does not take it
                continue
            for command in (
                ["info", "x.h5"],
                ["check", "x.h5"],
                ["table", "x.h5"],
                ["best", "x.h5", "--minimise", "peak:effort:O"],
            ):
                main(command)
                out, err = capsys.readouterr()
                assert not OBEYED.search(out + err), (word, command)
                assert "\nFAKE" not in out + err, (word, command)
                shown += r"\x1b[2J\x9b31m" in out + err
    assert shown


def test_names_of_files_are_escaped(here, capsys):
    (here / "a\x1b[2J.h5").write_bytes(b"x")
    assert main(["check", "a\x1b[2J.h5"]) == 1
    assert capsys.readouterr().err.startswith(r"error: a\x1b[2J.h5: ")
    assert main(["check", "no\x1b]0;x\x07.h5"]) == 2
    assert r"no\x1b]0;x\x07.h5" in capsys.readouterr().err

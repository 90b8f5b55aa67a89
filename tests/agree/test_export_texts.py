"""Texts that users give, in files that others compile, build and read: they are shown, and nothing
else comes of them.
"""

import json
import re
import shutil
import subprocess
from xml.etree import ElementTree

import matplotlib.pyplot as plt
import pytest
from compiled import cc, compilers, present
from hypothesis import given, settings
from hypothesis import strategies as st
from internals import label, naming, text
from matplotlib.cbook import is_math_text
from mechanisms import slider_crank
from stepped import iterated

from lagrange_casadi import Mechanism, Scene, evaluate, export, motion, sweep
from lagrange_casadi.cli import main
from lagrange_casadi.errors import DeclarationError

WICKED = [
    'x"),fopen("PWNED","w"),printf("',
    "x*/ int pwned; /*",
    "*\\/ int pwned; /\\*",
    '100 %s %n %d "quoted" \\',
    "what??/",
    "what??/\" ??' ??( trigraphs",
    "it's $HOME ${CMAKE_COMMAND} $<1:x> #[[ ]] <b>&amp;</b> | `rm` ",
    "// comment \\",
    "Kurbel\u2013Presse \u00b5m\u00b2 \U0001f600",
    "%{ %} '); system('touch PWNED'); ('",
    "</title><script>alert(1)</script>",
    "long" * 75,
]
LINES = st.text(
    st.characters(exclude_categories=["C", "Zs", "Zl", "Zp"], include_characters=" "), max_size=12
)


def arm(unit="m", name="arm"):
    m = Mechanism(name)
    m.revolute("O", m.ground, m.link("a", length=m.parameter("l", 0.5, unit, low=0.0), mass=1.0))
    return Scene(m, {"O": motion.polynomial(0, 2)}, t=(0, 1, 5))


def build_and_run(folder, prefix):
    """The self-test and the example, pedantically, as C and as C++; what they print."""
    said = []
    for kind, command in compilers():
        if present(command[0]):
            done = cc(
                command + (["-c"] if "++" in kind else []),
                folder,
                f"{prefix}.c",
                *([] if "++" in kind else ["selftest.c"]),
            )
            assert done.returncode == 0, done.stderr
    for source in ("selftest.c", "example.c"):
        done = cc(
            ["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"],
            folder,
            f"{prefix}.c",
            source,
        )
        assert done.returncode == 0, done.stderr
        ran = subprocess.run([folder / "program"], cwd=folder, capture_output=True, check=True)
        said.append(ran.stdout.decode())
    assert not (folder / "PWNED").exists()
    return said


@pytest.mark.sampled(13)
@pytest.mark.parametrize("wicked", WICKED)
def test_a_name_is_only_ever_shown(tmp_path, wicked):
    made = export(slider_crank(), tmp_path, name=wicked, wanted=["effort"])
    assert re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", made.prefix)
    selftest, _ = build_and_run(tmp_path, made.prefix)
    assert selftest.startswith(f"{wicked}: ")
    content = json.loads((tmp_path / "export.json").read_text())
    assert content["mechanism"] == wicked
    header = (tmp_path / f"{made.prefix}.h").read_text()
    assert header.count("*/") == header.count("/*")


@pytest.mark.sampled(13)
@pytest.mark.parametrize("wicked", WICKED)
def test_a_unit_is_only_ever_shown(tmp_path, wicked):
    made = export(arm(wicked), tmp_path, wanted=["effort"])
    build_and_run(tmp_path, made.prefix)
    header = (tmp_path / "arm.h").read_text()
    (struct,) = re.findall(r"typedef struct \{\n([^\n]*)\n\} arm_parameters;", header)
    assert re.fullmatch(r"  arm_real l; /\* [^\n]* \*/", struct)
    assert header.count("*/") == header.count("/*")
    content = json.loads((tmp_path / "export.json").read_text())
    assert content["parameters"][0]["unit"] == wicked


@pytest.mark.sampled(13)
@pytest.mark.skipif(shutil.which("cmake") is None, reason="needs cmake")
@pytest.mark.parametrize(
    "name",
    [
        *WICKED[:2],
        WICKED[6],
        "INTERFACE",
        "ZERO_CHECK",
        "RUN_TESTS",
        "ALL",
        "test",
        "install",
        "Package",
        "PROJECT",
        "Experimental",
    ],
)
def test_a_name_stops_no_build(tmp_path, name):
    folder, build = tmp_path / "c", tmp_path / "build"
    export(arm(), folder, name=name, wanted=["effort"])
    for command in (
        ["cmake", "-S", folder, "-B", build],
        ["cmake", "--build", build],
        ["ctest", "--test-dir", build],
        ["cmake", "--install", build, "--prefix", tmp_path / "installed"],
    ):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    assert not list(tmp_path.rglob("PWNED"))


@pytest.mark.parametrize(
    "name",
    [
        *(
            "INTERFACE",
            "ZERO_CHECK",
            "RUN_TESTS",
            "ALL",
            "all",
            "test",
            "Test",
            "install",
            "clean",
            "package",
            "ALL_BUILD",
            "CMAKE",
            "PROJECT",
        ),
        *(
            "con",
            "CON",
            "nul",
            "aux",
            "Prn",
            "com1",
            "lpt9",
            "example",
            "Selftest",
            "double",
            "class",
            "nullptr",
            "typeof",
            "constexpr",
        ),
        *(
            "errno",
            "math",
            "String",
            "unistd",
            "pthread",
            "stdio",
            "Windows",
            "matrix",
            "linux",
            "I",
            "EOF",
            "TRUE",
            "SEEK_SET",
            "debug",
        ),
    ],
)
def test_a_name_that_is_taken_is_another_one(name):
    assert naming.prefix(name) == f"{name}_mechanism"


@pytest.mark.parametrize(
    "name",
    [
        "slider_crank",
        "press",
        "engine",
        "interface_2",
        "Interface",
        "library",
        "A",
        "E1",
        "B0",
        "console",
    ],
)
def test_other_names_stay(name):
    assert naming.prefix(name) == name


def test_parameters_and_joints_may_be_called_as_macros_are(tmp_path):
    """Of ISO C's headers, which are all there before the exported header."""
    m = Mechanism("macros")
    names = [
        "NULL",
        "EOF",
        "M_PI",
        "INT_MAX",
        "SEEK_SET",
        "stdin",
        "errno",
        "SIGINT",
        "DBL_EPSILON",
        "true",
        "I",
        "SEAL",
        "EDOM",
    ]
    parts = [m.parameter(name, 0.1, "m", low=0.0) for name in names]
    first = m.link("NAN", length=sum(parts), mass=1.0)
    m.revolute("INFINITY", m.ground, first)
    m.revolute("RAND_MAX", first.tip, m.link("BUFSIZ", length=0.3, mass=1.0))
    scene = Scene(
        m, {"INFINITY": motion.polynomial(0, 1), "RAND_MAX": motion.polynomial(0, 2)}, t=(0, 1, 5)
    )
    made = export(scene, tmp_path)
    assert {f"parameter {name}": f"{name}_" for name in names}.items() <= made.mapped.items()
    headers = (
        "assert complex ctype errno fenv float inttypes limits locale math setjmp signal stdarg"
        " stdbool stddef stdint stdio stdlib"
    )
    first = "".join(
        f"#include <{header}.h>\n"
        for header in [*headers.split(), "string", "tgmath", "time", "wchar", "wctype"]
    )
    for file in ("macros.c", "selftest.c"):
        (tmp_path / file).write_text(first + (tmp_path / file).read_text())
    done = cc(["cc", "-std=gnu11"], tmp_path, "macros.c", "selftest.c")
    assert done.returncode == 0, done.stderr
    assert subprocess.run([tmp_path / "program"], check=False, capture_output=True).returncode == 0


def test_what_an_export_defines_is_no_members_name(tmp_path):
    made = export(iterated(), tmp_path, precision="single", newton=2)
    texts = [path.read_text() for path in tmp_path.glob("*.[ch]")]
    defined = {
        word
        for text in texts
        for word in re.findall(r"^ *#\s*define (\w+)(?!\()\b", text, re.MULTILINE)
    }
    own = {
        word for word in defined if not word.startswith((made.prefix.upper(), "CASADI", "casadi"))
    }
    assert own
    assert all(map(naming.reserved, own)), own


def test_links_that_differ_in_capitals_alone(tmp_path):
    m = Mechanism("two")
    links = [m.link(name, length=0.5, mass=1.0) for name in ("rod", "Rod", "ROD_2")]
    m.revolute("A", m.ground, links[0])
    m.revolute("B", links[0].tip, links[1])
    m.revolute("C", links[1].tip, links[2])
    scene = Scene(
        m, {name: motion.polynomial(0, k + 1) for k, name in enumerate("ABC")}, t=(0, 1, 5)
    )
    made = export(scene, tmp_path)
    assert [link.constant for link in made.links] == [
        "TWO_LINK_ROD",
        "TWO_LINK_ROD_2",
        "TWO_LINK_ROD_2_2",
    ]
    assert made.mapped == {"link Rod": "TWO_LINK_ROD_2", "link ROD_2": "TWO_LINK_ROD_2_2"}
    build_and_run(tmp_path, "two")


@pytest.mark.parametrize(
    "wicked", ["two\nlines", "tab\t", "nul\0", "\u202eright", "lone \udcff", "\x1b[31m", "\x85"]
)
def test_what_is_no_line_of_text_is_refused(tmp_path, wicked):
    for what in (lambda: export(slider_crank(), tmp_path, name=wicked), lambda: arm(wicked)):
        with pytest.raises(DeclarationError, match="must be a line of printable characters, got "):
            what()
    with pytest.raises(DeclarationError, match="unit: expected a text, got 7"):
        arm(7)
    with pytest.raises(
        DeclarationError,
        match=r"flags: expected options of a compiler, .*: they hold a null character",
    ):
        evaluate(arm(), flags="-DX=\0")
    assert not list(tmp_path.iterdir())


@settings(max_examples=20, deadline=None)
@given(lines=st.lists(LINES, min_size=1, max_size=40))
def test_any_line_is_what_c_reads(lines, tmp_path_factory):
    """In strings and formats, byte by byte, with trigraphs; and no comment ends in it."""
    folder = tmp_path_factory.mktemp("lines")
    prints = "".join(
        f'  /* {text.comment(line)} */ fputs("{text.quoted(line)}\\n", stdout);'
        f' printf("{text.printed(line)}\\n");\n'
        for line in lines
    )
    (folder / "x.c").write_text(
        f"#include <stdio.h>\nint main(void) {{\n{prints}  return 0;\n}}\n", encoding="utf-8"
    )
    assert cc(["cc", "-std=c99", "-Wall", "-Werror"], folder, "x.c").returncode == 0
    said = subprocess.run([folder / "program"], capture_output=True, check=True).stdout
    assert said.decode() == "".join(f"{line}\n{line}\n" for line in lines)


@given(LINES)
def test_a_comment_stays_one(line):
    shown = f"/* {text.comment(line)} */"
    assert shown.find("*/") == len(shown) - 2
    assert "/*" not in shown[2:]


@given(LINES)
def test_a_string_of_octave_stays_one(line):
    assert text.octave(line).replace("''", "").count("'") == 0
    assert re.sub(r"%%|\\\\", "", text.octave_printed(line)).strip("%\\") == re.sub(
        r"%%|\\\\", "", text.octave_printed(line)
    )


def test_a_unit_shows_in_a_figure_as_it_is(tmp_path):
    """A dollar begins no mathematics."""
    for unit in ("$", "US$/m$", r"$\frac{", "x_{1}^$"):
        found = sweep(arm(unit), {"l": (0.2, 0.3, 3)}, wanted=["effort"])
        figure, axes = plt.subplots()
        axes.set_xlabel(label(found, "l"))
        figure.canvas.draw()
        shown = axes.xaxis.label.get_text()
        plt.close(figure)
        assert not is_math_text(shown)
        assert unit in shown.replace(r"\$", "$")


@pytest.mark.long
def test_units_in_an_fmu(tmp_path):
    pytest.importorskip("fmpy")
    import zipfile

    for k, wicked in enumerate(WICKED):
        export(arm(wicked), tmp_path / str(k), name=wicked, fmu=True, wanted=["effort"])
        (path,) = (tmp_path / str(k)).glob("*.fmu")
        with zipfile.ZipFile(path) as archive:
            root = ElementTree.fromstring(archive.read("modelDescription.xml"))
            page = archive.read("documentation/index.html").decode()
        assert root.get("modelName") == wicked
        assert wicked in [unit.get("name") for unit in root.iter("Unit")]
        assert "<script>" not in page
    assert not list(tmp_path.rglob("PWNED"))


def test_from_the_command_line(here, capfd):
    case = here / "case.py"
    case.write_text(
        "from lagrange_casadi import Mechanism, Scene, motion\n"
        "def scene():\n"
        "    m = Mechanism('arm')\n"
        "    m.revolute('O', m.ground, m.link('a', length=1, mass=1))\n"
        "    return Scene(m, {'O': motion.polynomial(0, 1)}, t=(0, 1, 5))\n"
    )
    assert main(["export", str(case), "--out", "c", "--name", WICKED[0]]) == 0
    assert f"name {WICKED[0]} is called x_fopen_PWNED_w_printf in C" in capfd.readouterr().out
    assert main(["export", str(case), "--out", "d", "--name", "a\nb"]) == 2
    assert (
        capfd.readouterr().err
        == "error: name must be a line of printable characters, got 'a\\nb'\n"
    )
    assert sorted(path.name for path in here.iterdir() if path.name != "__pycache__") == [
        "c",
        "case.py",
    ]

"""Texts that users give, in files that others compile, build and read: they are shown, and nothing
else comes of them.
"""

import json
import re
import shutil
import subprocess

import pytest
from compiled import cc, compilers, present
from hypothesis import given, settings
from hypothesis import strategies as st
from internals import naming, text
from mechanisms import slider_crank
from stepped import iterated

from lagrange_casadi import Mechanism, Scene, evaluate, export, motion
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

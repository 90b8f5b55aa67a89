"""Code that was emitted or exported: compiled, and run."""

from __future__ import annotations

import stat
import subprocess
from importlib import resources

HEADER = resources.files("lagrange_casadi.engine.codegen").joinpath("lanes.h")
PEDANTIC = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-Wno-unused-parameter"]
STRICT = [*PEDANTIC, "-Wdouble-promotion", "-Wfloat-conversion"]


def fake_compiler(folder, monkeypatch, script, variable="CC"):
    program = folder / "fake-cc"
    program.write_text(f"#!/bin/sh\n{script}\n")
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv(variable, str(program))
    return program


TRIED = """  {
    @_model model;
    @_inputs inputs;
    @_outputs outputs;
    @_parameters parameters = @_defaults;
    @_status status;
    outputs.EFFORT = 1;
    %s
    printf("%%d %%g %%s\\n", (int) status, (double) outputs.EFFORT, @_message(status));
  }
"""

UNPREPARED = "status = @_prepare(&model, &parameters);"
PREPARED = "status = @_prepare(&model, &parameters); @_motion(&model, 0.01, &inputs); "
EVALUATED = "status = @_evaluate(&model, &inputs, &outputs);"


def cc(command, folder, *sources, output="program"):
    files = [folder / source for source in sources]
    linked = [] if "-c" in command else ["-lm"]
    return subprocess.run(
        [*command, *files, "-o", folder / output, *linked],
        capture_output=True,
        text=True,
        check=False,
    )


def compilers():
    """Those that there are, with the warnings that must not come."""
    strict = ["-pedantic", "-Wall", "-Wextra", "-Werror", "-Wconversion"]
    found = [("cc", ["cc", "-std=c99", *strict]), ("clang", ["clang", "-std=c99", *strict])]
    as_cpp = ["-pedantic", "-Wall", "-Wextra", "-Werror"]
    found += [
        ("g++", ["g++", "-x", "c++", "-std=c++11", *as_cpp]),
        ("clang++", ["clang++", "-x", "c++", "-std=c++17", *as_cpp]),
    ]
    return found


def present(command):
    try:
        return (
            subprocess.run([command, "--version"], capture_output=True, check=False).returncode == 0
        )
    except OSError:
        return False


def assert_clean(folder, prefix):
    """No compiler that there is warns of an exported folder. The first one looks into what is
    optimized too, and leaves SOURCE.o.
    """
    for label, command in compilers():
        own = [] if "++" in label else ["selftest.c", "example.c"]
        how = ["-O2", "-c"] if label == "cc" else ["-fsyntax-only", "-c"]
        for source in [f"{prefix}.c", *own] if present(command[0]) else []:
            result = cc([*command, *how], folder, source, output=f"{source}.o")
            assert result.returncode == 0, f"{label} {source}: {result.stderr}"


def told(folder, made, *tried):
    """What a program says that does these things, one after another, with an exported mechanism:
    the status, the effort of its drive and the sentence of each.
    """
    effort = next(member.name for member in made.outputs if member.name.startswith("effort_"))
    blocks = "".join(TRIED % statements for statements in tried).replace("EFFORT", effort)
    if f"{made.prefix}_defaults" not in (folder / f"{made.prefix}.h").read_text():
        blocks = blocks.replace("@_parameters parameters = @_defaults;", "")
    head = "\n".join(f"#include {name}" for name in ('"@.h"', "<math.h>", "<stdio.h>"))
    text = f"{head}\nint main(void) {{\n{blocks}  return 0;\n}}\n"
    (folder / "harness.c").write_text(text.replace("@", made.prefix))
    result = cc(["cc", "-std=c99"], folder, "harness.c", f"{made.prefix}.c")
    assert result.returncode == 0, result.stderr
    lines = subprocess.run(
        [folder / "program"], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    answers = [line.split(" ", 2) for line in lines]
    return [(int(status), float(effort), sentence) for status, effort, sentence in answers]

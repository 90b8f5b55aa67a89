"""The exported folder: what it holds, that it is clean C, that it fails loudly, and that it is the same bytes each time."""

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from builders import slider_crank
from test_codegen import spline_arm
from test_mobility import truss_platform

from lagrange_casadi import Mechanism, Scene, export, load_case, motion
from lagrange_casadi.errors import DeclarationError, PathError, SizeError, UnknownNameError

ARITHMETIC = [
    {},
    {"precision": "single"},
    {"newton": 2, "precision": "single"},
    {"table": 64},
    {"table": 64, "precision": "single"},
]
SCENES = {"slider_crank": slider_crank, "spline_arm": spline_arm, "truss_platform": truss_platform}
CASES = sorted(path.parent for path in (Path(__file__).parents[1] / "cases").glob("*/case.py"))


def keywords():
    """A mechanism whose names are words that C and C++ keep for themselves."""
    m = Mechanism("double")
    l = m.parameter("double", 0.5, "m", low=0.0)
    arm = m.link("int", length=l, mass=m.parameter("register", 2.0, "kg"))
    m.revolute("class", m.ground, arm)
    return Scene(m, {"class": motion.polynomial(0, 2)}, t=(0, 1, 11))


def cc(command, folder, *sources, output="program"):
    files = [folder / source for source in sources]
    linked = [] if "-c" in command else ["-lm"]
    return subprocess.run([*command, *files, "-o", folder / output, *linked], capture_output=True, text=True, check=False)


def compilers():
    """Those that there are, with the warnings that must not come."""
    strict = ["-pedantic", "-Wall", "-Wextra", "-Werror", "-Wconversion"]
    found = [("gcc", ["gcc", "-std=c99", *strict]), ("clang", ["clang", "-std=c99", *strict])]
    as_cpp = ["-pedantic", "-Wall", "-Wextra", "-Werror"]
    found += [("g++", ["g++", "-x", "c++", "-std=c++11", *as_cpp]), ("clang++", ["clang++", "-x", "c++", "-std=c++17", *as_cpp])]
    return found


def present(command):
    try:
        return subprocess.run([command, "--version"], capture_output=True, check=False).returncode == 0
    except OSError:
        return False


# Only one drive that turns has a cycle to be read from a table.
@pytest.mark.parametrize(
    ("name", "options"), [(n, o) for n in SCENES for o in ARITHMETIC if n == "slider_crank" or "table" not in o], ids=str
)
def test_the_source_is_clean(name, options, tmp_path):
    clean(SCENES[name](), tmp_path, options, compilers())


@pytest.mark.parametrize("options", ARITHMETIC[:2], ids=str)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_the_source_of_every_case_is_clean(case, options, tmp_path):
    clean(load_case(case).scene, tmp_path, options, compilers()[:2])


def clean(scene, folder, options, commands):
    made = export(scene, folder, **options)
    for label, command in commands:
        if not present(command[0]):
            continue
        programs = [f"{made.prefix}.c"] if "++" in label else [f"{made.prefix}.c", "selftest.c", "example.c"]
        for source in programs:
            result = cc([*command, "-O2", "-c"], folder, source, output="x.o")
            assert result.returncode == 0, f"{label} {source}: {result.stderr}"


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("options", ARITHMETIC[:3], ids=str)
def test_the_self_test_passes_under_sanitizers(name, options, tmp_path):
    made = export(SCENES[name](), tmp_path, **options)
    sanitized = ["cc", "-std=c99", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    result = cc(sanitized, tmp_path, f"{made.prefix}.c", "selftest.c")
    if "cannot find" in result.stderr:
        pytest.skip("this compiler has no sanitizers' libraries")
    assert result.returncode == 0, result.stderr
    ran = subprocess.run([tmp_path / "program"], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert "0 wrong" in ran.stdout


def test_the_self_test_passes_under_valgrind(tmp_path):
    if not present("valgrind"):
        pytest.skip("needs valgrind")
    made = export(slider_crank(), tmp_path)
    assert cc(["cc", "-std=c99", "-O1", "-g"], tmp_path, f"{made.prefix}.c", "selftest.c").returncode == 0
    command = ["valgrind", "-q", "--error-exitcode=9", "--leak-check=full", tmp_path / "program"]
    assert subprocess.run(command, capture_output=True, check=False).returncode == 0


def test_the_self_test_can_fail(tmp_path):
    made = export(slider_crank(), tmp_path)
    source = (tmp_path / "selftest.c").read_text()
    _, _, rows = source.partition("outputs_at[INSTANTS][OUTPUTS] = {\n  {")
    first = rows.partition(",")[0]
    (tmp_path / "selftest.c").write_text(source.replace(rows, rows.replace(first, f"{float(first) + 1e-3!r}", 1)))
    assert cc(["cc", "-std=c99"], tmp_path, f"{made.prefix}.c", "selftest.c").returncode == 0
    ran = subprocess.run([tmp_path / "program"], capture_output=True, text=True, check=False)
    assert ran.returncode == 1
    assert f"wrong: {made.outputs[0].name} is" in ran.stdout


def symbols(folder, prefix):
    assert cc(["cc", "-std=c99", "-O2", "-c"], folder, f"{prefix}.c", output="x.o").returncode == 0
    lines = subprocess.run(["nm", folder / "x.o"], capture_output=True, text=True, check=True).stdout.splitlines()
    return [line.split()[-2:] for line in lines]


@pytest.mark.parametrize("options", ARITHMETIC, ids=str)
def test_only_prefixed_symbols_are_seen_and_only_libm_is_needed(options, tmp_path):
    made = export(slider_crank(), tmp_path, **options)
    found = symbols(tmp_path, made.prefix)
    assert all(name.startswith(f"{made.prefix}_") for kind, name in found if kind in "TDRBC")
    assert not [name for kind, name in found if kind in "DdBbC"], "no state"
    needed = {name for kind, name in found if kind == "U"} - {"_GLOBAL_OFFSET_TABLE_", "memset", "memcpy"}
    functions = {"sin", "cos", "sincos", "atan2", "sqrt", "ceil", "floor", "fmax"}
    suffix = "f" if options.get("precision") == "single" else ""
    assert needed <= {name + suffix for name in functions}


def test_a_table_needs_no_sine(tmp_path):
    made = export(slider_crank(wanted=["effort"]), tmp_path, table=64, precision="single")
    assert {name for kind, name in symbols(tmp_path, made.prefix) if kind == "U"} <= {"floorf", "_GLOBAL_OFFSET_TABLE_"}


def test_nothing_recurs_allocates_or_is_of_another_precision(tmp_path):
    made = export(slider_crank(), tmp_path, precision="single")
    text = (tmp_path / f"{made.prefix}.c").read_text()
    assert not re.search(r"\b(malloc|calloc|realloc|free|alloca)\b", text)
    assert not re.search(r"\bdouble\b", text)
    assert not re.search(r"(?<![\w.])\d+\.\d*(e[+-]?\d+)?(?![\w.])", re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL))


HARNESS = """
#include "@.h"
#include <math.h>
#include <stdio.h>
int main(void) {
  @_model model;
  @_inputs inputs;
  @_outputs outputs;
  @_parameters parameters = @_defaults;
  @_status status;
  outputs.effort_O = 1;
  %s
  printf("%%d %%g %%s", (int) status, (double) outputs.effort_O, @_message(status));
  return 0;
}
"""


def told(folder, made, statements):
    """What a program says that does this with an exported slider-crank."""
    (folder / "harness.c").write_text((HARNESS % statements).replace("@", made.prefix))
    result = cc(["cc", "-std=c99"], folder, "harness.c", f"{made.prefix}.c")
    assert result.returncode == 0, result.stderr
    status, effort, sentence = subprocess.run([folder / "program"], capture_output=True, text=True, check=True).stdout.split(" ", 2)
    return int(status), float(effort), sentence


PREPARED = "status = @_prepare(&model, &parameters); @_motion(&model, 0.01, &inputs); "
EVALUATED = "status = @_evaluate(&model, &inputs, &outputs);"


@pytest.mark.parametrize(
    ("statements", "sentence"),
    [
        ("model.seal = 0; inputs.O = 0; " + EVALUATED, "the model was not prepared"),
        ("parameters.l = -1; status = @_prepare(&model, &parameters);", "a parameter is not finite, or out of its range"),
        ("parameters.r = 0; status = @_prepare(&model, &parameters);", "or leaves a link without length"),
        ("parameters.l = NAN; status = @_prepare(&model, &parameters);", "a parameter is not finite"),
        ("parameters.m2 = INFINITY; status = @_prepare(&model, &parameters);", "a parameter is not finite"),
        (PREPARED + "inputs.O_rate = NAN; " + EVALUATED, "an input is not finite"),
        (PREPARED + "inputs.O = INFINITY; " + EVALUATED, "an input is not finite"),
        (PREPARED + "status = @_motion(&model, NAN, &inputs); " + EVALUATED, "an input is not finite"),
        (PREPARED + "status = @_motion(&model, NAN, &inputs); outputs.effort_O = NAN;", "the time is not finite"),
        ("parameters.l = 0.05; " + PREPARED + "inputs.O = 1.5; " + EVALUATED, "its links do not reach"),
        ("parameters.l = 0.1; " + PREPARED + "inputs.O = 1.5707963267948966; " + EVALUATED, "a loop is at a dead centre"),
        (PREPARED + "inputs.O_rate = 1e200; " + EVALUATED, "a result is not finite"),
        (PREPARED + "outputs.effort_O = NAN; status = (@_status) 99;", "no status of this mechanism"),
    ],
)
def test_failures_say_so_and_leave_nothing_undefined(statements, sentence, tmp_path):
    made = export(slider_crank(), tmp_path)
    status, effort, found = told(tmp_path, made, statements)
    assert status != 0
    assert sentence in found
    assert np.isnan(effort) or "prepare(&model, &parameters);" in statements


def test_ratios_outside_a_link(tmp_path):
    made = export(slider_crank(), tmp_path)
    call = "@_forces forces; %s%s status = @_section(&model, &outputs, @_LINK_ROD, %s, &forces); outputs.effort_O = forces.axial;"
    call = call.replace("@_LINK", "SLIDER_CRANK_LINK")
    for ratio in ("-0.001", "1.001", "NAN", "INFINITY"):
        status, axial, sentence = told(tmp_path, made, call % (PREPARED, EVALUATED, ratio))
        assert sentence == "a ratio xi/l is outside 0 to 1"
        assert np.isnan(axial)
    lost = "inputs.O = NAN; "
    status, axial, sentence = told(tmp_path, made, call % (PREPARED + lost, EVALUATED, "0.5"))
    assert np.isnan(axial)
    assert sentence.startswith("a result is not finite")
    assert status


def test_times_outside_the_samples(tmp_path):
    made = export(spline_arm(), tmp_path)
    text = HARNESS.replace("effort_O", "effort_J").replace("@_parameters parameters = @_defaults;", "")
    for time, outside in (("0.0", False), ("3.0", False), ("-1e-9", True), ("3.0000001", True)):
        (tmp_path / "harness.c").write_text(
            (text % f"@_prepare(&model); status = @_motion(&model, {time}, &inputs);").replace("@", made.prefix)
        )
        assert cc(["cc", "-std=c99"], tmp_path, "harness.c", f"{made.prefix}.c").returncode == 0
        answer = subprocess.run([tmp_path / "program"], capture_output=True, text=True, check=True).stdout
        assert ("outside the samples" in answer) is outside


def test_iterated_loops_report_failure_and_stay_where_they_were(tmp_path):
    made = export(slider_crank(), tmp_path, newton=2)
    far = "inputs.O += 2.5; " + EVALUATED
    back = "inputs.O -= 2.5; " + EVALUATED
    for statements, lost in ((PREPARED + EVALUATED + far, True), (PREPARED + EVALUATED + far + back, False)):
        status, effort, _ = told(tmp_path, made, statements)
        assert np.isnan(effort) is np.bool_(lost)
        assert (status != 0) is lost


def test_twice_the_same_bytes(tmp_path):
    program = "import sys; sys.path.insert(0, sys.argv[1]); from builders import slider_crank; from lagrange_casadi import export; "
    program += "export(slider_crank(), sys.argv[2], precision='single')"
    for name, seed in (("one", "1"), ("two", "2")):
        environment = {"PYTHONHASHSEED": seed, "PATH": "", "XDG_CACHE_HOME": str(tmp_path / f"cache_{name}")}
        subprocess.run([sys.executable, "-c", program, Path(__file__).parent, tmp_path / name], check=True, env=environment)
    files = {path.name: path.read_bytes() for path in (tmp_path / "one").iterdir()}
    assert files == {path.name: path.read_bytes() for path in (tmp_path / "two").iterdir()}
    assert not any(str(tmp_path).encode() in content for content in files.values())


def test_names_that_c_keeps_for_itself(tmp_path):
    made = export(keywords(), tmp_path)
    assert made.prefix == "double_mechanism"
    assert made.mapped == {
        "name double": "double_mechanism",
        "parameter double": "double_",
        "parameter register": "register_",
        "input class": "class_",
    }
    for text in ((tmp_path / "README.md").read_text(), (tmp_path / "double_mechanism.h").read_text()):
        assert "parameter register" in text
        assert "register_" in text
    for _, command in compilers():
        if present(command[0]):
            result = subprocess.run(
                [*command, "-c", tmp_path / "double_mechanism.c", "-o", tmp_path / "x.o"],
                capture_output=True,
                text=True,
                check=False,
            )
            assert result.returncode == 0, result.stderr
    assert cc(["cc", "-std=c99"], tmp_path, "double_mechanism.c", "selftest.c").returncode == 0
    subprocess.run([tmp_path / "program"], check=True, capture_output=True)


def test_the_manifest_knows_all_files(tmp_path):
    made = export(slider_crank(), tmp_path)
    content = json.loads((tmp_path / "export.json").read_text())
    assert set(content["files"]) | {"export.json"} == {path.name for path in tmp_path.iterdir()}
    assert [row["path"] for row in content["outputs"]] == [member.path for member in made.outputs]
    assert content["scene"] in (tmp_path / "slider_crank.h").read_text()


def test_the_scene_hash_tells_scenes_apart(tmp_path):
    hashes = set()
    for number, (options, change) in enumerate(
        (({}, {}), ({"wanted": ["effort"]}, {}), ({}, {"l": 0.3}), ({"precision": "single"}, {}))
    ):
        export(slider_crank(), tmp_path / str(number), parameters=change, **options)
        hashes.add(json.loads((tmp_path / str(number) / "export.json").read_text())["scene"])
    assert len(hashes) == 3, "the precision is not the scene's affair"


@pytest.mark.parametrize(
    ("options", "low", "high"), [({}, 0, 1e-12), ({"precision": "single"}, 1e-9, 1e-4), ({"table": 8}, 1e-3, 1)]
)
def test_the_folder_says_how_it_is_evaluated_and_how_exactly(options, low, high, tmp_path):
    export(slider_crank(), tmp_path, parameters={"l": 0.3125}, **options)
    content = json.loads((tmp_path / "export.json").read_text())
    assert low < content["error"]["largest"] < high
    said = f"options of the export: {content['options']}. Its outputs are off by about {content['error']['largest']:.0e}"
    for file in ("slider_crank.h", "README.md"):
        text = re.sub(r"\s+", " ", (tmp_path / file).read_text())
        assert said in text
        assert ("l = 0.3125" in text) is ("table" in options)
    assert content["fixed"] == ({"r": 0.1, "l": 0.3125, "m1": 0.1, "m2": 0.1, "m3": 0.1} if "table" in options else {})


def test_a_coarse_table_is_compared_with_the_mechanism_itself(tmp_path):
    export(slider_crank(), tmp_path / "exact")
    export(slider_crank(), tmp_path / "table", table=8)
    rows = [
        (tmp_path / kind / "selftest.c").read_text().partition("outputs_at[INSTANTS]")[2].partition("};")[0]
        for kind in ("exact", "table")
    ]
    assert rows[0] == rows[1]


def test_examples_of_iterated_loops_go_in_steps_they_can_follow(tmp_path):
    for number, (scene, options) in enumerate(((slider_crank(), {"newton": 1}), (truss_platform(), {}))):
        folder = tmp_path / str(number)
        made = export(scene, folder, **options)
        assert cc(["cc", "-std=c99"], folder, f"{made.prefix}.c", "example.c").returncode == 0
        ran = subprocess.run([folder / "program"], capture_output=True, text=True, check=False)
        assert ran.returncode == 0, ran.stderr
        assert ran.stdout.count("\n") == 13
        (folder / "shown.c").write_text(shown((folder / f"{made.prefix}.h").read_text(), made.prefix))
        assert cc(["cc", "-std=c99"], folder, f"{made.prefix}.c", "shown.c").returncode == 0
        assert subprocess.run([folder / "program"], check=False).returncode == 0


def shown(header, prefix):
    """The header's own example as a program that answers with its last status."""
    lines = re.search(rf"     {prefix}_model model;\n.*?puts\([^\n]*\n", header, re.DOTALL).group()
    return f'#include "{prefix}.h"\n#include <stdio.h>\nint main(void) {{\n{lines}return (int) status;\n}}\n'


def test_a_joint_may_be_called_as_a_rest_is(tmp_path):
    m = Mechanism("two")
    first, second = m.link("first", length=1, mass=1), m.link("second", length=1, mass=1)
    m.revolute("O", m.ground, first)
    m.revolute("O_rest", first.tip, second)
    scene = Scene(m, {"O": motion.polynomial(0, 1), "O_rest": motion.polynomial(0, 2)}, t=(0, 1, 11))
    made = export(scene, tmp_path, precision="single")
    assert len({member.name for member in made.inputs}) == len(made.inputs) == 8
    assert {"O_rest", "O_rest_2"} < {member.name for member in made.inputs}
    assert list(made.mapped.values()) == ["O_rest_2"]
    assert cc(["cc", "-std=c99"], tmp_path, "two.c", "selftest.c").returncode == 0
    assert subprocess.run([tmp_path / "program"], check=False, capture_output=True).returncode == 0


@pytest.mark.parametrize("flag", ["-ffast-math", "-ffinite-math-only"])
def test_arithmetic_without_nan_is_refused(flag, tmp_path):
    export(slider_crank(), tmp_path)
    result = cc(["cc", "-std=c99", "-O2", flag, "-c"], tmp_path, "slider_crank.c", output="x.o")
    assert "compile without -ffast-math" in result.stderr


def test_parameters_become_defaults(tmp_path):
    export(slider_crank(), tmp_path, parameters={"l": 0.3125})
    assert "0.3125 /* l */" in (tmp_path / "slider_crank.c").read_text()


def test_an_export_goes_over_its_own_files_only(tmp_path):
    out = tmp_path / "out"
    export(slider_crank(), out)
    export(slider_crank(), out, precision="single")
    assert "float" in (out / "slider_crank.h").read_text()
    (out / "notes.txt").write_text("mine")
    with pytest.raises(PathError, match=r"holds other files, 'notes\.txt' among them"):
        export(slider_crank(), out)
    export(slider_crank(), out, force=True)
    assert (out / "notes.txt").read_text() == "mine"
    (out / "notes.txt").unlink()
    (out / "example.c").write_text("int main(void) { return 0; }\n")
    with pytest.raises(PathError, match=r"an export whose 'example\.c' was changed since"):
        export(slider_crank(), out)
    export(slider_crank(), out, force=True)
    assert "slider_crank" in (out / "example.c").read_text()


def test_what_an_earlier_export_alone_had_goes(tmp_path):
    export(slider_crank(), tmp_path, name="press")
    (tmp_path / "build").mkdir()
    with pytest.raises(PathError, match="holds an export of another name"):
        export(slider_crank(), tmp_path, name="pump")
    export(slider_crank(), tmp_path, name="pump", force=True)
    assert {path.stem for path in tmp_path.glob("*.[ch]")} == {"pump", "pump_mex", "example", "selftest"}
    assert (tmp_path / "build").is_dir()


def test_nothing_of_others_is_touched_even_by_force(tmp_path):
    (tmp_path / "README.md").write_text("mine")
    with pytest.raises(PathError, match=r"'README\.md' there is no file of an export"):
        export(slider_crank(), tmp_path, force=True)
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"README.md": "mine"}


def test_a_table_too_large_for_its_target(tmp_path):
    with pytest.raises(SizeError, match=r"the table of the cycle takes \d+ bytes of constants, and the limit is 64000"):
        export(slider_crank(), tmp_path / "out", table=4096, precision="single")
    assert not (tmp_path / "out").exists()
    t = np.linspace(0, 1, 4001)
    m = Mechanism("arm")
    m.revolute("J", m.ground, m.link("a", length=1, mass=1))
    scene = Scene(m, {"J": motion.samples(t, t**2)}, t=(0, 1, 11))
    with pytest.raises(SizeError, match=r"the motion of joint 'J' takes 112008 bytes"):
        export(scene, tmp_path / "out", precision="single")
    export(scene, tmp_path / "out", precision="single", largest=120_000)


def test_mistakes(tmp_path):
    with pytest.raises(UnknownNameError, match="unknown output 'effrot'"):
        export(slider_crank(), tmp_path / "out", wanted=["effrot"])
    with pytest.raises(UnknownNameError, match="unknown parameter 'q'"):
        export(slider_crank(), tmp_path / "out", parameters={"q": 1.0})
    with pytest.raises(DeclarationError, match="expected a Scene"):
        export("slider_crank", tmp_path / "out")
    with pytest.raises(DeclarationError, match="newton and table exclude each other"):
        export(slider_crank(), tmp_path / "out", newton=2, table=64)
    with pytest.raises(PathError, match="does not exist"):
        export(slider_crank(), tmp_path / "none" / "out")
    assert not list(tmp_path.iterdir())

"""Exported programs as WebAssembly, called by their wrapper in a browser: the numbers of the API,
and failures that say why.
"""

import base64
import json
import re

import alive
import numpy as np
import pytest
from reports import CASES

from lagrange_casadi import Mechanism, Scene, evaluate, export
from lagrange_casadi.cli import main
from lagrange_casadi.motion import polynomial
from lagrange_casadi.studies.case import load_case

# Where ziglang has no C library yet, it builds one.
pytestmark = [alive.NEEDS_BROWSER, alive.NEEDS_ENGINE, pytest.mark.early]

chromium = alive.chromium


def loaded(one, folder, prefix):
    """Load an exported module into a page, as ``made`` for its exports and ``mechanism``; browsers
    import no scripts from files.
    """
    one.open(folder / "README.md")
    script, module = (
        base64.b64encode((folder / f"{prefix}.{end}").read_bytes()).decode()
        for end in ("js", "wasm")
    )
    one.run(
        f"(async () => {{ window.made = await import('data:text/javascript;base64,{script}');"
        f" const bytes = Uint8Array.from(atob('{module}'), (letter) => letter.charCodeAt(0));"
        " window.mechanism = await made.load(bytes); })()"
    )


@pytest.mark.sampled(7)
@pytest.mark.parametrize(
    ("name", "precision"),
    [("quick_return", "double"), ("slider_crank", "single"), ("rssr", "double")],
)
def test_the_module_gives_what_the_api_gives(chromium, tmp_path, name, precision):
    scene = load_case(CASES / name).scene
    agreed = export(scene, tmp_path / "out", precision=precision, wasm=True)
    loaded(chromium, tmp_path / "out", agreed.prefix)
    values = {setting.name: 1.03 * setting.default for setting in agreed.settings}
    parameters = {setting.source: values[setting.name] for setting in agreed.settings}
    true = evaluate(scene, parameters=parameters, backend="vm", newton=None)
    times = true.t[:: max(1, true.t.size // 12)]
    chosen = np.searchsorted(true.t, times)
    near = 1e-12 if precision == "double" else 2e-5
    arrays = (
        "Object.fromEntries(Object.entries(found.outputs).map(([name, one]) => [name, [...one]]))"
    )
    found = chromium.run(
        f"(() => {{ mechanism.prepare({json.dumps(values)}); const found ="
        f" mechanism.cycle({json.dumps(times.tolist())}); return [[...found.statuses], {arrays}];"
        " })()"
    )
    assert found[0] == [0] * times.size
    assert list(found[1]) == [member.name for member in agreed.outputs]
    largest = {}
    for member in agreed.outputs:
        largest[member.unit] = max(
            largest.get(member.unit, 0.0), float(np.abs(true.series[member.source]).max())
        )
    for member in agreed.outputs:
        exact, values = true.series[member.source], np.array(found[1][member.name])
        gaps = values - exact[chosen]
        gaps -= 2 * np.pi * np.round(gaps / (2 * np.pi)) if member.wrapped else 0.0
        assert np.abs(gaps).max() <= near * max(np.abs(exact).max(), 1e-3 * largest[member.unit]), (
            member.name
        )
    for link in agreed.links:
        outputs = f"mechanism.evaluate(mechanism.motion({float(times[3])!r}))"
        forces = chromium.run(f"mechanism.section({outputs}, {json.dumps(link.name)}, 0.37)")
        law = true.section(link.name).law
        for force in agreed.table.forces:
            exact = law.on_grid(force, np.array([0.37]))[:, 0]
            assert forces[force] == pytest.approx(
                exact[chosen[3]], abs=near * max(law.bound(force, np.linspace(0, 1, 5)), 1e-3)
            )
    assert chromium.complaints == []


def test_a_failure_is_a_status_and_a_sentence_and_types_name_every_member(
    chromium, tmp_path, capsys
):
    out = tmp_path / "out"
    assert main(["export", str(CASES / "slider_crank"), "--out", str(out), "--wasm"]) == 0
    assert "README.wasm.md says how a web page uses them" in capsys.readouterr().out
    loaded(chromium, out, "slider_crank")
    told = (
        "(() => { try { %s } catch (error) { return [error.name, error.status ?? 0, error.message];"
        " } })()"
    )
    reach = "mechanism.prepare({ l: 0.05 }); return mechanism.evaluate(mechanism.motion(0.008));"
    assert chromium.run(told % reach) == [
        "MechanismError",
        7,
        "a loop cannot be closed: its links do not reach",
    ]
    cycle = (
        "const found = mechanism.cycle([0, 0.008]); return [[...found.statuses],"
        " [...found.outputs.effort_O].map(Number.isNaN)];"
    )
    assert chromium.run(told % cycle) == [[0, 7], [False, True]]
    name, status, message = chromium.run(told % "mechanism.prepare({ L: 1 });")
    assert (name, status, message) == (
        "TypeError",
        0,
        "unknown parameter 'L'; valid: r, l, m1, m2, m3",
    )
    assert (
        chromium.run(told % "mechanism.prepare(); mechanism.section({}, 'arm', 0.5);")[2]
        == "unknown link 'arm'; valid: crank, rod"
    )
    contract = chromium.run("JSON.parse(JSON.stringify(made.contract))")
    types = (out / "slider_crank.d.ts").read_text()
    for group, head in (
        ("parameters", "Parameters"),
        ("inputs", "Inputs"),
        ("outputs", "Outputs"),
        ("forces", "Forces"),
    ):
        block = re.search(rf"export interface {head} {{\n(.*?)\n}}", types, re.DOTALL)[1]
        assert re.findall(r"^  (\w+): number;", block, re.MULTILINE) == [
            member["name"] for member in contract[group]
        ]
    assert 'export type Link = "crank" | "rod";' in types
    manifest = json.loads((out / "export.json").read_text())["files"]
    assert {
        "slider_crank.wasm",
        "slider_crank.js",
        "slider_crank.d.ts",
        "README.wasm.md",
    } <= manifest.keys()
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    assert main(["export", str(CASES / "slider_crank"), "--out", str(out), "--wasm"]) == 0
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before


def test_what_every_object_of_javascript_has_is_no_parameter(chromium, tmp_path):
    """A parameter and a joint that are called so have their default, and 0."""
    m = Mechanism("arm")
    length = m.parameter("constructor", 0.5, "m", low=0.0)
    m.revolute("toString", m.ground, m.link("arm", length=length, mass=1.0))
    scene = Scene(m, {"toString": polynomial(0.0, 2.0)}, t=(0.0, 1.0, 5))
    export(scene, tmp_path / "out", wasm=True)
    loaded(chromium, tmp_path / "out", "arm")
    effort = "mechanism.prepare({}); return mechanism.evaluate({}).effort_toString;"
    assert chromium.run(f"(() => {{ {effort} }})()") == pytest.approx(9.81 * 0.25, rel=1e-12)

"""A right call of every public function, class and method: what walks over them start from."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from calls_declaring import SPAN, Call, calls, declarations, plane, sized, swing
from calls_of_laws import laws

from lagrange_casadi import (
    actuators,
    animation,
    beams,
    bearings,
    evaluate,
    figures,
    forward,
    free,
    prepare,
    save,
    sensitivities,
    strength,
    sweep,
)

PRESS = Path(__file__).parents[2] / "cases" / "cad_press" / "press.asmt"

DOORS = (
    "lagrange_casadi",
    *(
        f"lagrange_casadi.{name}"
        for name in (
            "actuators",
            "animation",
            "beams",
            "bearings",
            "density",
            "elements",
            "figures",
            "forward",
            "motion",
            "studies.optimise",
            "peaks",
            "strength",
            "studies.sweep",
        )
    ),
)
"""Where users import from."""


def solved() -> SimpleNamespace:
    """What is made of a scene, which no call changes."""
    scene = swing()
    solution = evaluate(scene, backend="vm", certificate=False)
    save(solution, "run.h5")
    duty = actuators.duty_of(solution, "O")
    motor = actuators.Motor("M", 9.0, 8.0, 100.0, 20.0, 200.0, 1e-5)
    return SimpleNamespace(
        scene=scene,
        solution=solution,
        gone=free(scene, wanted=["effort", "motion"]),
        duty=duty,
        motor=motor,
        stress=solution.stress("arm"),
        prepared=prepare(scene, wanted=["effort"]),
        sensitivities=sensitivities(scene, solution, backend="vm"),
        swept=sweep(scene, {"l": (0.2, 0.3, 2)}, wanted=["effort"], out="swept.h5", workers=1),
        plane=plane(),
    )


def uses(of: SimpleNamespace) -> Iterator[tuple[str, Call]]:
    """Calls of what evaluates a scene, and of what it gives."""
    root = importlib.import_module("lagrange_casadi")
    peaks = importlib.import_module("lagrange_casadi.peaks")
    scene, solution, swept = of.scene, of.solution, of.swept
    both = {"scene": scene, "solution": solution}
    lean = {"scene": scene, "wanted": ["effort"]}
    one = {"l": (0.2, 0.3, 2)}
    t = np.linspace(0.0, 1.0, 9)
    columns = {"O": np.linspace(0.0, 1.0, 9) ** 2, "effort:O": np.ones(9)}
    record = root.Measurements(t, columns)
    heads = [f"{at},{angle},1.0" for at, angle in zip(t, columns["O"], strict=True)]
    Path("record.csv").write_text("\n".join(["t [s],O [rad],effort:O [N m]", *heads]))
    yield from calls(
        "",
        root,
        {
            "compile_scene": {"scene": scene, "wanted": ["effort"]},
            "derive": {"scene": scene, "wanted": ["effort"]},
            "evaluate": {**lean, "certificate": False, "backend": "vm"},
            "prepare": lean,
            "refine": {**both, "names": ["effort:O"]},
            "sensitivities": {**both, "backend": "vm"},
            "holding": both,
            "tolerances": {**lean, "within": {"l": 0.01}, "samples": 10},
            "tool_deflection": {"scene": scene, "point": scene.mechanism.links["arm"].tip},
            "vibration": {"solution": solution, "link": "arm"},
            "sweep": {**lean, "grid": one, "out": "made.h5", "force": True, "workers": 1},
            "optimise": {
                "scene": scene,
                "minimise": "l",
                "over": {"l": (0.2, 0.3)},
                "starts": 1,
                "screen": 2,
                "points": 2,
            },
            "best": {"sweep": swept, "minimise": "l"},
            "read_designs": {"path": "designs.csv"},
            "load": {"path": "run.h5"},
            "check": {"path": "run.h5"},
            "save": {"solution": solution, "path": "saved.h5"},
            "load_case": {"path": "slider_crank"},
            "read": {"path": str(PRESS)},
            "save_model": {"scene": scene, "path": "model.json"},
            "link_load_cases": {"solution": solution, "link": "arm"},
            "write_load_cases": {"cases": [], "folder": "load_cases"},
            "Measurements": {"t": t, "columns": columns},
            "read_measurements": {"path": "record.csv"},
            "identify": {"scene": scene, "measurements": record, "backend": "vm"},
            "excite": {
                "scene": scene,
                "limits": {"O": ("-50 deg", 1.0, "2 rad/s", 9.0)},
                "steps": 1,
                "backend": "vm",
            },
            "write_spectrum": {"solution": solution, "name": "effort:O", "path": "spectrum.csv"},
            "bearing_loads": {"solution": solution, "joint": "O"},
            "export": {"scene": scene, "out": "exported", "wanted": ["effort"], "force": True},
            "free": {"scene": scene, "wanted": ["effort"]},
            "flywheel": {"scene": scene, "start": (0.0, 30.0), "count": 5, "wanted": ["effort"]},
        },
    )
    found = root.identify(scene, record, backend="vm")
    yield "Identification.validate", (found.validate, {"measurements": record})
    yield from calls(
        "Measurements.",
        record,
        {
            "quantities": {"drives": ["O"]},
            "motion": {"drives": ["O"]},
            "cutoff": {"drive": "O"},
        },
    )
    yield from calls(
        "peaks.",
        peaks,
        {
            "forces": {"solution": solution},
            "refine_safety": {**both, "link": "arm"},
            "refine_stress": {**both, "link": "arm"},
            "shortfall": {"scene": scene, "counts": [5, 9], "names": ["effort:O"]},
        },
    )
    size = importlib.import_module("lagrange_casadi.studies.sizing").size
    yield (
        "size",
        (
            size,
            {"scene": sized(), "profiles": [beams.Profile("p", {"height": 0.03, "width": 0.01})]},
        ),
    )
    yield from calls(
        "Solution.",
        solution,
        {
            "animate": {"path": "cycle.svg"},
            "array": {"name": "effort:O"},
            "deflection": {"link": "arm"},
            "determined": {"name": "effort:O"},
            "during": {"instants": slice(0, 2)},
            "effort": {"joint": "O"},
            "extremes": {"name": "effort:O"},
            "life": {"link": "arm"},
            "motion": {"joint": "O"},
            "peak": {"name": "effort:O"},
            "pose": {"body": "arm"},
            "reaction": {"joint": "O"},
            "report": {"path": "page.html"},
            "safety": {"link": "arm"},
            "section": {"link": "arm"},
            "statistics": {"name": "effort:O"},
            "stress": {"link": "arm"},
            "unit": {"name": "effort:O"},
            "view": {"height": 300},
        },
    )
    yield from {
        "Mechanism.draw": (scene.mechanism.draw, {"path": "mechanism.svg"}),
        "Scene.draw": (scene.draw, {"path": "scene.svg"}),
        "Scene.report": (scene.report, {"path": "scene.html"}),
        "Scene.checked": (scene.checked, {"values": {"l": 0.5}}),
        "Scene.timing": (scene.timing, {"t": SPAN}),
        "Scene.values": (scene.values, {"parameters": {"l": 0.5}}),
        "Scene.wants": (scene.wants, {"names": ["effort"]}),
        "Scene.with_elastic": (scene.with_elastic, {"elastic": True}),
        "Deflection.at": (
            solution.deflection("arm").at,
            {"name": solution.deflection("arm").names[0], "u": 0.5},
        ),
    }.items()
    yield from calls(
        "Stress.",
        of.stress,
        {
            "at": {"xi": 0.5},
            "fibres": {"xi": 0.5},
            "grid": {"kind": "von_mises"},
            "largest": {"kind": "von_mises"},
            "largest_at_notches": {"kind": "von_mises"},
            "peak": {"kind": "von_mises"},
        },
    )
    yield from {
        "Safety.against": (solution.safety("arm").against, {"what": "yielding"}),
        "Plane.value": (strength.critical_plane(np.eye(3, 4)).value, {}),
    }.items()
    yield from calls(
        "strength.",
        strength,
        {
            "safety": {"solution": solution, "link": "arm"},
            "life": {"solution": solution, "link": "arm"},
            "stress": {"solution": solution, "link": "arm"},
            "joint_safety": {"solution": solution, "joint": "O"},
            "safeties": {"solution": solution},
            "effective_lengths": {"description": solution.description, "link": "arm"},
        },
    )
    yield "Prepared.__call__", (of.prepared, {"*": ({"l": 0.3},)})
    for name in ("peaks", "gradient", "curvature"):
        yield f"Prepared.{name}", (getattr(of.prepared, name), {"*": ({"l": 0.3},)})
    yield "Prepared.designs", (of.prepared.designs, {"p": np.array([[0.3]])})
    yield from calls(
        "Sensitivities.",
        of.sensitivities,
        {
            "array": {"name": "effort:O", "parameter": "l"},
            "curvature": {"name": "effort:O", "parameter": "l", "other": "l"},
            "mean": {"name": "effort:O"},
            "rms": {"name": "effort:O"},
            "peak": {"name": "effort:O"},
            "peaks": {"names": ["effort:O"]},
        },
    )
    peak = "peak:effort:O"
    yield from calls(
        "Sweep.",
        swept,
        {
            "__getitem__": {"name": peak},
            "axes_of": {"names": [peak]},
            "blocks": {"names": [peak]},
            "check_columns": {"names": [peak]},
            "column": {"name": peak},
            "design": {"number": 0},
            "open": {"path": "swept.h5"},
            "part": {"axis": "l", "places": slice(None, None, 2)},
            "report": {"path": "sweep.html"},
            "select": {"l": 0.2},
            "to_xarray": {"names": [peak]},
            "unit": {"name": peak},
            "values": {"number": 0, "names": [peak]},
        },
    )
    swept_room = importlib.import_module("lagrange_casadi.studies.sweep")
    yield from {
        "chosen": (swept_room.chosen, {"sweep": swept, "names": ["l"]}),
        "is_sweep": (swept_room.is_sweep, {"path": "swept.h5"}),
    }.items()
    held = {"solution": solution, "joint": "O"}
    yield from calls(
        "",
        actuators,
        {
            "duty_of": held,
            "inertia_at": {"scene": scene, "joint": "O"},
            "assess": {"motor": of.motor, "duty": of.duty},
            "plot_duty": {"duty": of.duty, "path": "duty.png"},
            "select": {
                "motors": [of.motor],
                "duty": lambda ratio, inertia: actuators.duty_of(
                    **held, ratio=ratio, inertia=inertia
                ),
            },
        },
    )
    yield from calls(
        "forward.",
        forward,
        {
            "torque": {"value": 1.0},
            "power": {"value": 1.0},
            "torque_curve": {"speeds": [0.0, 1.0], "torques": [1.0, 0.0]},
            "dc_motor": {"stall_torque": 1.0, "no_load_speed": 10.0},
            "induction_motor": {
                "breakdown_torque": 1.0,
                "breakdown_slip": 0.2,
                "synchronous_speed": 10.0,
            },
            "expression": {"law": lambda t, angle, speed: -speed},
            "plot_cycle": {"motion": of.gone, "path": "cycle.png"},
        },
    )
    yield "Law.geared", (forward.torque(1.0).geared, {"ratio": 2.0})
    chosen = {**held, "bearings": bearings.deep_groove("62"), "hours": 10.0}
    yield from {
        "select_bearing": (bearings.select_bearing, chosen),
        "Motor.short_time_torque": (of.motor.short_time_torque, {"speed": 10.0}),
        "Motor.continuous_torque": (of.motor.continuous_torque, {"speed": 10.0}),
        "write_animation": (animation.write_animation, {"solution": solution, "path": "made.svg"}),
        "default_figures": (figures.default_figures, {"solution": solution}),
    }.items()
    drawn = {"solution": solution, "specs": [figures.TimePlot("f", ("effort:O",))], "folder": "."}
    yield from {
        "draw": (figures.draw, drawn),
        "TimePlot.draw": (drawn["specs"][0].draw, {"solution": solution}),
    }.items()


def files() -> None:
    """Put what calls read into this folder."""
    for name, text in {
        "profile.csv": (
            "x,y\n"
            + "\n".join(
                f"{0.05 * np.cos(a):.6f},{0.05 * np.sin(a):.6f}" for a in np.linspace(0.0, 6.0, 20)
            )
        ),
        "samples.csv": "0,0\n1,1\n2,0\n3,1\n4,0\n5,1\n",
        "profiles.csv": "name,height,width\nflat,0.03,0.01\n",
        "designs.csv": "l\n0.2\n0.3\n",
        "bearings.csv": (
            "name,bore [mm],outer [mm],width [mm],dynamic [kN],static [kN]\nB,25,52,15,14,7.8\n"
        ),
        "motors.csv": (
            "name,stall_torque,rated_torque,peak_torque,rated_speed,max_speed,inertia\nM,9,8,20,1000,2000,1e-5\n"
        ),
    }.items():
        Path(name).write_text(text)


def rights(of: SimpleNamespace) -> dict[str, Call]:
    """All right calls, each on what it may change alone."""
    return dict([*declarations(), *laws(), *uses(of)])

"""The oracle's solution of a scene in as many digits as one likes."""

from __future__ import annotations

import functools

import rubbing
from arithmetic import Digits
from balance import apart, columns_at, oracle_of, postures
from beside import of_case

from lagrange_casadi import derive, evaluate


def precise(scene, t, drives=None, parameters=None, digits=50, beside=None, least=None):
    """What a scene has at an instant, by full name: numbers, and under ``section:LINK:FORCE``
    functions of the ratio xi/l.

    There are efforts, reactions, poses, multipliers and section forces, less what the mechanism
    leaves undetermined. The numbers of the declaration are doubles and taken as exact. ``drives``
    are (coordinate, rate, acceleration) of the driven joints, numbers of any kind, by default the
    doubles of the scene's graph. ``beside(arithmetic, values)`` gives the oracle its loads, extras
    and unaided drives, by default those of the case of the mechanism's name. ``least``: see
    :class:`.Digits`. Angles count a drive's turns: a graph's may differ by whole ones.
    """
    m, arithmetic = scene.mechanism, Digits(digits, least)
    values = m.values(parameters)
    program = derive(scene, ["all"])
    found, motion = columns_at(program, t, values)
    acting = (beside or functools.partial(of_case, m.name))(arithmetic, values)
    for given, declared in (("loads", [*m.loads]), ("extras", [*m.constraints, *m.rows])):
        assert bool(acting.get(given)) == bool(declared), (
            f"'{m.name}' declares {declared}: give the oracle the same {given}"
        )
    drives, guides = apart(m, drives or motion, values, arithmetic)
    acting = {"pushed": scene.drives and list(scene.drives)} | acting
    acting["extras"] = [*acting.get("extras", ()), *guides]
    solved = rubbing.solve(
        oracle_of(m, values, arithmetic, **acting),
        m,
        values,
        drives,
        postures(m, found, motion, 0.0),
    )
    named = _named(m, solved)
    if not program.indeterminate:
        return named
    span = (
        (float(t), float(t), 1)
        if program.newton is None or t == scene.t[0]
        else (scene.t[0], float(t), 20)
    )
    told = evaluate(
        scene, wanted=["all"], t=span, parameters=parameters, backend="vm", certificate=False
    )
    return {name: value for name, value in named.items() if told.determined(name)}


def _named(m, solved):
    named = {f"effort:{joint}": effort for joint, effort in solved.efforts.items()}
    for joint, forces in solved.reactions.items():
        named |= {
            f"reaction:{joint}:{member}": force
            for member, force in zip(("fx", "fy", "mz"), forces, strict=True)
        }
    for body in m.moving:
        x, y, angle = (jet.v for jet in solved.q[body.name])
        named |= {f"pose:{body.name}:x": x, f"pose:{body.name}:y": y} | (
            {f"pose:{body.name}:angle": angle} if body.oriented else {}
        )
    named |= {f"multiplier:{name}": multiplier for name, multiplier in solved.multipliers.items()}
    named |= solved.frictions
    for link, forces in solved.sections.items():
        forces = functools.lru_cache(maxsize=None)(forces)
        named |= {
            f"section:{link}:{force}": _member(forces, k)
            for k, force in enumerate(("axial", "shear", "bending"))
        }
    return named


def _member(forces, k):
    return lambda ratio: forces(ratio)[k]

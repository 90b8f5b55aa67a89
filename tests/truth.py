"""How far a solution really is off: its outputs against the scene's graphs in fifty digits."""

from __future__ import annotations

import itertools
import math

import mpmath
import numpy as np

from lagrange_casadi import derive
from lagrange_casadi.backends import run
from lagrange_casadi.reference import reference
from lagrange_casadi.rung import Rung
from lagrange_casadi.section_law import FORCES

MP = mpmath.mp
RATIOS = (0.0, 0.31, 0.64, 1.0)


def truth(scene, t, parameters=None):
    """Every output at instants ``t`` by full name, one after the other in time, of loops that are closed: numbers of fifty digits.

    Those under ``section:LINK:FORCE`` are rows over :data:`RATIOS`.
    """
    m = scene.mechanism
    values = m.values(parameters)
    graph, p = derive(scene), list(values.values())
    z = None
    if graph.newton is not None:
        grid = np.unique([*np.linspace(*scene.t[:2], 200), *t])
        z = run(graph, grid, np.array(p), Rung("vm"))[0].iterated[:, np.searchsorted(grid, t)]
    columns = [dict(zip(graph.columns, row, strict=True)) for row in reference(graph, t, p, z=z)]
    found = {name: [row[name] for row in columns] for name in graph.columns if not name.startswith("_")}
    for link in m.links:
        if f"section:{link}:law:n0" in found:
            rows = [[section(row, m, values, link, ratio) for ratio in RATIOS] for row in columns]
            for k, force in enumerate(FORCES):
                found[f"section:{link}:{force}"] = [[at_ratio[k] for at_ratio in row] for row in rows]
    return found


def true_errors(solution, exact):
    """The largest error of every output over the instants, by full name; angles up to whole turns."""
    errors, joints = {}, solution.description["joints"]
    for name, rows in exact.items():
        group, part, *member = name.split(":")
        if group == "section" and name not in solution.series:
            mine = solution.section(part).law.at(member[0], np.tile(RATIOS, (solution.t.size, 1)))
        else:
            mine = solution.series[name]
        gaps = np.abs((np.array(rows) - mine).astype(float))
        if member == ["angle"] or (group == "motion" and joints.get(part, {}).get("coordinate") == "angle"):
            gaps = np.abs(gaps - math.tau * np.rint(gaps / math.tau))
        errors[name] = float(np.max(gaps))
    return errors


def section(columns, mechanism, values, link, ratio):
    """Axial, shear and bending of a link at a ratio, from its law and stations, by the moments as they are defined."""
    body, u = mechanism.links[link], MP.mpf(ratio)
    l = MP.mpf(mechanism.number(body.length, values))
    mu = [MP.mpf(0)] * 3
    for (a, b), cell in zip(itertools.pairwise(map(MP.mpf, body.mass.breaks)), body.mass.cells, strict=True):
        for (j, coefficient), k in itertools.product(enumerate(cell), range(3)):
            density = MP.mpf(mechanism.number(coefficient, values)) * (l if body.mass.per_length else 1)
            mu[k] += density * l**k * max(b ** (j + k + 1) - max(a, u) ** (j + k + 1), 0) / (j + k + 1)
    n0, n1, n2, f0, f1, f2, m0 = (columns[f"section:{link}:law:{k}"] for k in ("n0", "n1", "n2", "f0", "f1", "f2", "m0"))
    xi = u * l
    axial, shear = n0 + n1 * mu[0] + n2 * mu[1], f0 + f1 * mu[0] + f2 * mu[1]
    bending = m0 + f0 * (l - xi) + f1 * (mu[1] - xi * mu[0]) + f2 * (mu[2] - xi * mu[1])
    for name in columns:
        if name.startswith(f"section:{link}:") and name.endswith(":station"):
            n, f, m, station = (columns[name.removesuffix("station") + member] for member in ("n", "f", "m", "station"))
            if u < station or u == 1 <= station:
                axial, shear, bending = axial + n, shear + f, bending + m + f * (station - u) * l
    return axial, shear, bending

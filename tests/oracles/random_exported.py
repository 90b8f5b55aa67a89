"""Random mechanisms as exported C, compiled with every warning an error."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from exported import FORCES, RATIOS, by_c99, exported, instants
from internals import Output


def by_exported_c(many, folder):
    """Solutions of what was drawn, as ``(drawn, scene, solution)``, with all outputs by exported C,
    and how far section forces there are off those of the solutions, in sizes of their terms.
    """
    for drawn, scene, solution in many:
        own = folder / scene.mechanism.name
        lasting = replace(scene, t=drawn.grid)
        _, told = exported(lasting, own, parameters=drawn.keywords.get("parameters"))
        found = by_c99(own, told, instants(solution.t, "double"), ("-O0",)).T
        outputs, off, rest = dict(solution.outputs), 0.0, iter(found[len(told["outputs"]) :])
        for row, values in zip(told["outputs"], found, strict=False):
            outputs[Output.of(row["path"].replace("/", ":"))] = values
        for link in told["links"]:
            law = solution.section(link["name"]).law
            for ratio in RATIOS:
                for force in FORCES:
                    gap = np.abs(next(rest) - law.on_grid(force, np.array([ratio]))[:, 0])
                    if solution.determined(f"section:{link['name']}:{force}"):
                        size = np.max(law.bound(force, np.array([ratio]))) + 1e-300
                        off = max(off, np.max(gap) / size)
        yield drawn, replace(solution, outputs=outputs), off

"""``lagrange-casadi loads``: load cases of links, for programs of finite elements."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..base.publish import check_writable
from ..base.vocabulary import LOAD_FORMATS
from ..case import load_case
from ..declare.even_points import EvenPoints
from ..declare.scene import kinds
from ..declare.times import Over
from ..errors import CertificateError
from ..load_cases import link_load_cases, write_load_cases
from ..studies.evaluate import evaluate
from ..verification.certificate import failure, summary
from .echo import echo
from .options import parameters

_FORCES = ("reaction", "multiplier", "load", "friction")


def loads_command(
    case: Path,
    links: Sequence[str],
    out: Path,
    settings: Sequence[tuple[str, float | str]],
    t: EvenPoints | None,
    over: Over | None,
    every: bool,
    formats: Sequence[str],
) -> None:
    """See :func:`.commands.loads`."""
    check_writable(out, folder=True)
    scene, chosen = load_case(case).scene, tuple(dict.fromkeys(links))
    wanted = ["effort", "motion", *(kind for kind in kinds(scene.outputs) if kind in _FORCES)]
    wanted += (name for name in scene.outputs if name in {f"section:{link}" for link in chosen})
    solution = evaluate(scene, parameters=parameters(settings), t=t, over=over, wanted=wanted)
    if solution.failed:
        raise CertificateError(failure(solution))
    instants = solution.t.tolist() if every else None
    cases = [case for link in chosen for case in link_load_cases(solution, link, instants, scene)]
    for one in cases:
        governs = f": {', '.join(one.governs)}" if one.governs else ""
        echo(f"{one.link} at t = {one.t:.6g} s, residual {max(one.residual):.1e}{governs}")
    files = write_load_cases(cases, out, formats or LOAD_FORMATS)
    echo(f"wrote {out}: {len(cases)} load cases in {len(files)} files")
    echo(summary(solution.certificate))

"""``lagrange-casadi size``: the lightest profile for each link that is safe."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import click

from ..base.numerals import real
from ..beams.profiles import read_profiles
from ..case import load_case
from ..declare.even_points import EvenPoints
from ..declare.times import Over
from ..strength.critical_plane import FINDLEY
from ..strength.fatigue import CRITERIA
from ..strength.stress import KINDS
from ..studies.sizing import Sized, size
from .echo import echo
from .options import PATH, instants, parameters, settings_by
from .options import over as by_drive
from .strength_lines import safety_lines, told


def share(text: str) -> float:
    """A positive number, or one over another."""
    above, _, below = text.partition("/")
    try:
        found = real(above) / real(below or "1")
    except (ValueError, ZeroDivisionError):
        found = math.nan
    if not 0.0 < found < math.inf:
        raise click.BadParameter(f"expected a share of the length, as 1/500, got {text!r}")
    return found


@click.command(name="size")
@click.argument("case", type=PATH)
@click.option("--profiles", type=PATH, metavar="FILE.csv", help="A column name, and one for each dimension [m].")
@click.option("--safety", type=float, default=2.0, show_default=True, metavar="FACTOR", help="The least factor of safety.")
@click.option(
    "--deflection",
    type=share,
    metavar="SHARE",
    help="The largest deflection across a link over its length, as 1/500. Default: any.",
)
@click.option("--link", "links", multiple=True, metavar="LINK", help="Size this link; repeatable. Default: all that profiles fit.")
@click.option(
    "--criterion", type=click.Choice((*CRITERIA, FINDLEY)), default="goodman", show_default=True, help="How a mean counts."
)
@click.option(
    "--yielding",
    type=click.Choice(tuple(kind for kind in KINDS if kind not in ("normal", "shear"))),
    default="von_mises",
    show_default=True,
    help="The stress that yields.",
)
@settings_by()
@instants()
@by_drive
def size_command(
    case: Path,
    profiles: Path | None,
    safety: float,
    deflection: float | None,
    links: Sequence[str],
    criterion: str,
    yielding: str,
    settings: Sequence[tuple[str, float | str]],
    t: EvenPoints | None,
    over: Over | None,
) -> None:
    """Choose for each link of CASE, of the profiles of a table, the lightest that is safe under the loads that its mass brings."""
    loaded = load_case(case)
    beside = loaded.path.parent / "profiles.csv"
    if profiles is None and not beside.is_file():
        raise click.UsageError(f"--profiles: expected a table of profiles; there is none beside the case, {beside}")
    table = read_profiles(profiles or beside)
    found = size(
        loaded.scene,
        table,
        safety=safety,
        links=links or None,
        parameters=parameters(settings),
        t=t,
        over=over,
        criterion=criterion,
        yielding=yielding,
        deflection=deflection,
    )
    stiff = "" if deflection is None else f", and a deflection of {deflection:g} of its length, or less"
    echo(f"{loaded.name}: of {len(table)} profiles the lightest with a factor of safety of {safety:g}, or more{stiff}:")
    for sized in found.links:
        for line in _lines(sized):
            echo(line)
    for name, why in found.left.items():
        echo(f"{name}: left as it is, for {why}")
        for line in told(
            name, lambda link: list(safety_lines(found.solution.safety(link, criterion=criterion, yielding=yielding)))
        ):
            echo(line)
    loads = f"loads were evaluated {found.evaluations} times"
    echo(f"together {found.mass:.6g} kg; {loads}; certificate: {'holds' if found.solution.certified else 'fails'}")
    echo(" ".join(f"--set {name}={value!r}" for name, value in found.parameters.items()))


def _lines(sized: Sized) -> list[str]:
    """A link with what was chosen for it, what governs, and why nothing lighter will do."""
    lines = [f"{sized.link}: '{sized.profile.name}', {sized.mass:.6g} kg", *safety_lines(sized.safety)]
    if sized.lighter is not None:
        profile, found = sized.lighter
        lines.append(f"    lighter: '{profile.name}' has {found.factor:.4g} against {found.governs.against}")
    return lines

"""``lagrange-casadi optimise``: the design for which a peak or a mean is least, within limits."""

from __future__ import annotations

import signal
from collections.abc import Sequence
from pathlib import Path

import click
from tqdm import tqdm

from ..case import load_case
from ..declare.angles import typed
from ..declare.even_points import EvenPoints
from ..errors import DeclarationError
from ..instants.rung import BACKENDS, Backend
from ..optimise import Optimum
from ..optimise import optimise as search
from ..optimise.figure import PICTURES, draw_optimum
from ..optimise.file import save_optimum
from ..system.numerals import real
from ..system.publish import check_writable, writing
from .options import EVEN_POINTS, even_points, parameters, setting

_BOUNDS = "NAME=LEAST:LARGEST"


def _bounds(text: str) -> tuple[str, tuple[float, float]]:
    """NAME=LEAST:LARGEST; angles may have a unit, as 30deg."""
    name, _, words = (word.strip() for word in text.partition("="))
    try:
        low, high = (value if is_angle else real(word) for word in words.split(":") for value, is_angle in (typed(word),))
    except ValueError:
        raise click.BadParameter(f"expected {_BOUNDS}, as in l=0.15:0.4, got '{text}'") from None
    return name, (low, high)


@click.command()
@click.argument("case", type=click.Path(path_type=Path))
@click.option("--minimise", required=True, metavar="TERM", help="peak:QUANTITY, max:, mean: or rms:, or a parameter.")
@click.option(
    "--over", "bounds", type=_bounds, multiple=True, required=True, metavar=_BOUNDS, help="A parameter to choose; repeatable."
)
@click.option(
    "--subject-to", "limits", multiple=True, metavar="'TERM<=NUMBER'", help="A limit, as 'peak:effort:O<=12'; repeatable."
)
@click.option("--starts", type=int, default=4, show_default=True, metavar="NUMBER", help="How many designs to start from.")
@click.option(
    "--transmission", type=float, default=0.05, show_default=True, metavar="SINE", help="Least sine of transmission angles."
)
@click.option(
    "--set", "settings", type=setting, metavar="NAME=VALUE", multiple=True, help="Give another parameter a value; repeatable."
)
@click.option("--t", type=even_points, metavar=EVEN_POINTS, help="Instants [s]; default: the case's.")
@click.option("--backend", type=click.Choice(BACKENDS), default="auto", show_default=True, help="What evaluates designs.")
@click.option("--out", type=click.Path(path_type=Path), help="History and result, as HDF5; default: <case>_optimum.h5 here.")
@click.option("--figure", type=click.Path(path_type=Path), help="The picture; default: <case>_optimum.png here.")
def optimise(
    case: Path,
    minimise: str,
    bounds: Sequence[tuple[str, tuple[float, float]]],
    limits: Sequence[str],
    starts: int,
    transmission: float,
    settings: Sequence[tuple[str, float | str]],
    t: EvenPoints | None,
    backend: Backend,
    out: Path | None,
    figure: Path | None,
) -> int:
    """Find the design of CASE for which a peak or a mean is least, within limits that hold over the whole motion."""
    over = dict(bounds)
    if len(over) < len(bounds):
        raise DeclarationError("over: a parameter has bounds twice")
    loaded = load_case(case)
    out, figure = out or Path(f"{loaded.name}_optimum.h5"), figure or Path(f"{loaded.name}_optimum.png")
    check_writable(out, hdf5=True)
    if figure.suffix not in PICTURES:
        raise click.UsageError(f"--figure {figure}: expected a name that ends in {' or '.join(PICTURES)}")
    check_writable(figure)
    with tqdm(desc="programs", leave=False, disable=None) as bar:

        def progress(start: int, objective: float, excess: float) -> None:
            bar.set_postfix_str(f"start {start + 1}: {objective:.5g}{'' if excess <= 0.0 else f', beyond a limit by {excess:.1g}'}")
            bar.update()

        found = search(
            loaded.scene,
            minimise=minimise,
            over=over,
            subject_to=limits,
            starts=starts,
            transmission=transmission,
            t=t,
            parameters=parameters(settings),
            backend=backend,
            progress=progress,
        )
    if found.stopped and hasattr(signal, "setitimer"):
        signal.setitimer(signal.ITIMER_REAL, 0.0)  # the interrupt has arrived, and is repeated no more
    save_optimum(found, out)
    with writing(figure) as (picture,):
        draw_optimum(loaded.scene, found, picture, figure.suffix)
    _print(found)
    click.echo(f"wrote {out} and {figure}")
    return 0 if found.feasible and found.converged and not found.stopped else 1


def _print(found: Optimum) -> None:
    told = ", ".join(f"{name} = {value:.8g}" for name, value in found.values.items())
    click.echo(f"{found.case}: {found.minimised} = {found.objective:.8g} {found.unit} at {told}")
    if found.stopped:
        click.echo("stopped: the best design so far")
    for limit in found.limits:
        excess = limit.constraint.excess(limit.value)
        kept = "active" if limit.active else f"VIOLATED by {excess:.4g}" if excess > 0.0 else "holds"
        relaxed = f", a unit more gains {limit.multiplier:.4g}" if limit.active and found.feasible else ""
        click.echo(f"  {limit.constraint}: {limit.value:.8g}, {kept}{relaxed}")
    for name, multiplier in found.bounds.items():
        if multiplier and found.feasible:
            click.echo(
                f"  {name} is at its {'least' if multiplier < 0.0 else 'largest'} value, a unit more gains {abs(multiplier):.4g}"
            )
    angle = "" if found.transmission != found.transmission else f", least sine of transmission angles {found.transmission:.4g}"
    ends = f"{sum(one.ending == 'converged' for one in found.starts)} of {len(found.starts)} starts converged"
    click.echo(f"  {ends}, {found.evaluations} designs, first-order conditions to {found.residual:.1e}{angle}")
    if not found.feasible:
        click.echo("  no design that was found is within all limits")
    elif not found.converged:
        click.echo(f"  not known to be an optimum: {found.start.ending}")
    for note in found.notes:
        click.echo(f"  note: {note}")

"""The commands: what each is asked, in one place that loads nothing else.

What a command does is imported when it is run.
"""

from __future__ import annotations

from typing import Any

import click

from ..base.room import MOST_THREADS
from ..base.vocabulary import (
    BACKENDS,
    CRITERIA,
    KEEPS,
    POINTS,
    RATE,
    SAMPLES,
    SECONDS,
    SIMPLE,
    TIME_LIMIT,
    WIDTH,
    YIELDING,
)
from .options import (
    AXIS,
    BOUNDS,
    EVEN_POINTS,
    PATH,
    arithmetic,
    axis,
    bounds,
    even_points,
    instants,
    length,
    over,
    place,
    ratios,
    rung,
    settings_by,
    share,
    tolerance,
    untabled_rung,
    wanted,
)


@click.command()
@click.argument("case", type=PATH)
@settings_by()
@instants()
@over
@click.option(
    "--xi",
    type=even_points,
    metavar=EVEN_POINTS,
    help="Section ratios xi/l, within 0 and 1; default: the case's.",
)
@wanted(
    "effort, reaction:JOINT, section:LINK, motion, sensitivity:PARAMETER, a kind such as section,"
    " or all; repeatable."
)
@rung
@click.option(
    "--threads",
    type=click.IntRange(1, MOST_THREADS),
    metavar="N",
    help="Threads; default: one a core.",
)
@click.option("--out", type=PATH, help="The file; default: <case>.h5 here.")
@click.option("--figures", type=PATH, help="The figures' folder; default: <case>_figures here.")
@click.option("--no-figures", is_flag=True, help="Draw nothing.")
@click.option(
    "--csv", type=PATH, metavar="FILE.csv", help="Write a row for every instant as CSV too."
)
@click.option(
    "--refine-peaks", is_flag=True, help="Seek the reported peaks between the instants too."
)
@click.option(
    "--elastic", is_flag=True, help="Let the beams of links tell what equilibrium leaves open."
)
@click.option("--no-certificate", is_flag=True, help="Do not check the solution.")
def run(**given: Any) -> None:
    """Evaluate CASE, a folder with a case.py, a Python file, or one that cases lists, and write an
    HDF5 file and figures.
    """
    from .run import run

    run(**given)


@click.command()
@click.argument("case", type=PATH)
@click.option(
    "--grid",
    "axes",
    type=axis,
    metavar=AXIS,
    multiple=True,
    help="Sweep a parameter; repeatable, the last varies fastest.",
)
@click.option(
    "--designs",
    type=PATH,
    metavar="FILE.csv",
    help="Sweep a list: a line of names, then one line for each design.",
)
@settings_by("Give a parameter that is not swept another value; repeatable.")
@instants()
@over
@click.option(
    "--xi",
    type=even_points,
    metavar=EVEN_POINTS,
    help="Keep section forces at these ratios xi/l too, each the largest over time.",
)
@wanted("An output that info CASE lists; all leaves out the motion; repeatable.")
@click.option(
    "--keep",
    type=click.Choice(KEEPS),
    default="peaks",
    show_default=True,
    help="Keep peaks, section laws too, or all outputs over time too.",
)
@untabled_rung
@click.option(
    "--workers",
    type=click.IntRange(1, MOST_THREADS),
    metavar="N",
    help="Threads of this machine; default: one a core.",
)
@click.option(
    "--dask",
    metavar="ADDRESS",
    help="Evaluate on a cluster: its Dask scheduler, as tcp://HOST:8786.",
)
@click.option(
    "--resume",
    is_flag=True,
    help="Go on with what is there of the same sweep; start where there is nothing.",
)
@click.option("--force", is_flag=True, help="Start anew, and replace what is there.")
@click.option("--yes", is_flag=True, help="Allow more than 10^9 designs.")
@click.option("--quiet", is_flag=True, help="Show no progress.")
@click.option("--out", type=PATH, help="The file; default: <case>_sweep.h5 here.")
def sweep(**given: Any) -> None:
    """Evaluate CASE for every design of a grid or a list, and write one HDF5 file.

    CASE is a folder with a case.py, a Python file, or one that cases lists. Of each design the
    peaks of what is wanted are kept, with their instants and places, and means of efforts. A
    stopped sweep goes on with --resume. best, table and plot read the file.

    \b
    lagrange-casadi sweep cases/slider_crank --grid l=0.12:0.4:57 --grid m3=0.1,0.5
    lagrange-casadi best slider_crank_sweep.h5 --minimise peak:section:rod:bending
    """
    from .sweep import sweep

    sweep(**given)


@click.command()
@click.argument("file", metavar="FILE.h5", type=PATH)
@click.option(
    "--minimise",
    multiple=True,
    metavar="COLUMN",
    help="The column to be least; with two objectives, their front.",
)
@click.option("--maximise", multiple=True, metavar="COLUMN", help="The column to be largest.")
@click.option(
    "--where",
    multiple=True,
    metavar="NAME<NUMBER",
    help="Only designs like this: <, <=, >, >=, == or !=; repeatable.",
)
@click.option(
    "--count",
    type=click.IntRange(1),
    metavar="N",
    help="How many; default: the best one, or the whole front.",
)
@click.option(
    "--column", "columns", multiple=True, metavar="COLUMN", help="Show this column too; repeatable."
)
@click.option("--csv", type=PATH, metavar="OUT.csv", help="Write them as CSV too.")
def best(**given: Any) -> None:
    """Name the best designs of the sweep FILE.h5; peaks count by their
    size, whatever their sign.
    """
    from .best import best

    best(**given)


@click.command()
@click.argument("file", metavar="FILE.h5", type=PATH)
@click.option(
    "--where",
    multiple=True,
    metavar="NAME<NUMBER",
    help="Only rows like this: <, <=, >, >=, == or !=; repeatable.",
)
@click.option(
    "--column",
    "columns",
    multiple=True,
    metavar="COLUMN",
    help="This column; repeatable. Default: the main peaks.",
)
@click.option(
    "--rows",
    type=click.IntRange(1),
    default=20,
    show_default=True,
    metavar="N",
    help="How many rows to show.",
)
@click.option(
    "--csv", type=PATH, metavar="OUT.csv", help="Write all rows; default: all columns without axes."
)
def table(**given: Any) -> None:
    """Show the designs of the sweep FILE.h5, or write them as CSV. A row is a design, or where
    columns have a value for every xi or t, a design at one of them."""
    from .table import table

    table(**given)


@click.command()
@click.argument("case", type=PATH)
@settings_by()
@instants()
@over
@wanted()
@click.option(
    "--accuracy",
    type=float,
    metavar="ERROR",
    help="Recommend the fastest method within this error of the peak.",
)
@click.option("--out", type=PATH, help="The numbers, as JSON; default: <case>_trade.json here.")
@click.option("--figure", type=PATH, help="The picture; default: <case>_trade.png here.")
def trade(**given: Any) -> None:
    """Measure time and error of every method on CASE, side by side: backends, precisions, Newton
    steps, tables, flags.
    """
    from .trade import trade

    trade(**given)


@click.command()
@click.argument("case", type=PATH)
@click.option("--out", type=PATH, required=True, metavar="DIR", help="The folder to write.")
@click.option("--name", metavar="NAME", help="What it is called in C; default: the case's name.")
@settings_by("Give a parameter another default; repeatable.")
@wanted()
@arithmetic
@click.option(
    "--largest",
    type=click.IntRange(0),
    metavar="BYTES",
    help="Most bytes of a table; default: 16 MB, in single precision 64 kB.",
)
@click.option(
    "--fmu",
    is_flag=True,
    help=(
        "Also write DIR/CASE.fmu, a unit of FMI 2.0 for simulation tools; needs FMPy and a C"
        " compiler."
    ),
)
@click.option(
    "--wasm",
    is_flag=True,
    help="Also write DIR/CASE.wasm for web pages, with a wrapper in JavaScript; needs ziglang.",
)
@click.option(
    "--force",
    is_flag=True,
    help="Write into a folder that holds other files too; these are not touched.",
)
def export(**given: Any) -> None:
    """Write CASE as C for other programs: a library, a self-test and an example, in a folder that
    stands alone.
    """
    from .export import export

    export(**given)


@click.command()
@click.argument("file", type=PATH)
@click.option("--out", type=PATH, required=True, help="The figures' folder.")
@click.option(
    "--over",
    multiple=True,
    metavar="NAME",
    help="Of a sweep: the parameter along the axis, two for maps; of a list, any.",
)
@click.option(
    "--at",
    type=place,
    multiple=True,
    metavar="NAME=VALUE",
    help="Of a sweep: where another parameter stays, or which designs of a list.",
)
@click.option(
    "--against",
    nargs=2,
    multiple=True,
    metavar="COLUMN COLUMN",
    help="Of a sweep: the front of these two columns or parameters.",
)
@click.option(
    "--si",
    is_flag=True,
    help="Axes in SI without prefixes, in place of units that people read, as kN and mm.",
)
def plot(**given: Any) -> None:
    """Draw the figures of FILE.h5, as its case wants them, or peaks over parameters where it is a
    sweep.
    """
    from .plot import plot

    plot(**given)


@click.command()
@click.argument("target", metavar="FILE.h5|CASE", type=PATH)
@click.option(
    "--out", type=PATH, metavar="REPORT.html", help="The page; default: <name>.html here."
)
@settings_by("Of a case: give a parameter another value.")
@instants("Of a case: instants [s]; default: its own.")
@over
@wanted("Of a case: what is shown besides motion; default: what it wants.")
@click.option(
    "--live",
    is_flag=True,
    help="Of a case: put the engine into the page, with sliders for the parameters; needs ziglang.",
)
@click.option("--case", type=PATH, help="Of a sweep: its case, for the mechanism in motion.")
def report(**given: Any) -> None:
    """Write a page that shows FILE.h5, or CASE evaluated, in any browser: one file, which needs no
    network and no Python.

    The mechanism moves, with its forces on it; charts and tables are beside it. Of a sweep there
    are maps, fronts, a table of designs, and the mechanism of the one that is pressed.
    """
    from .report_page import report

    report(**given)


@click.command()
@click.argument("target", metavar="FILE.h5|CASE", type=PATH)
@click.option(
    "--out",
    type=PATH,
    metavar="FILE.gif|FILE.mp4|FILE.svg|FILE.glb",
    help="The animation; default: <name>.gif here.",
)
@click.option("--forces", is_flag=True, help="Show reactions, efforts and loads as arrows.")
@click.option(
    "--section",
    default="",
    metavar="FORCE",
    help="Show a section force, as bending, as ribbons along links.",
)
@click.option("--no-names", is_flag=True, help="Leave out the joints' names.")
@click.option(
    "--width",
    type=int,
    default=WIDTH,
    show_default=True,
    metavar="PIXELS",
    help="Width of the picture.",
)
@click.option(
    "--rate", type=float, default=RATE, show_default=True, metavar="NUMBER", help="Frames a second."
)
@click.option(
    "--seconds",
    type=float,
    default=SECONDS,
    show_default=True,
    metavar="NUMBER",
    help="What a cycle takes.",
)
@settings_by("Of a case: give a parameter another value.")
@instants("Of a case: instants [s]; default: its own.")
@over
def animate(**given: Any) -> None:
    """Show FILE.h5, or CASE evaluated, in motion: one cycle, which repeats, from one file that
    needs nothing else.

    A GIF goes everywhere, an SVG is sharp at every size, an MP4 is small and needs ffmpeg. A GLB
    (glTF) has the solid bodies, for presentations and Blender.
    """
    from .animate import animate

    animate(**given)


@click.command()
@click.argument("target", metavar="CASE|FILE.h5|FILE.h5.parts", type=PATH)
@wanted("Count the instructions of these outputs; default: the case's.")
def info(**given: Any) -> None:
    """Describe a case: its parts, drives, loads, posture, what is wanted, and its instruction
    count. Or a file of a run or a sweep, finished or not."""
    from .info import info

    info(**given)


@click.command()
@click.argument("file", metavar="FILE.h5|FILE.h5.parts", type=PATH)
@click.option(
    "--untrusted",
    is_flag=True,
    help="Read it in a process of its own: forged files may crash or stall HDF5.",
)
@click.option(
    "--time-limit",
    type=float,
    metavar="SECONDS",
    help=f"What --untrusted may take; default: {TIME_LIMIT:g}.",
)
def check(**given: Any) -> int:
    """Read all of FILE.h5 and verify it: exit status 0 if nothing is wrong with it, else 1."""
    from .check import check

    return check(**given)


@click.command()
@click.argument("case", type=PATH)
@click.option(
    "--minimise",
    required=True,
    multiple=True,
    metavar="TERM",
    help="peak:QUANTITY, max:, mean: or rms:, or a parameter; repeated, for their front.",
)
@click.option(
    "--over",
    "bounds",
    type=bounds,
    multiple=True,
    required=True,
    metavar=BOUNDS,
    help="A parameter to choose; repeatable.",
)
@click.option(
    "--subject-to",
    "limits",
    multiple=True,
    metavar="'TERM<=NUMBER'",
    help="A limit, as 'peak:effort:O<=12'; repeatable.",
)
@click.option(
    "--starts",
    type=int,
    default=4,
    show_default=True,
    metavar="NUMBER",
    help="How many designs to start from.",
)
@click.option(
    "--screen",
    type=int,
    default=256,
    show_default=True,
    metavar="NUMBER",
    help="Among how many designs starts are chosen.",
)
@click.option(
    "--points",
    type=int,
    default=POINTS,
    show_default=True,
    metavar="NUMBER",
    help="Points of a front, at most.",
)
@click.option(
    "--transmission",
    type=float,
    default=0.05,
    show_default=True,
    metavar="SINE",
    help="Least sine of transmission angles.",
)
@settings_by("Give another parameter a value; repeatable.")
@instants()
@click.option(
    "--backend",
    type=click.Choice(BACKENDS),
    default="auto",
    show_default=True,
    help="What evaluates designs.",
)
@click.option(
    "--dask", metavar="ADDRESS", help="Search on a cluster: its Dask scheduler, as tcp://HOST:8786."
)
@click.option(
    "--resume",
    is_flag=True,
    help="Go on with a search that was stopped; start where there is nothing.",
)
@click.option("--force", is_flag=True, help="Start anew, whatever is there.")
@click.option(
    "--out", type=PATH, help="History and result, as HDF5; default: <case>_optimum.h5 here."
)
@click.option("--figure", type=PATH, help="The picture; default: <case>_optimum.png here.")
def optimise(**given: Any) -> int:
    """Find the design of CASE for which a peak or a mean is least, within limits that hold over the
    whole motion.

    Of several terms it finds their front: designs of which none is better in all of them. A search
    that was stopped leaves the best so far, and goes on with --resume.
    """
    from .optimise import optimise

    return optimise(**given)


@click.command()
@click.argument("case", type=PATH)
@click.option(
    "--tolerance",
    "within",
    type=tolerance,
    multiple=True,
    required=True,
    metavar="NAME=VALUE",
    help="Plus or minus; repeatable.",
)
@settings_by()
@instants()
@over
@wanted("As in run; default: the case's; repeatable.")
@click.option(
    "--samples",
    type=int,
    default=SAMPLES,
    show_default=True,
    metavar="NUMBER",
    help="Designs drawn at random.",
)
@click.option(
    "--backend",
    type=click.Choice(BACKENDS),
    default="auto",
    show_default=True,
    help="What evaluates designs.",
)
@click.option("--csv", "out", type=PATH, metavar="FILE.csv", help="All peaks, a row each.")
def tolerances(**given: Any) -> None:
    """Tell how far the peaks of CASE spread where parameters are within tolerances, and what each
    of these adds.
    """
    from .tolerances import tolerances

    tolerances(**given)


@click.command(name="size")
@click.argument("case", type=PATH)
@click.option(
    "--profiles",
    type=PATH,
    metavar="FILE.csv",
    help="A column name, and one for each dimension [m].",
)
@click.option(
    "--safety",
    type=float,
    default=2.0,
    show_default=True,
    metavar="FACTOR",
    help="The least factor of safety.",
)
@click.option(
    "--deflection",
    type=share,
    metavar="SHARE",
    help="The largest deflection across a link over its length, as 1/500. Default: any.",
)
@click.option(
    "--link",
    "links",
    multiple=True,
    metavar="LINK",
    help="Size this link; repeatable. Default: all that profiles fit.",
)
@click.option(
    "--criterion",
    type=click.Choice(CRITERIA),
    default="goodman",
    show_default=True,
    help="How a mean counts.",
)
@click.option(
    "--yielding",
    type=click.Choice(YIELDING),
    default="von_mises",
    show_default=True,
    help="The stress that yields.",
)
@settings_by()
@instants()
@over
def size(**given: Any) -> None:
    """Choose for each link of CASE, of the profiles of a table, the lightest that is safe under the
    loads that its mass brings.
    """
    from .size import size_command

    size_command(**given)


@click.command(name="drive")
@click.argument("case", type=PATH)
@click.option(
    "--motors", type=PATH, metavar="FILE.csv", help="A catalogue; default: motors.csv of the case."
)
@click.option(
    "--drive",
    "drives",
    multiple=True,
    metavar="JOINT",
    help="This drive; repeatable. Default: all.",
)
@click.option(
    "--ratio",
    "ratios",
    multiple=True,
    callback=ratios,
    metavar="NUMBER,...",
    help="Turns of the motor for one of the drive; of several the best is taken. Default: 1.",
)
@click.option(
    "--lead",
    type=length,
    metavar="LENGTH",
    help="Of a drive that slides by a screw or belt: its way in a turn [m].",
)
@click.option(
    "--efficiency",
    type=float,
    default=1.0,
    show_default=True,
    metavar="SHARE",
    help="That of the gearbox.",
)
@click.option(
    "--inertia",
    type=float,
    default=0.0,
    metavar="NUMBER",
    help="What turns with the motor's shaft [kg m^2].",
)
@settings_by()
@instants("Instants [s], over a whole cycle; default: the case's.")
@over
@click.option(
    "--plot", type=PATH, metavar="FILE.png", help="Draw torque over speed; also .pdf, .svg."
)
def drive(**given: Any) -> None:
    """Tell what a cycle of CASE asks of the motors of its drives, and which of a catalogue is the
    smallest that serves.
    """
    from .drive import drive_command

    drive_command(**given)


@click.command()
@click.option("--copy", type=PATH, metavar="FOLDER", help="Copy all of them into a new folder.")
def cases(**given: Any) -> None:
    """List the cases that come with the package, or copy them.

    Each is run by its name, as in run four_bar.
    """
    from .cases import cases

    cases(**given)


@click.command()
@click.argument("folder", type=PATH)
@click.option(
    "--like",
    default=SIMPLE,
    show_default=True,
    metavar="NAME",
    help="Begin with this case of those that cases lists.",
)
def new(**given: Any) -> None:
    """Begin a case of your own in the new FOLDER, as a copy of one that comes with the package,
    under the folder's name.
    """
    from .new import new

    new(**given)


@click.command()
@click.option("--clear", is_flag=True, help="Remove all of it.")
def cache(**given: Any) -> None:
    """Show where the cache of graphs and libraries is, how much it holds and
    may hold; or empty it.
    """
    from .cache import cache

    cache(**given)


COMMANDS = (
    run, sweep, best, table, trade, export, plot, report, animate, info, check, optimise,
        tolerances, size, drive, cases, new, cache
)  # fmt: skip
"""Commands in the order of the help."""

"""The commands and their groups: what each is asked, in files that load nothing else.

What a command does is imported when it is run.
"""

from __future__ import annotations

import click

from ..base.packages import check_installed
from ..base.space import MOST_THREADS
from ..base.vocabulary import LOAD_FORMATS, RATE, SECONDS, TIME_LIMIT, WIDTH
from .design_commands import (
    best,
    drive,
    free,
    identify,
    optimise,
    size,
    sweep,
    table,
    tolerances,
    trade,
)
from .echo import say_step
from .help import Body, command
from .options import (
    CASE,
    EVEN_POINTS,
    PATH,
    arithmetic,
    at_values,
    even_points,
    file,
    flag,
    instants,
    method,
    named,
    over,
    pair,
    place,
    setting,
    settings_by,
    several,
    svg,
    table_file,
    value,
    wanted,
)


@command
@click.argument("case", type=CASE)
@at_values
@value(
    "--xi",
    even_points,
    EVEN_POINTS,
    "Set the ratios xi/l at which sections are stored, within 0 (base) and 1 (tip); default:"
    " those of the case.",
)
@wanted(
    "Compute these outputs: effort, reaction:JOINT, section:LINK, motion, sensitivity:PARAMETER, a"
    " kind such as section, or all; repeatable. Default: those of the case."
)
@method
@value(
    "--threads",
    click.IntRange(1, MOST_THREADS),
    "N",
    "Use this number of threads; default: one per core.",
)
@file("--out", "Write the results to this HDF5 file; default: <case>.h5 here.")
@file("--figures", "Draw the figures into this folder; default: <case>_figures here.")
@flag("--no-figures", "Draw no figures.")
@svg
@table_file("Also write the results as CSV, one row per instant.")
@click.option(
    "--grids/--no-grids",
    default=None,
    help="Store section forces at all ratios xi/l beside their laws, of all links or of none;"
    " default: of all but pieces of bent bars.",
)
@flag("--refine-peaks", "Search for the listed peaks between the instants too.")
@flag(
    "--elastic", "Determine statically indeterminate forces by the elasticity of the links' beams."
)
@flag("--no-certificate", "Do not check the results by an independent balance of forces.")
@flag("--verbose", "List all quantities, with strength and deflection in full.")
def run() -> Body:
    """Compute efforts, reactions and section forces of CASE.

    CASE is a folder with a case.py, a Python file, or a name that the command cases lists. The
    largest values are listed, all results are written to an HDF5 file, and figures are drawn.
    """
    from .run import run

    return run


@command
@click.argument("case", type=CASE)
@file("--out", "Write into this folder.", metavar="DIR")
@file(
    "--model",
    "Write the mechanism as data for other programs: bodies, joints, motions.",
    metavar="FILE.json",
)
@value("--name", str, "NAME", "Set the prefix of the names in C; default: the case's name.")
@settings_by("Set the default of a parameter, as l=0.25 or phi=30deg; repeatable.")
@wanted()
@arithmetic
@value(
    "--largest",
    click.IntRange(0),
    "BYTES",
    "Limit the size of a table [bytes]; default: 16 MB, in single precision 64 kB.",
)
@flag(
    "--fmu",
    "Also write DIR/CASE.fmu, a unit of FMI 2.0 for simulation tools; needs FMPy and a C compiler.",
)
@value(
    "--fmu-by",
    str,
    "time|COORDINATE",
    "With --fmu, put the case's motion inside: the input is the time, or the place of this"
    " coordinate, as a crank's angle.",
)
@flag(
    "--control",
    "Also write DIR/CASE_control.hpp, a class of C++ for controllers as ros2_control's.",
)
@flag("--structured-text", "Also write DIR/CASE.st, function blocks of IEC 61131-3 for PLCs.")
@flag(
    "--wasm", "Also write DIR/CASE.wasm for web pages, with a wrapper in JavaScript; needs ziglang."
)
@flag("--force", "Write into a folder that holds other files as well; these are left as they are.")
def export() -> Body:
    """Write CASE as C for other programs.

    The folder stands alone: it has the library, a self-test and an example.
    """
    from .export import export

    return export


@command
@click.argument("file", type=PATH)
@file("--out", "Draw into this folder.", required=True)
@several(
    "--over",
    "NAME",
    "For a sweep: draw over this parameter, for maps over two; for a list of designs, over any.",
)
@named(
    "--at",
    "NAME=VALUE",
    "For a sweep: keep another parameter at this value, or choose designs of a list.",
    kind=place,
    into="at",
    twice="a parameter stays at one value, got two for '{}'",
)
@click.option(
    "--against",
    nargs=2,
    multiple=True,
    metavar="COLUMN COLUMN",
    help="For a sweep: draw the Pareto front of these two columns or parameters.",
)
@flag("--si", "Draw axes in SI units without prefixes, in place of kN and mm.")
@svg
def plot() -> Body:
    """Draw the figures of the run or sweep FILE.h5.

    A run has the figures of its case, a sweep has its peaks over parameters.
    """
    from .plot import plot

    return plot


@command
@click.argument(
    "targets", metavar="FILE.h5|CASE [FILE.h5|CASE]", type=CASE, nargs=-1, required=True
)
@file("--out", "Write the page to this file; default: <name>.html here.", metavar="REPORT.html")
@settings_by("For a case: set a parameter, as l=0.25 or phi=30deg; repeatable.")
@instants("For a case: set the instants [s], both ends included; default: those of the case.")
@over
@wanted("For a case: show these outputs besides the motion; default: those of the case.")
@flag(
    "--live",
    "For a case: put the evaluation into the page, with sliders for the parameters; needs ziglang.",
)
@named(
    "--beside",
    "NAME=VALUE",
    "For a case: show a second design beside it, with this parameter changed; repeatable.",
    kind=setting,
    into="beside",
)
@click.option("--case", type=CASE, help="For a sweep: show the mechanism of this case in motion.")
def report() -> Body:
    """Write a page for browsers about FILE.h5 or CASE, or about two of them side by side.

    It is one file, which needs no network and no Python. The mechanism moves with its forces drawn
    on it, next to charts and tables. For a sweep there are maps, fronts and a table of designs;
    click a design to see its mechanism move.
    """
    if click.get_current_context().params["live"]:
        # What is imported takes a second or more.
        check_installed("ziglang", "a live report", "live")
        say_step(1, "loading the program")
    from .report_page import report

    return report


@command
@click.argument("target", metavar="FILE.h5|CASE", type=CASE)
@file(
    "--out",
    "Write the animation to this file; default: <name>.gif here.",
    metavar="FILE.gif|FILE.mp4|FILE.svg|FILE.glb",
)
@flag("--forces", "Draw reactions, efforts and loads as arrows.")
@click.option(
    "--section",
    default="",
    metavar="FORCE",
    help="Draw a section force, as bending, as ribbons along the links.",
)
@flag("--no-names", "Do not write the names of joints.")
@value("--width", int, "PIXELS", "Set the width of the picture [pixels].", default=WIDTH)
@value("--rate", float, "NUMBER", "Set the number of frames per second.", default=RATE)
@value("--seconds", float, "NUMBER", "Set the playing time of one cycle [s].", default=SECONDS)
@settings_by("For a case: set a parameter, as l=0.25 or phi=30deg; repeatable.")
@instants("For a case: set the instants [s], both ends included; default: those of the case.")
@over
def animate() -> Body:
    """Write an animation of FILE.h5 or CASE.

    It shows one cycle, again and again. A GIF works everywhere, an SVG is sharp at every size, an
    MP4 is small and needs ffmpeg. A GLB (glTF) has the solid bodies, for presentations and Blender.
    """
    from .animate import animate

    return animate


@command
@click.argument("target", metavar="CASE|FILE.h5|FILE.h5.parts", type=CASE)
@wanted("Count the instructions of these outputs; default: those of the case.")
def info() -> Body:
    """Describe a case, or the file of a run or a sweep.

    For a case it lists parts, drives, loads, posture, wanted outputs and the number of
    instructions. A sweep need not be finished.
    """
    from .info import info

    return info


@command
@click.argument("file", metavar="FILE.h5|FILE.h5.parts", type=PATH)
@flag("--untrusted", "Read the file in a process of its own: forged files may crash or stall HDF5.")
@value(
    "--time-limit", float, "SECONDS", f"Limit the time of --untrusted [s]; default: {TIME_LIMIT:g}."
)
def check() -> Body:
    """Check that FILE.h5 is whole and consistent.

    The exit status is 0 if it is, else 1.
    """
    from .check import check

    return check


@command
@file("--copy", "Copy all of them into this new folder.", metavar="FOLDER")
def cases() -> Body:
    """List the cases that come with the package, or copy them.

    The name of each is a CASE for the other commands, as in run four_bar.
    """
    from .cases import cases

    return cases


@command
@click.argument("folder", type=PATH)
@value("--like", str, "NAME", "Copy this case; the command cases lists all.")
@click.option(
    "--from",
    "source",
    type=PATH,
    metavar="FILE",
    help="Begin with a model of another program: .json, .asmt, .urdf, .sdf or .xml (MuJoCo).",
)
@flag("--accept-inertias", "Take moments of inertia that no body has as FILE gives them.")
def new() -> Body:
    """Begin a case of your own in a new FOLDER.

    It is a copy of one that comes with the package, under the folder's name, or a model of another
    program that is written as a case.
    """
    from .cases import new

    return new


@command
@flag("--clear", "Remove all graphs and libraries from the cache.")
def cache() -> Body:
    """Show the cache of graphs and compiled libraries, or empty it.

    It lists the folder, its size, and the limit of that.
    """
    from .cache import cache

    return cache


@command
@click.argument("case", type=CASE)
@several(
    "--link",
    "NAME",
    "Write the load cases of this link, rigid body or point mass; repeatable.",
    into="links",
)
@file("--out", "Write into this folder.", metavar="DIR", required=True)
@at_values
@flag(
    "--every",
    "Write a load case for every instant; default: for those at which a section force or a stress"
    " of the link, or a reaction on it, is largest.",
)
@several(
    "--format",
    None,
    "Write this format; repeatable. inp is included by input files of CalculiX and Abaqus; beam is"
    " a model that CalculiX runs. Default: all.",
    kind=click.Choice(LOAD_FORMATS),
    into="formats",
)
@named(
    "--node",
    "JOINT=NAME",
    "Name the node set, or the number, of the node in your mesh that takes a joint's load;"
    " LINK=NAME names the element set; repeatable.",
    kind=pair,
    into="nodes",
    twice="'{}' is named twice",
)
@several(
    "--spectrum",
    "NAME",
    "Write the rainflow matrix of a quantity, as reaction:A:fx, section:rod:bending@0.5 or"
    " stress:rod@0.5; repeatable.",
    into="spectra",
)
@value(
    "--classes",
    click.IntRange(0),
    "N",
    "Set the classes of --spectrum, 0 for every cycle as it is; default: 64.",
    default=64,
    shown=False,
)
@several(
    "--bearing",
    "JOINT",
    "Write equivalent loads and the speed of this joint for catalogues of bearings; repeatable.",
    into="bearings",
)
@value(
    "--exponent",
    float,
    "P",
    "Set the exponent of --bearing: 3 for balls, 10/3 for rollers; default: 3.",
    default=3.0,
    shown=False,
)
def loads() -> Body:
    """Write loads on links of CASE for finite elements, and load spectra.

    Each load case has the forces and moments on the link, its acceleration and gravity, on the
    link's own axes. These are in equilibrium.
    """
    from .loads import loads

    return loads


GROUPS = {
    "Run": (run, info, check, cases, new),
    "Many designs": (sweep, best, table),
    "Design": (optimise, size, drive, free, tolerances, trade),
    "Measurements": (identify,),
    "Other programs": (export, loads),
    "Look": (plot, report, animate),
    "Cache": (cache,),
}
"""The commands as help lists them."""

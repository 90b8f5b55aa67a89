"""The commands for many designs and for design: what each is asked.

What a command does is imported when it is run.
"""

from __future__ import annotations

from typing import Any

import click

from ..base.space import MOST_THREADS
from ..base.vocabulary import (
    CRITERIA,
    KEEPS,
    PEAK_SEARCHES,
    POINTS,
    SAMPLES,
    YIELDING,
)
from .help import command
from .options import (
    AXIS,
    BOUNDS,
    CASE,
    EVEN_POINTS,
    PATH,
    at_values,
    axis,
    backend,
    bounds,
    conditions,
    even_points,
    instants,
    length,
    over,
    place,
    ratios,
    resumable,
    settings_by,
    share,
    table_file,
    tolerance,
    untabled_method,
    wanted,
)


@command()
@click.argument("case", type=CASE)
@click.option(
    "--grid",
    "axes",
    type=axis,
    metavar=AXIS,
    multiple=True,
    help="Sweep a parameter over a range or a list of values, in SI units or with a unit;"
    " repeatable, the"
    " last varies fastest.",
)
@click.option(
    "--designs",
    type=PATH,
    metavar="FILE.csv",
    help="Sweep the designs of a list: one row of parameter names, then one row per design.",
)
@settings_by("Set a parameter that is not swept, as l=0.25 or phi=30deg; repeatable.")
@instants()
@over
@click.option(
    "--xi",
    type=even_points,
    metavar=EVEN_POINTS,
    help="Also store the peak over time of the section forces at each of these ratios xi/l.",
)
@wanted("Compute these outputs, as info CASE lists them; all leaves out the motion; repeatable.")
@click.option(
    "--keep",
    type=click.Choice(KEEPS),
    default="peaks",
    show_default=True,
    help="Store of each design its peaks only, its section laws as well, or all outputs over time"
    " as"
    " well.",
)
@click.option(
    "--peaks",
    type=click.Choice(PEAK_SEARCHES),
    default="exact",
    show_default=True,
    help="Seek peaks between the instants, or take those of the instants, each with an error.",
)
@untabled_method
@click.option(
    "--workers",
    type=click.IntRange(1, MOST_THREADS),
    metavar="N",
    help="Use this number of threads; default: one per core.",
)
@click.option(
    "--dask",
    metavar="ADDRESS",
    help="Evaluate on the cluster of this Dask scheduler, as tcp://HOST:8786.",
)
@resumable("sweep")
@click.option("--yes", is_flag=True, help="Allow more than 10^9 designs.")
@click.option("--quiet", is_flag=True, help="Show no progress.")
@click.option(
    "--out", type=PATH, help="Write the sweep to this HDF5 file; default: <case>_sweep.h5 here."
)
def sweep(**given: Any) -> None:
    """Compute CASE for each design of a grid or a list.

    CASE is a folder with a case.py, a Python file, or a name that the command cases lists. One HDF5
    file stores, for each design, the peaks of the outputs with their times and places, and the
    means of efforts. A sweep that was stopped continues with --resume. The commands best, table and
    plot read the file.

    \b
    lagrange-casadi sweep cases/slider_crank --grid l=0.12:0.4:57 --grid m3=0.1,0.5
    lagrange-casadi best slider_crank_sweep.h5 --minimise peak:section:rod:bending
    """
    from .sweep import sweep

    sweep(**given)


@command()
@click.argument("file", metavar="FILE.h5", type=PATH)
@click.option(
    "--minimise",
    multiple=True,
    metavar="COLUMN",
    help="Minimise this column; of two objectives, list their Pareto front.",
)
@click.option("--maximise", multiple=True, metavar="COLUMN", help="Maximise this column.")
@conditions("designs")
@click.option(
    "--count",
    type=click.IntRange(1),
    metavar="N",
    help="List this number of designs; default: the best one, or the whole front.",
)
@click.option(
    "--column", "columns", multiple=True, metavar="COLUMN", help="List this column too; repeatable."
)
@table_file("Also write the designs as CSV.")
def best(**given: Any) -> None:
    """List the best designs of the sweep FILE.h5.

    Peaks are compared by their size, whatever their sign.
    """
    from .best import best

    best(**given)


@command()
@click.argument("file", metavar="FILE.h5", type=PATH)
@conditions("rows")
@click.option(
    "--column",
    "columns",
    multiple=True,
    metavar="COLUMN",
    help="List this column; repeatable. Default: the main peaks.",
)
@click.option(
    "--rows",
    type=click.IntRange(1),
    default=20,
    show_default=True,
    metavar="N",
    help="List this number of rows.",
)
@table_file("Write all rows as CSV; default: all columns without axes.")
def table(**given: Any) -> None:
    """List the designs of the sweep FILE.h5, or write them as CSV.

    A row is a design; for columns with a value at each xi or t, it is a design at one of these.
    """
    from .table import table

    table(**given)


@command()
@click.argument("case", type=CASE)
@click.option(
    "--minimise",
    required=True,
    multiple=True,
    metavar="TERM",
    help="Minimise peak:QUANTITY, max:, mean: or rms: of one, or a parameter; repeated: find the"
    " Pareto"
    " front.",
)
@click.option(
    "--over",
    "bounds",
    type=bounds,
    multiple=True,
    required=True,
    metavar=BOUNDS,
    help="Choose this parameter between two bounds, in SI units or with a unit; repeatable.",
)
@click.option(
    "--subject-to",
    "limits",
    multiple=True,
    metavar="'TERM<=NUMBER'",
    help="Keep within this limit, in SI units, as 'peak:effort:O<=12'; repeatable.",
)
@click.option(
    "--starts",
    type=int,
    default=4,
    show_default=True,
    metavar="NUMBER",
    help="Start from this number of designs.",
)
@click.option(
    "--screen",
    type=int,
    default=256,
    show_default=True,
    metavar="NUMBER",
    help="Choose the starts among this number of designs.",
)
@click.option(
    "--points",
    type=int,
    default=POINTS,
    show_default=True,
    metavar="NUMBER",
    help="Find at most this number of points of a front.",
)
@click.option(
    "--transmission",
    type=float,
    default=0.05,
    show_default=True,
    metavar="SINE",
    help="Keep the sine of all transmission angles above this number.",
)
@settings_by("Set a parameter that is not chosen, as l=0.25 or phi=30deg; repeatable.")
@instants()
@backend(" designs")
@click.option(
    "--dask",
    metavar="ADDRESS",
    help="Search on the cluster of this Dask scheduler, as tcp://HOST:8786.",
)
@resumable("search")
@click.option(
    "--out",
    type=PATH,
    help="Write history and result to this HDF5 file; default: <case>_optimum.h5 here.",
)
@click.option(
    "--figure", type=PATH, help="Draw the history into this file; default: <case>_optimum.png here."
)
def optimise(**given: Any) -> int:
    """Find the design of CASE with the least peak or mean.

    Limits hold over the whole motion. For several terms it finds their Pareto front: designs of
    which none is better in all terms. A search that was stopped keeps the best design so far, and
    continues with --resume.
    """
    from .optimise import optimise

    return optimise(**given)


@command("size")
@click.argument("case", type=CASE)
@click.option(
    "--profiles",
    type=PATH,
    metavar="FILE.csv|NAME",
    help="Choose from this table: a column name, and one column per dimension [m]; or by name from"
    " a standard one: IPE, HEA, HEB, CHS, SHS, RHS, SHS_cold, RHS_cold, flat, round. Default:"
    " profiles.csv next to the case.",
)
@click.option(
    "--safety",
    type=float,
    default=2.0,
    show_default=True,
    metavar="FACTOR",
    help="Demand this factor of safety at least.",
)
@click.option(
    "--deflection",
    type=share,
    metavar="SHARE",
    help="Limit the deflection across a link over its length, as 1/500. Default: no limit.",
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
    help="Count mean stress in fatigue by this criterion.",
)
@click.option(
    "--yielding",
    type=click.Choice(YIELDING),
    default="von_mises",
    show_default=True,
    help="Compare this equivalent stress with the yield strength.",
)
@at_values
def size(**given: Any) -> None:
    """Choose the lightest safe profile for each link of CASE.

    The loads follow the masses of the chosen profiles.
    """
    from .size import size_command

    size_command(**given)


@command("free")
@click.argument("case", type=CASE)
@click.option(
    "--drive",
    metavar="LAW=NUMBER,...",
    help="Drive it by torque=TORQUE [N m], power=POWER [W], dc=STALL_TORQUE,NO_LOAD_SPEED or"
    " induction=BREAKDOWN_TORQUE,BREAKDOWN_SLIP,SYNCHRONOUS_SPEED [rad/s]. Default: nothing; of a"
    " steady cycle the torque that keeps the mean speed.",
)
@click.option(
    "--geared",
    type=float,
    default=1.0,
    show_default=True,
    metavar="NUMBER",
    help="Let the motor turn so many times as fast as the drive.",
)
@click.option(
    "--load", type=float, default=0.0, metavar="NUMBER", help="Let this torque resist [N m]."
)
@click.option(
    "--inertia",
    type=float,
    default=0.0,
    metavar="NUMBER",
    help="Put a flywheel of this inertia on the drive [kg m^2].",
)
@click.option(
    "--start",
    metavar="COORDINATE,RATE",
    help="Start there [rad, rad/s or m, m/s]; default: where the motion of the case starts.",
)
@click.option("--steady", is_flag=True, help="Find the steady cycle, and go round once.")
@click.option(
    "--fluctuation",
    type=float,
    metavar="NUMBER",
    help="Find the flywheel with which the steady cycle has this coefficient of fluctuation.",
)
@click.option(
    "--cycle",
    type=float,
    default=1.0,
    show_default=True,
    metavar="TURNS",
    help="Say after how many turns the machine repeats.",
)
@click.option(
    "--count",
    type=int,
    default=721,
    show_default=True,
    metavar="NUMBER",
    help="Take so many instants of a steady cycle.",
)
@settings_by()
@instants()
@wanted()
@click.option("--out", type=PATH, help="Write the run to this HDF5 file; default: <case>_free.h5.")
@click.option(
    "--plot",
    type=PATH,
    metavar="FILE.png",
    help="Draw torque and speed over the drive's coordinate into this file, .png, .pdf or .svg.",
)
def free(**given: Any) -> None:
    """Let the machine CASE go: its motion under a motor, a load and its own weight.

    Each force is that of the true motion. CASE has one degree of freedom; its own motion says
    where it starts, and no more.

    \b
    lagrange-casadi free punch_press --drive induction=200,0.2,157 --geared 15 --fluctuation 0.05
    """
    from .free import free_command

    free_command(**given)


@command("drive")
@click.argument("case", type=CASE)
@click.option(
    "--motors",
    type=PATH,
    metavar="FILE.csv|NAME",
    help="Choose from this catalogue, or by name from a class of motors: servo, induction; default:"
    " motors.csv next to the case.",
)
@click.option(
    "--drive",
    "drives",
    multiple=True,
    metavar="JOINT",
    help="Choose a motor for this drive; repeatable. Default: all drives.",
)
@click.option(
    "--ratio",
    "ratios",
    multiple=True,
    callback=ratios,
    metavar="NUMBER,...",
    help="Set the gear ratio, turns of the motor per turn of the drive; the best of several is"
    " taken."
    " Default: 1.",
)
@click.option(
    "--lead",
    type=length,
    metavar="LENGTH",
    help="Set the travel per turn [m] of the screw or belt of a sliding drive.",
)
@click.option(
    "--efficiency",
    type=float,
    default=1.0,
    show_default=True,
    metavar="SHARE",
    help="Set the efficiency of the gearbox, from 0 to 1.",
)
@click.option(
    "--inertia",
    type=float,
    default=0.0,
    metavar="NUMBER",
    help="Add this moment of inertia to that of the motor's rotor [kg m^2].",
)
@settings_by()
@instants(
    "Set the instants [s] over a whole cycle, both ends included; default: those of the case."
)
@over
@click.option(
    "--plot",
    type=PATH,
    metavar="FILE.png",
    help="Draw torque over speed into this file, .png, .pdf or .svg.",
)
def drive(**given: Any) -> None:
    """Choose the smallest motor that suits each drive of CASE.

    It lists the speeds, torques and power that a cycle demands, and the reserves of the motor.
    """
    from .drive import drive_command

    drive_command(**given)


@command()
@click.argument("case", type=CASE)
@click.option(
    "--tolerance",
    "within",
    type=tolerance,
    multiple=True,
    required=True,
    metavar="NAME=VALUE",
    help="Set the tolerance of a parameter, plus or minus this value [SI unit, unit or %];"
    " repeatable.",
)
@at_values
@wanted("Compute these outputs, as in run; repeatable. Default: those of the case.")
@click.option(
    "--samples",
    type=int,
    default=SAMPLES,
    show_default=True,
    metavar="NUMBER",
    help="Draw this number of designs at random.",
)
@backend(" designs")
@table_file("Write the peaks as CSV, one row per quantity.")
def tolerances(**given: Any) -> None:
    """Compute the scatter of the peaks of CASE within tolerances.

    It lists the share of each tolerance in the scatter.
    """
    from .tolerances import tolerances

    tolerances(**given)


@command()
@click.argument("case", type=CASE)
@at_values
@wanted()
@click.option(
    "--accuracy",
    type=float,
    metavar="ERROR",
    help="Recommend the fastest method whose error, over the peak, is within this number.",
)
@click.option(
    "--out", type=PATH, help="Write the numbers to this JSON file; default: <case>_trade.json here."
)
@click.option(
    "--figure",
    type=PATH,
    help="Draw time over error into this file; default: <case>_trade.png here.",
)
def trade(**given: Any) -> None:
    """Measure time and error of each evaluation method on CASE.

    Methods differ in backend, precision, Newton steps, tables and compiler flags.
    """
    from .trade import trade

    trade(**given)


@command()
@click.argument("case", type=CASE)
@click.argument("data", metavar="DATA.csv", type=PATH)
@click.option(
    "--unknown",
    multiple=True,
    metavar="NAME",
    help="Find this parameter; repeatable. Default: all parameters of the case.",
)
@settings_by("Set a known parameter, or the first value of an unknown one, as l=0.25; repeatable.")
@click.option(
    "--column",
    "names",
    type=tolerance,
    multiple=True,
    metavar="NAME=HEAD",
    help="Read a drive's coordinate, or a force as effort:O, from the column of this head;"
    " repeatable.",
)
@click.option(
    "--noise",
    type=place,
    multiple=True,
    metavar="NAME=NUMBER",
    help="State the standard deviation of a column, in the unit of the file; repeatable.",
)
@click.option(
    "--prior",
    type=place,
    multiple=True,
    metavar="NAME=NUMBER",
    help="State how sure the first value of a parameter is, as a standard deviation; repeatable.",
)
@click.option(
    "--counts-per-turn",
    type=float,
    metavar="NUMBER",
    help="Set the number of counts of an encoder in one turn.",
)
@click.option("--robust", is_flag=True, help="Let outliers count less, by Huber's loss.")
@click.option(
    "--consistent",
    is_flag=True,
    help="Find positive masses, inertias that a body can have, and parameters in their bounds.",
)
@click.option(
    "--cutoff",
    type=float,
    metavar="HZ",
    help="Filter forces without delay; half the power is left at this frequency.",
)
@click.option(
    "--trim",
    type=float,
    default=0.0,
    show_default=True,
    metavar="SECONDS",
    help="Leave out this time at both ends of the record.",
)
@click.option(
    "--validate",
    type=PATH,
    metavar="OTHER.csv",
    help="Compare this other record with the model that was found.",
)
@click.option("--out", type=PATH, help="Write to this HDF5 file; default: <case>_identified.h5.")
@click.option(
    "--figure",
    type=PATH,
    metavar="FILE",
    help="Draw measured and model to this .png, .pdf or .svg.",
)
@click.option(
    "--report",
    type=PATH,
    metavar="FILE.html",
    help="Write a page with all tables and pictures.",
)
def identify(**given: Any) -> None:
    """Find parameters of CASE from motion and forces that were measured.

    The first line of DATA.csv has names and units of columns: t [s], the coordinates of all drives,
    as O [deg], and forces, as effort:O [N m], reaction:A:fx [N], section:rod:axial@0.5 [N]. The
    command prints combinations of parameters that the data determine, with standard errors, and the
    values as options --set.

    \b
    lagrange-casadi identify cases/slider_crank run.csv --unknown m3 --noise 'effort:O=0.05'
    """
    from .identify import identify_command

    identify_command(**given)

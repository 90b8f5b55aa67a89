"""The commands for many designs and for design: what each is asked.

What a command does is imported when it is run.
"""

from __future__ import annotations

import click

from ..base.space import MOST_THREADS
from ..base.vocabulary import CRITERIA, KEEPS, PEAK_SEARCHES, POINTS, SAMPLES, YIELDING
from .help import Body, command
from .options import (
    AXIS,
    BOUNDS,
    CASE,
    EVEN_POINTS,
    PATH,
    at_values,
    axis,
    backend_of_designs,
    bounds,
    choice,
    conditions,
    counts,
    even_points,
    file,
    flag,
    instants,
    length,
    method_of_designs,
    named,
    over,
    pair,
    place,
    ratios,
    resumable,
    separated,
    settings_by,
    several,
    share,
    table_file,
    tolerance,
    value,
    wanted,
)


@command
@click.argument("case", type=CASE)
@named(
    "--grid",
    AXIS,
    "Sweep a parameter over a range or a list of values, in SI units or with a unit; repeatable,"
    " the last varies fastest.",
    kind=axis,
    into="axes",
    twice="parameter '{}' is swept twice",
)
@file(
    "--designs",
    "Sweep the designs of a list: one row of parameter names, then one row per design.",
    metavar="FILE.csv",
)
@settings_by("Set a parameter that is not swept, as l=0.25 or phi=30deg; repeatable.")
@instants()
@over
@value(
    "--xi",
    even_points,
    EVEN_POINTS,
    "Also store the peak over time of the section forces at each of these ratios xi/l.",
)
@wanted("Compute these outputs, as info CASE lists them; all leaves out the motion; repeatable.")
@choice(
    "--keep",
    KEEPS,
    "peaks",
    "Store for each design its peaks only, its section laws as well, or all outputs over time as"
    " well.",
)
@choice(
    "--peaks",
    PEAK_SEARCHES,
    "exact",
    "Search for peaks between the instants, or take those of the instants, each with an error.",
)
@flag(
    "--fluctuation",
    "Store the fluctuation of energy of each drive as well, for which a flywheel is sized.",
)
@method_of_designs
@value(
    "--workers",
    click.IntRange(1, MOST_THREADS),
    "N",
    "Use this number of threads, or send a cluster this number of blocks at a time; default: one"
    " per core, or 128.",
)
@value(
    "--dask", str, "ADDRESS", "Evaluate on the cluster of this Dask scheduler, as tcp://HOST:8786."
)
@resumable("sweep")
@flag("--yes", "Allow more than 10^9 designs.", into="many")
@flag("--quiet", "Show no progress.")
@file("--out", "Write the sweep to this HDF5 file; default: <case>_sweep.h5 here.")
def sweep() -> Body:
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

    return sweep


@command
@click.argument("file", metavar="FILE.h5", type=PATH)
@several(
    "--minimise", "COLUMN", "Minimise this column; of two objectives, list their Pareto front."
)
@several("--maximise", "COLUMN", "Maximise this column.")
@conditions("designs")
@value(
    "--count",
    click.IntRange(1),
    "N",
    "List this number of designs; default: the best one, or the whole front.",
)
@several("--column", "COLUMN", "List this column too; repeatable.", into="columns")
@table_file("Also write the designs as CSV.")
def best() -> Body:
    """List the best designs of the sweep FILE.h5.

    Peaks are compared by their size, whatever their sign.
    """
    from .table import best

    return best


@command
@click.argument("file", metavar="FILE.h5", type=PATH)
@conditions("rows")
@several(
    "--column", "COLUMN", "List this column; repeatable. Default: the main peaks.", into="columns"
)
@value("--rows", click.IntRange(1), "N", "List this number of rows.", default=20)
@table_file("Write all rows as CSV; default: all columns without axes.")
def table() -> Body:
    """List the designs of the sweep FILE.h5, or write them as CSV.

    A row is a design; for columns with a value at each xi or t, it is a design at one of these.
    """
    from .table import table

    return table


@command
@click.argument("case", type=CASE)
@several(
    "--minimise",
    "TERM",
    "Minimise peak:QUANTITY, max:, mean: or rms: of one, fluctuation:effort:JOINT, or a"
    " parameter; repeated: find the Pareto front.",
    required=True,
)
@named(
    "--over",
    BOUNDS,
    "Choose this parameter between two bounds, in SI units or with a unit; repeatable.",
    kind=bounds,
    into="over",
    required=True,
    twice="parameter '{}' is listed twice",
)
@several(
    "--subject-to",
    "'TERM<=NUMBER'",
    "Keep within this limit, in SI units, as 'peak:effort:O<=12'; repeatable.",
    into="subject_to",
)
@value("--starts", int, "NUMBER", "Start from this number of designs.", default=4)
@value("--screen", int, "NUMBER", "Choose the starts among this number of designs.", default=256)
@value("--points", int, "NUMBER", "Find at most this number of points of a front.", default=POINTS)
@value(
    "--transmission",
    float,
    "SINE",
    "Keep the sine of all transmission angles above this number.",
    default=0.05,
)
@settings_by("Set a parameter that is not chosen, as l=0.25 or phi=30deg; repeatable.")
@instants()
@backend_of_designs
@value(
    "--dask", str, "ADDRESS", "Search on the cluster of this Dask scheduler, as tcp://HOST:8786."
)
@resumable("search")
@file("--out", "Write history and result to this HDF5 file; default: <case>_optimum.h5 here.")
@file("--figure", "Draw the history into this file; default: <case>_optimum.png here.")
def optimise() -> Body:
    """Find the design of CASE with the least peak or mean.

    Limits hold over the whole motion. For several terms it finds their Pareto front: designs of
    which none is better in all terms. A search that was stopped keeps the best design so far, and
    continues with --resume.
    """
    from .optimise import optimise

    return optimise


@command
@click.argument("case", type=CASE)
@file(
    "--profiles",
    "Choose from this table: a column name, and one column per dimension [m]; or by name from a"
    " standard one: IPE, HEA, HEB, CHS, SHS, RHS, SHS_cold, RHS_cold, flat, round. Default:"
    " profiles.csv next to the case.",
    metavar="FILE.csv|NAME",
)
@value("--safety", float, "FACTOR", "Demand this factor of safety at least.", default=2.0)
@value(
    "--deflection",
    share,
    "SHARE",
    "Limit the deflection across a link over its length, as 1/500. Default: no limit.",
)
@several(
    "--link", "LINK", "Size this link; repeatable. Default: all that profiles fit.", into="links"
)
@choice("--criterion", CRITERIA, "goodman", "Count mean stress in fatigue by this criterion.")
@choice(
    "--yielding",
    YIELDING,
    "von_mises",
    "Compare this equivalent stress with the yield strength.",
    into="yield_criterion",
)
@at_values
def size() -> Body:
    """Choose the lightest safe profile for each link of CASE.

    The loads follow the masses of the chosen profiles.
    """
    from .size import size

    return size


@command
@click.argument("case", type=CASE)
@value(
    "--drive",
    str,
    "LAW=NUMBER,...",
    "Drive it by torque=TORQUE [N m], power=POWER [W], dc=STALL_TORQUE,NO_LOAD_SPEED or"
    " induction=BREAKDOWN_TORQUE,BREAKDOWN_SLIP,SYNCHRONOUS_SPEED [rad/s]. Default: nothing; of a"
    " steady cycle the torque that keeps the mean speed.",
)
@value(
    "--geared",
    float,
    "NUMBER",
    "Set the gear ratio, turns of the motor per turn of the drive.",
    default=1.0,
)
@value("--load", float, "NUMBER", "Apply this resisting torque [N m].", default=0.0, shown=False)
@value(
    "--inertia",
    float,
    "NUMBER",
    "Put a flywheel of this inertia on the drive [kg m^2].",
    default=0.0,
    shown=False,
)
@value(
    "--start",
    str,
    "COORDINATE,RATE",
    "Set the initial coordinate and rate [rad, rad/s or m, m/s]; default: those of the case.",
)
@flag("--steady", "Find the steady cycle, and compute one period of it.")
@value(
    "--fluctuation",
    float,
    "NUMBER",
    "Find the flywheel with which the steady cycle has this coefficient of fluctuation.",
)
@value("--cycle", float, "TURNS", "Set the turns after which the machine repeats.", default=1.0)
@value("--count", int, "NUMBER", "Set the number of instants of a steady cycle.", default=721)
@settings_by()
@instants()
@wanted()
@file("--out", "Write the run to this HDF5 file; default: <case>_free.h5.")
@file(
    "--plot",
    "Draw torque and speed over the drive's coordinate into this file, .png, .pdf or .svg.",
    metavar="FILE.png",
)
def free() -> Body:
    """Compute the motion of CASE under the torques of a motor, its loads and its weight.

    All forces are those of this motion. CASE has one degree of freedom; the motion that it
    declares is used for the start only.

    \b
    lagrange-casadi free punch_press --drive induction=200,0.2,157 --geared 15 --fluctuation 0.05
    """
    from .free import free

    return free


@command
@click.argument("case", type=CASE)
@file(
    "--motors",
    "Choose from this catalogue, or by name from a class of motors: servo, induction; default:"
    " motors.csv next to the case.",
    metavar="FILE.csv|NAME",
)
@several(
    "--drive",
    "JOINT",
    "Choose a motor for this drive; repeatable. Default: all drives.",
    into="drives",
)
@several(
    "--ratio",
    "NUMBER,...",
    "Set the gear ratio, turns of the motor per turn of the drive; the best of several is taken."
    " Default: 1.",
    into="ratios",
    callback=ratios,
)
@value(
    "--lead",
    length,
    "LENGTH",
    "Set the travel per turn [m] of the screw or belt of a sliding drive.",
)
@value(
    "--efficiency", float, "SHARE", "Set the efficiency of the gearbox, from 0 to 1.", default=1.0
)
@value(
    "--inertia",
    float,
    "NUMBER",
    "Add this moment of inertia to that of the motor's rotor [kg m^2].",
    default=0.0,
    shown=False,
)
@settings_by()
@instants(
    "Set the instants [s] over a whole cycle, both ends included; default: those of the case."
)
@over
@file("--plot", "Draw torque over speed into this file, .png, .pdf or .svg.", metavar="FILE.png")
def drive() -> Body:
    """Choose the smallest motor that suits each drive of CASE.

    It lists the speeds, torques and power that a cycle demands, and the reserves of the motor.
    """
    from .drive import drive

    return drive


@command
@click.argument("case", type=CASE)
@named(
    "--tolerance",
    "NAME=VALUE",
    "Set the tolerance of a parameter, plus or minus this value [SI unit, unit or %]; repeatable.",
    kind=tolerance,
    into="within",
    required=True,
    twice="parameter '{}' is listed twice",
)
@at_values
@wanted("Compute these outputs, as in run; repeatable. Default: those of the case.")
@value("--samples", int, "NUMBER", "Draw this number of designs at random.", default=SAMPLES)
@backend_of_designs
@table_file("Write the peaks as CSV, one row per quantity.")
def tolerances() -> Body:
    """Compute the scatter of the peaks of CASE within tolerances.

    It lists the share of each tolerance in the scatter.
    """
    from .tolerances import tolerances

    return tolerances


@command
@click.argument("case", type=CASE)
@at_values
@wanted()
@value(
    "--accuracy",
    float,
    "ERROR",
    "Recommend the fastest method whose error, over the peak, is within this number.",
)
@file("--out", "Write the numbers to this JSON file; default: <case>_trade.json here.")
@file("--figure", "Draw time over error into this file; default: <case>_trade.png here.")
def trade() -> Body:
    """Measure time and error of each evaluation method on CASE.

    Methods differ in backend, precision, Newton steps, tables and compiler flags.
    """
    from .trade import trade

    return trade


@command
@click.argument("case", type=CASE)
@click.argument("data", metavar="DATA.csv", type=PATH)
@several(
    "--unknown",
    "NAME",
    "Find these parameters, with commas between; repeatable. Default: all of the case.",
    callback=separated,
)
@settings_by("Set a known parameter, or the first value of an unknown one, as l=0.25; repeatable.")
@named(
    "--column",
    "NAME=HEAD",
    "Read a drive's coordinate, or a force as effort:O, from the column of this head; repeatable.",
    kind=pair,
    into="names",
    twice="'{}' is read from two columns",
)
@named(
    "--noise",
    "NAME=NUMBER",
    "State the standard deviation of a column, in the unit of the file; repeatable.",
    kind=place,
    into="noise",
    twice="column '{}' has two",
)
@named(
    "--prior",
    "NAME=NUMBER",
    "Set the standard deviation of the first value of a parameter; repeatable.",
    kind=place,
    into="prior",
)
@several(
    "--counts-per-turn",
    "NUMBER|NAME=NUMBER",
    "Set the counts in one turn of all encoders, or of a column's; repeatable.",
    kind=counts,
)
@flag("--robust", "Reduce the weight of outliers, by Huber's loss.")
@flag(
    "--consistent",
    "Find positive masses, inertias that a body can have, and parameters in their bounds.",
)
@value(
    "--cutoff",
    float,
    "HZ",
    "Filter forces without delay; half the power is left at this frequency.",
)
@value("--trim", float, "SECONDS", "Leave out this time at both ends of the record.", default=0.0)
@file("--validate", "Compare this other record with the model that was found.", metavar="OTHER.csv")
@file("--out", "Write to this HDF5 file; default: <case>_identified.h5.")
@file("--figure", "Draw measured and model to this .png, .pdf or .svg.", metavar="FILE")
@file("--report", "Write a page with all tables and pictures.", metavar="FILE.html")
def identify() -> Body:
    """Find parameters of CASE from motion and forces that were measured.

    The first line of DATA.csv has names and units of columns: t [s], the coordinates of all drives,
    as O [deg], and forces, as effort:O [N m], reaction:A:fx [N], section:rod:axial@0.5 [N]. The
    command prints combinations of parameters that the data determine, with standard errors, and the
    values as options --set.

    \b
    lagrange-casadi identify cases/slider_crank run.csv --unknown m3 --noise 'effort:O=0.05'
    """
    from .identify import identify

    return identify

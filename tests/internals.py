"""Inner parts of the package that tests look at: the one place that knows where they stand."""

# ruff: noqa: F401

from lagrange_casadi.actuators.choice import warmest
from lagrange_casadi.animation import Film, write_animation
from lagrange_casadi.animation.drawn import Line
from lagrange_casadi.animation.film import picture_of
from lagrange_casadi.animation.raster import gif
from lagrange_casadi.animation.solids import block, cone, cylinder, prism, sphere
from lagrange_casadi.animation.vector import svg
from lagrange_casadi.arguments import public
from lagrange_casadi.arithmetic import scalars
from lagrange_casadi.arithmetic.boxes import boxed
from lagrange_casadi.arithmetic.compensated import DTYPES, ROUNDING, Pair, Pairs
from lagrange_casadi.arithmetic.compensated import closed as compensated_closed
from lagrange_casadi.arithmetic.interpret import (
    ROUNDINGS,
    Step,
    followable,
    interpret,
    numpy_arithmetic,
    steps,
    written_out,
)
from lagrange_casadi.arithmetic.lookups import cell, entries, is_entry, lookup
from lagrange_casadi.base import cache, space, symbolic, vocabulary
from lagrange_casadi.base import seal as base_seal
from lagrange_casadi.base.apart import LostError, run_apart
from lagrange_casadi.base.csv_rows import Row, read_rows
from lagrange_casadi.base.graph_text import dumps as graph_dumps
from lagrange_casadi.base.graph_text import loads as graph_loads
from lagrange_casadi.base.interrupts import interrupts
from lagrange_casadi.base.numerals import readable as numerals_readable
from lagrange_casadi.base.numerals import real, whole
from lagrange_casadi.base.publish import check_writable, filling, replacing, uninterrupted, writing
from lagrange_casadi.base.quantities import FORCES, Output, quotient
from lagrange_casadi.base.recorded_table import RecordedTable
from lagrange_casadi.base.seal import SIZE, kind_of, verify
from lagrange_casadi.base.seal import seal as seal_seal
from lagrange_casadi.base.space import cores, memory
from lagrange_casadi.base.status import Status
from lagrange_casadi.base.table_file import TableFile
from lagrange_casadi.base.tables import CONVENTIONS, PLANE, QUANTITIES, SPACE, SPATIAL_QUANTITIES
from lagrange_casadi.base.threads import in_threads
from lagrange_casadi.base.units import angle, typed
from lagrange_casadi.base.units import number as units_number
from lagrange_casadi.base.vocabulary import PRECISIONS
from lagrange_casadi.beams.profiles import Profile, read_profiles
from lagrange_casadi.cli.report import Row as ReportRow
from lagrange_casadi.cli.report import Rows as ReportRows
from lagrange_casadi.cli.report import peak_line, shown
from lagrange_casadi.cli.report import readable as report_readable
from lagrange_casadi.cli.run import slope_lines
from lagrange_casadi.cli.strength_lines import not_evaluated_lines, strength_lines
from lagrange_casadi.cluster import dask_workers
from lagrange_casadi.cluster.dask_workers import Cluster
from lagrange_casadi.codegen import compiler, find_compiler, library, printer
from lagrange_casadi.codegen.calls import Call
from lagrange_casadi.codegen.compiler import FLAGS, LANES_PLACE
from lagrange_casadi.codegen.emit import INSTANTS
from lagrange_casadi.codegen.link_curves import Along as LinkCurvesAlong
from lagrange_casadi.codegen.link_curves import along, mass_properties_of, turning
from lagrange_casadi.codegen.printer import literal, print_functions
from lagrange_casadi.codegen.reduction import CALL as DESIGNS_CALL
from lagrange_casadi.codegen.search import CALL as SEARCH_CALL
from lagrange_casadi.codegen.search import CURVES, interface
from lagrange_casadi.codegen.stages import FEW_TURNS, compensated, controlled, plain, turns_many
from lagrange_casadi.declare import laws
from lagrange_casadi.declare.declared import Declared
from lagrange_casadi.declare.density import Density, NumericDensity
from lagrange_casadi.declare.description import (
    coordinates_of,
    describe,
    drives_of,
    motions_of,
    shape_of,
)
from lagrange_casadi.declare.directions import Reference
from lagrange_casadi.declare.ends import beyond_ends, share_beyond
from lagrange_casadi.declare.even_points import points
from lagrange_casadi.declare.joints import Axis, Joint
from lagrange_casadi.declare.kinks import Smooth
from lagrange_casadi.declare.laws import Laws
from lagrange_casadi.declare.measures import Measure, Measures
from lagrange_casadi.declare.meshes import Mesh, Transmission, Wrench
from lagrange_casadi.declare.motion import Scaled
from lagrange_casadi.declare.parts import (
    Constraint,
    Force,
    Friction,
    Ground,
    LineLoad,
    Link,
    Path,
    Point,
    PointMass,
    RigidMass,
    Roller,
    Spring,
    Torque,
)
from lagrange_casadi.declare.parts import Row as NonHolonomicRow
from lagrange_casadi.declare.scene import Wanted, outputs
from lagrange_casadi.declare.spatial import reference_posture
from lagrange_casadi.declare.stated import Stated
from lagrange_casadi.declare.times import Timing
from lagrange_casadi.declare.wanted_names import by_parameters, others
from lagrange_casadi.elastic.compliance import Compliance, nodes
from lagrange_casadi.elastic.deflection import deflection
from lagrange_casadi.elements.cam import disc_cam
from lagrange_casadi.elements.cylindrical_cam import cylindrical_cam
from lagrange_casadi.elements.profile_lift import read_profile
from lagrange_casadi.equations import assembly, blocks, friction, loops, mobility
from lagrange_casadi.equations import derive as equations_derive
from lagrange_casadi.equations.assembly import assemble
from lagrange_casadi.equations.blocks import solving_order
from lagrange_casadi.equations.derive import derive as derive_derive
from lagrange_casadi.equations.fingerprint import fingerprint, sources
from lagrange_casadi.equations.integrability import Course, no_rates
from lagrange_casadi.equations.kinematics import describe_coordinate
from lagrange_casadi.equations.linear import LinearSystem
from lagrange_casadi.equations.model_data import template
from lagrange_casadi.equations.multibody import Turned, motion_along
from lagrange_casadi.equations.program import Program
from lagrange_casadi.equations.reciprocals import differentiable, share_reciprocals
from lagrange_casadi.equations.spherical import axes_of as spherical_axes_of
from lagrange_casadi.equations.spherical import quaternion_of
from lagrange_casadi.equations.stress import KINDS
from lagrange_casadi.equations.tree import span
from lagrange_casadi.exports import export, fmu
from lagrange_casadi.exports.folder import MANIFEST as FOLDER_MANIFEST
from lagrange_casadi.exports.units import BASE, base_unit
from lagrange_casadi.figures import figures
from lagrange_casadi.figures.diagrams import governing, marks
from lagrange_casadi.figures.drawing import draw_mechanism
from lagrange_casadi.figures.figures import (
    MechanismDrawing,
    PolarPlots,
    SectionDiagrams,
    SectionMaps,
    SpanPlot,
    TimePlot,
    default_figures,
    draw,
)
from lagrange_casadi.figures.labels import apart
from lagrange_casadi.figures.labels import placed as labels_placed
from lagrange_casadi.figures.postures import assemblies, draw_postures
from lagrange_casadi.figures.stills import stills
from lagrange_casadi.figures.strength_plot import draw_strength, draw_utilisation
from lagrange_casadi.figures.trade_plot import draw_trade
from lagrange_casadi.formats import case_of, json_model
from lagrange_casadi.formats.laws import LawError, python
from lagrange_casadi.formats.laws import parsed as laws_parsed
from lagrange_casadi.formats.mjcf import LIMITS as MODEL_LIMITS
from lagrange_casadi.formats.record import MOVES
from lagrange_casadi.geometry.frames import Frame
from lagrange_casadi.geometry.rotation import Rotation
from lagrange_casadi.instants import backends, cycle_table, grids, tabulate
from lagrange_casadi.instants import refusal as instants_refusal
from lagrange_casadi.instants.backends import run
from lagrange_casadi.instants.cycle import Cycle
from lagrange_casadi.instants.cycle_table import INTERPOLATE, CycleTable
from lagrange_casadi.instants.derivatives import derivatives
from lagrange_casadi.instants.determinacy import determinate
from lagrange_casadi.instants.evaluation_method import EvaluationMethod
from lagrange_casadi.instants.grids import GRID, LARGEST
from lagrange_casadi.instants.loads import DistributedLoad, SpatialPointLoad
from lagrange_casadi.instants.ordering import ordered, vanishes
from lagrange_casadi.instants.refusal import refusal as refusal_refusal
from lagrange_casadi.instants.section_law import PointLoad, SectionLaw
from lagrange_casadi.instants.solution import Provenance, Solution
from lagrange_casadi.instants.statistics import Statistics
from lagrange_casadi.methods import METHODS as METHODS_METHODS
from lagrange_casadi.peak_search import search
from lagrange_casadi.peak_search.between import highest, passed, passed_or_touched, unresolved
from lagrange_casadi.peak_search.fits import SEVEN, bounds, stretch, vertices, where, window
from lagrange_casadi.peak_search.intervals import Curves, Samples
from lagrange_casadi.peak_search.intervals import Listed as IntervalsListed
from lagrange_casadi.peak_search.search import peaks
from lagrange_casadi.peak_search.sharpness import Kind, Sharpness, Watch
from lagrange_casadi.portable import naming, stack, text
from lagrange_casadi.portable.golden import ALLOWED
from lagrange_casadi.portable.statuses import ANSWERS, SHARED, STATUSES
from lagrange_casadi.report import instants, maps, write_report
from lagrange_casadi.report import page as report_page
from lagrange_casadi.report.comparison import write_comparison
from lagrange_casadi.report.contents import contents
from lagrange_casadi.report.live import Live
from lagrange_casadi.report.of_sweep import is_of
from lagrange_casadi.report.page import COMPARISON_SCRIPTS, LIVE_SCRIPTS, SCRIPTS, SWEEP_SCRIPTS
from lagrange_casadi.report.still import still
from lagrange_casadi.sensitivity.jacobian import total
from lagrange_casadi.sensitivity.peaks import PeakKind
from lagrange_casadi.sensitivity.series import at_instants
from lagrange_casadi.sensitivity.slopes import Slopes, unit_ways
from lagrange_casadi.shapes import pictures
from lagrange_casadi.shapes.index import MANIFEST as INDEX_MANIFEST
from lagrange_casadi.shapes.kept import dump_specs, parse_specs
from lagrange_casadi.shapes.pictures import PICTURES
from lagrange_casadi.shapes.pictures import save as pictures_save
from lagrange_casadi.shapes.places import placed as places_placed
from lagrange_casadi.shapes.readable import PREFIXED, STEPS, scale_for
from lagrange_casadi.shapes.readable import Scale as ReadableScale
from lagrange_casadi.shapes.shapes import Spot, joint_shapes, load_shapes, shapes
from lagrange_casadi.shapes.solid import (
    BLOCK,
    MARKS,
    PATH,
    cloud_of,
    direction_of,
    grounds_of,
    lines_of,
    marks_of,
    place_of,
)
from lagrange_casadi.shapes.solid import axes_of as solid_axes_of
from lagrange_casadi.shapes.views import page as views_page
from lagrange_casadi.shapes.views import upright, view, views
from lagrange_casadi.shipped_cases import shipped_cases
from lagrange_casadi.store import runs
from lagrange_casadi.store.attributes import SCHEMA_VERSION
from lagrange_casadi.store.runs import SCHEMA, check, load
from lagrange_casadi.store.runs import save as runs_save
from lagrange_casadi.store.scales import LARGE, Scales
from lagrange_casadi.store.untrusted import check_shape, reported_as
from lagrange_casadi.store.untrusted import parsed as untrusted_parsed
from lagrange_casadi.strength.critical_plane import FINDLEY
from lagrange_casadi.strength.fatigue import (
    CRITERIA,
    Histories,
    cycles,
    factor,
    lacking,
    loaded,
    use_score,
)
from lagrange_casadi.strength.fatigue import used as fatigue_used
from lagrange_casadi.strength.member import Member
from lagrange_casadi.strength.rainflow import rainflow
from lagrange_casadi.strength.worst import LinkHistories
from lagrange_casadi.studies.designs.engine import DesignEngine
from lagrange_casadi.studies.designs.outcome import Outcome
from lagrange_casadi.studies.designs.reduction import KeptOutputs, stages_of
from lagrange_casadi.studies.optimise import Term, file
from lagrange_casadi.studies.optimise.conditions import conditions
from lagrange_casadi.studies.optimise.descent import Descent
from lagrange_casadi.studies.optimise.journal import journal_of, kept
from lagrange_casadi.studies.optimise.problem import Question
from lagrange_casadi.studies.optimise.searching import Search
from lagrange_casadi.studies.optimise.sobol import MOST_DIMENSIONS, sobol
from lagrange_casadi.studies.optimise.solver import Solver
from lagrange_casadi.studies.peaks import (
    ContinuousSolution,
    forces,
    rates,
    refine,
    resultants,
    shortfall,
)
from lagrange_casadi.studies.request import Request
from lagrange_casadi.studies.sizing import size
from lagrange_casadi.studies.sweep import (
    Condition,
    Grid,
    Range,
    Sweep,
    Values,
    best,
    chosen,
    columns,
    cut,
    is_sweep,
    plan,
    plots,
    read_designs,
    reading,
    sweep,
    sweeping,
    workers,
)
from lagrange_casadi.studies.sweep.axes import check_designs, counted, designs_of, size_of
from lagrange_casadi.studies.sweep.best import _front, counts, missed
from lagrange_casadi.studies.sweep.blocks import Queue, chunk_of, slabs
from lagrange_casadi.studies.sweep.checking import check_sweep, progress
from lagrange_casadi.studies.sweep.chunks import FILTERS, deflated, encoded, fletcher32
from lagrange_casadi.studies.sweep.columns import Column as ColumnsColumn
from lagrange_casadi.studies.sweep.columns import Task
from lagrange_casadi.studies.sweep.default_figures import default_plots
from lagrange_casadi.studies.sweep.listing import Listed as ListingListed
from lagrange_casadi.studies.sweep.parts import Folder
from lagrange_casadi.studies.sweep.plan import Plan, difference
from lagrange_casadi.studies.sweep.plots import Along as PlotsAlong
from lagrange_casadi.studies.sweep.plots import Front, Peaks, Scatter, draw_sweep
from lagrange_casadi.studies.sweep.scale import Scale as ScaleScale
from lagrange_casadi.studies.sweep.scale import edges, logarithmic, tick
from lagrange_casadi.studies.sweep.scale import number as scale_number
from lagrange_casadi.studies.sweep.selection import absent, matches, near
from lagrange_casadi.studies.sweep.sheet import fitted, label
from lagrange_casadi.studies.tolerances import read_tolerance
from lagrange_casadi.studies.trade import COMPARED, Measurement, Trade, trade
from lagrange_casadi.studies.trade import METHODS as TRADE_METHODS
from lagrange_casadi.studies.trade import _in_turns as trade_in_turns
from lagrange_casadi.studies.trade import _Work as TradeWork
from lagrange_casadi.verification.accuracy import explained
from lagrange_casadi.verification.certificate import COARSE, TOLERANCE, certify, tolerance
from lagrange_casadi.verification.disturbed import TRIALS, Instants, effects, openness
from lagrange_casadi.verification.reference import DIGITS, arithmetic, reference
from lagrange_casadi.verification.roundings import rounding_error
from lagrange_casadi.verification.vectors import GROUND, NIL, Axes, Vector

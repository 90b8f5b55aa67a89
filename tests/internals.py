"""Inner parts of the package that tests look at: the one place that knows where they stand."""

# ruff: noqa: F401

from lagrange_casadi.arithmetic.boxes import boxed
from lagrange_casadi.arithmetic.compensated import DTYPES, ROUNDING, Pair, Pairs
from lagrange_casadi.arithmetic.compensated import closed as compensated_closed
from lagrange_casadi.arithmetic.interpret import interpret, numpy_arithmetic
from lagrange_casadi.arithmetic.lookups import cell, entries
from lagrange_casadi.base import cache, symbolic
from lagrange_casadi.base import seal as base_seal
from lagrange_casadi.base.quantities import FORCES, Output
from lagrange_casadi.base.seal import SIZE
from lagrange_casadi.base.status import Status
from lagrange_casadi.base.tables import PLANE, QUANTITIES, SPACE, SPATIAL_QUANTITIES
from lagrange_casadi.base.threads import in_threads
from lagrange_casadi.base.vocabulary import PRECISIONS
from lagrange_casadi.beams.profiles import Profile
from lagrange_casadi.cli.report import Row as ReportRow
from lagrange_casadi.cli.report import Rows as ReportRows
from lagrange_casadi.codegen import compiler, find_compiler, library, printer
from lagrange_casadi.codegen.calls import Call
from lagrange_casadi.codegen.compiler import FLAGS, LANES_PLACE
from lagrange_casadi.codegen.emit import INSTANTS
from lagrange_casadi.codegen.link_curves import Along as LinkCurvesAlong
from lagrange_casadi.codegen.link_curves import along, mass_properties_of, turning
from lagrange_casadi.codegen.printer import print_functions
from lagrange_casadi.codegen.reduction import CALL as DESIGNS_CALL
from lagrange_casadi.codegen.search import CALL as SEARCH_CALL
from lagrange_casadi.codegen.search import CURVES, interface
from lagrange_casadi.codegen.stages import FEW_TURNS, compensated, controlled, plain, turns_many
from lagrange_casadi.declare import laws
from lagrange_casadi.declare.declared import Declared
from lagrange_casadi.declare.density import Density, NumericDensity
from lagrange_casadi.declare.directions import Reference
from lagrange_casadi.declare.even_points import points
from lagrange_casadi.declare.joints import Axis, Joint
from lagrange_casadi.declare.kinks import Smooth
from lagrange_casadi.declare.limits import END
from lagrange_casadi.declare.measures import Measure, Measures
from lagrange_casadi.declare.meshes import Mesh, Transmission, Wrench
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
from lagrange_casadi.declare.scene import Wanted
from lagrange_casadi.declare.stated import Stated
from lagrange_casadi.elastic.compliance import Compliance, nodes
from lagrange_casadi.elastic.deflection import deflection
from lagrange_casadi.elements.cam import disc_cam
from lagrange_casadi.equations import assembly, blocks, friction, loops, mobility
from lagrange_casadi.equations.derive import derive as derive_derive
from lagrange_casadi.equations.fingerprint import fingerprint, sources
from lagrange_casadi.equations.integrability import Course, no_rates
from lagrange_casadi.equations.linear import LinearSystem
from lagrange_casadi.equations.model_data import template
from lagrange_casadi.equations.spherical import axes_of as spherical_axes_of
from lagrange_casadi.equations.spherical import quaternion_of
from lagrange_casadi.figures import figures
from lagrange_casadi.figures.figures import default_figures, draw
from lagrange_casadi.formats import case_of
from lagrange_casadi.instants import backends, cycle_table, grids
from lagrange_casadi.instants import refusal as instants_refusal
from lagrange_casadi.instants.backends import run
from lagrange_casadi.instants.cycle_table import INTERPOLATE
from lagrange_casadi.instants.evaluation_method import EvaluationMethod
from lagrange_casadi.instants.grids import GRID, LARGEST
from lagrange_casadi.instants.loads import DistributedLoad, SpatialPointLoad
from lagrange_casadi.instants.refusal import refusal as refusal_refusal
from lagrange_casadi.instants.section_law import PointLoad, SectionLaw
from lagrange_casadi.instants.solution import Provenance, Solution
from lagrange_casadi.methods import METHODS as METHODS_METHODS
from lagrange_casadi.peak_search import search
from lagrange_casadi.peak_search.intervals import Curves, Samples
from lagrange_casadi.portable.statuses import ANSWERS, SHARED, STATUSES
from lagrange_casadi.store import runs
from lagrange_casadi.store.attributes import SCHEMA_VERSION
from lagrange_casadi.store.runs import SCHEMA, load
from lagrange_casadi.store.runs import save as runs_save
from lagrange_casadi.strength.member import Member
from lagrange_casadi.studies.designs.engine import DesignEngine
from lagrange_casadi.studies.designs.outcome import Outcome
from lagrange_casadi.studies.designs.reduction import KeptOutputs, stages_of
from lagrange_casadi.studies.optimise.journal import kept
from lagrange_casadi.studies.optimise.sobol import MOST_DIMENSIONS, sobol
from lagrange_casadi.studies.peaks import forces, rates
from lagrange_casadi.studies.sizing import size
from lagrange_casadi.studies.sweep import Sweep, best, is_sweep, sweep
from lagrange_casadi.studies.sweep.checking import check_sweep
from lagrange_casadi.studies.sweep.default_figures import default_plots
from lagrange_casadi.studies.sweep.listing import Listed as ListingListed
from lagrange_casadi.studies.sweep.plots import Along as PlotsAlong
from lagrange_casadi.studies.sweep.plots import Front, Peaks, Scatter, draw_sweep
from lagrange_casadi.studies.sweep.scale import number as scale_number
from lagrange_casadi.verification.accuracy import explained
from lagrange_casadi.verification.certificate import COARSE, TOLERANCE, certify, tolerance
from lagrange_casadi.verification.disturbed import TRIALS, Instants, effects, openness
from lagrange_casadi.verification.reference import DIGITS, arithmetic, reference
from lagrange_casadi.verification.roundings import rounding_error
from lagrange_casadi.verification.vectors import GROUND, NIL, Axes, Vector

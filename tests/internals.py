"""Inner parts of the package that tests look at: the one place that knows where they stand."""

# ruff: noqa: F401

from lagrange_casadi.arithmetic.boxes import boxed
from lagrange_casadi.arithmetic.compensated import Pair, Pairs
from lagrange_casadi.arithmetic.interpret import interpret, numpy_arithmetic
from lagrange_casadi.base import cache, symbolic
from lagrange_casadi.base import seal as base_seal
from lagrange_casadi.base.quantities import Output
from lagrange_casadi.base.status import Status
from lagrange_casadi.base.tables import QUANTITIES, SPATIAL_QUANTITIES
from lagrange_casadi.base.threads import in_threads
from lagrange_casadi.codegen import compiler, library
from lagrange_casadi.codegen.printer import print_functions
from lagrange_casadi.codegen.stages import compensated, controlled, plain
from lagrange_casadi.declare import laws
from lagrange_casadi.declare.declared import Declared
from lagrange_casadi.declare.even_points import points
from lagrange_casadi.declare.kinks import Smooth
from lagrange_casadi.declare.scene import Wanted
from lagrange_casadi.declare.stated import Stated
from lagrange_casadi.elastic.compliance import Compliance, nodes
from lagrange_casadi.elastic.deflection import deflection
from lagrange_casadi.equations import assembly, blocks, loops
from lagrange_casadi.equations.fingerprint import fingerprint
from lagrange_casadi.formats import case_of
from lagrange_casadi.instants import backends, cycle_table, grids
from lagrange_casadi.instants.backends import run
from lagrange_casadi.instants.evaluation_method import EvaluationMethod
from lagrange_casadi.instants.refusal import refusal as refusal_refusal
from lagrange_casadi.instants.solution import Provenance
from lagrange_casadi.methods import METHODS as METHODS_METHODS
from lagrange_casadi.strength.member import Member
from lagrange_casadi.studies.designs.engine import DesignEngine
from lagrange_casadi.studies.designs.outcome import Outcome
from lagrange_casadi.studies.optimise.sobol import sobol
from lagrange_casadi.studies.peaks import rates
from lagrange_casadi.verification.certificate import certify
from lagrange_casadi.verification.disturbed import TRIALS, Instants, effects
from lagrange_casadi.verification.reference import arithmetic, reference
from lagrange_casadi.verification.roundings import rounding_error

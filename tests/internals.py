"""Inner parts of the package that tests look at: the one place that knows where they stand."""

# ruff: noqa: F401

from lagrange_casadi.base import bernstein, cache, symbolic
from lagrange_casadi.base.interpret import interpret, numpy_arithmetic
from lagrange_casadi.base.methods import METHODS as METHODS_METHODS
from lagrange_casadi.base.quantities import Output
from lagrange_casadi.base.status import Status
from lagrange_casadi.base.tables import PLANE, SPACE
from lagrange_casadi.engine import assembly, blocks, codegen, loops, placement
from lagrange_casadi.engine.codegen import compiler, library
from lagrange_casadi.engine.codegen.printer import print_functions
from lagrange_casadi.engine.compensated import Pair, Pairs
from lagrange_casadi.engine.identity import identity_of
from lagrange_casadi.engine.instants import backends, cycle_table, grids
from lagrange_casadi.engine.instants.backends import run
from lagrange_casadi.engine.instants.evaluation_method import EvaluationMethod, Provenance
from lagrange_casadi.engine.instants.refusing import refusal as refusal_refusal
from lagrange_casadi.engine.strains import moduli_of
from lagrange_casadi.engine.threads import in_threads
from lagrange_casadi.interop.formats import case_of
from lagrange_casadi.model import sampled_laws
from lagrange_casadi.model.even_points import points
from lagrange_casadi.model.kinks import Smooth
from lagrange_casadi.model.scene import Wanted
from lagrange_casadi.model.stated import Stated
from lagrange_casadi.results.elastic.compliance import nodes, strains_along
from lagrange_casadi.results.elastic.deflection import deflection
from lagrange_casadi.results.sensitivity.slopes import Slopes
from lagrange_casadi.results.store import opening
from lagrange_casadi.results.strength import fatigue
from lagrange_casadi.results.strength.critical_plane import plane_score
from lagrange_casadi.results.strength.member import Member
from lagrange_casadi.results.verification.certificate import certify
from lagrange_casadi.results.verification.reference import reference
from lagrange_casadi.studies.designs.engine import DesignEngine
from lagrange_casadi.studies.designs.outcome import Outcome
from lagrange_casadi.views.shapes.readable import scale_for

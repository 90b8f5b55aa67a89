"""The documentation site: ``sphinx-build -W -b html docs OUT``. The build needs no network."""

import ast
import builtins
import inspect
import re
import sys
import typing
from collections import Counter
from contextlib import suppress
from pathlib import Path

from sphinx import addnodes
from sphinx.util.nodes import make_refnode

import lagrange_casadi
from lagrange_casadi.base.tables import PLANE, SPACE

HERE = Path(__file__).parent
CASES = HERE.parent / "cases"
sys.path.append(str(HERE))

import notebooks  # noqa: E402 - it lies beside this file

project = "lagrange_casadi"
author = "The lagrange_casadi developers"
project_copyright = author
version = release = lagrange_casadi.__version__

extensions = [
    "myst_parser",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.intersphinx",
    "sphinx_click",
    "sphinx_design",
]
exclude_patterns = ["_*"]
UNLISTED = [
    r"ca\.SX",
    *(
        "Axis",
        "Backend",
        "Between",
        "Compiled",
        "Deflection",
        "Derivatives",
        "Drawing",
        "Drive",
        "Design",
        "Executor",
        "Expression",
        "Figure",
        "Listed",
        "Operand",
        "Over",
        "Placement",
        "Progress",
        "Quantity",
    ),
    *(
        "Histories",
        "Range",
        "RigidMass",
        "LoadDensity",
        "Starts",
        "StiffSafety",
        "Times",
        "Timetable",
        "Transmission",
        "Vibration",
        "View",
    ),
    *(
        "IN_SPACE",
        "check_picture",
        "elastic.deflection.deflection",
        "identity_of",
        "outputs",
        "read_rows",
        "time",
        r"Wanted\.of",
    ),
    *(r"_pickle\.PicklingError", r"h5py\._hl\..*"),
]
"""Names that docstrings and signatures mention, and that have no page."""

suppress_warnings = ["myst.header"]  # the glossary has its words at one level
nitpicky = True
nitpick_ignore_regex = [
    (
        "py:class",
        r"lagrange_casadi\..*",
    ),  # types in signatures that are no part of the interface
    (
        "py:.*",
        r"casadi\..*|(SX|DM|Function)|Array|numpy\.(generic|int8)",
    ),  # of no inventory
    ("py:(class|func|meth|data|attr)", "|".join(UNLISTED)),
    ("py:mod", r"\.*[a-z_.]+"),  # modules that docstrings name to developers
]
templates_path = ["_templates"]

# Pages are Markdown, with links as on GitHub.
myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 4

# Links into other projects. Their inventories are kept here, as text, with the names that are used
# and no others.
intersphinx_mapping = {
    name: (address, f"_inventories/{name}.inv")
    for name, address in (
        ("python", "https://docs.python.org/3/"),
        ("numpy", "https://numpy.org/doc/stable/"),
        ("matplotlib", "https://matplotlib.org/stable/"),
        ("h5py", "https://docs.h5py.org/en/stable/"),
        ("xarray", "https://docs.xarray.dev/en/stable/"),
        ("pandas", "https://pandas.pydata.org/docs/"),
    )
}

# The reference is made from docstrings, and the gallery from the cases.
autosummary_generate = True
doors = [
    lagrange_casadi,
    *(
        thing
        for name in lagrange_casadi.__all__
        if inspect.ismodule(thing := getattr(lagrange_casadi, name))
    ),
]
names = [f"{door.__name__}.{name}" for door in doors for name in dir(door)]
twins = Counter(map(str.lower, names))
autosummary_filename_map = {
    name: f"{name}_class"
    for name in names
    if not name.islower() and twins[name.lower()] > 1
}


def write(path, text):
    """Write a file that is made, if it is to be another; what is unchanged is not read again by the
    build.
    """
    path.parent.mkdir(exist_ok=True)
    if not path.is_file() or path.read_text() != text:
        path.write_text(text)


def names_of(module):
    """A heading for a public module, and a table of its names."""
    purpose = inspect.getdoc(module).split("\n\n")[0].split(": the public part of")[0]
    head = f".. currentmodule:: {module.__name__}\n\n.. autosummary::\n   :toctree: .\n"
    names = "".join(f"   {name}\n" for name in sorted(module.__all__, key=str.lower))
    title = module.__name__.rpartition(".")[2]
    return f"## {title}\n\n{purpose}\n\n```{{eval-rst}}\n{head}\n{names}```\n"


# Before the build looks for pages: autosummary reads those alone that are there at its begin.
write(
    HERE / "reference" / "generated" / "modules.md",
    "\n".join(
        [
            "# Modules\n",
            *(names_of(door) for door in doors[1:] if hasattr(door, "__all__")),
        ]
    ),
)

autodoc_default_options = {
    "members": True,
    "inherited-members": True,
    "show-inheritance": False,
}
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 88
numpydoc_show_class_members = False

html_theme = "pydata_sphinx_theme"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_title = "lagrange_casadi"
html_show_sphinx = False
html_theme_options = {
    "show_prev_next": False,
    "secondary_sidebar_items": ["page-toc"],
    "navigation_with_keys": False,
}


PLACES = {
    "motion": "JOINT",
    "pose": "BODY/",
    "effort": "JOINT",
    "holding": "JOINT/",
    "reaction": "JOINT/",
    "multiplier": "NAME",
    "load": "NAME/",
    "friction": "NAME/",
    "output": "NAME",
    "certificate": "",
    "section": "LINK/",
    "deflection": "LINK/",
    "stress": "LINK/",
    "utilisation": "LINK/",
    "law": "LINK/law/",
    "station": "LINK/NAME/",
    "spread": "LINK/NAME/",
}
"""What stands in a file's path between the group of a quantity and its member."""


def quantities(_app):
    """Write the tables of all datasets in files: in the plane, and in space in addition."""
    folder = HERE / "reference" / "generated"
    axes = [
        "| /t | t | s | time | |",
        "| /xi | xi | 1 | position along a link, ratio xi/l | |",
    ]
    others = [quantity for quantity in SPACE.rows if quantity not in PLANE.rows]
    write_table(folder / "quantities.txt", [*axes, *map(row, PLANE.rows)])
    write_table(folder / "quantities_in_space.txt", map(row, others))


def write_table(path, rows):
    """Write rows of datasets below their heads."""
    heads = ["| dataset | axes | unit | is | sign |", "| --- | --- | --- | --- | --- |"]
    write(path, "\n".join([*heads, *rows]) + "\n")


def row(quantity):
    """One row for a quantity: /GROUP/NAME/member, its axes, unit, meaning and sign."""
    group, member = quantity.group, quantity.member
    if group == "motion" and member:
        member = f"_{member}"
    if group == "spread" and member[0] in "qc":
        member += "J"  # the power
    place = f"/{'section' if group in ('law', 'station', 'spread') else group}/{PLACES[group]}"
    units = " or ".join(
        dict.fromkeys(quantity.unit_for(kind) for kind in ("angle", "slide"))
    )
    about = f"{quantity.long_name} | {quantity.sign}"
    return f"| {place}{member} | {', '.join(quantity.axes)} | {units} | {about} |"


def gallery(_app):
    """Write a page for each case: its picture, a link to its report, its README and its code; and a
    card with the first line of its code for each.
    """
    folder = HERE / "gallery" / "generated"
    cards = []
    for case in sorted(CASES.glob("*/case.py")):
        name, code = case.parent.name, case.read_text()
        picture = f"![{name} in motion](../{name}.svg)"
        link = f'<a href="../reports/{name}.html">Open its report</a>'
        about = f"{link}: the mechanism with its forces, charts, tables and diagrams."
        title, rest = case.with_name("README.md").read_text().split("\n", 1)
        write(
            folder / f"{name}.md",
            f"{title}\n\n{picture}\n\n{about}\n{rest}\n## The case\n\n```python\n{code}```\n",
        )
        purpose = ast.get_docstring(ast.parse(code)).split("\n\n")[0]
        cards.append(
            f":::{{grid-item-card}} {name}\n:link: generated/{name}\n:link-type: doc\n:img-top:"
            f" {name}.svg\n\n{purpose}\n:::\n"
        )
    write(
        folder / "cards.txt",
        f"::::{{grid}} 1 2 3 3\n:gutter: 3\n\n{''.join(cards)}::::\n",
    )


def reports(app, error):
    """Write the report of each case beside the gallery of a site, without a compiler."""
    if error is not None or app.builder.format != "html":
        return
    folder = Path(app.outdir) / "gallery" / "reports"
    folder.mkdir(exist_ok=True)
    for case in sorted(CASES.glob("*/case.py")):
        scene = lagrange_casadi.load_case(case.parent).scene
        wanted = [*scene.wanted, "motion"]
        solution = lagrange_casadi.evaluate(scene, wanted=wanted, backend="vm")
        solution.report(folder / f"{case.parent.name}.html")


def offer_a_notebook(_app, name, source):
    """Write a page as a notebook too, and put a link to it below the title."""
    if name in notebooks.PAGES:
        page = HERE / f"{name}.md"
        made = page.parent / "generated" / f"{page.stem}.ipynb"
        made.parent.mkdir(exist_ok=True)
        notebooks.write(made, source[0], page.parent)
        title, rest = source[0].split("\n", 1)
        link = f"[Download this page as a notebook](generated/{made.name})"
        source[0] = f"{title}\n\n{link}\n{rest}"


class Names(dict):
    """Names of annotations that only a type checker imports, each as a class of this name."""

    def __init__(self, known):
        self.known = known

    def __missing__(self, name):
        if name in self.known or hasattr(builtins, name):
            raise KeyError(name)
        return type(name, (), {"__module__": "builtins"})


def without_marks(_app, thing, _bound):
    """Leave out of annotations what only looks at arguments: ``Annotated[float, ...]`` is a float
    to a reader.
    """
    function = inspect.unwrap(thing.__init__ if isinstance(thing, type) else thing)
    if inspect.isfunction(function):
        with suppress(
            AttributeError, NameError, TypeError
        ):  # of what a type checker imports: it stays as it is written
            function.__annotations__.update(
                typing.get_type_hints(function, localns=Names(function.__globals__))
            )


def short_arrays(_app, _what, _name, _thing, _options, signature, returned):
    """Write an array as ``ndarray``; all are of doubles."""
    return tuple(
        text
        and re.sub(
            r"(numpy\.)?ndarray\[.*?, (numpy\.)?dtype\[[\w.]*\]\]", "ndarray", text
        )
        for text in (signature, returned)
    )


def by_last_name(_app, env, node, shown):
    """Find a name of Python that docstrings give without its module."""
    if node.get("refdomain") != "py":
        return None
    domain = env.get_domain("py")
    target = node["reftarget"].lstrip(".")
    # What the command line reads has the module, which pages do not show.
    public = f"lagrange_casadi.{target.rpartition('.')[2]}"
    found = {
        entry.node_id: entry
        for _, entry in domain.find_obj(env, None, None, target, None, 1)
        or domain.find_obj(env, None, None, public, None, 0)
    }
    if len(found) != 1:
        return None
    (entry,) = found.values()
    return make_refnode(
        env.app.builder, node["refdoc"], entry.docname, entry.node_id, shown
    )


def out_of_the_pages(app, tree):
    """Lead links to cases into the gallery; leave folders of the source, which are links on GitHub,
    as text.
    """
    here = (HERE / app.env.docname).parent
    for node in list(tree.findall(addnodes.pending_xref)):
        place = (here / node["reftarget"]).resolve()
        if place.is_relative_to(CASES):
            case = place.relative_to(CASES).parts[:1]
            link = addnodes.pending_xref(
                "",
                *node.children,
                refdomain="std",
                reftype="doc",
                refexplicit=True,
                refwarn=True,
            )
            link["reftarget"], link["refdoc"] = (
                f"/gallery/{'/'.join(('generated', *case)) if case else 'index'}",
                app.env.docname,
            )
            node.replace_self(link)
        elif place.is_dir() and not place.is_relative_to(HERE):
            node.replace_self(node.children)


def setup(app):
    """Connect what is above."""
    app.connect("builder-inited", gallery)
    app.connect("builder-inited", quantities)
    app.connect("build-finished", reports)
    app.connect("source-read", offer_a_notebook)
    app.connect("autodoc-before-process-signature", without_marks)
    app.connect("autodoc-process-signature", short_arrays)
    app.connect("missing-reference", by_last_name)
    app.connect("doctree-read", out_of_the_pages)

"""The manual: `sphinx-build -W -b html docs docs/_build`.

Every code cell of every page runs when the manual is built, and a cell that fails stops it. Nothing
is asked of the network; RODIMPACT_DOCS_LINKS=1 links names of NumPy, SciPy and Matplotlib to their
own manuals, which does.
"""

import contextlib
import io
import os
import re
import sys
from pathlib import Path

from sphinx.application import Sphinx

import rodimpact

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))
os.environ["RODIMPACT_ROOT"] = str(HERE.parent)  # where cells find records and cases
os.environ["TQDM_DISABLE"] = "1"  # pages show results, not bars
os.environ["PATH"] = (
    str(Path(sys.executable).parent) + os.pathsep + os.environ["PATH"]
)  # commands

project = "rodimpact"
release = version = rodimpact.__version__
author = copyright = "The rodimpact developers"  # noqa: A001
extensions = [
    "mathml",
    "myst_nb",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.intersphinx",
]
exclude_patterns = ["_build", "**/.ipynb_checkpoints"]
source_suffix = {
    ".rst": "restructuredtext",
    ".md": "myst-nb",
}  # .rst is made by autosummary

nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 120
nb_execution_in_temp = True
nb_merge_streams = True
nb_output_stderr = (
    "remove"  # such as how long compiling takes; what fails stops the build
)
nb_render_markdown_format = "myst"
myst_heading_anchors = 3
myst_enable_extensions = ["dollarmath"]
html_math_renderer = "mathml"

autosummary_generate = True
autodoc_typehints = "none"  # docstrings say what they take, with units
numpydoc_show_class_members = False

links = {
    name: (f"https://{place}", None)
    for name, place in (
        ("python", "docs.python.org/3"),
        ("numpy", "numpy.org/doc/stable"),
        ("scipy", "docs.scipy.org/doc/scipy"),
        ("matplotlib", "matplotlib.org/stable"),
    )
}
intersphinx_mapping = links if os.environ.get("RODIMPACT_DOCS_LINKS") else {}

templates_path = ["_templates"]
html_theme = "pydata_sphinx_theme"
html_title = "rodimpact"
html_static_path = ["_static"]
html_css_files = ["manual.css"]
html_show_sourcelink = False
html_copy_source = False
html_theme_options = {
    "show_prev_next": True,
    "navigation_with_keys": False,
    "secondary_sidebar_items": ["page-toc"],
    "navbar_end": ["theme-switcher"],
    "navbar_persistent": ["search-button"],
    "show_toc_level": 2,
    "header_links_before_dropdown": 6,
}
html_sidebars = {"[!a]*": []}  # names have one of all names, other pages none


def of_tuple(
    _app: Sphinx,
    _what: str,
    _name: str,
    member: object,
    _skip: bool,
    _options: object,
) -> bool | None:
    """Skip what Python says of a named tuple's fields; its docstring says more."""
    return (
        str(getattr(member, "__doc__", "")).startswith("Alias for field number") or None
    )


def public_signature(
    _app: Sphinx,
    _what: str,
    _name: str,
    _member: object,
    _options: object,
    signature: str | None,
    returns: str | None,
) -> tuple[str, str | None] | None:
    """A result that is made by functions alone is shown without what it is made of."""
    return ("", returns) if re.search(r"[(,] *_", signature or "") else None


def write_box(app: Sphinx, failure: Exception | None) -> None:
    """The textbook's unequal rods as a page that plays, for the first page of the manual."""
    from rodimpact.cli import main

    if failure is None and app.builder.format == "html":
        page = str(Path(app.outdir) / "_static" / "box.html")
        case = str(HERE.parent / "validation" / "cases" / "unequal-rods.toml")
        with contextlib.redirect_stdout(io.StringIO()):
            if main(["export", case, "-o", page, "--force"]):
                raise RuntimeError("the page of the first page could not be written")


def setup(app: Sphinx) -> None:
    """What happens while the manual is built."""
    app.connect("autodoc-skip-member", of_tuple)
    app.connect("autodoc-process-signature", public_signature)
    app.connect("build-finished", write_box)

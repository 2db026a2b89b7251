"""Settings of the manual, which is built by `sphinx-build -W -b html docs docs/_build`.

Every code cell of every page runs when the manual is built, and a cell that fails stops
the build. The build needs no network unless RODIMPACT_DOCS_LINKS=1 is set, which links
names of NumPy, SciPy and Matplotlib to their own manuals.
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
os.environ["TQDM_DISABLE"] = "1"  # pages show results, not progress bars
commands = str(Path(sys.executable).parent)  # where cells find `rodimpact`
os.environ["PATH"] = commands + os.pathsep + os.environ["PATH"]

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
    ".rst": "restructuredtext",  # autosummary makes such pages
    ".md": "myst-nb",
}

nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 120
nb_execution_in_temp = True
nb_merge_streams = True
# Messages, such as how long compiling takes, are not shown. A failure stops the build.
nb_output_stderr = "remove"
nb_render_markdown_format = "myst"
myst_heading_anchors = 3
myst_enable_extensions = ["dollarmath"]
html_math_renderer = "mathml"

autosummary_generate = True
autodoc_typehints = "none"  # docstrings describe arguments, with units
numpydoc_show_class_members = False

intersphinx_mapping = {}
if os.environ.get("RODIMPACT_DOCS_LINKS"):
    intersphinx_mapping = {
        "python": ("https://docs.python.org/3", None),
        "numpy": ("https://numpy.org/doc/stable", None),
        "scipy": ("https://docs.scipy.org/doc/scipy", None),
        "matplotlib": ("https://matplotlib.org/stable", None),
    }

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
# Pages of the API begin with "a" and have a sidebar of all names. Others have none.
html_sidebars = {"[!a]*": []}


def skip_field_docs(
    _app: Sphinx,
    _what: str,
    _name: str,
    member: object,
    _skip: bool,
    _options: object,
) -> bool | None:
    """Skip the docstrings that Python gives to the fields of a named tuple.

    The docstring of the tuple describes them. None leaves the decision to Sphinx.
    """
    text = str(getattr(member, "__doc__", ""))
    if text.startswith("Alias for field number"):
        return True
    return None


def public_signature(
    _app: Sphinx,
    _what: str,
    _name: str,
    _member: object,
    _options: object,
    signature: str | None,
    returns: str | None,
) -> tuple[str, str | None] | None:
    """Hide the arguments of a class whose objects only functions make.

    Such a class has an argument whose name begins with an underscore.
    """
    if signature is not None and re.search(r"[(,] *_", signature):
        return ("", returns)
    return None


def write_animation(app: Sphinx, failure: Exception | None) -> None:
    """Write the textbook's unequal rods as a page with sliders for index.md."""
    from rodimpact.cli import main

    if failure is not None or app.builder.format != "html":
        return
    page = Path(app.outdir) / "_static" / "box.html"
    case = HERE.parent / "validation" / "cases" / "unequal-rods.toml"
    with contextlib.redirect_stdout(io.StringIO()):
        status = main(["export", str(case), "-o", str(page), "--force"])
    if status:
        raise RuntimeError(f"{page} could not be written")


def setup(app: Sphinx) -> None:
    """Connect the functions above to the build."""
    app.connect("autodoc-skip-member", skip_field_docs)
    app.connect("autodoc-process-signature", public_signature)
    app.connect("build-finished", write_animation)

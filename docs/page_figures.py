"""Draw the figures of the tutorials: `python docs/page_figures.py`.

A figure is the picture that the code cell above it in its page shows. All cells of a
page run in order.
"""

import ast
import contextlib
import io
import re
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import rodimpact as ri

HERE = Path(__file__).parent
PAGES = ("student", "teacher", "researcher", "experimenter")
CELL = re.compile(
    r"^```\{code-cell\}\n(?P<options>(?::[^\n]*\n)*)(?P<code>.*?)^```\n"
    r"(?:\n!\[[^\]]*\]\(figures/(?P<figure>\w+)\.svg\))?",
    re.MULTILINE | re.DOTALL,
)


class Figure(NamedTuple):
    """A committed figure of a page, and the picture that its cell shows."""

    name: str
    picture: Any


def is_command(code: str) -> bool:
    """Whether a cell begins with a command of a notebook or a shell."""
    first_word = code.split(maxsplit=1)[0]
    return "%" in first_word


def write_module(code: str) -> None:
    """Write the file of a cell that begins with %%writefile; ignore other commands."""
    command, _, text = code.partition("\n")
    if command.startswith("%%writefile "):
        Path(command.split()[1]).write_text(text, encoding="utf-8")


def run_statements(statements: list[ast.stmt], page: str, names: dict) -> None:
    """Run the statements of a cell, without their output."""
    code = compile(ast.Module(statements, []), page, "exec")
    with contextlib.redirect_stdout(io.StringIO()):
        exec(code, names)


def figures_of(page: str) -> Iterator[Figure]:
    """Run the cells of a page, and give its figures.

    Cells find the records of validation, and write, in the folder in which this runs.
    They can import the modules that they write there.
    """
    folder = str(Path.cwd())
    sys.path.insert(0, folder)
    try:
        yield from pictures_of_cells(page)
    finally:
        sys.path.remove(folder)


def pictures_of_cells(page: str) -> Iterator[Figure]:
    """Run the cells of a page in this folder, and give its figures."""
    records = Path("validation")
    if not records.exists():
        records.symlink_to(HERE.parent / "validation")
    names: dict[str, Any] = {}
    text = (HERE / f"{page}.md").read_text(encoding="utf-8")
    for cell in CELL.finditer(text):
        if is_command(cell["code"]):
            write_module(cell["code"])
            continue
        statements = ast.parse(cell["code"]).body
        if cell["figure"] is None:
            run_statements(statements, page, names)
            continue
        *before, last = statements
        run_statements(before, page, names)
        if isinstance(last, ast.Expr):
            expression = compile(ast.Expression(last.value), page, "eval")
            yield Figure(cell["figure"], eval(expression, names))


def main() -> None:
    """Draw every figure; cells write into a temporary folder."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        for page in PAGES:
            for figure in figures_of(page):
                path = HERE / "figures" / f"{figure.name}.svg"
                ri.plot.save(figure.picture, path, force=True)
                kilobytes = path.stat().st_size / 1e3
                print(f"{kilobytes:6.1f} kB  {path.name}")  # noqa: T201


if __name__ == "__main__":
    main()

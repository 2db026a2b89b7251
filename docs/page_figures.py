"""The figures of the tutorials, drawn anew: `python docs/page_figures.py`.

A figure is what the code cell above it in its page shows; all cells of the page run in order.
"""

import ast
import contextlib
import io
import re
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import rodimpact as ri

HERE = Path(__file__).parent
PAGES = ("student", "teacher", "researcher", "experimenter")
CELL = re.compile(
    r"^```\{code-cell\}\n(?P<options>(?::[^\n]*\n)*)(?P<code>.*?)^```\n"
    r"(?:\n!\[[^\]]*\]\(figures/(?P<figure>\w+)\.svg\))?",
    re.MULTILINE | re.DOTALL,
)


def figures_of(page: str) -> Iterator[tuple[str, Any]]:
    """Name of each committed figure of a page, and the picture that its cell shows.

    Cells find the records of validation, and write, in the folder in which this runs.
    """
    if not Path("validation").exists():
        Path("validation").symlink_to(HERE.parent / "validation")
    names: dict[str, Any] = {}
    for cell in CELL.finditer((HERE / f"{page}.md").read_text(encoding="utf-8")):
        if (
            "%" in cell["code"].split(maxsplit=1)[0]
        ):  # commands of a notebook or a shell
            continue
        lines = ast.parse(cell["code"]).body
        shown = lines.pop() if cell["figure"] else None
        with contextlib.redirect_stdout(io.StringIO()):
            exec(compile(ast.Module(lines, []), page, "exec"), names)
        if isinstance(shown, ast.Expr):
            yield (
                cell["figure"],
                eval(compile(ast.Expression(shown.value), page, "eval"), names),
            )


def main() -> None:
    """Draw every figure; what cells write lies in a folder that goes."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        for name, picture in (figure for page in PAGES for figure in figures_of(page)):
            path = HERE / "figures" / f"{name}.svg"
            ri.plot.save(picture, path, force=True)
            print(f"{path.stat().st_size / 1e3:6.1f} kB  {path.name}")  # noqa: T201


if __name__ == "__main__":
    main()

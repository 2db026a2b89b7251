"""`%%sh` for cells of this manual: a command that fails stops the build, its text stays whole."""

import subprocess

from IPython.core.magic import register_cell_magic


@register_cell_magic
def sh(_line: str, cell: str) -> None:
    """Run the cell in a shell and print what it prints, in one piece."""
    done = subprocess.run(
        ["sh", "-ec", cell], stdout=subprocess.PIPE, text=True, check=True
    )
    print(done.stdout, end="")  # noqa: T201

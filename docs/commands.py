"""The cell magic `%%sh` of this manual: a command that fails stops the build."""

import subprocess

from IPython.core.magic import register_cell_magic


@register_cell_magic
def sh(_line: str, cell: str) -> None:
    """Run the cell in a shell, and print all of its output in one piece."""
    command = ["sh", "-ec", cell]
    process = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
    print(process.stdout, end="")  # noqa: T201

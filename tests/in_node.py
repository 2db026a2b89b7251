"""JavaScript of the page, run by Node."""

import json
import shutil
import subprocess
import tempfile
from pathlib import Path

import pytest

NODE = shutil.which("node")
needs_node = pytest.mark.skipif(NODE is None, reason="node is not installed")


def run(script, data=None):
    """What `answer(data)` returns, a function that the script defines; data is JSON.

    It fails if the script ends with an error.
    """
    read_data = "const data = JSON.parse(require('fs').readFileSync(0, 'utf8'));"
    write_answer = "process.stdout.write(JSON.stringify(answer(data)));"
    text = f"{script}\n{read_data}\n{write_answer}"
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "script.js")
        file.write_text(text, encoding="utf-8")
        done = subprocess.run(
            [NODE, file],
            input=json.dumps(data),
            capture_output=True,
            text=True,
            timeout=600,
            check=False,
        )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)

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
    """What a script makes of JSON data: `answer(data)`."""
    text = (
        f"{script}\nconst data = JSON.parse(require('fs').readFileSync(0, 'utf8'));\n"
    )
    text += "process.stdout.write(JSON.stringify(answer(data)));"
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

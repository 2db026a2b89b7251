"""The page in one file: complete, closed to the network, written whole or not at
all.
"""

import base64
import hashlib
import html.parser
import json
import re
import zlib
from pathlib import Path

import pytest

import rodimpact as ri
from rodimpact.cli import main
from rodimpact.explorer import page_files
from rodimpact.explorer.page_files import LOADER, SCRIPTS, compact, lean, read

MAX_PAGE_BYTES = 165_000


class Reader(html.parser.HTMLParser):
    """Collects elements, and the text of scripts and styles."""

    def __init__(self, text):
        super().__init__()
        self.elements = []
        self.texts = {}  # texts of scripts and styles
        self._open = None
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        if tag in ("script", "style"):
            self._open = dict(attributes).get("id", tag)

    def handle_data(self, data):
        if self._open:
            self.texts[self._open] = self.texts.get(self._open, "") + data

    def handle_endtag(self, tag):  # noqa: ARG002
        self._open = None


@pytest.fixture
def case(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    alloy = ri.Material("</script><b>", youngs_modulus=200e9, density=7850.0)
    left = ri.Rod(0.4, area=1e-4, material=alloy, velocity=1.0)
    right = ri.Rod(1.0, area=1e-4, material=alloy)
    path = tmp_path / "two <b> rods.toml"
    path.write_text(ri.format_case(ri.System([left, right])))
    return path


def export(case, *arguments):
    return main(["export", str(case), "-o", "page.html", *arguments])


def test_the_page_holds_its_case(case, tmp_path, capsys):
    assert export(case) == 0
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert len(text.encode()) < MAX_PAGE_BYTES
    assert re.fullmatch(r"page\.html: \d+ kB\n", capsys.readouterr().out)
    data = json.loads(Reader(text).texts["embedded"])
    assert data["design"]["case"]["bodies"][0]["length"] == 0.4
    assert ("b", {}) not in Reader(text).elements
    assert "<title>two &lt;b&gt; rods</title>" in text


def test_the_page_asks_nobody_for_anything(case, tmp_path):
    export(case)
    page = Reader((tmp_path / "page.html").read_text(encoding="utf-8"))
    for tag, attributes in page.elements:
        assert not {"src", "srcset", "action", "data"} & set(attributes), tag
        assert attributes.get("href", "data:") in ("data:", "data:,"), tag
    policy = next(
        a["content"]
        for _, a in page.elements
        if a.get("http-equiv") == "Content-Security-Policy"
    )
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert "connect-src" not in policy
    for name in ("script", "style"):
        digest = base64.b64encode(
            hashlib.sha256(page.texts[name].encode()).digest()
        ).decode()
        assert f"'sha256-{digest}'" in policy


@pytest.mark.parametrize(
    ("text", "short"),
    [
        ("  a = 1; // why\n", "a = 1;\n"),
        ('  b = "x // y";\n', 'b = "x // y";\n'),
        ("// all of the line\n  c();\n", "c();\n"),
        ("/** What it does.\n * And more. */\nd();\n", "d();\n"),
    ],
)
def test_scripts_lose_their_comments_and_no_text(text, short):
    assert lean(text) == short


def test_a_style_keeps_the_spaces_that_separate():
    assert compact("a,\nb c {\n  d: e f;\n}\n") == "a,b c {d: e f}"


def unpacked(text):
    letters = text.replace(",", "<")
    return zlib.decompress(base64.b85decode(letters)).decode()


def test_all_of_the_script_is_inside(case, tmp_path):
    export(case)
    page = Reader((tmp_path / "page.html").read_text(encoding="utf-8"))
    script = unpacked(page.texts["packed"])
    for name in SCRIPTS:
        assert lean(read(name)) in script
    assert page.texts["script"] == lean(read(LOADER))
    files = {
        path.name for path in (Path(page_files.__file__).parent / "page").glob("*.js")
    }
    around = "notebook.js"  # the script of the frame around the page
    assert files | {"kernels.js"} == {*SCRIPTS, LOADER, around}


@pytest.mark.parametrize("command", ["export", "explore"])
def test_a_case_that_the_page_cannot_solve_is_refused_before_anything_is_written(
    case, tmp_path, capsys, command
):
    case.write_text(case.read_text("utf-8") + "[solve]\nmethod = 'finite-difference'\n")
    output = ["-o", "page.html"] if command == "export" else ["--no-browser"]
    assert main([command, str(case), *output]) == 2
    output_shown = capsys.readouterr()
    assert output_shown.out == ""
    assert (
        'solve.method: the page cannot solve the method "finite-diff'
        in output_shown.err
    )
    assert "rodimpact animate CASE.toml" in output_shown.err
    assert list(tmp_path.iterdir()) == [case]


def test_explore_opens_a_temporary_page(case, tmp_path, monkeypatch, capsys):
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    for arguments in ([], [str(case)], [str(case), "--no-browser"]):
        assert main(["explore", *arguments]) == 0
    paths = [Path(line) for line in capsys.readouterr().out.split()]
    assert opened == [path.as_uri() for path in paths[:2]]
    titles = [
        re.search("<title>(.*)</title>", path.read_text("utf-8"))[1] for path in paths
    ]
    assert titles == ["Elastic rods collide", *["two &lt;b&gt; rods"] * 2]

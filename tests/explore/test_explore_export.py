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
    """The elements of a page, and the texts of its scripts and styles.

    Attributes
    ----------
    elements : list of tuple
        Tag and attributes of each element; the attributes are a dict.
    texts : dict of str to str
        Texts by the id of a script or style, or by its tag.
    """

    def __init__(self, text):
        """Read the HTML text: its elements with attributes, and the texts of its
        scripts and styles by id or tag.
        """
        super().__init__()
        self.elements = []
        self.texts = {}
        self._open = None  # id or tag of the script or style that is being read
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
    """Path of a case in the current folder, with markup in its names."""
    monkeypatch.chdir(tmp_path)
    alloy = ri.Material("</script><b>", youngs_modulus=200e9, density=7850.0)
    left = ri.Rod(0.4, area=1e-4, material=alloy, velocity=1.0)
    right = ri.Rod(1.0, area=1e-4, material=alloy)
    path = tmp_path / "two <b> rods.toml"
    path.write_text(ri.format_case(ri.System([left, right])))
    return path


def export(case, *arguments):
    """Exit status of an export to page.html."""
    return main(["export", str(case), "-o", "page.html", *arguments])


def test_the_page_is_small_holds_its_case_and_makes_no_markup_of_names(
    case, tmp_path, capsys
):
    """`export` of a case with "<b>" in its name writes a page of at most
    `MAX_PAGE_BYTES` with the case as data and the name escaped.
    """
    assert export(case) == 0

    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    page = Reader(text)
    data = json.loads(page.texts["embedded"])
    assert len(text.encode()) < MAX_PAGE_BYTES
    assert re.fullmatch(r"page\.html: \d+ kB\n", capsys.readouterr().out)
    assert data["design"]["case"]["bodies"][0]["length"] == 0.4
    assert ("b", {}) not in page.elements
    assert "<title>two &lt;b&gt; rods</title>" in text


@pytest.fixture
def page(case, tmp_path):
    """The exported page of the case."""
    export(case)
    return Reader((tmp_path / "page.html").read_text(encoding="utf-8"))


def test_no_element_of_the_page_asks_for_an_address(page):
    assert page.elements
    for tag, attributes in page.elements:
        assert not {"src", "srcset", "action", "data"} & set(attributes), tag
        assert attributes.get("href", "data:") in ("data:", "data:,"), tag


def test_the_policy_of_the_page_allows_its_own_script_and_style_only(page):
    """The content security policy of the page allows nothing by default, no
    connections, and its one script and style by their SHA-256.
    """
    (policy,) = [
        attributes["content"]
        for _, attributes in page.elements
        if attributes.get("http-equiv") == "Content-Security-Policy"
    ]
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert "connect-src" not in policy
    for name in ("script", "style"):
        digest = hashlib.sha256(page.texts[name].encode()).digest()
        assert f"'sha256-{base64.b64encode(digest).decode()}'" in policy


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
    """The script that a text in base 85 holds; a "<" would open an element."""
    letters = text.replace(",", "<")
    return zlib.decompress(base64.b85decode(letters)).decode()


def test_all_scripts_are_inside_the_page_which_loads_them(page):
    script = unpacked(page.texts["packed"])
    for name in SCRIPTS:
        assert lean(read(name)) in script
    assert page.texts["script"] == lean(read(LOADER))


def test_every_script_of_the_package_is_one_of_the_page_or_of_its_frame():
    """The script files of the explorer, and the translated kernels, are those of the
    page, its loader, and that of the frame in a notebook.
    """
    folder = Path(page_files.__file__).parent / "page"
    files = {path.name for path in folder.glob("*.js")}
    made = "kernels.js"  # the translated kernels
    of_frame = "notebook.js"
    assert files | {made} == {*SCRIPTS, LOADER, of_frame}


@pytest.mark.parametrize("command", ["export", "explore"])
def test_a_case_that_the_page_cannot_solve_is_refused_before_anything_is_written(
    case, tmp_path, capsys, command
):
    """`explore` and `export` of a case for a grid end with status 2, recommend
    `animate`, and write no file.
    """
    case.write_text(case.read_text("utf-8") + "[solve]\nmethod = 'finite-difference'\n")
    options = ["--no-browser"]
    if command == "export":
        options = ["-o", "page.html"]

    assert main([command, str(case), *options]) == 2

    printed = capsys.readouterr()
    message = 'solve.method: the page cannot solve the method "finite-diff'
    assert printed.out == ""
    assert message in printed.err
    assert "rodimpact animate CASE.toml" in printed.err
    assert list(tmp_path.iterdir()) == [case]


def test_a_page_that_prints_says_how_it_is_seen():
    rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)

    text = str(ri.explore(ri.System([rod, ri.Wall()])))

    assert re.fullmatch(r"<Page: 1\d\d kB; save\(FILE\.html\) writes it, .*>", text)
    assert "open() opens it in the browser" in text


def test_physics_that_the_page_lacks_is_told_before_an_option_that_it_needs():
    """`explore` of a pile in soil without `until` says that the page cannot solve it,
    and nothing of `until`.
    """
    ram = ri.RigidMass(1000.0, velocity=3.0)
    soil = ri.Soil(resistance=3e5, quake=2.5e-3, damping=0.2)
    pile = ri.Rod(10.0, area=1e-2, material=ri.materials.steel, shaft=soil)
    cushion = ri.Cushion(1e8, restitution=0.5)

    with pytest.raises(ri.InvalidModel) as caught:
        ri.explore(ri.System([ram, pile], contacts=[cushion]))

    assert "solve.until" not in str(caught.value)
    assert "the page cannot solve" in str(caught.value)


def test_a_page_is_no_figure(case, tmp_path, capsys):
    """`rodimpact export` to a PDF file is refused with the call that draws a figure; no
    file is written.
    """
    assert main(["export", str(case), "-o", "p.pdf"]) == 2

    error = capsys.readouterr().err
    assert "--output: must end in .html or .htm, got 'p.pdf'" in error
    assert "rodimpact run CASE.toml --plot FILE draws a figure" in error
    assert list(tmp_path.iterdir()) == [case]


def test_python_saves_a_page_and_a_family_under_their_own_endings_only(tmp_path):
    """A page is refused as .pdf and a family as .csv; a page is saved as .HTM, and
    nothing else is written.
    """
    rod = ri.Rod([0.2, 0.4], area=1e-4, material=ri.materials.steel, velocity=1.0)
    family = ri.System([rod, ri.Wall()])
    page = ri.explore(family[0])

    with pytest.raises(ri.InvalidModel, match=r"path: must end in \.html or \.htm, "):
        page.save(tmp_path / "page.pdf")
    with pytest.raises(ri.InvalidModel, match=r"path: must end in \.npz, got"):
        ri.sweep(family).save(tmp_path / "family.csv")
    page.save(tmp_path / "page.HTM")

    assert [path.name for path in tmp_path.iterdir()] == ["page.HTM"]


def test_explore_opens_a_temporary_page_unless_told_not_to(
    case, tmp_path, monkeypatch, capsys
):
    """`explore`, without a case and with one, prints the path of a page and opens it;
    with --no-browser it opens none. The title of the page is that of the case, escaped.
    """
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))

    for arguments in ([], [str(case)], [str(case), "--no-browser"]):
        assert main(["explore", *arguments]) == 0

    first, second, third = [Path(line) for line in capsys.readouterr().out.split()]
    titles = []
    for path in (first, second, third):
        titles.append(re.search("<title>(.*)</title>", path.read_text("utf-8"))[1])
    assert opened == [first.as_uri(), second.as_uri()]
    assert titles == ["Elastic rods collide", *["two &lt;b&gt; rods"] * 2]

"""The page with the solver inside, opened from a file by a browser that nobody steers."""

import html
import json
import shutil
import subprocess

import pytest

import rodimpact as ri
from rodimpact.cli import main

BROWSER = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
needs_browser = pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")
MOST = 150_000  # bytes of the page of the box
STEEL = ri.materials.steel


def live(folder, system, name="page", **solve):
    """Write a case and its live page; the path of the page."""
    (folder / "case.toml").write_text(ri.write_case(ri.Case(system, solve)), encoding="utf-8")
    page = folder / f"{name}.html"
    assert main(["export", str(folder / "case.toml"), "-o", str(page), "--live"]) == 0
    return page


def opened(page, hash_=""):
    """What the page has become after a while, and what it asked others for."""
    log = page.with_suffix(".json")
    done = subprocess.run(
        [BROWSER, "--headless", "--no-sandbox", "--disable-gpu", f"--log-net-log={log}",
         f"--user-data-dir={page.parent}/browser", "--virtual-time-budget=5000", "--dump-dom",
         f"{page.as_uri()}{hash_}"],
        capture_output=True, text=True, timeout=120, check=True,
    )
    text = log.read_text(encoding="utf-8").rstrip().rstrip(",")
    events = json.loads(text if text.endswith("}") else text + "]}")["events"]
    asked = [e["params"]["url"] for e in events
             if e.get("params", {}).get("initiator", "not an origin") != "not an origin"]
    return done.stdout, asked


def pair(length=0.4, material=STEEL):
    return ri.System([
        ri.Rod(length, area=1e-4, material=material, velocity=1.0),
        ri.Rod(1.0, area=1e-4, material=material),
    ])


@needs_browser
def test_the_page_solves_by_itself_and_asks_nobody(tmp_path):
    name = "</script><b>alloy</b>"
    page = live(tmp_path, pair(material=ri.Material(name, youngs_modulus=2e11, density=7850.0)))
    assert len(page.read_bytes()) < MOST
    text, asked = opened(page)
    assert asked == []
    assert 'data-frames="' in text
    assert '<output id="restitution">0.4</output>' in text
    assert "Saint-Venant" in text
    assert "<b>alloy" not in text
    assert html.escape(name, quote=False) in text


@needs_browser
@pytest.mark.parametrize(("address", "words"), [
    ("#case.schema=1&case.bodies.0.kind=rod&case.bodies.0.length=-1&case.bodies.0.area=1e-4"
     "&case.bodies.0.material=steel&case.bodies.1.kind=wall",
     "must be a finite positive number, got \u22121000 mm"),
    ("#case.schema=1&case.bodies.0.kind=mass&case.bodies.0.mass=1&case.bodies.1.kind=rod"
     "&case.bodies.1.length=1&case.bodies.1.area=1e-4&case.bodies.1.material=steel",
     "this page follows fronts only, without rigid masses; the one that rodimpact explore"),
])
def test_what_the_page_cannot_solve_is_told(tmp_path, address, words):
    text, asked = opened(live(tmp_path, pair()), address)
    assert words in text
    assert asked == []


def test_only_fronts_make_a_live_page(tmp_path, capsys):
    (tmp_path / "case.toml").write_text(
        ri.write_case(ri.System(pair().bodies, contacts=[ri.Hertz(1e10)])))
    arguments = ["export", str(tmp_path / "case.toml"), "-o", str(tmp_path / "p.html"), "--live"]
    assert main(arguments) == 2
    assert "--live: cannot be solved by a page" in capsys.readouterr().err
    assert not (tmp_path / "p.html").exists()

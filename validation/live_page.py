"""How large the page with the solver inside is, and how fast, in a Chromium without a window.

    python -m validation.live_page

Times are medians, in a page of 1280 x 800; what the browser takes to paint comes on top.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

import rodimpact as ri
from rodimpact.cli import main as command

STEEL = ri.materials.steel
REDRAWN = """(() => {
  const times = [];
  for (let i = 0; i < 60; i += 1) {
    design.case.bodies[0].length *= 1.003;
    const began = performance.now();
    receive(sceneOf(design));
    draw();
    times.push(performance.now() - began);
  }
  return times.sort((a, b) => a - b)[30];
})()"""
MAPPED = """(() => {
  const times = [];
  for (let k = 0; k < 5; k += 1) {
    const began = performance.now();
    const [x, , , y] = numbersOf(design);
    const [xs, ys] = [x, y].map((number) => valuesAbout(number).map((value) =>
      fromShown(value, FIELDS[number.key].power)));
    for (const value of ys) {
      fronts.e_over(fronts.changed(design.case, y.path, value), start.materials, x.path, xs);
    }
    times.push(performance.now() - began);
  }
  return times.sort((a, b) => a - b)[2];
})()"""
FIRST = """new Promise((done) => {
  const root = document.documentElement;
  const look = () => (root.dataset.frames ? done(performance.now()) : requestAnimationFrame(look));
  look();
})"""


class Browser:
    """A Chromium that is told what to do through a pipe."""

    def __init__(self, program: str, folder: str) -> None:
        (theirs, self.to), (self.come, mine) = os.pipe(), os.pipe()

        def plumb() -> None:
            os.dup2(theirs, 3)
            os.dup2(mine, 4)

        self.process = subprocess.Popen(
            [program, "--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe",
             "--window-size=1280,800", f"--user-data-dir={folder}/browser"],
            preexec_fn=plumb, pass_fds=(3, 4), stderr=subprocess.DEVNULL,
        )
        self.number, self.rest = 0, b""

    def ask(self, method: str, session: str = "", **given: Any) -> Any:
        """The result of a command of the DevTools protocol."""
        self.number += 1
        sent = {"id": self.number, "method": method, "params": given}
        if session:
            sent["sessionId"] = session
        os.write(self.to, json.dumps(sent).encode() + b"\0")
        while True:
            while b"\0" not in self.rest:
                self.rest += os.read(self.come, 1 << 20)
            text, _, self.rest = self.rest.partition(b"\0")
            answer = json.loads(text)
            if answer.get("id") == self.number:
                return answer.get("result", {})

    def page(self, path: Path) -> str:
        """Open a page; its session."""
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        session = str(self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"])
        self.ask("Page.navigate", session, url=path.as_uri())
        return session

    def value(self, session: str, code: str) -> float:
        """What code in a page comes to."""
        while True:
            found = self.ask("Runtime.evaluate", session, expression=code, awaitPromise=True,
                             returnByValue=True)
            if isinstance(value := found.get("result", {}).get("value"), int | float):
                return value
            time.sleep(0.01)  # the page is not there yet


def rods(lengths: list[float]) -> ri.System:
    """A row of steel rods, the first of which moves."""
    return ri.System([
        ri.Rod(length, area=1e-4, material=STEEL, velocity=float(i == 0))
        for i, length in enumerate(lengths)
    ])


def main() -> None:
    """Print the figures."""
    program = shutil.which("chromium") or shutil.which("google-chrome")
    if program is None:
        print("no Chromium is installed")
        return
    with tempfile.TemporaryDirectory() as folder:
        pages = {}
        for name, system in (
            ("box", rods([0.4, 1.0])), ("chain of ten", rods([0.2 + 0.01 * i for i in range(10)])),
        ):
            case, pages[name] = Path(folder, f"{name}.toml"), Path(folder, f"{name}.html")
            case.write_text(ri.write_case(system), encoding="utf-8")
            command(["export", str(case), "-o", str(pages[name])])
        browser = Browser(program, folder)
        try:
            figures = []
            for name, page in pages.items():
                size = f"{len(page.read_bytes()) / 1000:.0f} kB"
                session = browser.page(page)
                figures.append((f"{name}: size", size))
                figures.append((f"{name}: first frame", f"{browser.value(session, FIRST):.0f} ms"))
                figures.append((f"{name}: redrawn", f"{browser.value(session, REDRAWN):.1f} ms"))
            session = browser.page(pages["box"])
            browser.value(session, FIRST)
            figures.append(("200 x 200 map", f"{browser.value(session, MAPPED):.0f} ms"))
            for what, value in figures:
                print(f"{what:30} {value}")
        finally:
            browser.process.kill()
            browser.process.wait()


if __name__ == "__main__":
    main()

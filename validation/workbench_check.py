"""Plays the story of the workbench in headless Chromium: a file is dropped, effects are switched on, the error falls, a diagnosis is accepted.

    apt-get install chromium chromium-driver
    python validation/workbench_check.py --bulge target/release/bulge --tour TOUR [--big BIG.csv] [--pictures FOLDER]
    python validation/workbench_check.py http://127.0.0.1:PORT/TOKEN/ --tour TOUR ...

TOUR is the folder that `bulge demo --out TOUR` writes (braid-loops.csv and braid.toml are used). With `--bulge` the server is started by the test and killed
at its end, to see what the page says then. BIG is a file of 10^5 rows with which zooming is timed. Needs nothing beyond the Python standard library.
The last lines are a table of timings and `N passed, M failed`; the exit status is 1 if anything failed.
"""

import argparse
import base64
import contextlib
import json
import os
import random
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path

from report_check import CONTRAST, FLAGS, OVERFLOW, Browser, Checks, Trouble, complaints_of

WIDE, NARROW = (1440, 900), (400, 800)
LIMIT = 900
# Of the browser: the page is on this machine, and the bulge needs WebGL, which SwiftShader draws without a card.
PAGE_FLAGS = [flag for flag in FLAGS if not flag.startswith("--host-resolver")] + [
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1", "--enable-unsafe-swiftshader",
]
HOSTILE = '<img src=x onerror="window.hurt=1">'
EFFECTS = ["end-taper", "bladder-elasticity", "coulomb-friction"]

# Controls without a name that a screen reader could say.
NAMELESS = """
return [...document.querySelectorAll('button, a[href], input, select, textarea, [role=switch], [role=tab]')].filter((e) => {
  if (!e.checkVisibility()) return false;
  const label = e.labels && e.labels.length ? e.labels[0].textContent : '';
  return !(e.getAttribute('aria-label') || e.getAttribute('aria-labelledby') || label.trim() || e.textContent.trim() || e.title);
}).map((e) => e.outerHTML.slice(0, 80));
"""

# Zooms a plot by one notch of the wheel for each frame, and tells the times between frames.
# A slider is dragged in steps and let go; where it stands after that, frame by frame, until nothing is under way.
DRAG = """
const done = arguments[arguments.length - 1];
const at = () => document.querySelector('[data-slider=bladder-elasticity-modulus]');
const seen = [];
let v = 320, frames = 0;
const step = () => {
  if (v <= 620) { at().value = v; at().dispatchEvent(new Event('input')); v += 20; if (v > 620) at().dispatchEvent(new Event('change')); }
  else { seen.push(at().value); frames += 1; }
  if (frames > 90 && document.body.dataset.state !== 'busy') done(seen);
  else requestAnimationFrame(step);
};
requestAnimationFrame(step);
"""
ZOOM = """
const done = arguments[arguments.length - 1];
const plot = document.querySelector('#plot-force'), box = plot.getBoundingClientRect();
const times = []; let last = 0, i = 0; performance.clearMeasures('redraw');
const step = (now) => {
  if (last) times.push(now - last);
  last = now;
  if (i >= 60) { done([times.slice(2), performance.getEntriesByName('redraw').map((m) => m.duration).slice(1), document.querySelector('#plot-force .note').textContent]); return; }
  plot.dispatchEvent(new WheelEvent('wheel', {deltaY: i < 30 ? -60 : 60, clientX: box.left + box.width / 2, clientY: box.top + box.height / 2, bubbles: true, cancelable: true}));
  i += 1; requestAnimationFrame(step);
};
requestAnimationFrame(step);
"""


class Page(Browser):
    """The workbench in a browser, driven by what a hand would do."""

    def __init__(self):
        super().__init__(PAGE_FLAGS, LIMIT)

    def visit(self, address):
        self.do("/url", {"url": address})

    def later(self, script):
        """A script that calls back."""
        return self.do("/execute/async", {"script": script, "args": []})

    def is_ready(self, seconds=60):
        self.wait("document.body.dataset.state === 'ready'", "the page is ready", seconds)

    def settle(self, seconds=120):
        self.is_ready(seconds)
        self.wait("document.body.dataset.heldOut === 'done' && document.body.dataset.state === 'ready'", "held-out errors are there", seconds)

    def choose(self, selector, *paths):
        self.do(f"/element/{self.find(selector)}/value", {"text": "\n".join(str(Path(path).resolve()) for path in paths)})

    def error(self):
        return float(self.run("return document.querySelector('#error').dataset.rmse"))

    def press(self, selector, rest=0.25):
        """As a hand does: the pointer comes, rests, and presses."""
        self.run(f"document.querySelector({json.dumps(selector)}).scrollIntoView({{block: 'center'}})")
        x, y, width, height = self.run(f"const b = document.querySelector({json.dumps(selector)}).getBoundingClientRect(); return [b.left, b.top, b.width, b.height]")
        steps = [
            {"type": "pointerMove", "duration": 30, "x": round(x + width / 2), "y": round(y + height / 2), "origin": "viewport"},
            {"type": "pause", "duration": round(1000 * rest)}, {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0},
        ]
        self.do("/actions", {"actions": [{"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": steps}]})

    def shot(self, path):
        picture = self.devtools("Page.captureScreenshot", format="png")
        Path(path).write_bytes(base64.b64decode(picture["data"]))


class Server:
    """`bulge open`, which the test starts and kills."""

    def __init__(self, program, tour, session=None):
        self.program, self.tour = program, tour
        self.session = ["--session", str(session)] if session else []

    def __enter__(self):
        self.process = subprocess.Popen(
            # In the folder of the tour: screenshots show the command line.
            [Path(self.program).resolve(), "open", "braid-loops.csv", "--muscle", "braid.toml", "--no-browser", *self.session],
            cwd=self.tour, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        )
        for line in self.process.stdout:
            if "http://127.0.0.1:" in line:
                self.address = "http://127.0.0.1:" + line.split("http://127.0.0.1:", 1)[1].split()[0].strip("`.,")
                return self
        raise Trouble("bulge open printed no address")

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def memory(self):
        """Resident set [MiB]."""
        pages = int(Path(f"/proc/{self.process.pid}/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE") / 2**20

    def ask(self, method, call, body=None):
        request = urllib.request.Request(self.address + "api/" + call, json.dumps(body).encode() if body is not None else None, {"Content-Type": "application/json"}, method=method)
        with urllib.request.urlopen(request, timeout=120) as answer:
            return answer.read()

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.terminate()
            with contextlib.suppress(subprocess.TimeoutExpired):
                self.process.wait(timeout=5)
            if self.process.poll() is None:
                self.kill()
        self.process.stdout.close()


class Story:
    def __init__(self, page, checks, tour, folder):
        self.page, self.checks, self.tour, self.folder = page, checks, tour, folder
        self.timings = []

    def expect(self, what, is_so, says=""):
        self.checks.check(what, [] if is_so else [str(says) or "it is not so"])

    def part(self, what, play):
        """Plays a part of the story; what breaks off is a failure of this part only."""
        try:
            play()
        except Trouble as trouble:
            self.checks.check(what, [str(trouble)])

    def measured(self, name, values, limit=None):
        """A row of the table: limits are told, not enforced, because a shared machine is no bench."""
        values = sorted(values)
        if values:
            self.timings.append((name, statistics.median(values), values[min(len(values) - 1, int(0.95 * len(values)))], len(values), limit))

    def loads(self):
        page = self.page
        page.settle()
        paint = page.run("return performance.getEntriesByType('paint').filter((p) => p.name === 'first-contentful-paint').map((p) => p.startTime)")
        self.measured("first paint", paint, 300)
        self.measured("data drawn", page.run("return performance.getEntriesByName('data').map((m) => m.duration)"), 1000)
        self.expect("the error stands in the headline", page.text("#error").endswith("N"), page.text("#error"))
        self.expect("the noise floor stands beside it", page.text("#floor").endswith("N"), page.text("#floor"))
        self.expect("the command that does the same is there", page.text("#command").startswith("bulge compare"), page.text("#command"))

    def start_over(self):
        """Nothing switched on and nothing excluded, whatever was left by somebody before."""
        script = """
        const done = arguments[arguments.length - 1];
        fetch('api/session', {method: 'PUT', headers: {'Content-Type': 'application/json'}, body: JSON.stringify({effects: [], excluded: [], own_effects: null, view: {}})}).then((a) => done(a.status));
        """
        self.page.later(script)
        self.page.visit(self.page.run("return location.href"))
        self.page.settle()

    def hostile(self):
        page = self.page
        source = (self.tour / "braid-loops.csv").read_text().splitlines()
        start = next(i for i, line in enumerate(source) if not line.startswith("#"))
        name = HOSTILE.replace('"', '""')
        rows = [source[start] + f',"{name}"'] + [line + ",1" for line in source[start + 1:]]
        file = self.folder / "<b>hostile.csv"
        file.write_text("\n".join(rows) + "\n")
        page.choose("#file", file)
        page.wait("document.querySelector('#data-name').textContent.includes('hostile')", "the file with hostile names is there")
        page.settle()
        self.drag_about()
        self.expect("names of columns and files make no markup", page.run("return !document.querySelector('img') && !document.querySelector('#headline b i') && window.hurt === undefined"))

    def drag_about(self):
        self.page.drag("#plot-force", (0.3, 0.5), (0.4, 0.55))
        self.page.click("#reset")

    def drop(self):
        page = self.page
        page.choose("#file", self.tour / "braid-loops.csv")
        page.wait("document.querySelector('#data-name').textContent === 'braid-loops.csv'", "the file is there")
        page.settle()
        columns = page.run("return [...document.querySelectorAll('#columns [data-quantity]')].map((r) => r.dataset.quantity)")
        self.expect("each column was taken for something", {"pressure", "contraction", "force"} <= set(columns), columns)

    def map_column(self):
        page = self.page
        page.run("document.querySelector('#columns tr[data-quantity=time] .link').click()")
        page.run("const s = document.querySelector('#columns .editor select'); s.value = 'ignore'; s.dispatchEvent(new Event('change'))")
        page.click("#columns .editor button[type=submit]")
        page.wait("document.querySelector('#mapping')", "the mapping is there")
        page.settle()
        said = page.text("#mapping code")
        self.expect("a column is mapped by a click", "ignore=time" in said, said)
        page.click("#forget-columns")
        page.wait("!document.querySelector('#mapping')", "the mapping is forgotten")
        page.settle()

    def assign(self):
        """A file whose headings say nothing: the page asks, and is told by hand."""
        page = self.page
        source = [line for line in (self.tour / "braid-loops.csv").read_text().splitlines() if not line.startswith("#")]
        file = self.folder / "odd.csv"
        file.write_text("\n".join(["one,two,three,four,five", *source[1:]]) + "\n")
        page.choose("#file", file)
        page.wait("!document.querySelector('#columns-error').hidden && document.querySelector('#columns tr[data-column=five]')", "it is asked which column is which")
        self.expect("what was drawn stays, and is shown to be older", page.run("return document.body.dataset.stale") == "true")
        self.expect("no number of the older data stands in the headline", page.text("#error-ladder") == "–" and page.text("#floor") == "–", page.text("#error-ladder"))
        self.expect("the reason stands above the plots", page.run("return !document.querySelector('#problem').hidden") and "pressure" in page.text("#problem"), page.text("#problem"))
        for heading, quantity in (("one", "time"), ("two", "sweep"), ("three", "pressure"), ("four", "contraction"), ("five", "force")):
            page.run(f"document.querySelector('#columns tr[data-column={heading}] .link').click()")
            page.run(f"const s = document.querySelector('#columns .editor select'); s.value = '{quantity}'; s.dispatchEvent(new Event('change'))")
            page.click("#columns .editor button[type=submit]")
            page.wait(f"document.querySelector('#mapping code')?.textContent.includes('{quantity}={heading}') && document.body.dataset.state !== 'busy'", f"{heading} is said")
        page.wait("document.querySelector('#columns-error').hidden", "the file is read as said")
        page.settle()
        self.expect("columns without a meaning are told by hand", page.text("#data-name") == "odd.csv" and not page.run("return document.body.dataset.stale"), page.text("#mapping code"))
        for _ in range(6):
            page.click("#undo")
            page.wait("document.body.dataset.state !== 'busy'", "a step back")
        page.wait("document.querySelector('#data-name').textContent === 'braid-loops.csv'", "undo brings the old file back")
        page.settle()

    def specimens(self):
        """Specimens whose sweeps have the same names are drawn, each in its own colour."""
        page = self.page
        head, *rows = [line for line in (self.tour / "braid-loops.csv").read_text().splitlines() if not line.startswith("#")]
        file = self.folder / "specimens.csv"
        file.write_text("\n".join(["specimen," + head, *(f"{name},{row}" for name in "AB" for row in rows[:300])]) + "\n")
        page.choose("#file", file)
        page.wait("document.querySelector('#data-name').textContent === 'specimens.csv'", "the file is taken")
        page.settle()
        self.expect("several specimens are drawn", page.run("return document.querySelector('#banner').hidden && !document.body.dataset.stale") and page.error() > 0, page.text("#banner"))
        page.click("#undo")
        page.wait("document.querySelector('#data-name').textContent === 'braid-loops.csv'", "undo brings the old file back")
        page.settle()

    def elsewhere(self):
        """Another tab switches an effect on: this one follows."""
        page = self.page
        put = """
        const done = arguments[arguments.length - 1];
        fetch('api/session', {method: 'PUT', headers: {'Content-Type': 'application/json'}, body: JSON.stringify({effects: [{name: 'end-taper'}]})}).then((a) => done(a.status));
        """
        page.later(put)
        page.wait("document.querySelectorAll('#ladder .rung').length === 2", "the change of another tab is seen")
        page.settle()
        page.click("#undo")
        page.wait("document.querySelectorAll('#ladder .rung').length === 1", "it is undone here")
        page.settle()
        self.expect("a change of another tab is followed", True)

    def hold(self):
        """A slider holds a number, and the button fits it again."""
        page = self.page
        page.run("const s = document.querySelector('[data-slider=bladder-elasticity-modulus]'); s.value = 300; s.dispatchEvent(new Event('input')); s.dispatchEvent(new Event('change'))")
        page.wait("document.querySelector('[data-hold=bladder-elasticity-modulus]').getAttribute('aria-pressed') === 'true'", "the number is held")
        page.settle()
        seen = page.later(DRAG)
        self.expect("a slider that is let go stays where it was let go", seen and all(at == seen[-1] == "620" for at in seen), seen)
        page.settle()
        page.click("[data-hold=bladder-elasticity-modulus]")
        page.wait("document.querySelector('[data-hold=bladder-elasticity-modulus]').getAttribute('aria-pressed') === 'false'", "the number is fitted again")
        page.settle()
        self.expect("a number is held by its slider and fitted again", True)

    def switch(self):
        page = self.page
        errors = [page.error()]
        for name in EFFECTS:
            page.run(f"document.querySelector('#catalogue [role=switch][data-effect={name}]').click()")
            page.wait(f"document.querySelectorAll('#ladder .rung').length === {len(errors) + 1}", f"{name} is on")
            page.is_ready()
            errors.append(page.error())
        self.expect("the error falls with each of three effects", all(b < a for a, b in zip(errors, errors[1:])), errors)
        print("       " + " -> ".join(f"{error:.3g} N" for error in errors))
        page.settle()
        self.expect("the held-out error follows", page.text("#held-out").endswith("N"), page.text("#held-out"))
        shown = page.run("return [...document.querySelectorAll('#active .number .value')].map((v) => v.textContent)")
        self.expect("the numbers of the effects are shown", len(shown) >= 2, shown)

    def time_switches(self, name, times, limit, reads, skip=0):
        """Effects are switched on for the first time and off again: a person reads for some seconds, then a hand rests on each switch for a quarter of a second."""
        page = self.page
        page.run("performance.clearMeasures('switch'); performance.clearMeasures('draw')")
        usable = page.run("return [...document.querySelectorAll('#catalogue [role=switch]:not(:disabled)[aria-checked=false]')].map((s) => s.dataset.effect)")
        # Of all stages, and not those alone that stand first.
        some = usable[skip :: max(1, len(usable) // max(1, times // 2))][: times // 2]
        time.sleep(reads)
        for effect in [effect for effect in some for _ in ("on", "off")]:
            before = page.run("return performance.getEntriesByName('switch').length")
            page.press(f"#catalogue [role=switch][data-effect={effect}]")
            page.wait(f"performance.getEntriesByName('switch').length > {before}", f"the plots are redrawn with {effect}")
            page.is_ready()
        self.measured(name, page.run("return performance.getEntriesByName('switch').map((m) => m.duration)"), limit)
        self.measured(f"{name}: of it drawing", page.run("return performance.getEntriesByName('draw').map((m) => m.duration)"))
        page.settle()

    def time_held_out(self, name, limit):
        """From the click to the error on held-out data, for some effects that are there already and one more."""
        page = self.page
        page.run("performance.clearMeasures('held-out')")
        for effect in page.run("return [...document.querySelectorAll('#catalogue [role=switch]:not(:disabled)[aria-checked=false]')].slice(-3).map((s) => s.dataset.effect)"):
            for _ in ("on", "off"):
                page.press(f"#catalogue [role=switch][data-effect={effect}]")
                page.is_ready()
                page.settle()
        self.measured(name, page.run("return performance.getEntriesByName('held-out').map((m) => m.duration)"), limit)

    def look_closely(self):
        page = self.page
        page.click("[data-tool=rectangle]")
        page.drag("#plot-force", (0.3, 0.05), (0.6, 0.85))
        says = page.text("#selection-says")
        self.expect("a brush selects rows and names their lines", "rows" in says and "lines" in says, says)
        rows = page.run("return document.querySelector('#data-facts').textContent")
        before = page.error()
        page.click("#exclude")
        page.wait("document.querySelector('#excluded')", "rows are excluded")
        page.settle()
        self.expect("excluded rows stand beside the data", "excluded" in page.text("#excluded"), rows)
        page.click("#excluded button")
        page.wait("!document.querySelector('#excluded')", "rows are back")
        page.settle()
        self.expect("brought back, the error is the same", abs(page.error() - before) < 1e-6 * before, (before, page.error()))
        page.click("[data-tool=pan]")

    def diagnose(self):
        page = self.page
        page.run("document.querySelector('#ladder [data-rung=\"0\"]').click()")
        page.wait("document.querySelectorAll('#ladder .rung').length === 1", "all effects are off")
        page.settle()
        page.click("#diagnose")
        page.wait("document.querySelector('#diagnosis-progress')", "progress is shown")
        page.click("#diagnosis-cancel")
        page.wait("document.body.dataset.diagnosis === 'cancelled'", "it is cancelled")
        start = time.monotonic()
        page.click("#diagnose")
        page.wait("document.body.dataset.diagnosis === 'done'", "the diagnosis is there", 300)
        self.measured("diagnosis", [1000 * (time.monotonic() - start)])
        self.expect("the verdict stands there", page.run("return document.querySelector('#verdict').dataset.verdict") == "missing", page.text("#verdict"))
        base = page.error()
        page.click("[data-show]")
        page.wait("document.querySelector('#preview')", "a claim is shown")
        page.settle()
        self.expect("a preview moves the plots", page.error() < base, page.error())
        page.click("#preview-discard")
        page.wait("!document.querySelector('#preview')", "the preview is gone")
        page.settle()
        self.expect("a discarded preview leaves nothing", page.error() == base, page.error())
        # Accepted out of a preview, the claim stays and the preview goes.
        page.click("#show-all, [data-show]")
        page.wait("document.querySelector('#preview')", "the claim is shown again")
        page.settle()
        page.click("#accept-all, [data-accept]")
        page.wait("!document.querySelector('#preview') && document.querySelectorAll('#ladder .rung').length > 1", "the claim is accepted")
        page.settle()
        self.expect("with what was found the error is near the noise", page.error() < 0.05 * base, page.error())
        page.run("document.querySelector('#active [role=switch]').click()")
        page.wait("document.querySelector('#tab-effects').textContent.includes('on)')", "an effect is switched off")
        page.settle()
        page.run("document.querySelector('#catalogue [role=switch][data-effect=force-gain]').click()")
        page.wait("document.querySelector('#diagnosed-with')", "a verdict on other effects says so")
        page.settle()
        page.click("#undo")
        page.settle()
        page.click("#undo")
        page.wait("!document.querySelector('#diagnosed-with')", "undone, the verdict is about what is on")
        page.settle()

    def plan(self):
        """A test is drawn, and what it would show is told; a wrong number is told at its field, an impossible one in the library's words."""
        page = self.page
        page.click("#tab-plan")
        page.wait("document.querySelector('#plan-facts')", "the test of the data is looked at")
        self.expect("the test of the data is taken over", page.text("#plan-facts").startswith("750 rows in 5 sweeps"), page.text("#plan-facts"))
        page.click("#clear-plan")
        page.run("document.querySelector('#plan-panel').scrollIntoView()")
        start = time.monotonic()
        page.drag("#plan-plane", (0.35, 0.75), (0.75, 0.3))
        page.wait("document.querySelectorAll('[data-block]').length === 1 && document.querySelector('#plan-facts') && !document.querySelector('#plan-answer.pending')", "a drawn test is looked at")
        self.measured("a test is drawn and looked at", [1000 * (time.monotonic() - start)])
        self.expect("a rectangle is three sweeps", "in 3 sweeps" in page.text("#plan-facts"), page.text("#plan-facts"))
        page.drag("#plan-plane", (0.3, 0.5), (0.7, 0.5))
        page.wait("document.querySelectorAll('[data-block]').length === 2 && document.querySelector('#plan-facts')?.textContent.includes('in 4 sweeps')", "a held length is added")
        self.expect("a level line holds the length", page.run("return document.querySelector('#block-1-motion').value") == "held")
        wrong = "const b = document.querySelector('#block-0-{}'); b.value = '{}'; b.dispatchEvent(new Event('change'))"
        page.run(wrong.format("pressures", "2 bar"))
        self.expect("a wrong number is told at its field", "numbers such as" in page.text("[data-block='0'] .field-error"), page.text("[data-block='0']"))
        page.run(wrong.format("pressures", "2, 4"))
        page.run(wrong.format("period_s", "0"))
        page.wait("document.querySelector('#plan-error').textContent.includes('a period of 0 s is not possible')", "an impossible test is refused in the library's words")
        page.run(wrong.format("period_s", "60"))
        page.wait("!document.querySelector('#plan-error').textContent && document.querySelector('#plan-facts')?.textContent.includes('in 3 sweeps')", "a right one is looked at again")
        here = page.run("return location.href")
        # What was drawn is with the session a moment later.
        time.sleep(1)
        page.visit(here)
        page.settle()
        page.click("#tab-plan")
        page.wait("document.querySelectorAll('[data-block]').length === 2", "a reload keeps the plan")
        page.click("#tab-effects")

    def undo(self):
        page = self.page
        rungs = page.run("return document.querySelectorAll('#ladder .rung').length")
        page.click("#undo")
        page.wait("document.querySelectorAll('#ladder .rung').length === 1", "undo takes the effects off")
        page.settle()
        page.click("#redo")
        page.wait(f"document.querySelectorAll('#ladder .rung').length === {rungs}", "redo brings them back")
        page.settle()
        error = page.error()
        page.visit(page.run("return location.href"))
        page.settle()
        self.expect("a reload keeps the state", page.error() == error, (error, page.error()))

    def bad_input(self):
        page = self.page
        page.run("const b = document.querySelector('#muscle-form input[data-key=length]'); b.value = '-3 mm'; b.dispatchEvent(new Event('change'))")
        page.wait("document.querySelector('#muscle-form .field-error')", "the field complains")
        self.expect("a wrong number is told at its field", "length" in page.text("#muscle-form .field-error"), page.text("#muscle-form .field-error"))
        page.click("#muscle-raw summary")
        page.click("#muscle-revert")
        page.wait("!document.querySelector('#muscle-form .field-error')", "the complaint is gone")
        page.click("#muscle-raw summary")
        typed = "const b = document.querySelector('#muscle-form input[data-key={}]'); b.value = '{}'; b.dispatchEvent(new Event('change'))"
        before = page.error()
        page.run(typed.format("radius", "11,5 mm"))
        page.wait("document.querySelector('#muscle-form .field-error')", "the field complains again")
        page.run("document.querySelector('#catalogue [role=switch][data-effect=force-gain]').click()")
        page.is_ready()
        self.expect("another change leaves the complaint", page.run("return document.querySelector('#muscle-form input[data-key=radius]').value === '11,5 mm' && Boolean(document.querySelector('#muscle-form .field-error'))"))
        page.run("document.querySelector('#catalogue [role=switch][data-effect=force-gain]').click()")
        page.run(typed.format("radius", "10.5 mm"))
        page.wait("!document.querySelector('#muscle-form .field-error')", "a right number takes the place of a wrong one")
        page.settle()
        self.expect("and is what is computed", page.error() != before, (before, page.error()))
        page.click("#undo")
        page.settle()
        page.run("document.querySelector('#own').open = true; const b = document.querySelector('#own-toml'); b.value = '[effects.x]\\nforce = \"k *\"'; b.dispatchEvent(new Event('input'))")
        page.wait("document.querySelector('#own-says').dataset.kind === 'bad'", "a wrong formula is told")
        page.run("document.querySelector('#own').open = false")

    def pictures(self, folder):
        page = self.page
        for kind, (width, height) in (("wide", WIDE), ("narrow", NARROW)):
            for shade in ("light", "dark"):
                page.devtools("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600)
                page.shade(shade)
                time.sleep(0.6)
                needed, room, wide = page.run(OVERFLOW)
                self.expect(f"no horizontal overflow at {width} px, {shade}", needed <= room, f"{needed} px in {room} px: {wide}")
                self.checks.check(f"contrast at {width} px, {shade}", page.run(CONTRAST))
                if folder:
                    page.shot(folder / f"workbench-{kind}-{shade}.png")
        page.shade("light")
        self.wide()

    def wide(self):
        self.page.devtools("Emulation.setDeviceMetricsOverride", width=WIDE[0], height=WIDE[1], deviceScaleFactor=1, mobile=False)

    def many(self, big, folder):
        page = self.page
        page.choose("#file", big)
        page.wait(f"document.querySelector('#data-name').textContent === {json.dumps(big.name)}", "the large file is there", 180)
        page.settle(300)
        frames, redraws, note = page.later(ZOOM)
        self.measured("zoom at 1e5 rows, frame to frame", frames, 20)
        self.measured("zoom at 1e5 rows, script", redraws, 20)
        self.expect("it is said that points are thinned while moving", "while moving" in note, note)
        time.sleep(0.5)
        self.expect("all points are drawn at rest", page.text("#plot-force .note") == "", page.text("#plot-force .note"))
        if folder:
            page.shot(folder / "workbench-many.png")
        self.time_switches("a switch at 1e5 rows, at once", 6, None, 0)
        self.time_switches("a switch at 1e5 rows", 6, 1000, 60, 1)
        self.time_held_out("the error on held-out data at 1e5 rows, from the click", 5000)

    def table(self):
        print("\n| what | median [ms] | 95 % [ms] | times | to reach [ms] |\n|---|---|---|---|---|")
        for name, median, most, count, limit in self.timings:
            print(f"| {name} | {median:.0f} | {most:.0f} | {count} | {limit or ''} |")
        print()


def killed_while_diagnosing(page, checks, arguments, folder):
    """A server that is killed in the middle of a diagnosis is started again: the session is what it was, and the page goes on."""
    session = folder / "session"
    with Server(arguments.bulge, arguments.tour, session) as server:
        page.visit(server.address)
        page.settle()
        page.press("#catalogue [role=switch][data-effect=end-taper]")
        page.wait("document.querySelectorAll('#ladder .rung').length === 2", "an effect is on")
        page.settle()
        error, address = page.error(), server.address
        page.click("#diagnose")
        page.wait("document.querySelector('#diagnosis-progress') && document.querySelector('#diagnosis-progress').value > 0.05", "the diagnosis is under way")
        server.kill()
        page.wait("document.querySelector('#banner').textContent.includes('has ended')", "the page says that the server has ended", 20)
    with Server(arguments.bulge, arguments.tour, session) as server:
        page.visit(server.address)
        page.settle()
        same = server.address.rsplit("/", 2)[1] == address.rsplit("/", 2)[1]
        checks.check("killed while diagnosing, nothing is lost", [] if page.error() == error and same else [f"{error} became {page.error()}, {address} {server.address}"])
        page.click("#diagnose")
        page.wait("document.body.dataset.diagnosis === 'done'", "the diagnosis is made again", 300)
        checks.check("the diagnosis is made again", [])


def stays_small(checks, arguments, times):
    """Memory of the server over many switches and held numbers: it is flat once what is kept is full."""
    names = ["end-taper", "bladder-elasticity", "coulomb-friction", "pressure-offset", "force-offset", "thread-elasticity", "viscoelasticity", "specimen-spread"]
    chance = random.Random(5)
    with Server(arguments.bulge, arguments.tour) as server:
        usable = {card["name"] for card in json.loads(server.ask("GET", "effects"))["effects"] if not card["unsuitable"]}
        names = [name for name in names if name in usable]
        sizes = []
        for i in range(times):
            on = [{"name": name} for name in chance.sample(names, chance.randint(0, 3))]
            for effect in on:
                if effect["name"] == "coulomb-friction" and chance.random() < 0.5:
                    effect["hold"] = {"force": round(chance.uniform(1, 20), 2)}
            server.ask("PUT", "session", {"effects": on})
            server.ask("GET", "comparison?held_out=0")
            server.ask("GET", "rows")
            if i % 10 == 0:
                server.ask("GET", "comparison?held_out=1")
            sizes.append(server.memory())
        early, late = statistics.mean(sizes[times // 2 : 3 * times // 4]), statistics.mean(sizes[-times // 4 :])
        print(f"memory over {times} switches [MiB]: {sizes[0]:.1f} at first, {early:.1f} in the third quarter, {late:.1f} in the last, {max(sizes):.1f} at most")
        checks.check("the memory of the server is flat", [] if late < 1.1 * early + 4 else [f"{early:.1f} MiB became {late:.1f} MiB"])


def play(page, checks, arguments, address, folder):
    story = Story(page, checks, arguments.tour, folder)
    story.wide()
    page.shade("light")
    page.visit(address)
    story.part("the page loads", story.loads)
    story.part("it starts over", story.start_over)
    for what, part in (
        ("hostile names", story.hostile), ("a file is read", story.drop), ("a column is mapped", story.map_column),
        ("columns are assigned", story.assign), ("specimens", story.specimens), ("another tab", story.elsewhere), ("effects are switched", story.switch), ("a number is held", story.hold),
        ("rows are brushed", story.look_closely), ("it is diagnosed", story.diagnose), ("a test is planned", story.plan), ("undo, redo, reload", story.undo), ("bad input", story.bad_input),
    ):
        story.part(what, part)
    story.part("switches are timed", lambda: story.time_switches("a switch at once", 10, None, 0))
    story.part("switches are timed after reading", lambda: story.time_switches("a switch", arguments.switches, 100, 15, 1))
    story.part("held-out errors are timed", lambda: story.time_held_out("the error on held-out data, from the click", 1000))
    checks.check("all controls have names", page.run(NAMELESS))
    story.part("pictures", lambda: story.pictures(arguments.pictures))
    if arguments.big:
        story.part("many rows", lambda: story.many(arguments.big, arguments.pictures))
    # What the server refuses with a sentence is a complaint of the console too.
    # Chromium without a card says how slowly it reads pixels back.
    serious = [text for text in complaints_of(page) if "Failed to load resource" not in text and "GL Driver Message" not in text]
    checks.check("no complaint on the console", serious)
    return story


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("address", nargs="?", help="of a workbench that runs")
    parser.add_argument("--bulge", type=Path, help="program to start the workbench with")
    parser.add_argument("--tour", type=Path, required=True, help="folder with braid-loops.csv and braid.toml")
    parser.add_argument("--big", type=Path, help="a CSV of 1e5 rows")
    parser.add_argument("--pictures", type=Path, help="folder for screenshots")
    parser.add_argument("--memory", type=int, default=0, help="number of switches over which the memory of the server is watched")
    parser.add_argument("--switches", type=int, default=20, help="how often a switch is timed")
    arguments = parser.parse_args()
    if bool(arguments.address) == bool(arguments.bulge):
        parser.error("say either an address or --bulge PROGRAM")
    if arguments.pictures:
        arguments.pictures.mkdir(parents=True, exist_ok=True)
    arguments.tour = arguments.tour.resolve()
    arguments.big = arguments.big and arguments.big.resolve()
    checks = Checks()
    folder = Path(tempfile.mkdtemp(prefix="workbench-check-"))
    try:
        with contextlib.ExitStack() as stack:
            server = stack.enter_context(Server(arguments.bulge, arguments.tour)) if arguments.bulge else None
            page = stack.enter_context(Page())
            story = play(page, checks, arguments, server.address if server else arguments.address, folder)
            if server:
                server.kill()
                story.part("the server is killed", lambda: page.wait("document.querySelector('#banner').textContent.includes('has ended')", "the page says so", 20))
                story.expect("what was drawn stays", page.run("return document.querySelectorAll('#ladder .rung').length > 0"))
            if server:
                story.part("the server is killed in a diagnosis", lambda: killed_while_diagnosing(page, checks, arguments, folder))
            story.table()
        if arguments.memory:
            stays_small(checks, arguments, arguments.memory)
    except Trouble as trouble:
        checks.check("the browser can look at it", [str(trouble)])
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    print(f"{checks.passed} passed, {checks.failed} failed")
    return 1 if checks.failed else 0


if __name__ == "__main__":
    sys.exit(main())

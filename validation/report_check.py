"""Opens reports of Bulge in headless Chromium, with the network blocked, and looks at them as a reader would.

    apt-get install chromium chromium-driver
    python validation/report_check.py report.html ... [--screenshot FILE.png] [--narrow FILE.png] [--dark FILE.png] [--pdf FILE.pdf]

Needs nothing beyond the Python standard library: Chromium is driven by chromedriver over the W3C WebDriver protocol. Looks for complaints
on the console, requests to anywhere, drawings without size, texts in drawings that overlap or are cut, a page wider than the window (1280
and 390 px), texts without contrast on light and on dark ground, and drawings that do not fit on a printed A4 page. Where a report holds its rows, their
plots are used with mouse and keyboard, and the report is looked at once more without scripts (report_plots.py). Pictures of several reports are numbered: FILE-1.png, FILE-2.png and so on.
The last line is `N passed, M failed`; the exit status is 1 if anything failed, or if there is no Chromium to look with.
"""

import argparse
import base64
import contextlib
import http.client
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import urllib.error
import urllib.request
from pathlib import Path

import report_plots

WIDE, NARROW = 1280, 390
HEIGHT = 900
# CSS pixels are 1/96 inch; the page's @page rule leaves 15 mm on both sides and 16 mm above and below.
PRINTED_WIDTH, PRINTED_HEIGHT = (round((side - 2 * margin) / 25.4 * 96) for side, margin in ((210, 15), (297, 16)))

# A report that takes longer than this [s] is too heavy to read.
LIMIT = 180

LEAST_DRAWING = 60
# Boxes of neighbouring texts are higher than their letters; this much of both may overlap.
OVERLAP = 2.5
# Texts may reach beyond the edge of a drawing by this much: a box is wider than its letters.
BEYOND = 1.5

FLAGS = [
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--hide-scrollbars", "--host-resolver-rules=MAP * ~NOTFOUND",
]

# Of a report whose rows are drawn by its script only those for which these plots don't stand.
DRAWINGS = """
const isShown = svg => svg.checkVisibility() || !(svg.closest('.without-script') && document.querySelector('.scripted'));
return [...document.querySelectorAll('svg')].filter(svg => !svg.closest('#explored') && isShown(svg)).map((svg, i) => {
  const box = svg.getBoundingClientRect();
  const figure = svg.closest('figure');
  const texts = [...svg.querySelectorAll('text')].map(text => {
    const b = text.getBoundingClientRect();
    return [b.left, b.top, b.right, b.bottom, text.textContent];
  });
  return {name: figure ? figure.id : 'drawing ' + (i + 1), box: [box.left, box.top, box.right, box.bottom], texts};
});
"""

OVERFLOW = """
const room = document.documentElement.clientWidth;
const wide = [...document.body.querySelectorAll('*')].filter(e => {
  if (e.getBoundingClientRect().right <= room + 1) return false;
  for (let p = e.parentElement; p; p = p.parentElement)
    if (getComputedStyle(p).overflowX !== 'visible') return false;
  return true;
});
return [document.documentElement.scrollWidth, room, wide.slice(0, 3).map(e => e.tagName.toLowerCase() + ' ' + e.className)];
"""

FIGURES = """
return [...document.querySelectorAll('figure')].map(f => {
  const b = f.getBoundingClientRect();
  return [f.id, b.width, b.height];
});
"""

SECTIONS = "return [...document.querySelectorAll('section')].map(s => [s.id, !!s.querySelector('h2'), (s.querySelector('.lead') || {}).textContent || '']);"

# Contrast of texts with their ground (WCAG 2.1): those that are below AA.
CONTRAST = """
const parse = (c) => { const m = c.match(/[\\d.]+/g).map(Number); return m.length > 3 ? m : [...m, 1]; };
const light = (c) => { const [r, g, b] = c.slice(0, 3).map((v) => { v /= 255; return v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; }); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
const found = [];
for (const element of document.querySelectorAll('body *')) {
  const own = [...element.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim());
  if (!own || element.closest('svg, :disabled, [hidden], .visually-hidden, noscript')) continue;
  if (element.checkVisibility && !element.checkVisibility()) continue;
  const style = getComputedStyle(element);
  let ground = [255, 255, 255, 1];
  for (let p = element; p; p = p.parentElement) { const g = getComputedStyle(p).backgroundColor; if (!g.startsWith('rgb')) continue; const c = parse(g); if (c[3] > 0.99) { ground = c; break; } }
  const [a, b] = [light(parse(style.color)), light(ground)].sort((x, y) => y - x);
  const ratio = (a + 0.05) / (b + 0.05);
  const size = parseFloat(style.fontSize);
  const least = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700) ? 3 : 4.5;
  if (ratio < least) found.push(`${element.tagName.toLowerCase()}.${element.className} “${element.textContent.trim().slice(0, 30)}” ${ratio.toFixed(2)}`);
}
return [...new Set(found)];
"""


class Trouble(Exception):
    """The browser can't be started, doesn't answer or refuses: nothing is known of the report."""


def installed(*names):
    """Path of the first of the programs that there is."""
    found = next(filter(None, map(shutil.which, names)), None)
    if not found:
        raise Trouble(f"{names[0]} is not installed: apt-get install chromium chromium-driver")
    return found


class Browser:
    """A session of chromedriver, which ends with the `with` block, or after so many seconds."""

    def __init__(self, flags=FLAGS, limit=LIMIT):
        self.flags, self.limit = flags, limit

    def __enter__(self):
        chromium, driver = installed("chromium", "chromium-browser", "google-chrome"), installed("chromedriver")
        self.folder = tempfile.mkdtemp(prefix="report-check-")
        self.driver = subprocess.Popen(
            # A group of its own, to which Chromium belongs as well.
            [driver, "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, start_new_session=True
        )
        self.is_late = False
        self.watch = threading.Timer(self.limit, self.too_late)
        self.watch.daemon = True
        self.watch.start()
        self.session = None
        try:
            self.url = f"http://127.0.0.1:{self.port()}"
            options = {"binary": chromium, "args": [*self.flags, f"--user-data-dir={self.folder}"]}
            capabilities = {
                "browserName": "chrome",
                "goog:chromeOptions": options,
                "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"},
            }
            answer = self.send("POST", "/session", {"capabilities": {"alwaysMatch": capabilities}})
            self.session = answer["sessionId"]
        except BaseException:
            self.__exit__()
            raise
        return self

    def too_late(self):
        """Whoever waits for an answer gets none."""
        self.is_late = True
        self.end(signal.SIGTERM)

    def end(self, kind):
        """Ends chromedriver and its Chromium, which lives on when only chromedriver ends."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.driver.pid, kind)

    def __exit__(self, *_):
        if self.session:
            with contextlib.suppress(Trouble):
                self.send("DELETE", f"/session/{self.session}")
        self.watch.cancel()
        self.end(signal.SIGTERM)
        try:
            self.driver.wait(timeout=10)
        except subprocess.TimeoutExpired:
            pass
        self.end(signal.SIGKILL)
        self.driver.wait()
        self.driver.stdout.close()
        shutil.rmtree(self.folder, ignore_errors=True)

    def port(self):
        """The port that chromedriver chose and prints."""
        for line in self.driver.stdout:
            if "successfully on port" in line:
                return int(line.rsplit("port", 1)[1].strip().rstrip("."))
        raise Trouble(f"it took longer than {self.limit:.0f} s" if self.is_late else "chromedriver did not start")

    def send(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.url + path, data, {"Content-Type": "application/json"}, method=method)
        # Not through a proxy of the environment: chromedriver is on this machine.
        opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
        try:
            with opener.open(request, timeout=self.limit) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            with error:
                value = json.load(error)["value"]
            says = (value.get("message") or "").split("\n")[0]
            raise Trouble(f"the browser refuses {path.rsplit('/', 1)[-1]}: {value.get('error')}: {says}") from None
        except (OSError, http.client.HTTPException) as error:
            late = f"it took longer than {self.limit:.0f} s" if self.is_late else f"the browser does not answer: {error}"
            raise Trouble(late) from None

    def do(self, path, body=None):
        method = "GET" if body is None else "POST"
        return self.send(method, f"/session/{self.session}{path}", body)

    def devtools(self, command, **parameters):
        return self.do("/goog/cdp/execute", {"cmd": command, "params": parameters})

    def run(self, script):
        return self.do("/execute/sync", {"script": script, "args": []})

    def wait(self, condition, what, seconds=60):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if self.run(f"return Boolean({condition})"):
                return
            time.sleep(0.05)
        raise Trouble(f"after {seconds} s still waiting until {what}")

    def find(self, selector):
        found = self.do("/element", {"using": "css selector", "value": selector})
        return next(iter(found.values()))

    def click(self, selector):
        self.do(f"/element/{self.find(selector)}/click", {})

    def text(self, selector):
        return self.run(f"return (document.querySelector({json.dumps(selector)}) || {{}}).textContent || ''")

    def drag(self, selector, start, end):
        """From one to another place of an element, as shares of its size."""
        x, y, width, height = self.box(selector)
        at = [(round(x + width * a), round(y + height * b)) for a, b in (start, end)]
        move = lambda place, ms: {"type": "pointerMove", "duration": ms, "x": place[0], "y": place[1], "origin": "viewport"}
        steps = [move(at[0], 0), {"type": "pointerDown", "button": 0}, move(((at[0][0] + at[1][0]) // 2, at[1][1]), 60), move(at[1], 60), {"type": "pointerUp", "button": 0}]
        self.do("/actions", {"actions": [{"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": steps}]})

    def shade(self, name):
        self.devtools("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": name}])

    def pause(self, seconds):
        time.sleep(seconds)

    def box(self, selector):
        """Left, top, width and height of an element in the window."""
        return self.run(f"const b = document.querySelector({json.dumps(selector)}).getBoundingClientRect(); return [b.left, b.top, b.width, b.height]")

    def mouse(self, kind, x, y, **more):
        self.devtools("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)
        self.pause(0.05)

    def wheel(self, x, y, by):
        self.mouse("mouseMoved", x, y)
        self.mouse("mouseWheel", x, y, deltaX=0, deltaY=by)
        self.pause(0.25)

    def key(self, key):
        for kind in ("keyDown", "keyUp"):
            self.devtools("Input.dispatchKeyEvent", type=kind, key=key)

    def log(self, kind):
        return self.do("/se/log", {"type": kind})

    def open(self, address):
        self.devtools("Network.enable")
        self.devtools("Network.setBlockedURLs", urls=["http://*", "https://*", "ws://*", "wss://*", "ftp://*"])
        self.devtools(
            "Network.emulateNetworkConditions", offline=True, latency=0, downloadThroughput=0, uploadThroughput=0
        )
        # The page that Chromium starts with asks for parts of its own.
        self.do("/url", {"url": "about:blank"})
        time.sleep(0.3)
        for kind in ("browser", "performance"):
            self.log(kind)
        self.do("/url", {"url": address})

    def size(self, width, height=HEIGHT):
        self.devtools(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600
        )
        time.sleep(0.2)

    def picture(self, path):
        """The whole page, not only the window."""
        picture = self.devtools("Page.captureScreenshot", format="png", captureBeyondViewport=True)
        Path(path).write_bytes(base64.b64decode(picture["data"]))

    def whole_page(self, width, path):
        height = int(self.run("return document.documentElement.scrollHeight"))
        # Chromium draws at most 16384 px.
        self.size(width, min(height, 16000))
        self.picture(path)
        self.size(width)

    def pdf(self):
        margins = {"top": 0.4, "bottom": 0.4, "left": 0.4, "right": 0.4}
        answer = self.devtools("Page.printToPDF", preferCSSPageSize=True, printBackground=True, **{
            f"margin{side.capitalize()}": size for side, size in margins.items()
        })
        return base64.b64decode(answer["data"])


def complaints_of(browser):
    """What the console says."""
    return [f"{entry['level']}: {entry['message']}" for entry in browser.log("browser") if entry["level"] != "DEBUG"]


def requests_of(browser):
    """Addresses that were asked for, other than the file itself."""
    found = []
    for entry in browser.log("performance"):
        message = json.loads(entry["message"])["message"]
        if message["method"] == "Network.requestWillBeSent":
            address = message["params"]["request"]["url"]
            if not address.startswith(("file:", "data:", "about:", "chrome:")):
                found.append(address)
    return found


def overlaps(texts):
    """Pairs of texts that cover each other, and how much."""
    found = []
    ordered = sorted(texts)
    for i, a in enumerate(ordered):
        for b in ordered[i + 1:]:
            if b[0] >= a[2]:
                break
            across, down = min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])
            if across > OVERLAP and down > OVERLAP:
                found.append(f"“{a[4]}” and “{b[4]}” by {across:.0f} x {down:.0f} px")
    return found


def drawing_faults(drawing):
    """What is wrong with one drawing."""
    left, top, right, bottom = drawing["box"]
    if right - left <= LEAST_DRAWING or bottom - top <= LEAST_DRAWING:
        yield f"it is only {right - left:.0f} x {bottom - top:.0f} px"
    for fault in overlaps(drawing["texts"]):
        yield f"texts overlap: {fault}"
    for text in drawing["texts"]:
        beyond = max(left - text[0], top - text[1], text[2] - right, text[3] - bottom)
        if beyond > BEYOND:
            yield f"“{text[4]}” is cut by {beyond:.0f} px"


class Checks:
    """Counts what passed and says what failed."""

    def __init__(self):
        self.passed = self.failed = 0

    def check(self, what, faults):
        faults = list(faults)
        if faults:
            self.failed += 1
            print(f"FAILED {what}")
            for fault in faults[:8]:
                print(f"    {fault}")
            if len(faults) > 8:
                print(f"    and {len(faults) - 8} more")
        else:
            self.passed += 1
            print(f"ok     {what}")


def look(browser, checks, pictures):
    for width in (WIDE, NARROW):
        browser.size(width)
        needed, room, wide = browser.run(OVERFLOW)
        faults = [f"the page is {needed} px wide in a window of {room} px: {wide}"] if needed > room or wide else []
        checks.check(f"no horizontal overflow at {width} px", faults)
        if width == NARROW and pictures.narrow:
            browser.whole_page(width, pictures.narrow)
    browser.size(WIDE)
    for ground in ("dark", "light"):
        browser.shade(ground)
        checks.check(f"texts stand out from the {ground} ground", browser.run(CONTRAST))
        if ground == "dark" and pictures.dark:
            browser.whole_page(WIDE, pictures.dark)
    for drawing in browser.run(DRAWINGS):
        checks.check(f"drawing {drawing['name']}", drawing_faults(drawing))
    sections = browser.run(SECTIONS)
    checks.check("the page has sections", [] if sections else ["there is none"])
    bare = [name for name, heading, lead in sections if not heading or not lead.strip()]
    checks.check("each section begins with a heading and a sentence", [f"section {name} does not" for name in bare])
    if pictures.screenshot:
        browser.whole_page(WIDE, pictures.screenshot)


def look_without_scripts(browser, checks, report):
    """The same with a browser that runs none: drawings stand for the plots."""
    browser.devtools("Emulation.setScriptExecutionDisabled", value=True)
    browser.open(report.resolve().as_uri())
    browser.size(WIDE)
    drawings = browser.run(DRAWINGS)
    faults = [f"{drawing['name']}: {fault}" for drawing in drawings for fault in drawing_faults(drawing)]
    checks.check("without scripts all drawings are there", faults)
    shown = browser.run("return !!document.querySelector('#explore').checkVisibility()")
    checks.check("without scripts there is no place for the plots", ["it is there"] if shown else [])
    browser.devtools("Emulation.setScriptExecutionDisabled", value=False)


def print_out(browser, checks, pictures):
    browser.devtools("Emulation.setEmulatedMedia", media="print")
    browser.size(PRINTED_WIDTH, PRINTED_HEIGHT)
    needed, room, wide = browser.run(OVERFLOW)
    faults = [f"it needs {needed} px of {room} px: {wide}"] if needed > room or wide else []
    checks.check("no horizontal overflow on paper", faults)
    high = [f"{name} is {height:.0f} px high, and a page {PRINTED_HEIGHT} px" for name, _, height in browser.run(FIGURES)
            if height > PRINTED_HEIGHT]
    checks.check("each figure fits on an A4 page", high)
    browser.devtools("Emulation.setEmulatedMedia", media="")
    browser.size(WIDE)
    pdf = browser.pdf()
    checks.check("it prints to PDF", [] if pdf.startswith(b"%PDF-") and len(pdf) > 10_000 else [f"{len(pdf)} bytes"])
    if pictures.pdf:
        Path(pictures.pdf).write_bytes(pdf)


def numbered(path, number, count):
    """`FILE.png` for one report, `FILE-2.png` for the second of several; none stays none."""
    path = path and Path(path)
    return path and (path if count == 1 else path.with_name(f"{path.stem}-{number}{path.suffix}"))


def check_report(report, checks, pictures):
    with Browser() as browser:
        browser.open(report.resolve().as_uri())
        browser.size(WIDE)
        look(browser, checks, pictures)
        has_rows = browser.run("return !!document.querySelector('#explore')")
        if has_rows:
            report_plots.use(browser, checks)
        print_out(browser, checks, pictures)
        checks.check("no complaint on the console", complaints_of(browser))
        checks.check("nothing was asked of a network", requests_of(browser))
        if has_rows:
            look_without_scripts(browser, checks, report)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("reports", type=Path, nargs="+", metavar="report.html")
    parser.add_argument("--screenshot", metavar="FILE.png", help=f"picture of the page at {WIDE} px")
    parser.add_argument("--narrow", metavar="FILE.png", help=f"picture of the page at {NARROW} px")
    parser.add_argument("--dark", metavar="FILE.png", help=f"picture of the page at {WIDE} px on dark ground")
    parser.add_argument("--pdf", metavar="FILE.pdf", help="the page as it is printed")
    arguments = parser.parse_args()
    missing = [str(report) for report in arguments.reports if not report.is_file()]
    if missing:
        sys.exit(f"no such file: {', '.join(missing)}")
    checks = Checks()
    count = len(arguments.reports)
    for number, report in enumerate(arguments.reports, 1):
        if count > 1:
            print(f"{report}:")
        pictures = argparse.Namespace(
            **{kind: numbered(getattr(arguments, kind), number, count) for kind in ("screenshot", "narrow", "dark", "pdf")}
        )
        start = time.monotonic()
        try:
            check_report(report, checks, pictures)
        except Trouble as trouble:
            checks.check("the browser can look at it", [str(trouble)])
        print(f"       {time.monotonic() - start:.0f} s")
    print(f"{checks.passed} passed, {checks.failed} failed")
    return 1 if checks.failed else 0


if __name__ == "__main__":
    sys.exit(main())

"""Opens reports of Bulge in headless Chromium, with the network blocked, and looks at them as a reader would.

    apt-get install chromium chromium-driver
    python validation/report_check.py report.html ... [--screenshot FILE.png] [--narrow FILE.png] [--pdf FILE.pdf]

Needs nothing beyond the Python standard library: Chromium is driven by chromedriver over the W3C WebDriver protocol. Looks for complaints
on the console, requests to anywhere, drawings without size, texts in drawings that overlap or are cut, a page wider than the window (1280
and 390 px), and drawings that do not fit on a printed A4 page. Pictures of several reports are numbered: FILE-1.png, FILE-2.png and so on.
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

WIDE, NARROW = 1280, 390
HEIGHT = 900
# CSS pixels are 1/96 inch; the page's @page rule leaves 15 mm on both sides and 16 mm above and below.
PRINTED_WIDTH, PRINTED_HEIGHT = (round((side - 2 * margin) / 25.4 * 96) for side, margin in ((210, 15), (297, 16)))

# A report that takes longer than this [s] is too heavy to read.
LIMIT = 60

LEAST_DRAWING = 60
# Boxes of neighbouring texts are higher than their letters; this much of both may overlap.
OVERLAP = 2.5
# Texts may reach beyond the edge of a drawing by this much: a box is wider than its letters.
BEYOND = 1.5

FLAGS = [
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--hide-scrollbars", "--host-resolver-rules=MAP * ~NOTFOUND",
]

DRAWINGS = """
return [...document.querySelectorAll('svg')].map((svg, i) => {
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
    for drawing in browser.run(DRAWINGS):
        checks.check(f"drawing {drawing['name']}", drawing_faults(drawing))
    sections = browser.run(SECTIONS)
    checks.check("the page has sections", [] if sections else ["there is none"])
    bare = [name for name, heading, lead in sections if not heading or not lead.strip()]
    checks.check("each section begins with a heading and a sentence", [f"section {name} does not" for name in bare])
    if pictures.screenshot:
        browser.whole_page(WIDE, pictures.screenshot)


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
        print_out(browser, checks, pictures)
        checks.check("no complaint on the console", complaints_of(browser))
        checks.check("nothing was asked of a network", requests_of(browser))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("reports", type=Path, nargs="+", metavar="report.html")
    parser.add_argument("--screenshot", metavar="FILE.png", help=f"picture of the page at {WIDE} px")
    parser.add_argument("--narrow", metavar="FILE.png", help=f"picture of the page at {NARROW} px")
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
            **{kind: numbered(getattr(arguments, kind), number, count) for kind in ("screenshot", "narrow", "pdf")}
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

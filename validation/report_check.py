"""Opens a report of Bulge in headless Chromium, with the network blocked, and looks at it as a reader would.

    apt-get install chromium chromium-driver
    python validation/report_check.py report.html [--screenshot FILE.png] [--pdf FILE.pdf] [--narrow FILE.png]

Needs nothing beyond the Python standard library: Chromium is driven by chromedriver over the W3C WebDriver protocol. Looks for complaints
on the console, requests to anywhere, drawings without size, texts in drawings that overlap or are cut, a page wider than the window (1280
and 390 px), and drawings that do not fit on a printed A4 page. The last line is `N passed, M failed`; the exit status is 1 if anything failed.
"""

import argparse
import base64
import json
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from pathlib import Path

WIDE, NARROW = 1280, 390
HEIGHT = 900
# CSS pixels are 1/96 inch; the page's @page rule leaves 15 mm on both sides and 16 mm above and below.
PRINTED_WIDTH, PRINTED_HEIGHT = (round((side - 2 * margin) / 25.4 * 96) for side, margin in ((210, 15), (297, 16)))

LEAST_DRAWING = 100
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


class Browser:
    """A session of chromedriver, which ends with the `with` block."""

    def __enter__(self):
        driver, chromium = shutil.which("chromedriver"), shutil.which("chromium") or shutil.which("chromium-browser")
        if not driver or not chromium:
            sys.exit("chromium or chromedriver is not installed: apt-get install chromium chromium-driver")
        self.folder = tempfile.TemporaryDirectory(prefix="report-check-")
        self.driver = subprocess.Popen(
            [driver, "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        self.session = None
        try:
            self.url = f"http://127.0.0.1:{self.port()}"
            options = {"binary": chromium, "args": [*FLAGS, f"--user-data-dir={self.folder.name}"]}
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

    def __exit__(self, *_):
        if self.session:
            try:
                self.send("DELETE", f"/session/{self.session}")
            except (OSError, RuntimeError):
                pass
        self.driver.terminate()
        try:
            self.driver.wait(timeout=10)
        except subprocess.TimeoutExpired:
            self.driver.kill()
        shutil.rmtree(self.folder.name, ignore_errors=True)

    def port(self):
        """The port that chromedriver chose and prints."""
        for line in self.driver.stdout:
            if "successfully on port" in line:
                return int(line.rsplit("port", 1)[1].strip().rstrip("."))
        sys.exit("chromedriver did not start")

    def send(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.url + path, data, {"Content-Type": "application/json"}, method=method)
        try:
            # Not through a proxy of the environment: chromedriver is on this machine.
            opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
            with opener.open(request, timeout=120) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            value = json.load(error)["value"]
            raise RuntimeError(f"{path}: {value.get('error')}: {value.get('message', '').splitlines()[0]}") from None

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


def look(browser, checks, arguments):
    for width in (WIDE, NARROW):
        browser.size(width)
        needed, room, wide = browser.run(OVERFLOW)
        faults = [f"the page is {needed} px wide in a window of {room} px: {wide}"] if needed > room or wide else []
        checks.check(f"no horizontal overflow at {width} px", faults)
        if width == NARROW and arguments.narrow:
            browser.whole_page(width, arguments.narrow)
    browser.size(WIDE)
    for drawing in browser.run(DRAWINGS):
        checks.check(f"drawing {drawing['name']}", drawing_faults(drawing))
    sections = browser.run(SECTIONS)
    checks.check("the page has sections", [] if sections else ["there is none"])
    bare = [name for name, heading, lead in sections if not heading or not lead.strip()]
    checks.check("each section begins with a heading and a sentence", [f"section {name} does not" for name in bare])
    if arguments.screenshot:
        browser.whole_page(WIDE, arguments.screenshot)


def print_out(browser, checks, arguments):
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
    if arguments.pdf:
        Path(arguments.pdf).write_bytes(pdf)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("report", type=Path)
    parser.add_argument("--screenshot", metavar="FILE.png", help="picture of the page at 1280 px")
    parser.add_argument("--narrow", metavar="FILE.png", help="picture of the page at 390 px")
    parser.add_argument("--pdf", metavar="FILE.pdf", help="the page as it is printed")
    arguments = parser.parse_args()
    if not arguments.report.is_file():
        sys.exit(f"{arguments.report}: no such file")
    checks = Checks()
    with Browser() as browser:
        browser.open(arguments.report.resolve().as_uri())
        browser.size(WIDE)
        look(browser, checks, arguments)
        print_out(browser, checks, arguments)
        checks.check("no complaint on the console", complaints_of(browser))
        checks.check("nothing was asked of a network", requests_of(browser))
    print(f"{checks.passed} passed, {checks.failed} failed")
    return 1 if checks.failed else 0


if __name__ == "__main__":
    sys.exit(main())

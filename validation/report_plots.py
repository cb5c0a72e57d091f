"""Uses the plots of rows of a report with mouse and keyboard, as a reader would; report_check.py calls it."""

import re

# The report must draw its rows within this time [ms] of being opened; a shared machine takes longer than a reader's.
MOST_MS = 3000

PLOTS = ("force", "map", "against")

# What a plot shows, axes and points; their pixels are the same as long as nothing is drawn anew.
DRAWN = "return [...document.querySelectorAll('#plot-%s canvas')].map(c => c.toDataURL()).join()"

# Centre of the ring around the row below the pointer, in the window.
RING = """
const ring = document.querySelector('#plot-%s .hovered'), box = document.querySelector('#plot-%s').getBoundingClientRect();
return ring.getAttribute('visibility') === 'visible' ? [box.left + Number(ring.getAttribute('cx')), box.top + Number(ring.getAttribute('cy'))] : null;
"""


class Plots:
    def __init__(self, browser, checks):
        self.browser, self.checks = browser, checks

    def expect(self, what, is_so, says=""):
        self.checks.check(what, [] if is_so else [str(says) or "it is not so"])

    def drawn(self, name):
        # Points that were thinned or moved are drawn in one of the next frames.
        self.browser.wait("!document.hidden", "the page is shown")
        return self.browser.run(DRAWN % name)

    def settled(self, name):
        """The drawing once it has come to rest."""
        before, now = None, self.drawn(name)
        for _ in range(20):
            if before == now:
                break
            before = now
            self.browser.pause(0.15)
            now = self.drawn(name)
        return now

    def focus(self, name):
        plot = f"document.querySelector('#plot-{name}')"
        self.browser.run(f"{plot}.scrollIntoView({{block: 'center'}}); {plot}.focus({{preventScroll: true}})")

    def point_at_a_row(self):
        """The keyboard finds the first row with a place; the mouse then points there."""
        browser = self.browser
        self.focus("force")
        for _ in range(60):
            browser.key("]")
            ring = browser.run(RING % ("force", "force"))
            if ring:
                break
        else:
            return self.expect("a row is found with the keyboard", False)
        browser.mouse("mouseMoved", *ring)
        browser.mouse("mouseMoved", 2, 2)
        self.expect("the pointer beside the plots points at no row", browser.run(RING % ("force", "force")) is None)
        browser.mouse("mouseMoved", *ring)
        tip, readout = browser.text("#tip"), browser.text("#readout")
        names_its_line = re.match(r"line \d+", tip) and re.match(r"line \d+", readout)
        self.expect("a row below the pointer says its line in the file", names_its_line, [tip, readout])
        rings = [name for name in PLOTS if browser.run(RING % (name, name)) is None]
        self.expect("it is marked in all plots that have a place for it", "no state" in readout or "left out" in readout or not rings, rings)
        return readout

    def switch(self, readout):
        """Another rung has other residuals."""
        browser = self.browser
        rungs = int(browser.run("return document.querySelectorAll('[data-rung]').length"))
        if not rungs:
            return
        before = [self.settled(name) for name in PLOTS]
        browser.click('[data-rung="0"]')
        after = [self.settled(name) for name in PLOTS]
        same = [name for name, a, b in zip(PLOTS, before, after) if a == b]
        self.expect("another rung changes all plots", not same, same)
        pressed = browser.run("return [...document.querySelectorAll('[data-rung][aria-pressed=true]')].map(b => b.dataset.rung).join()")
        self.expect("the rung is marked", pressed == "0", pressed)
        self.focus("force")
        browser.key("]")
        browser.key("[")
        other = browser.text("#readout")
        self.expect("the row has another residual", not readout or (other.startswith("line") and other != readout), [readout, other])
        browser.click(f'[data-rung="{rungs - 1}"]')
        again = [self.settled(name) for name in PLOTS]
        others = [name for name, a, b in zip(PLOTS, before, again) if a != b]
        self.expect("back at the last rung all is as before", not others, others)

    def zoom(self):
        browser = self.browser
        for name in PLOTS:
            browser.run(f"document.querySelector('#plot-{name}').scrollIntoView({{block: 'center'}}); document.activeElement.blur()")
            x, y, width, height = browser.box(f"#plot-{name}")
            x, y = x + width / 2, y + height / 2
            before = self.settled(name)
            scrolled = browser.run("return scrollY")
            browser.wheel(x, y, 40)
            moved = browser.run("return scrollY") != scrolled
            self.expect(f"the wheel moves the page until the plot {name} is clicked", moved and self.settled(name) == before, moved)
            self.focus(name)
            x, y, width, height = browser.box(f"#plot-{name}")
            x, y = x + width / 2, y + height / 2
            browser.wheel(x, y, -200)
            zoomed = self.settled(name)
            browser.key("0")
            self.expect(f"the wheel zooms the plot {name}, and 0 goes back", zoomed != before and self.settled(name) == before)

    def brush(self):
        browser = self.browser
        browser.click('[data-tool="rectangle"]')
        browser.run("document.querySelector('#plot-against').scrollIntoView({block: 'center'})")
        before = [self.settled(name) for name in PLOTS]
        browser.drag("#plot-against", (0.2, 0.08), (0.97, 0.8))
        says = browser.text("#selection-says")
        self.expect("brushed rows are counted with their lines", re.match(r"[\d ]+ rows?, (lines|of \d+ files)", says), says)
        same = [name for name, drawing in zip(PLOTS, before) if self.settled(name) == drawing]
        self.expect("they are marked in all plots", not same, same)
        browser.key("Escape")
        self.expect("Escape leaves them", not browser.run("return document.querySelector('#selection').checkVisibility()"))
        browser.click('[data-tool="pan"]')

    def other_columns(self):
        browser = self.browser
        names = browser.run("return [...document.querySelectorAll('#residual-against option')].map(o => o.value)")
        of_rungs = any(name.startswith("rung") for name in names)
        self.expect("residuals are drawn against columns, not against forces of rungs", "pressure" in names and not of_rungs, names)
        drawn = set()
        for name in names:
            choice = "document.querySelector('#residual-against')"
            browser.run(f"{choice}.value = {name!r}; {choice}.dispatchEvent(new Event('change'))")
            drawn.add(self.settled("against"))
        self.expect("each of them gives a drawing of its own", len(drawn) == len(names), f"{len(drawn)} of {len(names)}")


def use(browser, checks):
    plots = Plots(browser, checks)
    shown = browser.run("return document.documentElement.classList.contains('scripted') && document.querySelectorAll('#explored canvas').length")
    plots.expect("the script draws the rows", shown == len(PLOTS), shown)
    if not shown:
        return
    at = browser.run("return performance.getEntriesByName('plots:drawn')[0].startTime")
    plots.expect(f"rows are drawn {at:.0f} ms after the report was opened", at < MOST_MS)
    hidden = browser.run("return [...document.querySelectorAll('.without-script')].filter(e => e.checkVisibility()).map(e => e.id || e.tagName)")
    plots.expect("no drawing is there beside the plot that shows the same", not hidden, hidden)
    readout = plots.point_at_a_row()
    plots.switch(readout)
    plots.zoom()
    plots.brush()
    plots.other_columns()
    browser.run("scrollTo(0, 0)")

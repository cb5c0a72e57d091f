"""Truths and answers of the real tests side by side, and the rates of the table."""

import json
import math
import re
from dataclasses import dataclass

from simulator.wilson import interval

MEMORY = re.compile(r"friction|presliding|hysteresis|slip|bouc-wen|strand|solid|relax|loss|creep|viscous|viscosity|lag|line-delay")
"""Effects of a catalogue that make loops, by what their names contain."""
KINDS = (
    (
        "pressure",
        re.compile(r"^valve|^regulator|^pressure-(droop|hysteresis|lag|stop)|^sensor|^line-(lag|delay)|^force-lag|^pressure-sensor"),
    ),
    ("zero", re.compile(r"^pressure-(offset|gain|threshold)|^line-drop")),
    ("viscoelastic", re.compile(r"creep|solid|relax|rubber|bladder-(loss|hysteresis)|viscous|viscosity|stress-softening")),
    ("frame", re.compile(r"^frame|^end-slip|^displacement|^length-zero")),
    ("friction", re.compile(r"friction|presliding|maxwell|bouc|strand|hysteresis")),
)
"""Kinds of physics that a name of the catalogue counts under: the first that fits. Effects of one kind may be alike in one test."""
RIGHT = {
    "strand-friction": {"friction"},
    "rig-friction": {"friction"},
    "rubber-loss": {"viscoelastic"},
    "creep": {"viscoelastic"},
    "pressure-hysteresis": {"pressure"},
    "pressure-lag": {"pressure"},
    "pressure-zero": {"zero"},
    "frame-compliance": {"frame"},
}
"""The kinds that are right for what is hidden here."""
MARKS = ("<!-- {} -->", "<!-- end of {} -->")
STRENGTHS = ((0.0, 40.0, "12 to 40"), (40.0, 70.0, "40 to 70"), (70.0, math.inf, "above 70"))
"""Of what is hidden, in sigma."""


def kind(effect):
    """Kind of physics of an effect of the catalogue; None if it is none of these."""
    return next((name for name, pattern in KINDS if pattern.search(effect)), None)


@dataclass
class Answer:
    """One test with what was answered; `document` is None where there is no answer, and `problem` says why."""

    truth: dict
    document: dict | None
    problem: str | None
    seconds: float | None
    compared: bool

    @property
    def hidden(self):
        """Families hidden."""
        return [entry["family"] for entry in self.truth["hidden"]]

    @property
    def verdict(self):
        """What was said, or None."""
        return self.document and self.document.get("verdict")

    @property
    def claimed(self):
        """Whether a structure is claimed."""
        return self.verdict in ("missing", "unknown")

    @property
    def named(self):
        """Effects named as missing."""
        return [item["effect"] for item in self.document.get("missing") or []] if self.verdict == "missing" else []

    @property
    def outcome(self):
        """right, unknown, wrong, nothing (adequate or cannot tell), or none (no answer)."""
        if self.document is None:
            return "none"
        if self.verdict == "unknown":
            return "unknown"
        if self.verdict != "missing":
            return "nothing"
        return "right" if kind((self.named or [""])[0]) in self.wanted else "wrong"

    @property
    def wanted(self):
        """Kinds that are right."""
        return set().union(*(RIGHT[name] for name in self.hidden))

    @property
    def in_class(self):
        """Whether the first name, or one that the data cannot tell from it, is of a right kind."""
        first = (self.document.get("missing") or [{}])[0] if self.verdict == "missing" else {}
        return any(kind(name) in self.wanted for name in [first.get("effect", ""), *first.get("class", [])])

    @property
    def looks_for_loops(self):
        """Whether an effect that makes loops was tried, not set aside as untestable."""
        return any(
            MEMORY.search(entry["effect"]) and entry.get("status") != "not-testable" for entry in self.document.get("candidates") or []
        )


def answers(folder, results, compared):
    """All tests of a folder with the answers in `results`, and whether `compare` answered, from its own folder."""
    times, problems = (_json(results / name) or {} for name in ("times.json", "failures.json"))
    found = []
    for file in sorted(folder.glob("*/truth.json")):
        case = file.parent.name
        answer = results / f"{case}.json"
        document = _json(answer) if answer.exists() else None
        found.append(Answer(_json(file), document, problems.get(case), times.get(case), (compared / f"{case}.json").exists()))
    return found


def _json(file):
    try:
        return json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None


def rate(right, trials):
    """`value [low, high] (number)` with Wilson's 95 % interval."""
    if not trials:
        return "-"
    low, high = interval(right, trials)
    return f"{right} of {trials}: {100.0 * right / trials:.0f} % [{100.0 * low:.0f}, {100.0 * high:.0f}]"


def into_page(file, name, text):
    """Replaces what stands in a page between the markers of that name."""
    content = file.read_text(encoding="utf-8")
    first, last = (mark.format(name) for mark in MARKS)
    before, _, rest = content.partition(first)
    _, found, after = rest.partition(last)
    if not found:
        raise SystemExit(f"{file.name} has no markers {first} and {last}")
    file.write_text(f"{before}{first}\n\n{text}\n\n{last}{after}", encoding="utf-8")


def tables(found, told):
    """The Markdown tables; `told` is the line that says what was run."""
    return "\n\n".join([told, _summary(found), _rates(found), _nulls(found), _times(found), _dialects(found), _refusals(found)])


def markdown(header, rows):
    """A table."""
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows])


def _summary(found):
    isometric = [one for one in found if one.truth["rig"] == "isometric"]
    nulls = [one for one in found if one.truth["group"] == "null"]
    rows = [
        ("tests that `diagnose` answers", rate(sum(one.document is not None for one in found), len(found))),
        ("tests that `compare` answers", rate(sum(one.compared for one in found), len(found))),
        (
            "isometric tests in which hysteresis is looked for",
            rate(sum(bool(one.document) and one.looks_for_loops for one in isometric), len(isometric)),
        ),
        ("of nulls, claimed", rate(sum(one.claimed for one in nulls), len(nulls))),
    ]
    return markdown(("measure", "value [Wilson's 95 % interval]"), rows)


def _rates(found):
    hidden = [one for one in found if one.hidden]
    rows = []
    groups = [(f"{rig}", [one for one in hidden if one.truth["rig"] == rig]) for rig in ("isobaric", "isometric", "isotonic", "mixed")]
    groups += [(name, [one for one in hidden if one.hidden == [name]]) for name in RIGHT]
    groups += [("two at once", [one for one in hidden if len(one.hidden) > 1])]
    groups += [(f"{words} sigma", [one for one in hidden if low <= one.truth["sigmas"] < high]) for low, high, words in STRENGTHS]
    groups += [("damaged rows", [one for one in hidden if one.truth["damage"]]), ("all", hidden)]
    for title, group in groups:
        if group:
            count = {name: sum(one.outcome == name for one in group) for name in ("right", "unknown", "wrong", "nothing", "none")}
            others = [count[name] for name in ("unknown", "wrong", "nothing", "none")]
            rows.append((title, len(group), rate(count["right"], len(group)), sum(one.in_class for one in group), *others))
    header = (
        "hidden in",
        "tests",
        "right kind first",
        "right kind in the class",
        "unknown",
        "wrong name first",
        "adequate or cannot tell",
        "no answer",
    )
    return markdown(header, rows)


def _nulls(found):
    rows = []
    nulls = [one for one in found if not one.hidden]
    for group, title in (("null", "nulls"), ("large", "large nulls"), ("hard", "hard nulls")):
        for damaged in (False, True):
            some = [one for one in nulls if one.truth["group"] == group and bool(one.truth["damage"]) == damaged]
            if some:
                rows.append(
                    (
                        f"{title}, {'damaged rows' if damaged else 'whole'}",
                        rate(sum(one.claimed for one in some), len(some)),
                        sum(one.verdict == "missing" for one in some),
                        sum(one.verdict == "unknown" for one in some),
                        sum(one.document is None for one in some),
                    )
                )
    return markdown(("nothing hidden", "claimed", "a name", "unknown", "no answer"), rows)


def _times(found):
    rows = []
    for low, high in ((0, 500), (500, 1500), (1500, 7000), (7000, 10**9)):
        some = sorted(one.seconds for one in found if one.seconds is not None and low <= one.truth["rows"] < high)
        if some:
            span = f"{low} to {high}" if high < 10**9 else f"{low} and more"
            rows.append((span, len(some), f"{some[len(some) // 2]:.1f}", f"{some[-1]:.1f}"))
    return markdown(("rows", "answered", "median [s]", "longest [s]"), rows)


def _dialects(found):
    names = dict.fromkeys(sorted({one.truth["dialect"] for one in found}))
    rows = []
    for name in names:
        some = [one for one in found if one.truth["dialect"] == name]
        rows.append((f"`{name}`", len(some), sum(one.document is not None for one in some), sum(one.compared for one in some)))
    return markdown(("dialect", "tests", "`diagnose` answers", "`compare` answers"), rows)


def _refusals(found):
    """What was said where there is no answer, alike messages together: names and numbers left out."""
    said = {}
    for one in found:
        if one.problem:
            status, _, message = one.problem.partition(" Usage:")[0].partition(": ")
            message = re.sub(r"`[^`]*`|\"[^\"]*\"", "...", message)
            # Lists of lines differ in length.
            message = re.sub(r"-?\d[\d.e+-]*((, | and )(-?\d[\d.e+-]*|more))*", "#", message)
            short = f"{status}: {message}".rstrip(": ").replace("# more", "#").replace("|", "/")
            said.setdefault(short[:150], []).append(one.truth["case"])
    if not said:
        return "Every test has an answer."
    rows = sorted(((len(cases), f"{message}", f"`{cases[0]}`") for message, cases in said.items()), reverse=True)
    return markdown(("tests", "what was said where there is no answer", "first"), rows)

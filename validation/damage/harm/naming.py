"""What an answer says of the readings themselves, and whether that is the damage: its rows, its column, its kind."""

import re
from dataclasses import dataclass, field

KINDS = {
    "clipped": r"clip|extreme|end of its range|satur|largest (value|reading)",
    "decimals": r"decimal|comma|spike|far from|impossible|one factor|unit|larger than",
    "dropout": r"zeros|drop|spike|far from|frozen|repeats",
    "duplicated": r"duplicat|twice|equal|copied|same (as|values)",
    "flipped": r"sign|negative|push|spike|far from",
    "frozen": r"frozen|froze|stuck|repeats|stays",
    "gaps": r"gap|pause|missing|lost|straight|interpol",
    "late": r"\blate\b|delay|lag|ahead|resampl|apart in time",
    "leak": r"leak|sag|frozen|supply|pressure (lies|is) off",
    "mislabelled": r"specimen",
    "shifted": r"shifted|lies? [^.]*off|zeroed",
    "slip": r"jump|slip|shifted|\ba step\b",
    "sorted": r"\bsort|shuffl|goes back|backwards|out of order",
    "spikes": r"spike|far from|burst",
    "stuck-bit": r"\bbits?\b|coarse|steps of|quanti",
    "swapped": r"direction|backward|revers|branch",
    "unit": r"unit|psi|kPa|lbf|pounds|kilogram|kgf|inch|\bcm\b|absolute|one factor",
}
"""Words that count as the kind of damage. A spike is a fair word for a lost comma, and frozen for a block of zeros."""
COLUMNS = {"force": r"force|load cell", "pressure": r"pressure|absolute|psi", "length": r"length|motion|displacement|contraction|clamp|stroke"}
"""Words for a column; damage of several columns has none that must be named."""
NEAR = 1
"""Lines within which a complaint is beside the damaged row."""
ALL = 0.9
"""Where more rows than this are damaged, every row is right."""


@dataclass
class Complaint:
    """One thing that is said of the readings: in words, and of which lines of which file (numbers count files from 0)."""

    text: str
    lines: dict = field(default_factory=dict)


def complaints(answer):
    """All complaints of a kept answer: rows left out or set apart, findings of the data check, questions, warnings, the jump, the refusal."""
    found = [Complaint(entry["why"], _listed(entry["lines"])) for entry in answer.get("left_out", [])]
    for entry in answer.get("set_apart", []):
        found.append(Complaint(f"{entry['reason']}", {str(entry["file"]): {entry["row"]}}))
    for entry in answer.get("quality", []):
        lines = {}
        for run in entry["rows"]:
            lines.setdefault(run["file"], set()).update(range(run["first"], run["last"] + 1))
        found.append(Complaint(f"{entry['kind']}: {entry['says']}", lines))
    texts = [f"{entry['kind']}: {entry['says']}" for entry in answer.get("findings", [])]
    texts += [*answer.get("warnings", []), *answer.get("hints", []), answer.get("jump"), answer.get("refusal")]
    # What is said of effects is no complaint.
    texts = [text for text in texts if not (text or "").startswith("the nearest of the effects")]
    texts += [answer["says"]] if answer.get("verdict") in ("cannot-tell", "unknown") else []
    return found + [Complaint(text, _told(text)) for text in texts if text]


def _told(text):
    """Lines that stand in a sentence: "at line 162-201", "lines 3 and 4"."""
    return _listed(" ".join(re.findall(r"\blines? ((?:\d+(?:-\d+)?(?:, | and )?)+)", text)))


def _listed(text):
    """Lines as `left_out` lists them: "12, 33-40", with several files "a.csv:12, 14, b.csv:33-40"."""
    lines, file = {}, 0
    for name, first, last in re.findall(r"(?:([^\s,:]+):\s*)?(?:line\s+)?(\d+)(?:-(\d+))?", text):
        file = name or file
        lines.setdefault(file, set()).update(range(int(first), int(last or first) + 1))
    return lines


def named(truth, answer):
    """2: a complaint is of the damaged rows, its column and its kind; 1: of these rows, by another word or column; 0: none is."""
    best = 0
    for one in complaints(answer):
        if not _points(truth, one):
            continue
        column = COLUMNS.get(truth["column"])
        kind = bool(re.search(KINDS[truth["kind"]], one.text, re.IGNORECASE))
        # Where every row is damaged any complaint is of damaged rows: only the right word counts.
        if kind or not _everywhere(truth):
            best = max(best, 1 + (kind and (column is None or bool(re.search(column, one.text, re.IGNORECASE)))))
    return best


def covered(truth, answer):
    """Share of the damaged rows that complaints name."""
    damaged = _damaged(truth)
    said = set()
    for one in complaints(answer):
        said |= {(file, line) for file, lines in _by_name(truth, one.lines).items() for line in lines}
    rows = {(file, line) for file, lines in damaged.items() for line in lines}
    return len(rows & said) / len(rows) if rows else 0.0


def _damaged(truth):
    return {file: {line for first, last in runs for line in range(first, last + 1)} for file, runs in truth["lines"].items()}


def _everywhere(truth):
    return sum(len(lines) for lines in _damaged(truth).values()) >= ALL * truth["rows"]


def _by_name(truth, lines):
    files = list(truth["lines"])
    return {file if isinstance(file, str) and file in files else files[int(file) if str(file).isdigit() else 0]: rows for file, rows in lines.items()}


def _points(truth, one):
    """Whether at least half of what a complaint names is damaged: lines, a sweep, a file, or the second of a jump."""
    damaged = _damaged(truth)
    if _everywhere(truth):
        return True
    if one.lines:
        near = {file: {line + k for line in lines for k in range(-NEAR, NEAR + 1)} for file, lines in damaged.items()}
        said = [(file, line) for file, lines in _by_name(truth, one.lines).items() for line in lines]
        return 2 * sum(line in near.get(file, ()) for file, line in said) >= len(said) > 0
    sweeps = {int(label) for label in re.findall(r"sweep `?(\d+)", one.text)}
    if sweeps:
        return sweeps <= set(truth["sweeps"])
    files = {file for file in truth["lines"] if file in one.text}
    if files and len(truth["lines"]) > 1:
        return all(truth["lines"][file] for file in files)
    after = re.search(r"after ([\d.]+) s", one.text)
    if after:
        return any(abs(float(after[1]) - edge) <= max(0.02 * edge, truth["tick_s"] * 3.0) for edge in truth["edges_s"])
    return False

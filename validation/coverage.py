"""Coverage: which lines of a crate its own tests run.

    python validation/coverage.py [inference] [--tests kept]     # measures, and keeps what it found in validation/coverage.json
    python validation/docs_table.py coverage [--check]           # the table in docs/hardening.md

Lines and regions (of which a line with a condition has several) are those of LLVM's coverage (`rustup component add llvm-tools`). Modules of tests within a file
don't count. With `--tests`, the result is a lower bound.
"""

import argparse
import json
import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
KEPT = ROOT / "validation/coverage.json"
TARGET = ROOT / "target/coverage"
TESTS = "#[cfg(test)]\nmod tests {"
# Cargo calls it with the compiler and its words.
WRAPPER = """#!/bin/sh
case " $* " in
*" --crate-name {crate} "*|*" --test "*) exec "$@" -Cinstrument-coverage ;;
*) exec "$@" ;;
esac
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("crate", nargs="?", default="inference", help="without `bulge-`")
    parser.add_argument("--tests", nargs="*", default=[], help="run only tests whose names contain one of these; nothing is kept then")
    arguments = parser.parse_args()
    crate = arguments.crate
    if not (ROOT / "crates" / crate).is_dir():
        parser.error(f"there is no crate `{crate}` below crates/")
    host = re.search(r"^host: (.*)$", _output(["rustc", "-vV"]), re.MULTILINE)[1]
    tools = Path(_output(["rustc", "--print", "sysroot"]).strip()) / f"lib/rustlib/{host}/bin"
    if not (tools / "llvm-cov").exists():
        parser.error("LLVM's tools aren't installed: rustup component add llvm-tools")
    programs, failed = _run(crate, arguments.tests)
    source = ROOT / "crates" / crate / "src"
    found = {}
    for file in _files(tools, programs):
        path = Path(file["filename"])
        if path.is_relative_to(source) and file["segments"]:
            name = path.relative_to(source).as_posix()
            found[name] = _counts(path.read_text(encoding="utf-8"), file["segments"])
    for name, counts in sorted(found.items(), key=lambda entry: entry[1]["lines"] / max(1, entry[1]["all_lines"])):
        print(f"{100 * counts['lines'] / max(1, counts['all_lines']):6.1f} % of {counts['all_lines']:4} lines  {name}: not {counts['not']}")
    if failed or not found:
        print("not kept: a test failed, see above" if failed else "nothing was counted", file=sys.stderr)
        return 1
    if not arguments.tests:
        kept = {**(json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}), crate: found}
        KEPT.write_text(json.dumps(dict(sorted(kept.items())), indent=1, sort_keys=True) + "\n", encoding="utf-8")
    return 0


def _run(crate, tests):
    """Runs the tests; the programs, and whether one failed. Only the crate and its tests are instrumented: a counter in each loop of the crates below them
    would make the tests eight times slower."""
    TARGET.mkdir(parents=True, exist_ok=True)
    for old in TARGET.glob("*.profraw"):
        old.unlink()
    # Cargo builds anew what another wrapper has built, by its path.
    wrapper = TARGET / f"rustc-{crate}"
    wrapper.write_text(WRAPPER.format(crate=f"bulge_{crate.replace('-', '_')}"), encoding="utf-8")
    wrapper.chmod(0o755)
    environment = {**os.environ, "RUSTC_WORKSPACE_WRAPPER": str(wrapper), "LLVM_PROFILE_FILE": str(TARGET / "%m-%p.profraw")}
    cargo = ["cargo", "test", "--package", f"bulge-{crate}", "--lib", "--tests", "--target-dir", str(TARGET)]
    built = _output([*cargo, "--no-run", "--message-format=json"], env=environment)
    programs = [message["executable"] for message in map(json.loads, built.splitlines()) if message.get("executable")]
    return programs, subprocess.call([*cargo, "--no-fail-fast", "--", *tests], cwd=ROOT, env=environment) != 0


def _files(tools, programs):
    """What LLVM's tools say about each file."""
    merged = TARGET / "merged.profdata"
    subprocess.run([tools / "llvm-profdata", "merge", "--sparse", *TARGET.glob("*.profraw"), "-o", merged], check=True)
    objects = [word for program in programs[1:] for word in ("--object", program)]
    return json.loads(_output([tools / "llvm-cov", "export", "--instr-profile", merged, programs[0], *objects]))["data"][0]["files"]


def _output(command, **options):
    return subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True, **options).stdout


def _counts(text, segments):
    """Lines and regions that ran, of those before the tests, and the lines that did not."""
    end = text[: text.index(TESTS)].count("\n") + 1 if TESTS in text else text.count("\n") + 1
    # A segment is valid until the next one begins: line, column, count, whether it has one, whether a region begins there, whether it is a gap.
    regions = [segment for segment in segments if segment[3] and segment[4] and not segment[5] and segment[0] <= end]
    lines = {}
    for (line, _, count, has_count, _, is_gap), following in zip(segments, [*segments[1:], [end, 0]], strict=True):
        if has_count and not is_gap:
            for at in range(line, min(following[0] + (following[1] > 1), end + 1)):
                lines[at] = max(lines.get(at, 0), count)
    missed = sorted(line for line, count in lines.items() if count == 0)
    return {
        "lines": len(lines) - len(missed),
        "all_lines": len(lines),
        "regions": sum(segment[2] > 0 for segment in regions),
        "all_regions": len(regions),
        "not": missed,
    }


if __name__ == "__main__":
    sys.exit(main())

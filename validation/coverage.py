"""Which lines and regions of a crate its own tests run.

    python validation/coverage.py inference            # of one crate, or of several
    python validation/docs_table.py coverage [--check] # the table in docs/hardening.md

A region is a stretch of code without a branch; the stable compiler counts them, not branches. Needs cargo-llvm-cov (`cargo install cargo-llvm-cov`) and the
component llvm-tools. It builds the crate anew below target/llvm-cov-target, and keeps what it counted in validation/coverage.json. Its status is 1 if fewer than
90 % of the lines of a module of inference are run.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
KEPT = ROOT / "validation/coverage.json"
LEAST = 90.0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("crates", nargs="+", metavar="CRATE", help="without `bulge-`")
    arguments = parser.parse_args()
    if shutil.which("cargo-llvm-cov") is None:
        parser.error("cargo-llvm-cov isn't installed: cargo install cargo-llvm-cov --locked, and rustup component add llvm-tools")
    kept = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}
    for crate in arguments.crates:
        if not (ROOT / "crates" / crate).is_dir():
            parser.error(f"there is no crate `{crate}` below crates/")
        kept[crate] = counted(crate)
    KEPT.write_text(json.dumps(dict(sorted(kept.items())), indent=1) + "\n", encoding="utf-8")
    low = [module for module, share in kept.get("inference", {}).get("modules", {}).items() if share["lines"] < LEAST]
    for crate in arguments.crates:
        print(f"{crate}: {kept[crate]['lines']:.1f} % of the lines, {kept[crate]['regions']:.1f} % of the regions; lowest:")
        for module, share in sorted(kept[crate]["modules"].items(), key=lambda entry: entry[1]["lines"])[:12]:
            print(f"  {module}: {share['lines']:.1f} %, {share['regions']:.1f} %")
    return 1 if low else 0


def counted(crate):
    """Shares [%] of lines and regions of a crate, and of each of its modules."""
    words = ["cargo", "llvm-cov", "--package", f"bulge-{crate}", "--json", "--summary-only", "--lib", "--tests"]
    environment = {**os.environ, "CARGO_INCREMENTAL": "0", "CARGO_PROFILE_DEV_DEBUG": "false"}
    done = subprocess.run(words, cwd=ROOT, env=environment, check=True, stdout=subprocess.PIPE)
    source = ROOT / "crates" / crate / "src"
    modules, sums = {}, {"lines": [0, 0], "regions": [0, 0]}
    for file in json.loads(done.stdout)["data"][0]["files"]:
        path = Path(file["filename"])
        if source not in path.parents:
            continue
        modules[str(path.relative_to(source))] = {kind: round(file["summary"][kind]["percent"], 1) for kind in sums}
        for kind, counts in sums.items():
            counts[0] += file["summary"][kind]["covered"]
            counts[1] += file["summary"][kind]["count"]
    return {**{kind: round(100 * run / max(all_of, 1), 1) for kind, (run, all_of) in sums.items()}, "modules": dict(sorted(modules.items()))}


if __name__ == "__main__":
    sys.exit(main())

"""Times the pleated muscle's 1000 contractions here and with other libraries, in one session, alternating, and prints the ratios.

    python3 benches/peers/compare.py [rounds]

What is not installed is left out with a word. Ends with an error if a sum of forces differs from Bulge's closed form by more than 1e-9.
Peers: Boost.Math (a C++ compiler and the Boost headers), SciPy.
"""

import json
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
CLOSED, THROUGH, SHOOTING = "closed form", "closed form through Problem::solve", "shooting through Problem::solve"
# What each peer is compared with: the same question by the same method (Bulge's times include volume, stiffness and the rest).
RIVALS = {
    "Boost.Math as it comes, Newton": THROUGH,
    "Boost.Math in double, Newton": THROUGH,
    "SciPy, fsolve on the closed form": THROUGH,
    "SciPy, fsolve on DOP853 shooting": SHOOTING,
}
TOLERANCE = 1e-9


def build_own(program):
    """A program of Bulge's benches; it must build."""
    build = ["cargo", "build", "--release", "-p", "bulge-benches", "--bin", program]
    messages = [*build, "--message-format", "json-render-diagnostics"]
    done = subprocess.run(messages, cwd=HERE.parent.parent, check=True, stdout=subprocess.PIPE, text=True)
    programs = [json.loads(line).get("executable") for line in done.stdout.splitlines()]
    return [next(path for path in programs if path and Path(path).stem == program)]


def build_boost(folder, flags):
    compiler = next((name for name in ("g++", "clang++", "c++") if shutil.which(name)), None)
    if compiler is None:
        return None, "no C++ compiler"
    program = str(Path(folder) / f"pleated_boost{len(flags)}")
    build = [compiler, "-O3", *flags, "-o", program, str(HERE / "pleated_boost.cpp")]
    done = subprocess.run(build, capture_output=True, text=True)
    if done.returncode != 0:
        lines = [line for line in done.stderr.splitlines() if "error" in line] or ["the compiler failed"]
        return None, f"{lines[0].split('error:')[-1].strip()} (Debian: libboost-math-dev)"
    return [program], None


def find_scipy():
    done = subprocess.run([sys.executable, "-c", "import scipy"], capture_output=True, text=True)
    if done.returncode != 0:
        return None, "SciPy is not installed for this Python"
    return [sys.executable, str(HERE / "pleated_scipy.py")], None


def run(command):
    """Rows name -> numbers: microseconds and sum, or what else the program prints."""
    text = subprocess.run(command, cwd=HERE, check=True, capture_output=True, text=True).stdout
    rows = (line.split("\t") for line in text.splitlines())
    return {name: tuple(map(float, numbers)) for name, *numbers in rows}


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    times, sums = {}, {}
    with tempfile.TemporaryDirectory() as folder:
        programs = [build_own("pleated")]
        in_double = ["-DBOOST_MATH_PROMOTE_DOUBLE_POLICY=false"]
        peers = [
            ("Boost.Math", build_boost(folder, [])),
            ("Boost.Math in double", build_boost(folder, in_double)),
            ("SciPy", find_scipy()),
        ]
        for name, (command, missing) in peers:
            if command is None:
                print(f"skipped {name}: {missing}")
            else:
                programs.append(command)
        for _ in range(rounds):
            for program in programs:
                for name, (time, total) in run(program).items():
                    times.setdefault(name, []).append(time)
                    sums[name] = total
    print(f"{'1000 contractions, 5 to 40 %, l0/R = 6.875':<44} {'us/solve':>10} {'ratio':>8} {'sum of f':>18} {'off':>8}")
    wrong = []
    for name, values in times.items():
        time = statistics.median(values)
        ratio = f"{time / statistics.median(times[RIVALS[name]]):.1f} x" if name in RIVALS else ""
        off = abs(sums[name] / sums[CLOSED] - 1)
        print(f"{name:<44} {time:>10.2f} {ratio:>8} {sums[name]:>18.10f} {off:>8.0e}")
        if not off < TOLERANCE:
            wrong.append(name)
    if wrong:
        sys.exit(f"the sum of f differs by more than {TOLERANCE}: {', '.join(wrong)}")


if __name__ == "__main__":
    main()

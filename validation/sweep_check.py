"""Reads finished sweeps of Bulge with DuckDB, pandas, polars and pyarrow, and checks that all see the same data set.

    pip install duckdb pandas polars pyarrow
    python validation/sweep_check.py FOLDER ...

FOLDER is what `bulge sweep --out FOLDER` wrote: points/*.parquet and manifest.json. Checked are the numbers of rows and points, the names and
units of the columns, that outputs are missing where `infeasible` gives a reason and nowhere else, that none is NaN or infinite, and that every
reader has the same bits. One line per reader; the last line is `N passed, M failed`, and the exit status is 1 if anything failed.
"""

import argparse
import hashlib
import json
import sys
from pathlib import Path

import duckdb
import numpy
import pandas
import polars
import pyarrow.parquet

FIRST, LAST = "index", "infeasible"


def with_duckdb(files):
    names = [str(file) for file in files]
    relation = duckdb.sql("SELECT * FROM read_parquet($files) ORDER BY \"index\"", params={"files": names})
    return relation.columns, dict(zip(relation.columns, map(list, zip(*relation.fetchall(), strict=True)), strict=True))


def with_pandas(files):
    frame = pandas.concat([pandas.read_parquet(file, engine="pyarrow") for file in files], ignore_index=True)
    # pandas has no missing numbers apart from NaN: the types of pyarrow keep them apart.
    exact = pandas.concat(
        [pandas.read_parquet(file, engine="pyarrow", dtype_backend="pyarrow") for file in files], ignore_index=True
    )
    for name in frame.columns:
        if not (frame[name].isna() == exact[name].isna()).all():
            raise AssertionError(f"{name}: NaN and missing differ")
    columns = {name: [None if missing else value for value, missing in zip(exact[name].tolist(), exact[name].isna(), strict=True)]
               for name in exact.columns}
    return list(frame.columns), columns


def with_polars(files):
    frame = polars.concat([polars.read_parquet(file) for file in files])
    return frame.columns, {name: frame[name].to_list() for name in frame.columns}


def with_pyarrow(files):
    table = pyarrow.concat_tables([pyarrow.parquet.read_table(file, partitioning=None) for file in files])
    return table.column_names, {name: table[name].to_pylist() for name in table.column_names}


READERS = {"duckdb": with_duckdb, "pandas": with_pandas, "polars": with_polars, "pyarrow": with_pyarrow}


def described(files):
    """Names and units of the columns as the files themselves state them, the same in all."""
    found = {pyarrow.parquet.read_metadata(file).metadata[b"bulge.columns"] for file in files}
    assert len(found) == 1, f"{len(found)} descriptions of the columns"
    return [(column["name"], column["unit"]) for column in json.loads(found.pop())]


def names_of_outputs(folder):
    return json.loads((folder / "plan.json").read_text(encoding="utf-8"))["outputs"]


def check(names, columns, wanted, outputs, manifest):
    """What one reader has seen; a digest of all values."""
    rows = len(columns[FIRST])
    assert list(names) == [name for name, _ in wanted], f"columns {names}"
    assert columns[FIRST] == list(range(rows)), "`index` is not 0, 1, 2, ..."
    assert rows == manifest["points"], f"{rows} rows, {manifest['points']} points in the manifest"
    reasons = columns[LAST]
    without = [reason is not None for reason in reasons]
    assert sum(without) == manifest["infeasible"], f"{sum(without)} reasons, {manifest['infeasible']} in the manifest"
    assert all(reason for reason in reasons if reason is not None), "a reason is empty"
    digest = hashlib.sha256("\n".join(reason or "" for reason in reasons).encode())
    for name, _ in wanted[1:-1]:
        missing = [value is None for value in columns[name]]
        assert missing == (without if name in outputs else [False] * rows), f"{name} is missing elsewhere than it should"
        values = numpy.array([value for value in columns[name] if value is not None], dtype="<f8")
        assert numpy.isfinite(values).all(), f"{name} has a value that is not finite"
        digest.update(values.tobytes())
    return rows, sum(without), digest.hexdigest()


def check_folder(folder):
    """(passed, failed)"""
    manifest = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
    files = sorted((folder / "points").glob("*.parquet"))
    assert len(files) == len(manifest["chunks"]), f"{len(files)} files, {len(manifest['chunks'])} chunks in the manifest"
    for file, chunk in zip(files, manifest["chunks"], strict=True):
        assert hashlib.sha256(file.read_bytes()).hexdigest() == chunk["sha256"], f"{file} is not what the manifest says"
    wanted, outputs = described(files), names_of_outputs(folder)
    assert wanted[0] == (FIRST, "") and wanted[-1] == (LAST, ""), f"columns {wanted}"
    assert all(unit for _, unit in wanted[1:-1]), "a number without unit"
    print(f"{folder}: {', '.join(f'{name} [{unit}]' for name, unit in wanted[1:-1])}")
    passed, failed, digests = 0, 0, set()
    for reader, read in READERS.items():
        try:
            rows, without, digest = check(*read(files), wanted, outputs, manifest)
            digests.add(digest)
            assert len(digests) == 1, "other values than the readers before"
        except AssertionError as error:
            failed += 1
            print(f"  {reader}: FAILED: {error}")
        else:
            passed += 1
            print(f"  {reader}: {rows} rows in {len(files)} files, {without} without equilibrium, values {digest[:12]}")
    return passed, failed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", metavar="FOLDER", type=Path, nargs="+")
    passed, failed = 0, 0
    for folder in parser.parse_args().folders:
        try:
            good, bad = check_folder(folder)
        except (AssertionError, OSError, KeyError) as error:
            print(f"{folder}: FAILED: {error}")
            good, bad = 0, 1
        passed, failed = passed + good, failed + bad
    print(f"{passed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

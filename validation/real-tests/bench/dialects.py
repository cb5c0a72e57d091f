"""The table of a test as twenty-four programs and laboratories write it.

Each dialect is one function: it writes the data into a folder and returns what it wrote (`Written`), which suffices to read it again with pandas.
A table is a dictionary of columns in SI (pressure gauge); missing numbers are NaN, and rows that are NaN throughout are blank.
"""

import datetime
import io
import re
import zipfile
from dataclasses import dataclass, field

import numpy as np
import openpyxl
import pandas
from scipy.io import loadmat, savemat

ATMOSPHERE = 101325.0
FACTORS = {
    "s": 1.0, "ms": 1e-3, "bar": 1e5, "mbar": 1e2, "kPa": 1e3, "MPa": 1e6, "Pa": 1.0, "psi": 6894.757293168361, "N": 1.0, "kN": 1e3,
    "lbf": 4.4482216152605, "mm": 1e-3, "m": 1.0, "in": 0.0254, "%": 1e-2, "1": 1.0,
}  # fmt: skip
"""Units in SI."""
STAMP = datetime.datetime(2024, 3, 5, 14, 2, 11)
"""When recordings with a clock begin."""


@dataclass
class Written:
    """How a file is to be read: name, columns as header -> (quantity, unit), options of pandas, and what the program must be told."""

    file: str
    columns: dict
    options: dict = field(default_factory=dict)
    arguments: tuple = ()
    toml: str = ""
    absolute: bool = False


def _number(value, digits, missing, decimal):
    return missing if np.isnan(value) else f"{value:.{digits}g}".replace(".", decimal)


def _cells(table, columns, missing="NaN", decimal=".", digits=8):
    """Rows of text; a row without a number is blank throughout."""
    parts = []
    for quantity, unit in columns.values():
        values = table[quantity]
        if quantity in ("sweep", "specimen"):
            parts.append([str(int(v)) if np.isfinite(v) else "" for v in values])
        else:
            parts.append([_number(v, digits, missing, decimal) for v in values / FACTORS[unit]])
    rows = list(map(list, zip(*parts)))
    for i in np.flatnonzero(np.isnan(table["force"]) & np.isnan(table["pressure"]) & np.isnan(table["length"])):
        rows[i] = [""] * len(parts)
    return rows


def _text(folder, name, header, rows, sep=",", encoding="utf-8", before=(), after=()):
    lines = [*before, sep.join(header), *after, *(sep.join(row) for row in rows)]
    (folder / name).write_bytes(("\n".join(lines) + "\n").encode(encoding))


def _plain(folder, table, columns, name="data.csv", sep=",", encoding="utf-8", decimal=".", missing="NaN", before=(), after=()):
    """A text table; `before` stands above the header, `after` (a row of units) below it."""
    _text(folder, name, list(columns), _cells(table, columns, missing, decimal), sep, encoding, before, after)
    skipped = [*range(len(before)), *range(len(before) + 1, len(before) + 1 + len(after))]
    options = {"sep": sep, "encoding": encoding, "decimal": decimal, "skiprows": skipped, "skip_blank_lines": False}
    return Written(name, columns, options)


def contract(folder, table):
    """Columns `name [unit]`."""
    columns = {
        "pressure [bar]": ("pressure", "bar"),
        "contraction [%]": ("contraction", "%"),
        "force [N]": ("force", "N"),
        "time [s]": ("time", "s"),
    }
    return _plain(folder, table, columns)


def round_brackets(folder, table):
    """`Time (s)`."""
    columns = {
        "Time (s)": ("time", "s"),
        "Pressure (kPa)": ("pressure", "kPa"),
        "Length (mm)": ("length", "mm"),
        "Force (N)": ("force", "N"),
    }
    return _plain(folder, table, columns)


def underscores(folder, table):
    """`Force_N`, `t_s`."""
    columns = {"t_s": ("time", "s"), "P_bar": ("pressure", "bar"), "Length_mm": ("length", "mm"), "Force_N": ("force", "N")}
    return _plain(folder, table, columns)


def slashes(folder, table):
    """`Displacement/mm`: the shortening from rest."""
    columns = {
        "time/s": ("time", "s"),
        "pressure/bar": ("pressure", "bar"),
        "Displacement/mm": ("displacement", "mm"),
        "Force/N": ("force", "N"),
    }
    return _plain(folder, table, columns)


def semicolons(folder, table):
    """Semicolons and decimal commas."""
    columns = {
        "Time [s]": ("time", "s"),
        "Pressure [bar]": ("pressure", "bar"),
        "Contraction [%]": ("contraction", "%"),
        "Force [N]": ("force", "N"),
    }
    return _plain(folder, table, columns, sep=";", decimal=",")


def german(folder, table):
    """German names in Latin-1 with a temperature in degrees, semicolons and decimal commas."""
    columns = {
        "Zeit / s": ("time", "s"),
        "Druck / bar": ("pressure", "bar"),
        "Weg / mm": ("displacement", "mm"),
        "Kraft / N": ("force", "N"),
    }
    rows = [[*row, "21,5" if any(row) else ""] for row in _cells(table, columns, decimal=",")]
    _text(folder, "data.csv", [*columns, "Temperatur / °C"], rows, ";", "latin-1")
    return Written("data.csv", columns, {"sep": ";", "encoding": "latin-1", "decimal": ",", "skip_blank_lines": False})


def utf16(folder, table):
    """UTF-16 with a byte order mark, tabs, as spreadsheets export Unicode text."""
    columns = {
        "Time (s)": ("time", "s"),
        "Pressure (bar)": ("pressure", "bar"),
        "Length (mm)": ("length", "mm"),
        "Force (N)": ("force", "N"),
    }
    return _plain(folder, table, columns, name="data.txt", sep="\t", encoding="utf-16")


def labview(folder, table):
    """A LabVIEW measurement file: two headers, tabs, a column of comments."""
    columns = {
        "X_Value": ("time", "s"),
        "Pressure (bar)": ("pressure", "bar"),
        "Length (mm)": ("length", "mm"),
        "Force (N)": ("force", "N"),
    }
    before = [
        "LabVIEW Measurement\t", "Writer_Version\t2", "Reader_Version\t2", "Separator\tTab", "Decimal_Separator\t.", "Multi_Headings\tNo",
        "X_Columns\tOne", "Time_Pref\tRelative", "Operator\tbench", "Date\t2024/03/05", "Time\t14:02:11.5", "***End_of_Header***\t", "\t\t\t\t",
        "Channels\t3\t\t\t", f"Samples\t{len(table['time'])}\t{len(table['time'])}\t{len(table['time'])}\t", "Date\t2024/03/05\t2024/03/05\t2024/03/05\t",
        "Y_Unit_Label\tbar\tmm\tN\t", "X_Dimension\tTime\tTime\tTime\t", "***End_of_Header***\t\t\t\t",
    ]  # fmt: skip
    rows = [[*row, ""] for row in _cells(table, columns)]
    _text(folder, "data.lvm", [*columns, "Comment"], rows, "\t", before=before)
    return Written("data.lvm", columns, {"sep": "\t", "skiprows": len(before), "skip_blank_lines": False})


def preamble(folder, table):
    """Metadata of the acquisition above the table, with a blank line between."""
    columns = {
        "Time (s)": ("time", "s"),
        "Pressure (bar)": ("pressure", "bar"),
        "Length (mm)": ("length", "mm"),
        "Force (N)": ("force", "N"),
    }
    before = [
        "Device:,USB-6211", "Serial number:,01A3F5C7", "Operator:,M. Keller", "Date:,05.03.2024", "Sample rate (Hz):,see time", "Channels:,3",
        "Range ai0:,-10 V to 10 V", "Remark:,\"hose A, second day\"", "",
    ]  # fmt: skip
    return _plain(folder, table, columns, before=before)


def unit_row(folder, table):
    """A row of units beneath the names."""
    columns = {"Time": ("time", "s"), "Pressure": ("pressure", "bar"), "Length": ("length", "mm"), "Force": ("force", "N")}
    return _plain(folder, table, columns, after=["s,bar,mm,N"])


def iso_times(folder, table):
    """ISO 8601 timestamps for the time."""
    columns = {"Pressure (kPa)": ("pressure", "kPa"), "Length (mm)": ("length", "mm"), "Force (N)": ("force", "N")}
    stamps = [
        (STAMP + datetime.timedelta(seconds=float(t))).isoformat(timespec="microseconds") if np.isfinite(t) else "" for t in table["time"]
    ]
    rows = [[stamp, *row] for stamp, row in zip(stamps, _cells(table, columns))]
    _text(folder, "data.csv", ["Timestamp", *columns], rows)
    return Written("data.csv", {"Timestamp": ("time", "iso"), **columns}, {"skip_blank_lines": False})


def extra_columns(folder, table):
    """Voltages, set points' names and remarks beside what is asked for."""
    columns = {
        "time [s]": ("time", "s"),
        "pressure [kPa]": ("pressure", "kPa"),
        "length [mm]": ("length", "mm"),
        "force [N]": ("force", "N"),
    }
    rows = []
    for i, row in enumerate(_cells(table, columns)):
        volt = "" if np.isnan(table["force"][i]) else f"{table['force'][i] / 250.0:.4f}"
        rows.append([str(i), *row, volt, "5.002", '"start, cold"' if i == 0 else ""])
    _text(folder, "data.csv", ["sample", *columns, "U_force [V]", "supply [V]", "remark"], rows)
    return Written("data.csv", columns, {"skip_blank_lines": False})


def tabs(folder, table):
    """Tabs, capitals, `[SEC]`."""
    columns = {
        "TIME [SEC]": ("time", "s"),
        "PRESSURE [KPA]": ("pressure", "kPa"),
        "LENGTH [MM]": ("length", "mm"),
        "FORCE [N]": ("force", "N"),
    }
    return _plain(folder, table, columns, name="data.tsv", sep="\t")


def us_units(folder, table):
    """Pounds per square inch, pounds and inches."""
    columns = {
        "Time (s)": ("time", "s"),
        "Pressure (psi)": ("pressure", "psi"),
        "Length (in)": ("length", "in"),
        "Load (lbf)": ("force", "lbf"),
    }
    return _plain(folder, table, columns)


def milliseconds(folder, table):
    """Time in ms, pressure in mbar, force in kN."""
    columns = {"t [ms]": ("time", "ms"), "p [mbar]": ("pressure", "mbar"), "length [m]": ("length", "m"), "F [kN]": ("force", "kN")}
    return _plain(folder, table, columns)


def excel(folder, table):
    """An Excel workbook with a title above the table and a second sheet."""
    columns = {
        "Time (s)": ("time", "s"),
        "Pressure (bar)": ("pressure", "bar"),
        "Length (mm)": ("length", "mm"),
        "Force (N)": ("force", "N"),
    }
    book = openpyxl.Workbook()
    sheet = book.active
    sheet.title = "Test"
    sheet.append(["Tensile rig, muscle test"])
    sheet.append([])
    sheet.append(list(columns))
    values = [table[quantity] / FACTORS[unit] for quantity, unit in columns.values()]
    for row in zip(*values):
        sheet.append([None if np.isnan(v) else float(v) for v in row])
    book.create_sheet("Remarks").append(["nothing of note"])
    # Without the hour of writing: the same seed gives the same bytes.
    book.properties.created = book.properties.modified = STAMP
    content = io.BytesIO()
    book.save(content)
    with zipfile.ZipFile(content) as found, zipfile.ZipFile(folder / "data.xlsx", "w", zipfile.ZIP_DEFLATED) as written:
        for entry in found.infolist():
            part = found.read(entry)
            if entry.filename == "docProps/core.xml":
                part = re.sub(rb"(<dcterms:modified[^>]*>)[^<]*", rb"\g<1>2024-03-05T14:02:11Z", part)
            written.writestr(zipfile.ZipInfo(entry.filename, STAMP.timetuple()[:6]), part, zipfile.ZIP_DEFLATED)
    return Written("data.xlsx", columns, {"skiprows": 2, "sheet_name": "Test"})


def matlab(folder, table):
    """A MATLAB file of version 5: a vector for each quantity, names without units, so these must be told."""
    columns = {"t": ("time", "s"), "p": ("pressure", "kPa"), "l": ("length", "mm"), "F": ("force", "N")}
    values = {name: (table[quantity] / FACTORS[unit])[:, None] for name, (quantity, unit) in columns.items()}
    content = io.BytesIO()
    savemat(content, values)
    # Without the hour of writing, which the first 116 bytes hold.
    (folder / "data.mat").write_bytes(b"MATLAB 5.0 MAT-file".ljust(116) + content.getvalue()[116:])
    return Written("data.mat", columns, arguments=_mapping(columns))


def parquet(folder, table):
    """Parquet with the columns of the contract."""
    columns = {
        "pressure [bar]": ("pressure", "bar"),
        "contraction [%]": ("contraction", "%"),
        "force [N]": ("force", "N"),
        "time [s]": ("time", "s"),
    }
    frame = pandas.DataFrame({name: table[quantity] / FACTORS[unit] for name, (quantity, unit) in columns.items()})
    frame.to_parquet(folder / "data.parquet", index=False)
    return Written("data.parquet", columns)


def comments(folder, table):
    """Comments above the header and between the rows."""
    columns = {
        "time [s]": ("time", "s"),
        "pressure [kPa]": ("pressure", "kPa"),
        "length [mm]": ("length", "mm"),
        "force [N]": ("force", "N"),
    }
    rows = _cells(table, columns)
    lines = ["# rig 2, load cell 2 kN", "# room 21.5 degC", ",".join(columns)]
    for i, row in enumerate(rows):
        if i and i % 100 == 0:
            lines.append(f"# {i} samples")
        lines.append(",".join(row))
    (folder / "data.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return Written("data.csv", columns, {"comment": "#", "skip_blank_lines": False})


def labelled(folder, table):
    """With the number of the sweep, and one specimen."""
    columns = {
        "time [s]": ("time", "s"), "pressure [bar]": ("pressure", "bar"), "contraction [%]": ("contraction", "%"), "force [N]": ("force", "N"),
        "sweep": ("sweep", "1"), "specimen": ("specimen", "1"),
    }  # fmt: skip
    return _plain(folder, table, columns)


def absolute(folder, table):
    """Absolute pressure, labelled as such."""
    columns = {
        "time [s]": ("time", "s"),
        "absolute pressure [kPa]": ("pressure", "kPa"),
        "length [mm]": ("length", "mm"),
        "force [N]": ("force", "N"),
    }
    written = _plain(folder, {**table, "pressure": table["pressure"] + ATMOSPHERE}, columns)
    written.absolute = True
    return written


def not_available(folder, table):
    """`#N/A` where a spreadsheet had no number."""
    columns = {
        "time [s]": ("time", "s"),
        "pressure [bar]": ("pressure", "bar"),
        "length [mm]": ("length", "mm"),
        "force [N]": ("force", "N"),
    }
    return _plain(folder, table, columns, missing="#N/A")


def told(folder, table):
    """Channels without meaning, named in the call."""
    columns = {"ch0": ("time", "s"), "ch1": ("pressure", "psi"), "ch2": ("length", "mm"), "ch3": ("force", "N")}
    written = _plain(folder, table, columns)
    written.arguments = _mapping(columns)
    return written


def told_by_file(folder, table):
    """Channels without meaning, named in the muscle file."""
    columns = {"Dev1/ai0": ("force", "N"), "Dev1/ai1": ("pressure", "kPa"), "Dev1/ai2": ("length", "mm"), "clock": ("time", "ms")}
    written = _plain(folder, table, columns, sep=";")
    rows = [f'{quantity} = "{name} [{unit}]"' for name, (quantity, unit) in columns.items()]
    written.toml = "\n[data.columns]\n" + "\n".join(rows) + "\n"
    return written


def _mapping(columns):
    return ("--columns", ", ".join(f"{quantity}={name} [{unit}]" for name, (quantity, unit) in columns.items()))


DIALECTS = {
    function.__name__.replace("_", "-"): function
    for function in (
        contract, round_brackets, underscores, slashes, semicolons, german, utf16, labview, preamble, unit_row, iso_times, extra_columns, tabs,
        us_units, milliseconds, excel, matlab, parquet, comments, labelled, absolute, not_available, told, told_by_file,
    )
}  # fmt: skip
"""Dialects by name."""


def again(folder, written):
    """The columns in SI as pandas, openpyxl and SciPy read them from the file."""
    file = folder / written.file
    if file.suffix == ".mat":
        frame = {name: values.ravel() for name, values in loadmat(file).items() if not name.startswith("__")}
    elif file.suffix == ".xlsx":
        frame = pandas.read_excel(file, engine="openpyxl", **written.options)
    elif file.suffix == ".parquet":
        frame = pandas.read_parquet(file)
    else:
        frame = pandas.read_csv(file, **written.options)
    found = {}
    for name, (quantity, unit) in written.columns.items():
        if unit == "iso":
            since = pandas.to_datetime(frame[name]) - pandas.Timestamp(STAMP)
            found[quantity] = since.dt.total_seconds().to_numpy(float)
        else:
            found[quantity] = np.asarray(frame[name], float) * FACTORS[unit]
    if written.absolute:
        found["pressure"] = found["pressure"] - ATMOSPHERE
    return found

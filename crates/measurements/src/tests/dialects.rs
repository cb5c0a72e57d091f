//! One table in the dialects of many laboratories: it gives the same numbers, bit for bit, and the right
//! meaning of each heading.

#![expect(
    clippy::too_many_lines,
    clippy::format_collect,
    reason = "a table of dialects is long, and reads best as it is written"
)]

use crate::{ColumnMap, Data, ReadOptions, Trace};
use proptest::prelude::*;
use std::fmt::Write as _;

/// The rows of the table: time in s, pressure in bar, length in mm, force in N.
pub(super) const ROWS: [[&str; 4]; 5] = [
    ["0", "2.5", "300", "812.25"],
    ["0.1", "2.5", "298.5", "790.125"],
    ["0.2", "2.5", "297", "771"],
    ["0.3", "2.5", "295.5", "752.5"],
    ["0.4", "2.5", "294", "733.75"],
];

pub(super) fn options(columns: &str) -> ReadOptions {
    let columns = if columns.is_empty() { ColumnMap::default() } else { columns.parse().unwrap() };
    ReadOptions { columns, l0_m: Some(0.3), ..ReadOptions::default() }
}

#[track_caller]
pub(super) fn reads(name: &str, bytes: &[u8], columns: &str) -> Data {
    Data::from_bytes(bytes, "d.csv", &options(columns)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn plain() -> Data {
    let rows: String = ROWS.iter().map(|row| row.join(",") + "\n").collect();
    reads("plain", format!("time [s],pressure [bar],length [mm],force [N]\n{rows}").as_bytes(), "")
}

/// Equal numbers, bit for bit.
#[track_caller]
pub(super) fn equal(name: &str, found: &Data) {
    let expected = plain();
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    let columns = |data: &Data| {
        let Trace::Length(length) = data.motion() else { panic!("{name}: no length") };
        [data.pressure(), length, data.force(), data.time().unwrap_or_default()].map(bits)
    };
    assert_eq!(columns(found), columns(&expected), "{name}");
    assert!(found.set_apart().is_empty(), "{name}: {:?}", found.set_apart());
}

/// The rows with a separator and a decimal sign.
pub(super) fn rows(separator: &str, comma: bool) -> String {
    let one = |row: &[&str; 4]| {
        let line = row.join(separator);
        if comma { line.replace('.', ",") } else { line }
    };
    ROWS.iter().map(|row| one(row) + "\n").collect()
}

#[test]
fn the_same_table_in_many_dialects() {
    let points = rows(",", false);
    let commas = rows(";", true);
    let tabs = rows("\t", false);
    let lvm = "LabVIEW Measurement\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\nX_Columns\tOne\n\
               Time_Pref\tRelative\nDate\t2026/03/01\nTime\t12:00:00,5\n***End_of_Header***\n\t\nChannels\t3\t\t\nSamples\t5\t5\t5\n\
               Date\t2026/03/01\t2026/03/01\t2026/03/01\nY_Unit_Label\tbar\tmm\tN\nX_Dimension\tTime\tTime\tTime\n\
               X0\t0\t0\t0\nDelta_X\t0.1\t0.1\t0.1\n***End_of_Header***\t\t\t\nX_Value\tPressure (bar)\tLength (mm)\tForce (N)\tComment\n";
    let clocks = |times: [&str; 5]| -> String {
        times.iter().zip(ROWS).map(|(time, row)| format!("{time},{}\n", row[1..].join(","))).collect()
    };
    let scaled: String = ROWS
        .iter()
        .map(|row| {
            let number = |i: usize| row[i].parse::<f64>().unwrap();
            format!("{},{},{},{}\n", 1000.0 * number(0), 100.0 * number(1), number(2), number(3))
        })
        .collect();
    let aligned = rows("   ", false);
    let dialects: Vec<(&str, String)> = vec![
        ("parentheses", format!("Time (s),Pressure (bar),Length (mm),Force (N)\n{points}")),
        ("underscores", format!("t_s,p_bar,length_mm,Force_N\n{points}")),
        ("slashes", format!("Time/s,Pressure/bar,Length/mm,Force/N\n{points}")),
        ("slashes with blanks", format!("t / s;p / bar;L / mm;F / N\n{commas}")),
        ("German", format!("Zeit / s;Druck / bar;L\u{e4}nge / mm;Kraft / N\n{commas}")),
        (
            "compound words",
            format!("Messzeit [s];Innendruck [bar];Muskell\u{e4}nge [mm];Zugkraft [N]\n{commas}"),
        ),
        ("French", format!("temps (s);pression (bar);longueur (mm);force (N)\n{commas}")),
        ("shouting", format!("TIME [S],PRESSURE [BAR],LENGTH [MM],FORCE [N]\n{points}")),
        (
            "words for units",
            format!("time [sec],pressure [bars],length [millimeter],force [Newton]\n{points}"),
        ),
        ("gauge", format!("Time (s),Pressure (bar gauge),Length (mm),Force (N)\n{points}")),
        ("barg", format!("Time (s),P1 [barg],L [mm],F [N]\n{points}")),
        ("in", format!("time in s,pressure in bar,length in mm,force in N\n{points}")),
        ("one letters", format!("t [s],p [bar],l [mm],f [N]\n{points}")),
        ("without units of time and force", format!("time,pressure [bar],length [mm],force\n{points}")),
        ("units beneath", format!("time,pressure,length,force\ns,bar,mm,N\n{points}")),
        (
            "units in brackets beneath",
            format!("Time;Pressure;Length;Load cell\n[s];[bar];[mm];[N]\n{commas}"),
        ),
        (
            "units and a rule beneath",
            format!("time\tpressure\tlength\tforce\ns\tbar\tmm\tN\n----\t----\t----\t----\n{tabs}"),
        ),
        (
            "decimal commas and tabs",
            format!("Zeit [s]\tDruck [bar]\tL\u{e4}nge [mm]\tKraft [N]\n{}", rows("\t", true)),
        ),
        ("tabs", format!("time [s]\tpressure [bar]\tlength [mm]\tforce [N]\n{tabs}")),
        ("blanks", format!("time[s] pressure[bar] length[mm] force[N]\n{aligned}")),
        ("aligned blanks", format!("Time (s)   Pressure (bar)   Length (mm)   Force (N)\n{aligned}")),
        ("savetxt", format!("# time [s],pressure [bar],length [mm],force [N]\n{points}")),
        ("commented with per cent", format!("% time(s) pressure(bar) length(mm) force(N)\n{aligned}")),
        (
            "metadata with colons",
            format!(
                "Operator: A. Nother\nDate: 2026-03-01 12:00\nRate: 10 Hz\nPressure: 2.5 bar, Length: 300 mm, Force: up\n\nTime (s),Pressure (bar),Length (mm),Force (N)\n{points}"
            ),
        ),
        (
            "metadata with separators",
            format!(
                "Instrument;DAQ 9;;\nChannels;4;;\nSample rate;10;10;10\n\nZeit [s];Druck [bar];L\u{e4}nge [mm];Kraft [N]\n{commas}"
            ),
        ),
        ("a recorder's header", format!("{lvm}{}", tabs.replace('\n', "\t\n"))),
        (
            "set points beside",
            format!(
                "Time (s),Pressure setpoint (bar),Pressure (bar),Length (mm),Force (N)\n{}",
                ROWS.iter().map(|r| format!("{},2,{}\n", r[0], r[1..].join(","))).collect::<String>()
            ),
        ),
        (
            "extra columns",
            format!(
                "Index,Time (s),Pressure (bar),Length (mm),Force (N),Comment,Voltage [V]\n{}",
                ROWS.iter()
                    .enumerate()
                    .map(|(i, r)| format!("{i},{},ok,3.3\n", r.join(",")))
                    .collect::<String>()
            ),
        ),
        ("milliseconds and kilopascals", format!("t [ms],P [kPa],L [mm],F [N]\n{scaled}")),
        (
            "quotes",
            format!(
                "\"Time (s)\",\"Pressure (bar)\",\"Length (mm)\",\"Force (N)\"\n{}",
                ROWS.iter().map(|r| format!("\"{}\"\n", r.join("\",\""))).collect::<String>()
            ),
        ),
        (
            "quoted decimal commas",
            format!(
                "Time (s),Pressure (bar),Length (mm),Force (N)\n{}",
                ROWS.iter()
                    .map(|r| format!("\"{}\"\n", r.join("\",\"").replace('.', ",")))
                    .collect::<String>()
            ),
        ),
        (
            "units in every field",
            format!(
                "Time,Pressure,Length,Force\n{}",
                ROWS.iter()
                    .map(|r| format!("{} s,{} bar,{} mm,{} N\n", r[0], r[1], r[2], r[3]))
                    .collect::<String>()
            )
            .replace("Pressure,Length", "Pressure [bar],Length [mm]"),
        ),
        (
            "ISO timestamps",
            format!(
                "Timestamp,Pressure [bar],Length [mm],Force [N]\n{}",
                clocks([
                    "2026-03-01T12:00:00.0Z",
                    "2026-03-01T12:00:00.1Z",
                    "2026-03-01T12:00:00.2Z",
                    "2026-03-01T12:00:00.3Z",
                    "2026-03-01T12:00:00.4Z"
                ])
                .replace("12:00:00", "00:00:00")
            ),
        ),
        (
            "clock times",
            format!(
                "Time,Pressure [bar],Length [mm],Force [N]\n{}",
                clocks(["00:00:00", "00:00:00.1", "00:00:00.2", "00:00:00.3", "00:00:00.4"])
            ),
        ),
        ("slips", format!("tiem [s],presure [bar],lenght [mm],froce [N]\n{points}")),
        (
            "CRLF and padding",
            format!(
                "sep=;\r\n;;;\r\nZeit [s];Druck [bar];L\u{e4}nge [mm];Kraft [N];;\r\n{}",
                commas.replace('\n', ";;\r\n")
            ),
        ),
        (
            "reversed",
            format!(
                "Time (s),Pressure (bar),Length (mm),Force (N)\n{}",
                ROWS.iter().rev().map(|r| r.join(",") + "\n").collect::<String>()
            ),
        ),
        (
            "shuffled",
            format!(
                "Time (s),Pressure (bar),Length (mm),Force (N)\n{}",
                [3, 0, 4, 1, 2].iter().map(|i: &usize| ROWS[*i].join(",") + "\n").collect::<String>()
            ),
        ),
    ];
    assert!(dialects.len() >= 30);
    for (name, text) in &dialects {
        equal(name, &reads(name, text.as_bytes(), ""));
    }
    let german = &dialects.iter().find(|(name, _)| *name == "German").unwrap().1;
    let latin: Vec<u8> = german.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
    equal("Latin-1", &reads("Latin-1", &latin, ""));
    let utf16: Vec<u8> = german.encode_utf16().flat_map(u16::to_le_bytes).collect();
    equal("UTF-16 without mark", &reads("UTF-16 without mark", &utf16, ""));
    equal("UTF-16", &reads("UTF-16", &[&[0xff, 0xfe][..], &utf16].concat(), ""));
}

#[test]
fn what_the_user_says_settles_it() {
    let points = rows(",", false);
    for (name, header, columns) in [
        ("channels", "ch1,ch2,ch3,ch4", "time=ch1 [s], pressure=ch2 [bar], length=ch3 [mm], force=ch4 [N]"),
        ("numbers", "a,b,c,d", "time=1 [s],pressure=2 [bar],length=3 [mm],force=4 [N]"),
        (
            "over names",
            "force [N],time [s],length [mm],pressure [bar]",
            "time=force [s],pressure=time [bar],length=length,force=pressure [N]",
        ),
        ("two forces", "t [s],p [bar],L [mm],F1 [N]", "force=F1"),
    ] {
        equal(name, &reads(name, format!("{header}\n{points}").as_bytes(), columns));
    }
    let headless = "time=1 [s],pressure=2 [bar],length=3 [mm],force=4 [N]";
    equal("no header", &reads("no header", points.as_bytes(), headless));
    let reversed = reads("sign", format!("t [s],p [bar],L [mm],F [N]\n{points}").as_bytes(), "force=-F [N]");
    assert_eq!(reversed.force()[0].to_bits(), (-812.25_f64).to_bits());
    for (header, columns, parts) in [
        (
            "t [s],p [bar],L [mm],F1 [N]",
            "force=F2",
            vec!["no column `F2`", "did you mean `F1 [N]`?", "`p [bar]`"],
        ),
        (
            "t [s],p [bar],L [mm],F1 [N]",
            "force=F1,pressure=F1 [N]",
            vec!["`F1 [N]` is both `force` and `pressure`"],
        ),
        (
            "p2 [bar],p [bar],L [mm],F [N]",
            "",
            vec!["which column is `pressure`: `p2 [bar]`, `p [bar]`?", "--columns \"pressure=p2 [bar]\""],
        ),
        (
            "t [s],p [bar],F1 [N],F2 [N]",
            "",
            vec!["2 things", "which column is `force`", "no column `length` or `contraction`"],
        ),
        ("t [s],pressure,L [mm],F [N]", "", vec!["`pressure` has no unit", "`pressure [bar]`"]),
        (
            "t [s],pressure [mm],L [mm],F [N]",
            "",
            vec!["`pressure [mm]` has a unit of length where one of pressure is needed"],
        ),
        (
            "t [s],q [mm],L [mm],F [N]",
            "",
            vec!["no column `pressure`", "--columns \"pressure=NAME [UNIT]\"", "found: `t [s]`"],
        ),
        (
            "t [s],p [bar],L [mm],Pull (furlong)",
            "",
            vec!["`Pull (furlong)` has the unknown unit `furlong`", "N, mN, kN", "such as `force [N]`"],
        ),
        (
            "t [s],p [bar],L [mm],F [N]",
            "force=9 [N]",
            vec!["there is no column 9: the file has 4 (`t [s]`, `p [bar]`"],
        ),
        ("t [s],p [bar],L [mm],x", "force=y [N]", vec!["there is no column `y [N]`: write one of `t [s]`"]),
        (
            "t [s],p [bar],L [mm],x",
            "force=x [bar]",
            vec!["`x [bar]` has a unit of pressure where one of force is needed"],
        ),
    ] {
        let error = Data::from_bytes(format!("{header}\n{points}").as_bytes(), "d.csv", &options(columns))
            .unwrap_err();
        let message = error.to_string();
        for part in parts {
            assert!(message.contains(part), "{header}: {message:?} does not say {part:?}");
        }
    }
}

/// A displacement is measured from the unpressurised length; its sign is found from the force, given by its
/// name, or stated.
#[test]
fn displacements_of_specimens_count_from_their_own_lengths() {
    let text = "pressure [bar], displacement [mm], force [N], specimen\n2, 0, 900, short\n2, 6, 700, short\n2, 0, 900, long\n2, 25, 700, long\n";
    let options = ReadOptions { l0_m: Some(0.25), ..ReadOptions::default() };
    let data = Data::from_bytes(text.as_bytes(), "pull.csv", &options).unwrap();
    let own = data.clone().with_lengths(|name| (name == "short").then_some(0.06));
    let is_near = |found: Vec<f64>, expected: [f64; 4]| {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
    };
    is_near(own.contraction(0.25), [0.0, 0.1, 0.0, 0.1]);
    // Said again, or taken back.
    is_near(
        own.clone().with_lengths(|name| (name == "short").then_some(0.06)).contraction(0.25),
        [0.0, 0.1, 0.0, 0.1],
    );
    is_near(own.with_lengths(|_| None).contraction(0.25), [0.0, 0.024, 0.0, 0.1]);
}

/// As a row that was written under the other name is read: 6 mm of 60 are 6 of 250, and a length of 54 mm is one of
/// 1 - 54/250. A contraction stays.
#[test]
fn a_row_read_as_that_of_another_specimen() {
    let rows = "2, A, 900, short\n2, B, 700, long\n";
    for (heading, [a, b], as_long, as_short) in [
        ("displacement [mm]", ["6", "25"], 6.0 / 250.0, 25.0 / 60.0),
        ("length [mm]", ["54", "225"], 1.0 - 54.0 / 250.0, 1.0 - 225.0 / 60.0),
        ("contraction [%]", ["10", "10"], 0.1, 0.1),
    ] {
        let text = format!(
            "pressure [bar], {heading}, force [N], specimen\n{}",
            rows.replace('A', a).replace('B', b)
        );
        let options = ReadOptions { l0_m: Some(0.25), ..ReadOptions::default() };
        let data = Data::from_bytes(text.as_bytes(), "pull.csv", &options).unwrap();
        let data = data.with_lengths(|name| (name == "short").then_some(0.06));
        let read = data.contraction(0.25);
        let found = [data.contraction_as(1, 0, read[0], 0.25), data.contraction_as(0, 1, read[1], 0.25)];
        assert!(
            (found[0] - as_long).abs() < 1e-12 && (found[1] - as_short).abs() < 1e-12,
            "{heading}: {found:?}"
        );
        assert!((data.contraction_as(0, 0, read[0], 0.25) - read[0]).abs() < 1e-15);
    }
}

#[test]
fn displacements() {
    let table = |name: &str, values: [f64; 5]| {
        let mut text = format!("t [s],p [bar],{name},F [N]\n");
        for (row, value) in ROWS.iter().zip(values) {
            writeln!(text, "{},{},{value},{}", row[0], row[1], row[3]).unwrap();
        }
        text
    };
    let shortening = [0.0, 1.5, 3.0, 4.5, 6.0];
    let lengthening = shortening.map(|value| -value);
    for (name, values, columns) in [
        ("Displacement/mm", shortening, ""),
        ("Weg (mm)", lengthening, ""),
        ("Extension [mm]", lengthening, ""),
        ("sensor 3 [mm]", shortening, ""),
        ("x (mm)", [300.0, 298.5, 297.0, 295.5, 294.0], ""),
        ("Weg (mm)", lengthening, "displacement=-Weg"),
    ] {
        let found = reads(name, table(name, values).as_bytes(), columns);
        let length = |data: &Data| match data.motion() {
            Trace::Length(length) => length.clone(),
            Trace::Contraction(_) => panic!("{name}: a contraction"),
        };
        for (a, b) in length(&found).iter().zip(length(&plain())) {
            assert!((a - b).abs() < 1e-15, "{name}: {a} {b}");
        }
    }
    let says = reads("weg", table("Weg (mm)", lengthening).as_bytes(), "").reading().columns[2].says.clone();
    assert_eq!(says.as_deref(), Some("lengthening from 300 mm (the force rises as it grows)"));
    // Neither a wild reading nor a load cell that reads a pull as negative turns it over.
    let as_read = |text: &str| reads("weg", text.as_bytes(), "").reading().columns[2].says.clone();
    let good = table("Weg (mm)", shortening);
    let falls = as_read(&good);
    assert_eq!(falls.as_deref(), Some("shortening from 300 mm (the force falls as it grows)"));
    let negative: String = good
        .lines()
        .map(|line| {
            let (rest, force) = line.rsplit_once(',').unwrap();
            let sign = if force.parse::<f64>().is_ok() { "-" } else { "" };
            format!("{rest},{sign}{force}\n")
        })
        .collect();
    assert_eq!(as_read(&negative), falls);
    let wild: String = (0..4)
        .map(|n| good.lines().skip(usize::from(n > 0)).fold(String::new(), |text, line| text + line + "\n"))
        .collect();
    assert_eq!(as_read(&(wild + "9,3,5000,9000\n")), falls);
    let unknown = ReadOptions::default();
    let error = Data::from_bytes(table("Weg (mm)", shortening).as_bytes(), "d.csv", &unknown).unwrap_err();
    assert!(error.to_string().contains("name the muscle"), "{error}");
}

#[test]
fn what_was_guessed_is_told_once() {
    let data = reads("told", b"Time (s),Druck [bar],length [mm],F [N],Note\n0,1,300,5,a\n1,1,290,4,b\n", "");
    let told: Vec<_> = data
        .reading()
        .columns
        .iter()
        .map(|c| (c.column.as_str(), c.quantity.as_deref(), c.unit.as_deref(), c.guessed, c.first.join(" ")))
        .collect();
    let expected = [
        ("Time (s)", Some("time"), Some("s"), true, "0 1"),
        ("Druck [bar]", Some("pressure"), Some("bar"), true, "1 1"),
        ("length [mm]", Some("length"), Some("mm"), false, "300 290"),
        ("F [N]", Some("force"), Some("N"), true, "5 4"),
        ("Note", None, None, true, "a b"),
    ];
    assert_eq!(told, expected.map(|(a, b, c, d, e)| (a, b, c, d, e.to_owned())));
    assert!(!plain().reading().is_guessed());
}

/// Copies of rows, and times out of order.
#[test]
fn copies_and_times_out_of_order() {
    let header = "time [s],pressure [bar],length [mm],force [N]\n";
    let copied = format!("{header}{}{}\n", rows(",", false), ROWS[1].join(","));
    let data = reads("copied", copied.as_bytes(), "");
    assert_eq!((data.len(), data.set_apart()[0].row), (5, 7));
    assert_eq!(data.set_apart()[0].reason, "equal to row 3 in every column");
    // With a clock of whole seconds, a muscle at rest reads the same again.
    let coarse = "0,1,300,5\n0,1,299,5\n1,1,298,5\n1,1,298,5\n";
    assert_eq!(reads("coarse", format!("{header}{coarse}").as_bytes(), "").len(), 4);
    // A time that begins again is another run, as before.
    let mut runs = header.to_owned();
    let mut shuffled = header.to_owned();
    for i in 0..40_u32 {
        writeln!(runs, "{},{},{},5", i % 10, 1 + i / 10, 300 - i % 10).unwrap();
        // The readings follow the order in the file, not the times.
        writeln!(shuffled, "{},1,{},{}", i * 17 % 40, 300 - i, 500 - 3 * i).unwrap();
    }
    let data = reads("runs", runs.as_bytes(), "");
    assert_eq!((data.sweeps().len(), data.reading().notes.len()), (4, 0));
    let error = Data::from_bytes(shuffled.as_bytes(), "d.csv", &options("")).unwrap_err().to_string();
    assert!(
        error.contains(" of 40 rows, and sorted by time the readings jump") && error.contains("static map"),
        "{error}"
    );
    // Late packets.
    let mut late: Vec<String> =
        (0..200_u32).map(|i| format!("{},1,{},{}\n", i, 300 - i, 500 - 2 * i)).collect();
    for at in [20, 90, 150] {
        late.swap(at, at + 3);
    }
    let data = reads("late", format!("{header}{}", late.concat()).as_bytes(), "");
    assert_eq!(data.sweeps().len(), 1);
    assert!(data.reading().notes[0].contains("sorted"), "{:?}", data.reading().notes);
    assert!(data.time().unwrap().windows(2).all(|pair| pair[0] < pair[1]));
}

/// Contraction and length of one table follow from each other, or one of them is wrong.
#[test]
fn a_computed_contraction_is_left_aside() {
    let table = |c: f64| {
        format!(
            "pressure [Pa],contraction [-],length [m],force [N]\n1e5,0,0.25,10\n1e5,0.1,0.225,5\n1e5,{c},0.2,1\n"
        )
    };
    let data = reads("both", table(0.2).as_bytes(), "");
    assert!(matches!(data.motion(), Trace::Length(_)));
    assert_eq!(data.reading().columns[1].says.as_deref(), Some("ignored: it follows from the length"));
    let error = Data::from_bytes(table(0.3).as_bytes(), "d.csv", &options("")).unwrap_err().to_string();
    assert!(error.contains("both given"), "{error}");
}

/// A dialect: a way of writing a table.
#[derive(Debug, Clone)]
struct Dialect {
    separator: usize,
    comma: bool,
    encoding: usize,
    metadata: usize,
    units: bool,
    header: usize,
    crlf: bool,
}

fn dialect() -> impl Strategy<Value = Dialect> {
    (0..3_usize, any::<bool>(), 0..4_usize, 0..4_usize, any::<bool>(), 0..6_usize, any::<bool>()).prop_map(
        |(separator, comma, encoding, metadata, units, header, crlf)| Dialect {
            separator,
            // A comma can't be both.
            comma: comma && separator > 0,
            encoding,
            metadata,
            units,
            header,
            crlf,
        },
    )
}

impl Dialect {
    fn write(&self, rows: &[[f64; 4]]) -> Vec<u8> {
        let separator = [",", ";", "\t"][self.separator];
        let units = ["s", "bar", "mm", "N"];
        let names = [
            ["time", "pressure", "length", "force"],
            ["Zeit", "Druck", "L\u{e4}nge", "Kraft"],
            ["t", "p", "l", "F"],
            ["TIME", "P1", "Muscle length", "Load cell"],
            ["Elapsed time", "Pressure_1", "LENGTH", "Force 2"],
            ["temps", "pression", "longueur", "force"],
        ][self.header];
        let ways = ["{} [{}]", "{} ({})", "{}/{}", "{} / {}", "{}_{}", "{} [{}]"];
        let heading = |i: usize| {
            if self.units {
                names[i].to_owned()
            } else {
                ways[self.header].replacen("{}", names[i], 1).replacen("{}", units[i], 1)
            }
        };
        let mut text = ["", "Test: 12\nOperator: me\n\n", "# comment\n", "Date;2026-03-01\nGain;3;4;5\n"]
            [self.metadata]
            .to_owned();
        text.push_str(&([0, 1, 2, 3].map(heading).join(separator) + "\n"));
        if self.units {
            text.push_str(&(units.join(separator) + "\n"));
        }
        for row in rows {
            let line = row.map(|value| value.to_string()).join(separator);
            text.push_str(&(if self.comma { line.replace('.', ",") } else { line } + "\n"));
        }
        if self.crlf {
            text = text.replace('\n', "\r\n");
        }
        match self.encoding {
            0 => text.into_bytes(),
            1 => format!("\u{feff}{text}").into_bytes(),
            2 => text.encode_utf16().flat_map(u16::to_le_bytes).collect(),
            _ => text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect(),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// The same numbers give the same columns in any dialect.
    #[test]
    fn any_dialect_gives_the_same_bits(
        dialect in dialect(),
        values in prop::collection::vec((0.0..1e4_f64, 0.01..10.0_f64, 50.0..400.0_f64, -10.0..5000.0_f64), 1..30),
    ) {
        let rows: Vec<[f64; 4]> =
            values.iter().enumerate().map(|(i, (t, p, l, f))| [i as f64 + t / 1e5, *p, *l, *f]).collect();
        let first = Dialect { separator: 0, comma: false, encoding: 0, metadata: 0, units: false, header: 0, crlf: false };
        let [expected, found] = [&first, &dialect].map(|dialect| reads("any", &dialect.write(&rows), ""));
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        for (a, b) in expected.columns().numbers().zip(found.columns().numbers()) {
            prop_assert_eq!((a.0, bits(a.1)), (b.0, bits(b.1)));
        }
    }
}

#[test]
fn absolute_pressures_are_read_above_the_air() {
    for heading in [
        "p [bara]",
        "absolute pressure [bar]",
        "pressure [bar abs]",
        "p_abs / bar",
        "Absolutdruck [bar]",
        "P (bar a)",
    ] {
        let text = format!(
            "t [s],{heading},L [mm],F [N]\n0,1.01325,250,0.5\n1,3.01325,249,300\n2,4.01325,248,420\n"
        );
        let data = Data::from_csv(&text, "a.csv").unwrap();
        for (found, gauge) in data.pressure().iter().zip([0.0, 2e5, 3e5]) {
            assert!((found - gauge).abs() < 1e-6, "{heading}: {found}");
        }
        let says = data.reading().columns.iter().filter_map(|column| column.says.as_deref());
        assert!(says.into_iter().any(|says| says.contains("1.01325 bar are taken off")), "{heading}");
    }
    let gauge =
        Data::from_csv("t [s],gauge pressure [bar],L [mm],F [N]\n0,1.5,250,1\n1,3,249,300\n", "a.csv")
            .unwrap();
    assert_eq!(gauge.pressure(), [1.5e5, 3e5]);
}

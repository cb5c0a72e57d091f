//! Files without information that their authors take for granted: units, which header counts, the hour of a
//! clock.

use super::dialects::{ROWS, equal, options, reads, rows};
use crate::{Data, ReadOptions};

/// A muscle of 300 mm with the forces of the rows at 2.5 bar.
fn muscle(columns: &str) -> ReadOptions {
    ReadOptions { pull: vec![[0.0, 812.25 / 2.5e5], [0.1, 420.0 / 2.5e5]], ..options(columns) }
}

#[track_caller]
fn guesses(name: &str, text: &str) -> Data {
    Data::from_bytes(text.as_bytes(), "d.csv", &muscle("")).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The rows with factors on time, pressure, length and force.
fn scaled(factors: [f64; 4]) -> String {
    let one = |row: &[&str; 4]| {
        let numbers = row.iter().zip(factors).map(|(text, factor)| text.parse::<f64>().unwrap() * factor);
        numbers.map(|number| number.to_string()).collect::<Vec<_>>().join(",") + "\n"
    };
    ROWS.iter().map(one).collect()
}

#[track_caller]
fn refused(name: &str, text: &str, parts: &[&str]) {
    let message = Data::from_bytes(text.as_bytes(), "d.csv", &muscle("")).err().map(|e| e.to_string());
    let message = message.unwrap_or_else(|| panic!("{name} is read"));
    for part in parts {
        assert!(message.contains(part), "{name}: {message:?} does not say {part:?}");
    }
}

/// The only possible unit is taken and reported.
#[test]
fn units_are_known_by_the_size_of_the_readings() {
    for (name, header, factors) in [
        ("bar, mm", "time,pressure,length,force", [1.0; 4]),
        ("kPa, cm", "time,pressure,length,force", [1.0, 100.0, 0.1, 1.0]),
        ("Pa, m", "t,p,l,F", [1.0, 1e5, 1e-3, 1.0]),
        ("MPa, in", "t,p,l,F", [1.0, 0.1, 1.0 / 25.4, 1.0]),
        ("psi, newtons said", "t,p,l,F [N]", [1.0, 14.503_773_773, 1.0, 1.0]),
        ("mbar, m", "t,p,l,F", [1.0, 1000.0, 1e-3, 1.0]),
        ("bar, a position", "t,p,x,F", [1.0; 4]),
    ] {
        let data = guesses(name, &format!("{header}\n{}", scaled(factors)));
        for (found, expected) in data.pressure().iter().zip([2.5e5; 5]) {
            assert!((found / expected - 1.0).abs() < 1e-9, "{name}: {found} Pa");
        }
        let length = 0.3 * (1.0 - data.contraction(0.3)[4]);
        assert!((length - 0.294).abs() < 1e-9, "{name}: {length} m");
        let says = data.reading().columns[1].says.clone().unwrap_or_default();
        assert!(says.contains("no unit is written"), "{name}: {says}");
        assert!(data.reading().columns[1].guessed && data.reading().columns[1].unit.is_some());
    }
    let fractions = "pressure [bar],contraction,force [N]\n1,0,5\n1,0.2,4\n";
    assert_eq!(guesses("fractions", fractions).contraction(0.3)[1].to_bits(), 0.2_f64.to_bits());
    let per_cent = "pressure [bar],contraction,force [N]\n1,0,5\n1,20,4\n";
    assert_eq!(guesses("per cent", per_cent).contraction(0.3)[1].to_bits(), 0.2_f64.to_bits());
    let inside = "t,p,l,F\n0,2.5 bar,300 mm,812.25\n0.1,250 kPa,29.85 cm,790.125\n";
    assert_eq!(guesses("units in the fields", inside).pressure(), [2.5e5; 2]);
}

/// If two units are possible, or none, one message says what to write, and doing so works.
#[test]
fn units_that_the_readings_do_not_show_are_asked_for() {
    let table = |factors| format!("t,p,l,F\n{}", scaled(factors));
    refused(
        "kilograms or psi",
        &table([1.0, 1.0, 1.0, 1.0 / 9.806_65]),
        &[
            "d.csv:1: column `p` has no unit (2.50 to 2.50)",
            "psi",
            "bar",
            "kgf",
            "--columns \"pressure=p [bar], force=F [kgf]\"",
        ],
    );
    refused(
        "other lengths",
        &table([1.0, 1.0, 0.3, 1.0]),
        &["column `l` has no unit (88.2 to 90.0): none fits its readings", "length=l [mm], pressure=p ["],
    );
    refused(
        "some have one",
        "t,p,l [mm],F\n0,2.5 bar,300,812\n1,2.5,299,800\n",
        &["some of its fields have one"],
    );
    refused("an unknown one", "t,p [furlong],l [mm],F\n0,2,300,812\n", &["`p [furlong]`"]);
    // Without a muscle only the size of a pressure is known.
    let plain = Data::from_csv(&format!("t,p,l [mm],F\n{}", rows(",", false)), "d.csv").unwrap_err();
    assert!(plain.to_string().contains("bar (up to 2.5 bar)"), "{plain}");
    equal("settled", &reads("settled", table([1.0; 4]).as_bytes(), "length=l [mm], pressure=p [bar]"));
    // A column that an analysis doesn't need doesn't stop it.
    let other = format!("t,p [bar],l [mm],F,Temp\n{}", rows(",", false).replace('\n', ",21\n"));
    let data = guesses("no unit of temperature", &other);
    assert_eq!((data.temperature(), data.reading().columns[4].quantity.as_deref()), (None, None));
}

#[test]
fn headers_of_spreadsheets_and_recorders() {
    let points = rows(",", false);
    let header = "Time (s),Pressure (bar),Length (mm),Force (N)";
    let broken = format!("\"Time\n(s)\",\"Pressure\n(bar)\",\"Length\n(mm)\",\"Force\n(N)\"\n{points}");
    let data = reads("line breaks", broken.as_bytes(), "");
    equal("line breaks", &data);
    assert_eq!(data.line(0).1, 6);
    equal("CRLF", &reads("CRLF", broken.replace(")\"\n", ")\"\r\n").as_bytes(), ""));
    let recorder = |names: &str| {
        format!(
            "LabVIEW Measurement\nSeparator\tTab\n***End_of_Header***\n\nChannels\t3\nY_Unit_Label\tbar\tmm\tN\nX_Dimension\tTime\tTime\tTime\n\
             ***End_of_Header***\nX_Value\t{names}\tComment\n{}",
            rows("\t", false)
        )
    };
    equal(
        "units of channels",
        &reads("units of channels", recorder("Druck\tL\u{e4}nge\tKraft").as_bytes(), ""),
    );
    let own =
        recorder("Druck [bar]\tL\u{e4}nge [mm]\tKraft [N]").replace("bar\tmm\tN\n", "Volts\tVolts\tVolts\n");
    equal("units of names", &reads("units of names", own.as_bytes(), ""));
    let lines: Vec<&str> = points.lines().collect();
    let [first, last] = [lines[..3].join("\n"), lines[3..].join("\n")];
    let again = reads("again", format!("{header}\n{first}\n\n{header}\n{last}\n").as_bytes(), "");
    assert_eq!((again.len(), again.set_apart()[0].reason.as_str()), (5, "the header again"));
    let other = format!("{header}\n{first}\n\nTime (s),Force (N),Length (mm),Pressure (bar)\n{last}\n");
    refused(
        "another table",
        &other,
        &["d.csv:6: another table begins here", "`Force (N)`", "name both files"],
    );
    refused("no header", &points, &["d.csv:1", "--columns \"time=1 [s],pressure=2 [bar]"]);
    let twice = "t [s],p [bar],Force (N),l [mm],Force (N)\n0,2.5,3,300,4\n";
    refused("twice", twice, &["which column is `force`", "--columns \"force=3 [N]\""]);
}

#[test]
fn clocks_without_hours() {
    let times = ["59:59.8", "59:59.9", "00:00.0", "00:00.1", "00:00.2"];
    let lines = times.iter().zip(ROWS).map(|(time, row)| format!("{time},{}", row[1..].join(",")));
    let body = lines.collect::<Vec<_>>().join("\n");
    let data = reads("mm:ss", format!("Time,p [bar],l [mm],F [N]\n{body}").as_bytes(), "");
    for (found, row) in data.time().unwrap().iter().zip(ROWS) {
        assert!((found - row[0].parse::<f64>().unwrap()).abs() < 1e-9, "{found}");
    }
}

#[test]
fn pages_that_are_no_tables() {
    for (text, part) in [
        ("<html><table><tr><td>Time</td></tr></table></html>", "HTML"),
        ("[{\"t\":0,\"p\":1}]", "JSON"),
        ("  {\"t\":[0,1]}", "JSON"),
    ] {
        refused(part, text, &[part, "CSV"]);
    }
}

//! Any bytes give either a data set whose every method returns finite numbers, or an error of one line.
//! Nothing panics or hangs.

#![expect(
    clippy::unwrap_used,
    reason = "a test that cannot be set up fails; values are exact by construction"
)]

use crate::asked::{ask, complete};
use bulge_measurements::Data;
use proptest::prelude::*;
use std::fmt::Write as _;

fn read(text: &str) {
    match Data::from_csv(text, "any.csv") {
        Ok(data) => {
            ask(&data);
            if data.len() > 1 {
                ask(&data.subset(&(0..data.len()).map(|row| row % 3 != 1).collect::<Vec<_>>()));
            }
        }
        Err(error) => complete(&error),
    }
}

/// A valid table.
fn table(rows: usize) -> String {
    let mut text =
        "# rig 3\ntime [s],pressure [bar],length [mm],force [N],sweep,direction,cycle\n".to_owned();
    for row in 0..rows {
        let way = (row as f64 * 0.3).sin();
        let (length, force) = (280.0 + 20.0 * way, 300.0 + 200.0 * way);
        writeln!(text, "{},2,{length:.3},{force:.1},a,0,{}", 0.1 * row as f64, row / 20).unwrap();
    }
    text
}

const PIECES: &[&str] = &[
    "pressure",
    "length",
    "force",
    "contraction",
    "time",
    "sweep",
    "direction",
    " ",
    "[",
    "]",
    "[bar]",
    "[mm]",
    "[N]",
    "[%]",
    ",",
    ";",
    "\t",
    "\n",
    "\r\n",
    "\r",
    "#",
    "\"",
    "1",
    "-2.5e3",
    "1e308",
    "-1e308",
    "nan",
    "1,5",
    "2 bar",
    "up",
    "\u{feff}",
    "\u{b0}C",
    "\u{0}",
    "\u{1f600}",
    "1e-300",
    "0",
    "300",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_text(text in "\\PC{0,200}") {
        read(&text);
    }

    #[test]
    fn random_bytes_in_a_file(bytes in prop::collection::vec(any::<u8>(), 0..300), is_parquet in any::<bool>()) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(if is_parquet { "any.parquet" } else { "any.csv" });
        std::fs::write(&path, bytes).unwrap();
        match Data::read(&[path]) {
            Ok(data) => ask(&data),
            Err(error) => complete(&error),
        }
    }

    #[test]
    fn random_headers_and_rows(pieces in prop::collection::vec(prop::sample::select(PIECES), 0..60)) {
        read(&pieces.concat());
    }

    #[test]
    fn tables_with_bytes_changed(
        changes in prop::collection::vec((any::<prop::sample::Index>(), prop::sample::select(PIECES)), 1..5),
        cut in any::<prop::sample::Index>(),
        is_cut in any::<bool>(),
    ) {
        let mut text = table(40);
        for (place, piece) in changes {
            let at = text.floor_char_boundary(place.index(text.len()));
            let end = text.floor_char_boundary((at + 1).min(text.len())).max(at);
            text.replace_range(at..end, piece);
        }
        if is_cut {
            text.truncate(text.floor_char_boundary(cut.index(text.len())));
        }
        read(&text);
    }

    /// Any numbers in the right columns, from huge to equal.
    #[test]
    fn any_finite_numbers(
        rows in prop::collection::vec((any::<f64>(), any::<f64>(), any::<f64>(), any::<f64>()), 1..40),
        kind in 0..4,
    ) {
        let mut text = "time [s],pressure [Pa],length [m],force [N]\n".to_owned();
        let tame = |value: f64| match kind {
            0 => value % 1.0,
            1 => (value % 3.0).round(),
            2 => value % 1e9,
            _ => value.clamp(-1e30, 1e30),
        };
        for (t, p, l, f) in rows.iter().map(|(t, p, l, f)| (tame(*t), tame(*p), tame(*l), tame(*f))) {
            writeln!(text, "{t},{p},{l},{f}").unwrap();
        }
        read(&text);
    }

    /// Steps up and down and equal values, at equal times: every history is a path of rows.
    #[test]
    fn any_zigzag(steps in prop::collection::vec(-3..4_i32, 1..120), has_time in any::<bool>()) {
        let mut text = format!("sweep,pressure [bar],contraction [%],force [N]{}\n", if has_time { ",time [s]" } else { "" });
        let mut place = 0;
        for (row, step) in steps.iter().enumerate() {
            place += step;
            let time = if has_time { format!(",{}", row / 2) } else { String::new() };
            writeln!(text, "a,1,{},{}{time}", f64::from(place) * 0.7, 100 - place).unwrap();
        }
        read(&text);
    }
}

#[test]
fn every_cut_of_a_table() {
    let text = table(4);
    for end in 0..text.len() {
        read(&text[..end]);
    }
}

/// A valid Parquet file with changed bytes.
#[test]
fn changed_bytes_of_parquet() {
    use parquet::data_type::DoubleType;
    use parquet::file::properties::WriterProperties;
    use parquet::file::writer::SerializedFileWriter;
    let schema = "message schema { required double pressure[bar]; required double length[mm]; required double force[N]; }";
    let schema = std::sync::Arc::new(parquet::schema::parser::parse_message_type(schema).unwrap());
    let mut bytes = Vec::new();
    let properties = WriterProperties::builder().set_compression(parquet::basic::Compression::SNAPPY).build();
    let mut writer = SerializedFileWriter::new(&mut bytes, schema, std::sync::Arc::new(properties)).unwrap();
    let mut group = writer.next_row_group().unwrap();
    while let Some(mut column) = group.next_column().unwrap() {
        let values: Vec<f64> = (0..50).map(|row| f64::from(row) * 0.1).collect();
        column.typed::<DoubleType>().write_batch(&values, None, None).unwrap();
        column.close().unwrap();
    }
    group.close().unwrap();
    writer.close().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("any.parquet");
    let mut state = 1_u64;
    let mut next = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for _ in 0..3000 {
        let mut changed = bytes.clone();
        for _ in 0..=next(3) {
            let at = next(changed.len());
            changed[at] = u8::try_from(next(256)).unwrap();
        }
        if next(10) == 0 {
            changed.truncate(next(bytes.len()));
        }
        std::fs::write(&path, changed).unwrap();
        match Data::read(&[&path]) {
            Ok(data) => ask(&data),
            Err(error) => complete(&error),
        }
    }
}

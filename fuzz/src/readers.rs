//! Every reader of files.

#[cfg(feature = "sweeps")]
use bulge_design::joint::{Checks, Joint};
use bulge_effects::expression::{Expression, SHAPE_VARIABLES, VARIABLES};
use bulge_effects::user;
#[cfg(feature = "decisions")]
use bulge_inference::{Block, Protocol};
use bulge_measurements::{Data, MeasurementError, ReadOptions};
#[cfg(feature = "meshes")]
use bulge_membrane::{Mesh, case::Case};
use bulge_muscles::{Dimension, FileError, Force, Length, Parameter, Pressure, from_toml, to_toml, units};
#[cfg(any(feature = "sweeps", feature = "decisions"))]
use bulge_muscles::{Muscle, PRESETS, preset};
use bulge_numerics::{Dual, Real};
#[cfg(feature = "sweeps")]
use bulge_sweep::Plan;
use bulge_table::{Table, TableError, crc64};
use std::io::{Cursor, Write};
#[cfg(any(feature = "sweeps", feature = "meshes"))]
use std::path::Path;
use std::path::PathBuf;
use std::sync::OnceLock;
use zip::write::{SimpleFileOptions, ZipWriter};

#[path = "../../crates/measurements/tests/all/asked.rs"]
mod asked;

/// Most rows of a data set all of whose methods are called.
const MOST_ROWS: usize = 20_000;
/// Most rows of a protocol that are laid out.
#[cfg(feature = "decisions")]
const MOST_POINTS: u64 = 10_000;

/// Text, CSV in every dialect, Excel and MATLAB: the reader decides by the bytes.
pub(crate) fn measurements(bytes: &[u8]) {
    let Some((choice, bytes)) = bytes.split_first() else { return };
    let options = ReadOptions {
        l0_m: (choice & 1 > 0).then_some(0.3),
        force_may_lack: choice & 2 > 0,
        pull: if choice & 4 > 0 { vec![[0.01, 3e-3], [0.1, 2e-3], [0.2, 1e-3]] } else { Vec::new() },
        ..ReadOptions::default()
    };
    found(Data::from_bytes(bytes, "any.csv", &options));
}

fn found(data: Result<Data, MeasurementError>) {
    match data {
        Ok(data) if data.len() <= MOST_ROWS && data.has_force() => asked::ask(&data),
        Ok(_) => {}
        Err(error) => asked::complete(&error),
    }
}

/// Cells of a workbook of Excel. Its archive is made here: a changed byte of a compressed one would only break its checksum.
pub(crate) fn sheets(bytes: &[u8]) {
    const TYPES: &str = r#"<?xml version="1.0"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="xml" ContentType="application/xml"/></Types>"#;
    const RELATIONS: &str = r#"<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="rId1" Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/officeDocument" Target="xl/workbook.xml"/></Relationships>"#;
    const BOOK: &str = r#"<?xml version="1.0"?><workbook xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main" xmlns:r="http://schemas.openxmlformats.org/officeDocument/2006/relationships"><sheets><sheet name="loops" sheetId="1" r:id="rId1"/></sheets></workbook>"#;
    const SHEETS: &str = r#"<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="rId1" Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/worksheet" Target="worksheets/sheet1.xml"/></Relationships>"#;
    let parts: [(&str, &[u8]); 5] = [
        ("[Content_Types].xml", TYPES.as_bytes()),
        ("_rels/.rels", RELATIONS.as_bytes()),
        ("xl/workbook.xml", BOOK.as_bytes()),
        ("xl/_rels/workbook.xml.rels", SHEETS.as_bytes()),
        ("xl/worksheets/sheet1.xml", bytes),
    ];
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let plain = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    for (name, part) in parts {
        let written = archive.start_file(name, plain).map(|()| archive.write_all(part));
        assert!(matches!(written, Ok(Ok(()))), "the archive can't be written");
    }
    let Ok(archive) = archive.finish() else { return };
    found(Data::from_bytes(archive.get_ref(), "any.xlsx", &ReadOptions::default()));
}

/// Parquet is read from a file.
pub(crate) fn parquet(bytes: &[u8]) {
    static FILE: OnceLock<Option<PathBuf>> = OnceLock::new();
    let file = FILE.get_or_init(|| Some(tempfile::tempdir().ok()?.keep().join("any.parquet")));
    let Some(file) = file else { return };
    assert!(std::fs::write(file, bytes).is_ok(), "{} can't be written", file.display());
    found(Data::read(&[file]));
}

/// A message about a text file is complete and bounded.
fn refused(error: &FileError) {
    let message = error.to_string();
    assert!(!message.is_empty() && message.len() < 8000 && !message.contains('\u{1b}'), "{message:?}");
}

fn text(bytes: &[u8], read: impl FnOnce(&str) -> Result<(), FileError>) {
    if let Ok(text) = std::str::from_utf8(bytes)
        && let Err(error) = read(text)
    {
        refused(&error);
    }
}

/// A muscle that was read is the same after it was written and read again.
pub(crate) fn muscles(bytes: &[u8]) {
    text(bytes, |text| {
        let muscle = from_toml(text, "any.toml")?;
        let written = to_toml(&muscle);
        let again = from_toml(&written, "written.toml");
        let same = again.as_ref().is_ok_and(|again| {
            Parameter::ALL.iter().all(|parameter| {
                let both = [&muscle, again].map(|muscle| muscle.get(*parameter).unwrap_or(0.0));
                (both[0] - both[1]).abs() <= 1e-12 * both[0].abs()
            })
        });
        assert!(same, "{muscle:?}\n{written}\n{again:?}");
        Ok(())
    });
}

pub(crate) fn effects(bytes: &[u8]) {
    text(bytes, |text| {
        let effects = user::from_toml(text, "any.toml")?;
        assert!(!effects.is_empty() && effects.iter().all(|effect| !effect.name.is_empty()));
        Ok(())
    });
}

/// A formula's value doesn't depend on whether its derivatives are asked for, and what it says of itself reads as the same formula.
pub(crate) fn formulas(bytes: &[u8]) {
    let Some((choice, bytes)) = bytes.split_first() else { return };
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let parameters = [("k", Dimension::FORCE), ("a", Dimension::NONE), ("d", Dimension::PRESSURE)];
    let variables: &'static [_] = if choice & 1 > 0 { &SHAPE_VARIABLES } else { &VARIABLES };
    let result = if choice & 2 > 0 { Dimension::NONE } else { Dimension::FORCE };
    match Expression::parse_over(text, variables, &parameters, result) {
        Ok(formula) => {
            let number = |i: usize| 0.3 + 0.17 * i as f64;
            let [variables, parameters] =
                [variables.len(), 3].map(|n| (0..n).map(number).collect::<Vec<_>>());
            let value = formula.evaluate(&variables, &parameters);
            let dual = |numbers: &[f64]| -> Vec<Dual<1>> {
                numbers.iter().map(|number| Dual::variable(*number, 0)).collect()
            };
            let with = formula.evaluate(&dual(&variables), &dual(&parameters));
            // Powers and quotients are taken another way with their derivatives, and the tangent of ten thousand radians shows the last
            // digit of each: as far as it moves with those of the numbers, it isn't known.
            let (one, two) = (value, with.value());
            // Each by a part of its own, so that nothing cancels.
            let beside = |numbers: &[f64], digit: f64| -> Vec<f64> {
                numbers
                    .iter()
                    .enumerate()
                    .map(|(i, number)| number * (1.0 + digit * (1 + i) as f64))
                    .collect()
            };
            let moved = formula.evaluate(&beside(&variables, 1e-15), &beside(&parameters, -1e-15));
            let unknown = (one - moved).abs();
            assert!(
                (one - two).abs() <= 1e-12 * one.abs() + 10.0 * unknown
                    || one.to_bits() == two.to_bits()
                    || !one.is_finite() && !two.is_finite(),
                "{text}: {value} and {with:?}"
            );
        }
        Err(error) => {
            let message = error.to_string();
            assert!(!message.is_empty() && message.len() < 8000, "{message}");
        }
    }
}

#[cfg(any(feature = "sweeps", feature = "decisions"))]
fn muscle() -> Option<&'static Muscle> {
    static MUSCLE: OnceLock<Option<Muscle>> = OnceLock::new();
    MUSCLE.get_or_init(|| preset(PRESETS[0].name).ok()).as_ref()
}

/// Where muscles and meshes that a file names are looked up: nowhere.
#[cfg(any(feature = "sweeps", feature = "meshes"))]
fn nowhere() -> &'static Path {
    Path::new("/nonexistent/folder")
}

#[cfg(feature = "sweeps")]
pub(crate) fn sweeps(bytes: &[u8]) {
    let Some(muscle) = muscle() else { return };
    text(bytes, |text| {
        let plan = Plan::with_muscle(text, "any.toml", muscle)?;
        assert!(plan.points() > 0 || plan.table.is_some());
        Ok(())
    });
}

#[cfg(feature = "decisions")]
pub(crate) fn protocols(bytes: &[u8]) {
    let Some(muscle) = muscle() else { return };
    text(bytes, |text| {
        let protocol = Protocol::from_toml(text, "any.toml")?;
        let rows = |block: &Block| {
            let levels = block.pressures_pa.len().max(block.held.len()) as u64;
            let each = u64::from(block.rows) * u64::from(block.cycles.max(1));
            each * levels * u64::from(block.repeats) * u64::from(block.specimens)
        };
        if protocol.blocks.iter().map(rows).fold(0, u64::saturating_add) <= MOST_POINTS
            && let Ok(record) = protocol.moments(muscle)
        {
            assert!(record.moments().iter().all(|moment| moment.contraction.is_finite()));
        }
        Ok(())
    });
}

#[cfg(feature = "sweeps")]
pub(crate) fn joints(bytes: &[u8]) {
    text(bytes, |text| {
        Joint::from_toml(text, "any.toml", Some(nowhere()), Checks::Linkage, |_| Ok(())).map(|_| ())
    });
}

#[cfg(feature = "meshes")]
pub(crate) fn cases(bytes: &[u8]) {
    text(bytes, |text| Case::from_toml(text, "any.toml", Some(nowhere())).map(|_| ()));
}

/// A mesh that was read has cells of points that exist.
#[cfg(feature = "meshes")]
pub(crate) fn meshes(bytes: &[u8]) {
    match Mesh::from_bytes(bytes, "any.msh") {
        Ok(mesh) => {
            let points = mesh.nodes.len();
            assert!(mesh.nodes.iter().flatten().all(|x| x.is_finite()));
            for block in &mesh.blocks {
                assert!(block.cells.iter().all(|point| *point < points));
            }
        }
        Err(error) => {
            let message = error.to_string();
            assert!(!message.is_empty() && message.len() < 8000, "{message}");
        }
    }
}

/// A table whose checksum is set right, so that the rest of it is looked at: a damaged one answers or refuses, but never panics.
pub(crate) fn tables(bytes: &[u8]) {
    let _: Result<Table<'_>, TableError> = Table::from_bytes(bytes);
    let Some(body) = bytes.len().checked_sub(8) else { return };
    let mut whole = bytes[..body].to_vec();
    let (length, place) = (u32::try_from(bytes.len()), whole.get_mut(16..20));
    if let (Ok(length), Some(place)) = (length, place) {
        place.copy_from_slice(&length.to_le_bytes());
    }
    whole.extend(crc64(&whole).to_le_bytes());
    let Ok(table) = Table::from_bytes(&whole) else { return };
    let axes = (0..8).map_while(|i| table.axis(i)).count();
    let outputs = (0..64).map_while(|i| table.output(i)).count();
    let (mut values, mut gradients) = (vec![0.0; outputs], vec![0.0; outputs * axes]);
    for part in [0.0, 0.3, 0.99, 1.0] {
        let point: Vec<f64> = (0..axes)
            .map_while(|i| table.axis(i))
            .map(|axis| axis.low + part * (axis.high - axis.low))
            .collect();
        let _ = table.sample(&point, &mut values, &mut gradients);
        let _ = table.upper_end(&point);
    }
}

/// A quantity is a finite number, and a range has two of them.
pub(crate) fn units(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let value = units::parse::<Length>(text).map(bulge_muscles::Quantity::si);
    assert!(value.is_ok_and(f64::is_finite) || units::parse::<Length>(text).is_err());
    let _ = units::parse_with_width::<Pressure>(text);
    let _ = units::parse_list::<Force>(text);
    let _ = units::parse_range::<Pressure>(text);
    for parameter in Parameter::ALL {
        let _ = parameter.parse(text);
        let _ = parameter.parse_list(text);
    }
    let _ = text.parse::<bulge_measurements::ColumnMap>();
}

//! Times reading 10^6 rows from CSV and Parquet, the quality gate, and the search for repeats; it also
//! measures the peak memory. For comparison, the same run times the `csv` crate splitting the same file and
//! parsing its numbers, which is the minimum for any reader.
//!
//! It prints one line per task: name, seconds. The last line is the peak of the resident memory in MiB, if
//! the system reports it.

use bulge_benches::measured::{columns, csv};
use bulge_benches::{Failure, parquet, peak};
use bulge_measurements::{Columns, Data, QualityOptions};
use std::path::Path;
use std::time::Instant;

const ROWS: usize = 1_000_000;

fn timed<T>(name: &str, run: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
    let start = Instant::now();
    let found = run()?;
    println!("{name}\t{:.3}", start.elapsed().as_secs_f64());
    Ok(found)
}

fn ask(path: &Path) -> Result<(), Failure> {
    let kind = path.extension().unwrap_or_default().to_string_lossy().to_uppercase();
    let data = timed(&format!("read {kind}, {ROWS} rows"), || Ok(Data::read(&[path])?))?;
    let quality = timed("quality", || Ok(data.quality(&QualityOptions::default())))?;
    let repeats = timed("repeats", || Ok(data.repeats(0.11)))?;
    timed("history", || Ok(data.history(0.11)))?;
    println!("findings\t{}\ngroups of repeats\t{}", quality.findings.len(), repeats.groups().len());
    Ok(())
}

/// Seconds to split the file into fields and to parse those of the numeric columns.
fn plain(path: &Path) -> Result<f64, Failure> {
    let start = Instant::now();
    let bytes = std::fs::read(path)?;
    let mut reader = csv::Reader::from_reader(bytes.as_slice());
    let width = reader.headers()?.len();
    let mut columns: Vec<Vec<f64>> = vec![Vec::with_capacity(ROWS); width];
    let mut record = csv::StringRecord::new();
    while reader.read_record(&mut record)? {
        for (column, field) in columns.iter_mut().zip(&record) {
            column.push(field.parse().unwrap_or(f64::NAN));
        }
    }
    std::hint::black_box(&columns);
    Ok(start.elapsed().as_secs_f64())
}

/// Rows per second of the reader and of plain parsing, alternating; the best of five each.
fn against_plain(path: &Path) -> Result<(), Failure> {
    let (mut own, mut other) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..5 {
        let start = Instant::now();
        std::hint::black_box(Data::read(&[path])?);
        own = own.min(start.elapsed().as_secs_f64());
        other = other.min(plain(path)?);
    }
    let rate = |seconds: f64| ROWS as f64 / seconds;
    println!("read CSV, rows per second\t{:.3e}", rate(own));
    println!("the csv crate and parsing, rows per second\t{:.3e}", rate(other));
    println!("times as long\t{:.2}", own / other);
    Ok(())
}

fn write(folder: &Path) -> Result<(), Failure> {
    let columns: Columns = columns(ROWS)?;
    std::fs::write(folder.join("rows.csv"), csv(&columns))?;
    std::fs::write(folder.join("rows.parquet"), parquet(&columns)?)?;
    Ok(())
}

/// `load FOLDER` writes missing files in one run and reads them in the next, so that the memory is that of
/// reading alone.
fn main() -> Result<(), Failure> {
    let folder = std::env::args().nth(1).ok_or("name a folder for the files: load FOLDER")?;
    let folder = Path::new(&folder);
    if !folder.join("rows.parquet").exists() {
        write(folder)?;
        println!("the files are written: run the same command again");
        return Ok(());
    }
    for name in ["rows.csv", "rows.parquet"] {
        ask(&folder.join(name))?;
    }
    // This follows the memory measurement, so that it doesn't count.
    let peak = peak();
    against_plain(&folder.join("rows.csv"))?;
    if let Some(peak) = peak {
        println!("peak memory, MiB\t{peak}");
    }
    Ok(())
}

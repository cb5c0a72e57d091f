//! Times reading 10^6 rows from CSV and Parquet, the quality gate, and the search for repeats; and the largest memory of all.
//!
//! One line per question: name, seconds. The last line is the peak of the resident memory in MiB, where the system tells it.

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

fn write(folder: &Path) -> Result<(), Failure> {
    let columns: Columns = columns(ROWS)?;
    std::fs::write(folder.join("rows.csv"), csv(&columns))?;
    std::fs::write(folder.join("rows.parquet"), parquet(&columns)?)?;
    Ok(())
}

/// `load FOLDER` writes the files where they are missing, in one run, and reads them in the next: the memory is then that of reading.
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
    if let Some(peak) = peak() {
        println!("peak memory, MiB\t{peak}");
    }
    Ok(())
}

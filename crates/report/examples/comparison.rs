//! Writes the report of a simulated comparison with all its plots.
//!
//! `cargo run -p bulge-report --example comparison -- DIR [rich|bare|empty|crowded|hostile]`

#[path = "../tests/all/sample/mod.rs"]
mod sample;

use bulge_inference::Comparison;
use bulge_report::comparison::{html, plots};
use std::error::Error;
use std::path::PathBuf;

use sample::Recipe;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().ok_or("name the folder to write to")?);
    let of = |recipe: Recipe, comparison: Comparison| {
        let rows = sample::rows(&recipe, &comparison);
        (comparison, Some(rows))
    };
    let (comparison, rows) = match arguments.next().as_deref() {
        None | Some("rich") => of(Recipe::usual(), sample::rich(&Recipe::usual())),
        Some("bare") => of(Recipe::bare(), sample::bare()),
        Some("empty") => (sample::empty(), None),
        Some("crowded") => of(Recipe::crowded(), sample::crowded()),
        Some("hostile") => of(Recipe::hostile(), sample::hostile()),
        Some(other) => return Err(format!("there is no sample `{other}`").into()),
    };
    std::fs::create_dir_all(&folder)?;
    std::fs::write(folder.join("report.html"), html(&comparison, rows.as_ref())?)?;
    for plot in plots(&comparison)? {
        std::fs::write(folder.join(plot.name).with_extension("svg"), plot.svg)?;
    }
    Ok(())
}

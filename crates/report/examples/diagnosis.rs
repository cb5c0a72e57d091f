//! Writes reports of simulated diagnoses, one of each verdict and some around odd comparisons, with all their plots.
//!
//! `cargo run -p bulge-report --example diagnosis -- DIR`

#[path = "../tests/all/diagnosed/mod.rs"]
mod diagnosed;
#[path = "../tests/all/sample/mod.rs"]
mod sample;

use bulge_report::diagnosis::{html, plots};
use std::error::Error;
use std::path::PathBuf;

use sample::Recipe;

fn main() -> Result<(), Box<dyn Error>> {
    let into = PathBuf::from(std::env::args().nth(1).ok_or("name the folder to write to")?);
    let rich = sample::rich(&Recipe::usual());
    let usual = [
        ("missing", diagnosed::missing(rich.clone()), Some(Recipe::usual())),
        ("adequate", diagnosed::adequate(rich.clone()), Some(Recipe::usual())),
        ("unknown", diagnosed::unknown(rich), Some(Recipe::usual())),
    ];
    let odd = [
        ("cannot-tell", diagnosed::cannot_tell(sample::bare()), Some(Recipe::bare())),
        ("empty", diagnosed::cannot_tell(sample::empty()), None),
        ("crowded", diagnosed::missing(sample::crowded()), Some(Recipe::crowded())),
        ("hostile", diagnosed::missing(sample::hostile()), Some(Recipe::hostile())),
    ];
    for (name, mut diagnosis, recipe) in usual.into_iter().chain(odd) {
        diagnosis.rows = recipe.map(|recipe| sample::rows(&recipe, &diagnosis.comparison));
        let folder = into.join(name);
        std::fs::create_dir_all(&folder)?;
        std::fs::write(folder.join("report.html"), html(&diagnosis)?)?;
        for plot in plots(&diagnosis)? {
            std::fs::write(folder.join(plot.name).with_extension("svg"), plot.svg)?;
        }
    }
    Ok(())
}

//! Membrane finite elements against closed forms, against shooting, and against the meridian equation.

pub(crate) mod cloth;
pub(crate) mod discs;
pub(crate) mod muscles;
pub(crate) mod plates;
mod rig;
pub(crate) mod slack;
pub(crate) mod spheres;
pub(crate) mod tubes;

use bulge_membrane::case::{Case, Row};

use crate::check::Trouble;

/// Runs a case and returns its rows.
fn rows(text: &str) -> Result<Vec<Row>, Trouble> {
    let case = Case::from_toml(text, "case", None)?;
    let mut rows = Vec::new();
    case.start()?.last_row(|row| rows.push(row.clone()))?;
    Ok(rows)
}

/// Richardson extrapolation from one mesh and one twice as fine, for errors of fourth order.
fn extrapolated(coarse: f64, fine: f64) -> f64 {
    fine + (fine - coarse) / 15.0
}

const RUBBER: &str = "
[[material]]
name = \"rubber\"
law = \"neo-hooke\"
thickness = \"1 mm\"
shear = \"0.4 MPa\"
[[part]]
group = \"wall\"
kind = \"sheet\"
material = \"rubber\"
";

//! Example 4. How do I turn the bulge around in ParaView?
//!
//! A `Shape` is a value; a VTK file is a function of it. Expect `bulge.vtp` in a temporary folder, with pleats between 40 fibres.
//! Try next: `Style::Revolution`, another cloth, `write_series`.

use bulge::fibre::{Approach, Given, Problem};
use bulge::muscles::{Pressure, preset};
use bulge::vtk::{Bulge, Style, write_vtp};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let muscle = preset("ppam-2-r16")?;
    let problem = Problem::new(&muscle, Pressure::bar(2.0))?;
    let shape = problem.shape(Given::Contraction(0.25), Approach::Auto, 101)?;
    // The meridian starts and ends at the fittings.
    assert!((shape.meridian[0].r_m - 0.016).abs() < 1e-9 && shape.meridian.len() == 101);
    let style = Style::Pleats { cloth_circumference: Some(0.33) };
    let path = std::env::temp_dir().join("bulge.vtp");
    write_vtp(&path, &Bulge { shape: &shape, fibres: 40, style, facets: style.default_facets() })?;
    println!("open {} in ParaView", path.display());
    Ok(())
}

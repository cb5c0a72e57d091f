//! Shape, force and volume of pneumatic artificial muscles: the library that other Rust projects depend on.
//!
//! It re-exports the crates of Bulge; each is documented where it lives:
//!
//! - [`muscles`] says what a muscle is; units, TOML files, presets,
//! - [`fibre`] how it balances; shape, force, volume, derivatives,
//! - [`measurements`] what was seen; CSV and Parquet files, sweeps, a quality gate,
//! - [`effects`] what acts; the catalogue of physical effects and force laws,
//! - [`model`] what it predicts along a measured history,
//! - [`inference`] whether that matches; fits and the ladder of errors,
//! - [`design`] puts them to use; sizing, joints, air, sensing, heat,
//! - [`sweep`] runs families of muscles over their parameters, and makes certified tables of them,
//! - [`table`] looks such tables up, without std,
//! - [`vtk`] what it looks like in ParaView,
//! - [`report`] draws plots,
//! - [`numerics`] has the integrator, elliptic integrals, dual numbers.
//!
//! ```
//! use bulge::fibre::{Approach, Given, Problem};
//! use bulge::muscles::{Pressure, preset};
//!
//! // The second-generation PPAM at 1 bar, contracted by 20 %.
//! let muscle = preset("ppam-2-r16")?;
//! let problem = Problem::new(&muscle, Pressure::bar(1.0))?;
//! let response = problem.solve(Given::Contraction(0.2), Approach::Auto)?;
//! assert_eq!(format!("{:.1} N", response.force_n), "544.0 N");
//! assert_eq!(format!("{:.1} ml", 1e6 * response.volume_m3), "376.9 ml");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub use bulge_design as design;
pub use bulge_effects as effects;
pub use bulge_fibre as fibre;
pub use bulge_inference as inference;
pub use bulge_measurements as measurements;
pub use bulge_membrane as membrane;
pub use bulge_model as model;
pub use bulge_muscles as muscles;
pub use bulge_numerics as numerics;
pub use bulge_report as report;
pub use bulge_sweep as sweep;
pub use bulge_table as table;
pub use bulge_vtk as vtk;

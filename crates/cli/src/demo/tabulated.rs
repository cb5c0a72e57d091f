//! The part of the tour with a table: a family of muscles, and the error of lookups.

use bulge_fibre::{Approach, Given, Problem};
use bulge_muscles::{Parameter, Pressure, Quantity, preset};
use bulge_sweep::{Plan, TableDescription, tabulate};
use bulge_table::Table;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use crate::arguments::about;
use crate::failure::Failure;
use crate::files;
use crate::table::errors;
use crate::text::{significant, table};

/// The sweep file of the tour.
const FAMILY: (&str, &str) = ("family.toml", include_str!("../../data/family.toml"));
/// Contraction and slenderness of the lookups shown.
const POINTS: [[f64; 2]; 3] = [[0.05, 6.875], [0.2, 6.875], [0.35, 20.0]];

/// Builds the table, writes it, and shows a few lookups beside the solutions.
pub(super) fn tabulated(
    out: &Path,
    text: &mut String,
    written: &mut Vec<PathBuf>,
) -> Result<TableDescription, Failure> {
    let plan = Plan::from_toml(FAMILY.1, FAMILY.0, None)?;
    let missing = || Failure::Value { option: "demo", what: format!("{} asks for no table", FAMILY.0) };
    let wish = plan.table.as_ref().ok_or_else(missing)?;
    let built = tabulate(&plan, wish, &|_| ())?;
    let found = Table::from_bytes(&built.bytes)?;
    let description = TableDescription::of(&found)?;
    for (name, content) in [(FAMILY.0, FAMILY.1.as_bytes()), ("family.bulge", &built.bytes)] {
        let path = out.join(name);
        files::write(&path, content)?;
        written.push(path);
    }
    let _ = writeln!(
        text,
        "5. All muscles of that kind with l0/R from 2 to 100 in one table of {} bytes, for controllers without an operating system\n",
        description.bytes
    );
    text.push_str(&errors(&description));
    text.push('\n');
    let heading = ["contraction", "l0/R", "looked up [N]", "solved [N]"].map(String::from).to_vec();
    let mut rows = vec![heading];
    let lookup = found.lookup::<2, 2>()?;
    let (base, pressure) = (preset("ppam-2-r16")?, Pressure::bar(1.0));
    for [contraction, slenderness] in POINTS {
        let length = base.length().si();
        let muscle = base
            .with(Parameter::Radius, length / slenderness)
            .map_err(|error| Failure::Value { option: "demo", what: error.to_string() })?;
        let problem = Problem::new(&muscle, pressure).map_err(about(&muscle, pressure))?;
        let solved = problem.solve(Given::Contraction(contraction), Approach::Auto);
        let solved = solved.map_err(about(&muscle, pressure))?.force_n;
        // F = p l0^2 a f, a = (n/2 pi) sin(2 pi/n).
        let n = muscle.fibres().map_or(f64::INFINITY, f64::from);
        let scale = pressure.si() * length * length * (n / TAU) * (TAU / n).sin();
        let outside = || Failure::Outside(format!("contraction {contraction} lies outside the table"));
        let [force, _] = lookup.at([contraction, slenderness]).ok_or_else(outside)?;
        rows.push(vec![
            format!("{} %", 100.0 * contraction),
            significant(slenderness, 4),
            significant(scale * force.value, 8),
            significant(solved, 8),
        ]);
    }
    text.push_str(&table(&rows));
    text.push('\n');
    Ok(description)
}

//! `bulge table export`, `joint` and `papers`: tables for other programs.

use bulge_design::joint::{Checks, JOINT_EXAMPLE};
use bulge_muscles::{FileError, Ratio};
use bulge_sweep::export::{self, papers_polynomial, polynomial};
use bulge_sweep::{JointField, JointTable, TableDescription, build};
use bulge_table::Table;
use clap::{Args, ValueEnum};
use serde_json::json;
use std::fmt::Write;
use std::path::PathBuf;

use super::{errors, read};
use crate::arguments::{Json, pretty, range};
use crate::diagnose::paragraph::paragraph;
use crate::failure::Failure;
use crate::files;
use crate::text::{shown, significant, table as columns};

/// What a table can become.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Form {
    /// A Rust module with the table as a constant, for `bulge-table`
    Rust,
    /// A C99 header with the table and its lookup, without dependencies
    C,
    /// A regular grid of values and derivatives
    Csv,
    /// Everything, with the coefficients
    Json,
    /// Force and volume polynomials of one slenderness, in the form of S1 eqs. 31 and 32
    Polynomial,
}

#[derive(Debug, Args)]
pub(super) struct Export {
    /// A table, as `bulge sweep` writes it
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// What it becomes
    #[arg(long, value_enum)]
    to: Form,
    /// File to write [default: standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Rust and C: what the table is called
    #[arg(long, default_value = "BULGE_TABLE")]
    name: String,
    /// CSV: points along each axis
    #[arg(long, default_value_t = 51)]
    points: usize,
    /// Polynomials: l0/R, where the table has this axis
    #[arg(long)]
    slenderness: Option<f64>,
    /// Polynomials: number of fibres [default: a closed membrane]
    #[arg(long)]
    fibres: Option<u32>,
    /// Polynomials: range of the fit
    #[arg(long, default_value = "5 %..35 %")]
    contraction: String,
}

impl Export {
    pub(super) fn run(&self) -> Result<String, Failure> {
        if let Some(out) = &self.out {
            files::are_apart(&[("--out", out)], &[("the table", &self.file)])?;
            files::can_be_written(out)?;
        }
        let bytes = read(&self.file)?;
        let table = Table::from_bytes(&bytes)?;
        let text = match self.to {
            Form::Rust => export::rust_source(&table, &self.name)?,
            Form::C => export::c_header(&table, &self.name)?,
            Form::Csv => export::csv(&table, self.points)?,
            Form::Json => pretty(&export::json(&table))?,
            Form::Polynomial => {
                let percent = range::<Ratio>("--contraction", &self.contraction)?.map(|end| 100.0 * end);
                let found = papers_polynomial(&table, self.slenderness, self.fibres, percent)?;
                pretty(&found)?
            }
        };
        let Some(path) = &self.out else { return Ok(text) };
        files::wrote(Some(path), || Ok(text))
    }
}

#[derive(Debug, Args)]
#[command(after_long_help = example())]
pub(super) struct JointCommand {
    /// Two antagonistic muscles on a pulley or lever: a TOML file (`bulge table joint --help` has an example with every key)
    #[arg(value_name = "JOINT.toml")]
    joint: PathBuf,
    /// Table to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    json: Json,
}

fn example() -> String {
    shown("A joint file", JOINT_EXAMPLE)
}

impl JointCommand {
    pub(super) fn run(&self) -> Result<String, Failure> {
        let wanted = JointTable::read(&self.joint, Checks::Everywhere)?;
        let (joint, Some(wish)) = (&wanted.joint, &wanted.table) else {
            let origin = self.joint.display().to_string();
            let what = "the joint wants no table";
            return Err(FileError::whole(&origin, what, "add a line `[table]`").into());
        };
        let muscles: Vec<String> =
            joint.muscles().iter().map(|side| bulge_muscles::to_toml(side.muscle())).collect();
        let text = json!({
            "schema": "bulge.table/1",
            "version": env!("CARGO_PKG_VERSION"),
            "name": joint.name,
            "joint": wanted,
            "muscles": muscles,
            "meaning": [
                "a positive angle shortens the agonist; torque without load",
                "stiffness = -d(torque)/d(angle) at constant pressures",
            ],
        });
        let field = JointField::new(&wanted);
        let built = build(&field, &wish.with_text(serde_json::to_string(&text)?), &|_| ())
            .map_err(bulge_sweep::TabulateError::from)?;
        let description = TableDescription::of(&Table::from_bytes(&built.bytes)?)?;
        files::write(&self.out, &built.bytes)?;
        self.json.or(&description, || self.text(&joint.name, &description, built.is_met))
    }

    fn text(&self, name: &str, description: &TableDescription, is_met: bool) -> String {
        let mut out = format!("{name}\n\n  {}, {} bytes\n", description.form, description.bytes);
        out.push_str(&errors(description));
        if !is_met {
            out.push_str("  ! the size limit came first: the tolerance is not met\n");
        }
        let _ = writeln!(out, "  wrote {}", self.out.display());
        out
    }
}

/// The papers' own polynomials beside what they were fitted to.
#[derive(Debug, Args)]
pub(super) struct Papers {
    #[command(flatten)]
    json: Json,
}

impl Papers {
    pub(super) fn run(&self) -> Result<String, Failure> {
        let found = polynomial::s1_tables()?;
        if self.json.wanted {
            return pretty(&found);
        }
        let mut out = String::from("S1 Table 1: force in N at 1 bar and l0 = 110 mm\n\n");
        let mut rows = vec![["contraction", "printed", "computed", "difference"].map(String::from).to_vec()];
        rows.extend(found.force.rows.iter().map(|row| {
            vec![
                format!("{} %", row.percent),
                significant(row.printed, 5),
                significant(row.computed, 5),
                significant(row.printed - row.computed, 3),
            ]
        }));
        out.push_str(&columns(&rows));
        for sentence in &found.sentences {
            out.push('\n');
            paragraph(&mut out, "  ", sentence);
        }
        Ok(out)
    }
}

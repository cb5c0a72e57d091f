//! What a run tells of its states: the JSON document, and tables as CSV.

use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

use super::{CaseRun, Row};
use crate::state::Effort;

/// Files of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Written<'a> {
    /// The folder, if files were written.
    pub folder: Option<&'a Path>,
    /// The file that lists the states.
    pub pvd: Option<&'a Path>,
    /// Time for which the run waited for its files, s.
    pub seconds: f64,
}

/// The JSON document of a run.
#[derive(Debug, Serialize)]
pub struct CaseDocument<'a, E> {
    schema: &'static str,
    name: &'a str,
    folder: Option<&'a Path>,
    nodes: usize,
    elements: usize,
    unknowns: usize,
    matrix_entries: usize,
    factor_entries: usize,
    effort: EffortDocument,
    writing_s: f64,
    pvd: Option<&'a Path>,
    effect: Option<E>,
    states: &'a [Row],
}

#[derive(Debug, Serialize)]
struct EffortDocument {
    iterations: usize,
    factorisations: usize,
    elements_s: f64,
    factors_s: f64,
    solving_s: f64,
}

impl From<Effort> for EffortDocument {
    fn from(effort: Effort) -> Self {
        Self {
            iterations: effort.iterations,
            factorisations: effort.factorisations,
            elements_s: effort.assembling.as_secs_f64(),
            factors_s: effort.factorising.as_secs_f64(),
            solving_s: effort.solving.as_secs_f64(),
        }
    }
}

impl CaseRun<'_> {
    /// The JSON document of the states so far. `effect` is what was learnt from them, if anything.
    #[must_use]
    pub fn document<'a, E: Serialize>(
        &'a self,
        states: &'a [Row],
        written: Written<'a>,
        effect: Option<E>,
    ) -> CaseDocument<'a, E> {
        let [unknowns, matrix_entries, factor_entries] = self.sizes();
        CaseDocument {
            schema: "bulge.membrane/1",
            name: &self.case.name,
            folder: written.folder,
            nodes: self.case.mesh.nodes.len(),
            elements: self.elements(),
            unknowns,
            matrix_entries,
            factor_entries,
            effort: self.effort().into(),
            writing_s: written.seconds,
            pvd: written.pvd,
            effect,
            states,
        }
    }
}

/// All states with their units, as CSV.
#[must_use]
pub fn states_csv(rows: &[Row]) -> String {
    let mut text = String::from(
        "state,step,pressure [Pa],contraction,force [N],volume [m^3],largest_diameter [m],taut,wrinkled,slack,\
         membrane_force_min [N/m],membrane_force_max [N/m],fibre_tension_min [N],fibre_tension_max [N],energy [J],unstable,\
         iterations,residual\n",
    );
    for row in rows {
        let maybe = |x: Option<f64>| x.map_or_else(String::new, |x| x.to_string());
        // Writing to a String can't fail.
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{:e}",
            row.state,
            row.step,
            row.pressure,
            maybe(row.contraction),
            maybe(row.force),
            row.volume,
            row.diameter,
            row.taut,
            row.wrinkled,
            row.slack,
            row.forces[0],
            row.forces[1],
            row.threads[0],
            row.threads[1],
            row.energy,
            row.unstable,
            row.iterations,
            row.residual
        );
    }
    text
}

/// The states in the format of measurements, if some have a pressure, a contraction and a force.
#[must_use]
pub fn forces_csv(rows: &[Row]) -> Option<String> {
    let mut text = String::from("pressure [Pa],contraction,force [N],diameter [m],volume [m^3]\n");
    for row in rows.iter().filter(|row| row.pressure > 0.0) {
        let (contraction, force) = (row.contraction?, row.force?);
        let _ = writeln!(text, "{},{contraction},{force},{},{}", row.pressure, row.diameter, row.volume);
    }
    (text.lines().count() > 1).then_some(text)
}

//! A case run: state after state, each an equilibrium.

use bulge_muscles::FileError;
use serde::Serialize;
use thiserror::Error;

use super::{Case, Filling, Step};
use crate::error::MembraneError;
use crate::fields::Fields;
use crate::load::{Gas, Inflation, Load};
use crate::solver::Solver;
use crate::state::{Effort, State};
use crate::structure::{Fitting, Structure};

/// Why a case gives no next state.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CaseError {
    /// The case doesn't make a structure.
    #[error("{0}")]
    Structure(#[from] MembraneError),
    /// No equilibrium was found; those before stand.
    #[error("state {state} (step {step}): {source}")]
    State {
        /// Step, from 1.
        step: usize,
        /// State, from 1.
        state: usize,
        /// What went wrong.
        source: MembraneError,
    },
}

/// One state in numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// State, from 1.
    pub state: usize,
    /// Step that it belongs to, from 1.
    pub step: usize,
    /// Gauge pressure, Pa.
    #[serde(rename = "pressure_pa")]
    pub pressure: f64,
    /// Volume, m^3.
    #[serde(rename = "volume_m3")]
    pub volume: f64,
    /// Contraction, where the case has a length.
    pub contraction: Option<f64>,
    /// Force on the last fitting along z, N: what the muscle pulls with.
    #[serde(rename = "force_n")]
    pub force: Option<f64>,
    /// Largest diameter, m.
    #[serde(rename = "largest_diameter_m")]
    pub diameter: f64,
    /// Shares of the sheets that are taut, wrinkled and slack.
    pub taut: f64,
    /// See `taut`.
    pub wrinkled: f64,
    /// See `taut`.
    pub slack: f64,
    /// Smallest and largest principal force of the sheets, N/m.
    #[serde(rename = "membrane_force_n_per_m")]
    pub forces: [f64; 2],
    /// Smallest and largest tension of a thread, N.
    #[serde(rename = "fibre_tension_n")]
    pub threads: [f64; 2],
    /// Stored energy, J.
    #[serde(rename = "energy_j")]
    pub energy: f64,
    /// Directions in which the energy falls: above 0 the equilibrium is unstable.
    pub unstable: usize,
    /// Iterations.
    pub iterations: usize,
    /// Residual over the forces at a node.
    pub residual: f64,
}

/// A case on its way.
pub struct CaseRun<'a> {
    case: &'a Case,
    solver: Solver,
    last: State,
    /// Prescribed places and forces.
    fittings: Vec<f64>,
    /// The step under way: its number, its load at the beginning and at the end, and the states made.
    at: usize,
    made: usize,
    under_way: Option<(Load, Load)>,
    states: usize,
}

impl Case {
    /// The structure, ready to be loaded.
    ///
    /// # Errors
    /// If the mesh has an element without area, an edge of a cyclic sector without partner, or nothing that can move.
    pub fn start(&self) -> Result<CaseRun<'_>, CaseError> {
        let fittings: Vec<Fitting> = self.fittings.iter().map(|(_, fitting)| *fitting).collect();
        let structure = Structure::new(&self.mesh, &self.parts, &self.supports, &fittings)?;
        let mut solver = Solver::new(structure, self.copies, self.tolerance)?;
        let last = solver.at_rest();
        Ok(CaseRun {
            case: self,
            solver,
            last,
            fittings: vec![0.0; fittings.len()],
            at: 0,
            made: 0,
            under_way: None,
            states: 0,
        })
    }

    /// States that it asks for.
    #[must_use]
    pub fn states(&self) -> usize {
        self.steps.iter().map(|step| step.states).sum()
    }

    /// As [`FileError`], for a case that makes no structure.
    #[must_use]
    pub fn refused(origin: &str, error: &CaseError) -> FileError {
        FileError::whole(origin, error.to_string(), "mend the mesh or the case")
    }
}

impl CaseRun<'_> {
    /// The solver: sizes and effort.
    #[must_use]
    pub fn effort(&self) -> Effort {
        self.solver.effort()
    }

    /// Unknowns, numbers of the stiffness matrix and of its factors.
    #[must_use]
    pub fn sizes(&self) -> [usize; 3] {
        let (matrix, factors) = self.solver.sizes();
        [self.solver.structure().unknowns(), matrix, factors]
    }

    /// Elements.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.solver.structure().elements()
    }

    /// The next state; `None` after the last. `seen` is told each equilibrium on the way with its share of it.
    ///
    /// # Errors
    /// [`CaseError::State`]; the states before stand, and the run ends.
    pub fn advance(
        &mut self,
        seen: impl FnMut(f64, &State),
    ) -> Option<Result<(Row, State, Fields), CaseError>> {
        let step = self.case.steps.get(self.at)?;
        if self.under_way.is_none() {
            if step.is_restart {
                self.last = self.solver.at_rest();
                self.fittings.fill(0.0);
            }
            self.under_way = Some(self.loads(step));
        }
        let (begin, end) = self.under_way.clone()?;
        let share = |made: usize| made as f64 / step.states as f64;
        let (from, to) = (begin.towards(&end, share(self.made)), begin.towards(&end, share(self.made + 1)));
        self.states += 1;
        match self.solver.follow(&from, &self.last, &to, seen) {
            Ok(state) => {
                self.made += 1;
                let row_step = self.at + 1;
                if self.made == step.states {
                    self.fittings.clone_from(&end.fittings);
                    (self.at, self.made, self.under_way) = (self.at + 1, 0, None);
                }
                let fields = self.solver.fields(&state);
                let row = self.row(row_step, &state, &fields);
                self.last = state.clone();
                Some(Ok((row, state, fields)))
            }
            Err(source) => {
                let step = self.at + 1;
                self.at = self.case.steps.len();
                Some(Err(CaseError::State { step, state: self.states, source }))
            }
        }
    }

    /// All states; the row of the last.
    ///
    /// # Errors
    /// As [`Self::advance`].
    pub fn last_row(&mut self, mut seen: impl FnMut(&Row)) -> Result<Row, CaseError> {
        let mut last = Err(CaseError::Structure(MembraneError::NothingMoves));
        while let Some(next) = self.advance(|_, _| ()) {
            let (row, _, _) = next?;
            seen(&row);
            last = Ok(row);
        }
        last
    }

    /// The last equilibrium.
    #[must_use]
    pub fn last(&mut self) -> (&State, Fields) {
        let fields = self.solver.fields(&self.last);
        (&self.last, fields)
    }

    /// The loads at the beginning and at the end of a step, in the same kind of inflation.
    fn loads(&self, step: &Step) -> (Load, Load) {
        let (begin, end) = match step.filling {
            Filling::Pressure(p) => (Inflation::Pressure(self.last.pressure), Inflation::Pressure(p)),
            Filling::Volume(v) => (Inflation::Volume(self.last.volume), Inflation::Volume(v)),
            Filling::Closed { gamma, ambient } => {
                let gas = Gas::filling(self.last.volume, self.last.pressure, ambient, gamma);
                (Inflation::Gas(gas), Inflation::Gas(gas))
            }
        };
        let fittings =
            self.fittings.iter().zip(&step.fittings).map(|(before, now)| now.unwrap_or(*before)).collect();
        (Load { inflation: begin, fittings: self.fittings.clone() }, Load { inflation: end, fittings })
    }

    fn row(&self, step: usize, state: &State, fields: &Fields) -> Row {
        let summary = fields.summary();
        let along = self.case.copies.along;
        let distance = match state.fittings[..] {
            [] => None,
            [only] => Some(only),
            [first, .., last] => Some(last - first),
        };
        let contraction =
            self.case.length.and_then(|length| distance.map(|distance| 0.0 - along * distance / length));
        let [taut, wrinkled, slack] = summary.shares;
        Row {
            state: self.states,
            step,
            pressure: state.pressure,
            volume: state.volume,
            contraction,
            force: state.forces.last().copied(),
            diameter: 2.0 * summary.radius,
            taut,
            wrinkled,
            slack,
            forces: summary.forces,
            threads: summary.threads,
            energy: state.energy,
            unstable: state.unstable,
            iterations: state.iterations,
            residual: state.residual,
        }
    }
}

//! Runs a case: a sequence of states, each an equilibrium.

use bulge_muscles::Fault;
use serde::Serialize;
use thiserror::Error;

use super::{Case, Filling, Step};
use crate::element::Vector;
use crate::error::MembraneError;
use crate::fields::Fields;
use crate::load::{Gas, Inflation, Load};
use crate::solver::Solver;
use crate::state::{Effort, State};
use crate::structure::{Fitting, Structure};

/// Reasons why a case has no next state.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CaseError {
    /// The case doesn't define a valid structure.
    #[error("{0}")]
    Structure(#[from] MembraneError),
    /// No equilibrium was found; the earlier states remain valid.
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

impl CaseError {
    /// The kind of the error: wrong input, no solution, or a search that failed.
    #[must_use]
    pub const fn fault(&self) -> Fault {
        match self {
            Self::State {
                source:
                    MembraneError::LimitPoint { .. }
                    | MembraneError::Collapsed { .. }
                    | MembraneError::Overstretched { .. },
                ..
            } => Fault::NoSolution,
            Self::Structure(_) | Self::State { source: MembraneError::NoGas { .. }, .. } => Fault::Input,
            Self::State { .. } => Fault::NotConverged,
        }
    }
}

/// The results of one state.
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
    /// Contraction, if the case has a length.
    pub contraction: Option<f64>,
    /// Force that pulls the ends together, N: the pulling force of the muscle.
    #[serde(rename = "force_n")]
    pub force: Option<f64>,
    /// Largest diameter, m.
    #[serde(rename = "largest_diameter_m")]
    pub diameter: f64,
    /// Fraction of the sheets that is taut; the next two fields are those wrinkled and slack.
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
    /// Number of directions in which the energy decreases: above 0 the equilibrium is unstable.
    pub unstable: usize,
    /// Iterations.
    pub iterations: usize,
    /// Residual relative to the forces at a node.
    pub residual: f64,
}

/// A case in progress.
pub struct CaseRun<'a> {
    pub(super) case: &'a Case,
    solver: Solver,
    last: State,
    /// The state before it in the same step.
    older: Option<State>,
    /// Whether that is the mesh at rest, from which nothing is remembered.
    is_fresh: bool,
    /// Prescribed positions and forces.
    fittings: Vec<f64>,
    /// The current step: its number, its load at the beginning and at the end, and the states done.
    at: usize,
    made: usize,
    under_way: Option<(Load, Load)>,
    states: usize,
    /// The last equilibrium on the way to a state that wasn't reached.
    rescued: Option<(usize, State)>,
}

impl Case {
    /// The structure, ready for loading.
    ///
    /// # Errors
    /// If the mesh has an element without area, if an edge of a cyclic sector has no partner, or if nothing
    /// can move.
    pub fn start(&self) -> Result<CaseRun<'_>, CaseError> {
        let fittings: Vec<Fitting> = self.fittings.iter().map(|(_, fitting)| *fitting).collect();
        let structure = Structure::new(&self.mesh, &self.parts, &self.supports, &fittings)?;
        let structure = structure.stopped(&self.mesh, &self.supports, &self.contacts)?;
        let structure = structure.resisting_bending(&self.mesh, &self.supports, &self.bending)?;
        let mut solver = Solver::new(structure, self.copies, self.tolerance)?;
        let last = solver.at_rest();
        Ok(CaseRun {
            case: self,
            solver,
            last,
            older: None,
            is_fresh: true,
            fittings: vec![0.0; fittings.len()],
            at: 0,
            made: 0,
            under_way: None,
            states: 0,
            rescued: None,
        })
    }

    /// Total number of states.
    #[must_use]
    pub fn states(&self) -> usize {
        self.steps.iter().map(|step| step.states).sum()
    }
}

impl CaseRun<'_> {
    /// The computational effort so far, on coarser meshes as well.
    #[must_use]
    pub fn effort(&self) -> Effort {
        self.solver.effort()
    }

    /// Number of unknowns, and of entries of the stiffness matrix and its factors.
    #[must_use]
    pub fn sizes(&self) -> [usize; 3] {
        let (matrix, factors) = self.solver.sizes();
        [self.solver.structure().unknowns(), matrix, factors]
    }

    /// Number of elements.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.solver.structure().elements()
    }

    /// The next state; `None` after the last one. `seen` is called with each equilibrium on the way and its
    /// fraction of the way.
    ///
    /// # Errors
    /// [`CaseError::State`]; the earlier states remain valid, and the run ends. [`Self::rescued`] returns the
    /// last equilibrium on the way.
    pub fn advance(
        &mut self,
        seen: impl FnMut(f64, &State),
    ) -> Option<Result<(Row, State, Fields), CaseError>> {
        let step = self.case.steps.get(self.at)?;
        self.states += 1;
        Some(self.attempt(step, seen).map_err(|source| {
            let step = self.at + 1;
            self.at = self.case.steps.len();
            CaseError::State { step, state: self.states, source }
        }))
    }

    fn attempt(
        &mut self,
        step: &Step,
        mut seen: impl FnMut(f64, &State),
    ) -> Result<(Row, State, Fields), MembraneError> {
        if self.under_way.is_none() {
            if step.is_restart {
                self.last = self.solver.at_rest();
                self.is_fresh = true;
                self.fittings.fill(0.0);
            }
            self.under_way = Some(self.loads(step)?);
        }
        let Some((begin, end)) = self.under_way.clone() else { return Err(MembraneError::nothing_moves()) };
        let share = |made: usize| made as f64 / step.states as f64;
        let (from, to) = (begin.towards(&end, share(self.made)), begin.towards(&end, share(self.made + 1)));
        let mut on_the_way = None;
        let followed = match self.nested(&to) {
            Some(state) => {
                seen(1.0, &state);
                Ok(state)
            }
            None => self.solver.follow_on(&from, (self.older.as_ref(), &self.last), &to, |share, state| {
                on_the_way = Some(state.clone());
                seen(share, state);
            }),
        };
        let state = followed.and_then(|state| self.upright(&state).map(|()| state));
        let state = match state {
            Ok(state) => state,
            Err(error) => {
                let sound = on_the_way.filter(|state| self.upright(state).is_ok());
                self.rescued = sound.map(|state| (self.at + 1, state));
                return Err(error);
            }
        };
        self.made += 1;
        let row_step = self.at + 1;
        if self.made == step.states {
            self.fittings.clone_from(&end.fittings);
            (self.at, self.made, self.under_way) = (self.at + 1, 0, None);
        }
        let fields = self.solver.fields(&state);
        let row = self.row(row_step, &state, &fields);
        let last = std::mem::replace(&mut self.last, state.clone());
        // The loads of a step are equally far from each other. A mesh at rest is no equilibrium.
        self.older = (self.made > 0 && last.iterations > 0).then_some(last);
        Ok((row, state, fields))
    }

    /// The first state of a mesh at rest, from that of a coarser one.
    fn nested(&mut self, load: &Load) -> Option<State> {
        // The tensions of inextensible threads belong to their elements.
        if !(std::mem::take(&mut self.is_fresh) && self.last.held.is_empty()) {
            return None;
        }
        let (coarse, effort) = self.case.coarsely(self.at)?;
        self.solver.effort += effort;
        let (places, state) = coarse?;
        let start = self.solver.placed(&places, state);
        self.solver.attempt(load, &start).ok().filter(|state| state.unstable == 0)
    }

    /// Positions of the nodes in a state, m.
    pub(super) fn places(&self, state: &State) -> Vec<Vector> {
        let mut places = Vec::new();
        self.solver.structure().dofs.places(&state.y, &mut places);
        places
    }

    /// Refuses a state whose ends have passed each other.
    fn upright(&self, state: &State) -> Result<(), MembraneError> {
        let Some(ends) = self.case.ends else { return Ok(()) };
        let left = ends.distance + ends.apart(&state.fittings);
        if left > 0.0 {
            return Ok(());
        }
        let what = format!("its ends have passed each other by {:.6} mm", -1e3 * left);
        Err(MembraneError::Collapsed { what })
    }

    /// If a state wasn't reached, the last equilibrium on the way to it, with the number of that state.
    pub fn rescued(&mut self) -> Option<(Row, State, Fields)> {
        let (step, state) = self.rescued.take()?;
        self.last = state.clone();
        let fields = self.solver.fields(&state);
        Some((self.row(step, &state, &fields), state, fields))
    }

    /// Computes all states and returns the row of the last one.
    ///
    /// # Errors
    /// As [`Self::advance`].
    pub fn last_row(&mut self, mut seen: impl FnMut(&Row)) -> Result<Row, CaseError> {
        let mut last = Err(CaseError::Structure(MembraneError::nothing_moves()));
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

    /// The loads at the beginning and at the end of a step, with the same kind of inflation.
    fn loads(&self, step: &Step) -> Result<(Load, Load), MembraneError> {
        let (begin, end) = match step.filling {
            Filling::Pressure(p) => (Inflation::Pressure(self.last.pressure), Inflation::Pressure(p)),
            Filling::Volume(v) => (Inflation::Volume(self.last.volume), Inflation::Volume(v)),
            Filling::Closed { gamma, ambient } => {
                let (volume, pressure) = (self.last.volume, self.last.pressure);
                if volume <= 0.0 || pressure + ambient <= 0.0 {
                    return Err(MembraneError::NoGas { volume, pressure: pressure + ambient });
                }
                let gas = Gas::filling(volume, pressure, ambient, gamma);
                (Inflation::Gas(gas), Inflation::Gas(gas))
            }
        };
        let now = self.fittings.iter().zip(&step.fittings);
        let mut fittings: Vec<f64> = now.map(|(before, now)| now.unwrap_or(*before)).collect();
        if let (Some(ends), Some(contraction), Some(length)) =
            (self.case.ends, step.contraction, self.case.length)
        {
            fittings[ends.moving] = ends.place(contraction, length, self.case.copies, &fittings);
        }
        Ok((Load { inflation: begin, fittings: self.fittings.clone() }, Load { inflation: end, fittings }))
    }

    fn row(&self, step: usize, state: &State, fields: &Fields) -> Row {
        let summary = fields.summary();
        let ends = self.case.ends;
        let contraction = ends.zip(self.case.length).map(|(ends, length)| {
            // Avoids -0.
            0.0 - self.case.copies.along * ends.apart(&state.fittings) / length
        });
        let [taut, wrinkled, slack] = summary.shares;
        Row {
            state: self.states,
            step,
            pressure: state.pressure,
            volume: state.volume,
            contraction,
            force: ends.map(|ends| ends.sign * state.forces[ends.moving]),
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

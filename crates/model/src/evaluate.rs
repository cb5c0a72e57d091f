//! A model along a history: the force of every row, with exact derivatives.

use bulge_effects::{self as effects, Action, Input, Jet, LANES, Moment, Setting, Stage};
use bulge_fibre::Parts;
use bulge_numerics::{Dual, Real};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::answer::SHAPE;
use crate::base::Equilibrium;
use crate::error::ModelError;
use crate::failure::{RowError, failure};
use crate::lattice::{FEWEST_NODES, Lattice, Span};
use crate::model::{AtRest, Base, Chosen, Model};
use crate::prediction::{Partly, Prediction};
use crate::record::Record;
use crate::row::NORMAL;
use crate::segment::{Task, segment};
use crate::solved::Asked;
use crate::strands::{self, Strands};
use crate::warm::{Held, Slots, Warm};

/// What is wanted of [`Model::evaluate`] besides the force.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Wanted {
    /// Derivatives by these parameters, by their place in [`Model::parameters`].
    pub parameters: Vec<usize>,
    /// Derivatives by the readings of pressure and contraction.
    pub readings: bool,
}

/// Rows handed to one core at a time, where nothing is remembered from row to row, and where each of them takes a search. Fixed, so that results
/// don't depend on the number of threads.
const CHUNK: [usize; 2] = [256, 8];
/// Evaluations that a lattice serves at least, where it is held.
const HELD_FOR: usize = 4;

/// Everything that stays the same for all rows of one evaluation that are of one muscle.
pub(crate) struct Run<'a> {
    pub(crate) model: &'a Model,
    /// Whose equilibria it solves, of the model's muscles.
    pub(crate) body: usize,
    pub(crate) theta: &'a [f64],
    pub(crate) setting: Setting,
    pub(crate) strands: Strands,
    /// Parameters that change the shape, in the order of the answers' derivatives.
    shapes: Vec<usize>,
    pub(crate) equilibrium: Option<Equilibrium>,
    pub(crate) lattice: Option<Arc<Lattice>>,
    /// Searches for rows that the lattice doesn't reach.
    pub(crate) alone: AtomicUsize,
    /// Whether equilibria are searched for from those found before, as exactly as a fit needs them.
    pub(crate) within_fit: bool,
    /// Whether a segment ends at its first row without a state.
    pub(crate) all_or_none: bool,
}

/// Which variable each lane carries in one pass.
pub(crate) struct Pass {
    pub(crate) theta: Vec<Jet>,
    pub(crate) pressure_lane: Option<usize>,
    pub(crate) contraction_lane: Option<usize>,
    /// Lane of each shape parameter.
    pub(crate) shape_lanes: Vec<Option<usize>>,
    /// (lane, place among the wanted parameters)
    pub(crate) columns: Vec<(usize, usize)>,
}

impl Model {
    /// The force of every row with the parameters `theta`, and what else is wanted.
    ///
    /// # Errors
    /// If an effect doesn't fit the muscle, or rows have no equilibrium: the error lists them.
    pub fn evaluate(
        &self,
        record: &Record,
        theta: &[f64],
        wanted: &Wanted,
    ) -> Result<Prediction, ModelError> {
        let (all, failed) = self.evaluate_with(record, theta, wanted, None, true, &mut Slots::default())?;
        if failed.is_empty() { Ok(all) } else { Err(self.explained(record, theta, failure(failed))) }
    }

    /// The same within a fit: searches start where those of the evaluation before ended, and each of the rows that count (see
    /// [`Warm::of_rows`]) has an answer or there is none: the error then lists the first such row of each segment only.
    ///
    /// The forces are those of [`Model::evaluate`] within the accuracy of the solver, some 1e-10 of them; derivatives within 1e-6.
    ///
    /// # Errors
    /// Those of [`Model::evaluate`], for the rows that count.
    pub fn evaluate_warm(
        &self,
        record: &Record,
        theta: &[f64],
        wanted: &Wanted,
        warm: &Warm,
    ) -> Result<Prediction, ModelError> {
        let mut slots = warm.take();
        let found = self.evaluate_with(record, theta, wanted, Some(warm), true, &mut slots);
        warm.put(slots);
        let (all, failed) = found?;
        if failed.is_empty() { Ok(all) } else { Err(failure(failed)) }
    }

    /// As [`Model::evaluate_warm`], but a row without a state takes nothing from the others: it is listed. Nothing is remembered of single rows.
    ///
    /// # Errors
    /// If an effect doesn't fit the muscle. That no row has a state is none. See [`Model::explained`] for what to show of [`Partly::error`].
    pub fn evaluate_partly(
        &self,
        record: &Record,
        theta: &[f64],
        wanted: &Wanted,
        warm: &Warm,
    ) -> Result<Partly, ModelError> {
        let mut slots = warm.take();
        let found = self.evaluate_with(record, theta, wanted, Some(warm), false, &mut slots);
        warm.put(slots);
        let (mut prediction, failed) = match found {
            // The muscle itself has no state.
            Err(error @ ModelError::NoEquilibrium { .. }) => {
                let without_state: Vec<usize> = (0..record.len()).filter(|row| warm.counts(*row)).collect();
                let mut prediction = Prediction::zero(record.len(), wanted);
                prediction.leave_out(&without_state);
                return Ok(Partly { prediction, without_state, error: Some(error) });
            }
            found => found?,
        };
        let without_state: Vec<usize> = failed.iter().map(|(row, _)| *row).collect();
        prediction.leave_out(&without_state);
        let error = (!failed.is_empty()).then(|| failure(failed));
        Ok(Partly { prediction, without_state, error })
    }

    fn evaluate_with(
        &self,
        record: &Record,
        theta: &[f64],
        wanted: &Wanted,
        warm: Option<&Warm>,
        all_or_none: bool,
        slots: &mut Slots,
    ) -> Result<(Prediction, Vec<(usize, RowError)>), ModelError> {
        let (theta, asked, wanted) = (&*self.with_ties(theta), wanted, &*self.wanted_with_ties(wanted));
        let counts = |row: usize| warm.is_none_or(|warm| warm.counts(row));
        let mut runs = self.runs(record, theta, &wanted.parameters, &counts, slots)?;
        for run in &mut runs {
            run.within_fit = warm.is_some();
            run.all_or_none = warm.is_some() && all_or_none;
        }
        let segments = runs.iter().map(|run| run.segments(record)).max_by_key(Vec::len).unwrap_or_default();
        let keeps = warm.is_some() && all_or_none;
        slots.fit(segments.iter().map(|rows| if keeps { rows.len() } else { 1 }));
        let task = Task {
            record,
            passes: Self::passes(theta, wanted, &runs[0].shapes),
            columns: wanted.parameters.len(),
            counts: &counts,
            keeps,
        };
        let mut all = Prediction::zero(record.len(), wanted);
        let failed: Vec<Vec<(usize, RowError)>> = segments
            .par_iter()
            .zip(all.parts(&segments, task.columns))
            .zip(&mut slots.rows)
            .map(|((rows, part), slots)| segment(&runs, &task, rows.clone(), part, slots))
            .collect();
        slots.alone = runs.iter().map(|run| run.alone.load(Ordering::Relaxed)).collect();
        Ok((self.folded(all, asked, wanted), failed.into_iter().flatten().collect()))
    }

    /// One run for each of the muscles that the specimens are.
    fn runs<'a>(
        &'a self,
        record: &Record,
        theta: &'a [f64],
        wanted: &[usize],
        counts: &dyn Fn(usize) -> bool,
        slots: &mut Slots,
    ) -> Result<Vec<Run<'a>>, ModelError> {
        slots.for_bodies(self.bodies.len());
        let of_body = |body: usize| {
            let own = |row: usize| self.body_of(record.moments()[row].specimen) == body;
            self.run(body, record, theta, wanted, &|row| own(row) && counts(row), slots)
        };
        (0..self.bodies.len()).map(of_body).collect()
    }

    fn run<'a>(
        &'a self,
        body: usize,
        record: &Record,
        theta: &'a [f64],
        wanted: &[usize],
        counts: &dyn Fn(usize) -> bool,
        slots: &mut Slots,
    ) -> Result<Run<'a>, ModelError> {
        if theta.len() != self.parameters().len() {
            return Err(ModelError::Values { given: theta.len(), expected: self.parameters().len() });
        }
        let mut run = Run {
            model: self,
            body,
            theta,
            setting: self.bodies[body].setting,
            strands: Strands::of(&self.bodies[body].parts),
            shapes: Vec::new(),
            equilibrium: None,
            lattice: None,
            alone: AtomicUsize::new(0),
            within_fit: false,
            all_or_none: false,
        };
        if let Base::Law { .. } = self.base {
            return Ok(run);
        }
        run.shapes = self.shapes(wanted);
        if run.shapes.len() > SHAPE {
            return Err(ModelError::TooManyShapes { count: run.shapes.len(), most: SHAPE });
        }
        let parts = self.parts_of(body, theta)?;
        let shaped = self.shaped(body, theta, &run.shapes)?;
        let own = |moment: &Moment| self.body_of(moment.specimen) == body;
        let all = || (0..record.len()).filter(|row| own(&record.moments()[*row])).collect();
        let first = record.moments().iter().find(|moment| own(moment));
        let no_problem = |source| ModelError::NoEquilibrium {
            rows: all(),
            pressure_pa: first.map_or(0.0, |m| m.pressure),
            contraction: first.map_or(0.0, |m| m.contraction),
            source: Box::new(source),
        };
        let equilibrium = Equilibrium::new(shaped).map_err(no_problem)?;
        // Lengths stay those stated: what an effect takes from them would else move without a derivative.
        run.setting = run.setting.with(&parts);
        run.strands = Strands::of(&parts);
        if equilibrium.is_costly() && record.len() > FEWEST_NODES {
            let shape = |theta: &[f64]| self.parts_of(body, theta).ok();
            run.widen(record, counts, slots);
            run.lattice = slots.held_at(body, &parts, theta, &run.shapes, shape);
            if run.lattice.is_none() {
                run.lattice = run.solved(record, &parts, &equilibrium, counts, slots);
            }
        }
        run.equilibrium = Some(equilibrium);
        Ok(run)
    }

    fn passes(theta: &[f64], wanted: &Wanted, shapes: &[usize]) -> Vec<Pass> {
        // Variables in order: pressure and contraction if wanted, then the parameters.
        let readings = if wanted.readings { 2 } else { 0 };
        let all = readings + wanted.parameters.len();
        let mut passes = Vec::new();
        for first in (0..all.max(1)).step_by(LANES) {
            let lane_of = |variable: usize| {
                (variable >= first && variable < first + LANES && variable < all).then(|| variable - first)
            };
            let lane = |parameter: usize| {
                let place = wanted.parameters.iter().position(|other| *other == parameter)?;
                lane_of(readings + place)
            };
            let seeded = |(i, value): (usize, &f64)| match lane(i) {
                Some(lane) => Jet::variable(*value, lane),
                None => Jet::from(*value),
            };
            passes.push(Pass {
                theta: theta.iter().enumerate().map(seeded).collect(),
                pressure_lane: if wanted.readings { lane_of(0) } else { None },
                contraction_lane: if wanted.readings { lane_of(1) } else { None },
                shape_lanes: shapes.iter().map(|parameter| lane(*parameter)).collect(),
                columns: (0..wanted.parameters.len())
                    .filter_map(|place| lane_of(readings + place).map(|lane| (lane, place)))
                    .collect(),
            });
        }
        passes
    }

    /// Force at one moment of rest.
    pub(crate) fn rest(&self, theta: &[f64], moment: &Moment) -> Result<AtRest, ModelError> {
        let record = Record::from_moments(vec![*moment], vec![0.0], std::iter::once(0..1).collect());
        let Some(record) = record else { return Err(ModelError::Values { given: 0, expected: 1 }) };
        let theta = &*self.with_ties(theta);
        let mut slots = Slots::default();
        slots.for_bodies(self.bodies.len());
        let run = self.run(self.body_of(moment.specimen), &record, theta, &[], &|_| true, &mut slots)?;
        let pass = Pass {
            theta: theta.iter().map(|v| Jet::from(*v)).collect(),
            pressure_lane: None,
            contraction_lane: None,
            shape_lanes: vec![None; run.shapes.len()],
            columns: Vec::new(),
        };
        let mut memory = run.memory();
        match run.row(moment, &pass, &mut memory, &mut None) {
            Ok(row) => Ok(AtRest {
                equilibrium_n: row.equilibrium.value(),
                force_n: row.force.value(),
                reading_n: row.reading.value(),
            }),
            Err(error) => Err(failure(vec![(0, error)])),
        }
    }
}

impl Run<'_> {
    /// The lattice for the rows that count, if it is worth its while; held, if it is to be.
    fn solved(
        &self,
        record: &Record,
        parts: &Parts,
        equilibrium: &Equilibrium,
        counts: &dyn Fn(usize) -> bool,
        slots: &mut Slots,
    ) -> Option<Arc<Lattice>> {
        let matters = self.matters(record, counts);
        let counted = matters.iter().filter(|matters| **matters).count();
        let around = |levels: bool| {
            let unsolved = Lattice::unsolved(equilibrium, self.shapes.len(), self.model.refinement, levels);
            let spans = self.spans(record, &matters, &unsolved);
            (unsolved.around(&spans), spans)
        };
        let (even, of_levels) = (around(false), around(true));
        let (lattice, spans) = if of_levels.0.needed() < even.0.needed() { of_levels } else { even };
        // A node costs what a row costs, in one evaluation; what is held serves many.
        let evaluations = if slots.holds { HELD_FOR } else { 1 };
        if lattice.needed() >= evaluations * counted {
            return None;
        }
        let asked = || Asked {
            parts: parts.clone(),
            numbers: self.shaping().collect(),
            shapes: self.shapes.iter().map(|index| self.model.name_of(*index)).collect(),
        };
        let before = Arc::clone(&slots.nodes[self.body]);
        let solve = |lattice: Lattice| lattice.solved(equilibrium, &before);
        let (lattice, starts) = if before.is_empty() {
            self.model.solved.lattice(asked(), lattice, solve)
        } else {
            let (lattice, starts) = solve(lattice);
            (Arc::new(lattice), starts)
        };
        slots.nodes[self.body] = starts;
        if slots.holds {
            let (shapes, theta) = (self.shapes.clone(), self.theta.to_vec());
            let (parts, lattice) = (parts.clone(), Arc::clone(&lattice));
            slots.held[self.body] = Some(Arc::new(Held { shapes, theta, parts, spans, lattice }));
        }
        Some(lattice)
    }

    /// Widens a held lattice to where rows have moved since it was solved, if they take more searches than it would: a zero error of the length moves all rows
    /// of an isometric test out of it.
    fn widen(&self, record: &Record, counts: &dyn Fn(usize) -> bool, slots: &mut Slots) {
        let Some((held, alone)) = slots.missed(self.body) else { return };
        let there = || Equilibrium::new(self.model.shaped(self.body, &held.theta, &held.shapes).ok()?).ok();
        let Some(equilibrium) = (alone > FEWEST_NODES).then(there).flatten() else { return };
        let levels = held.lattice.is_of_levels();
        let unsolved = Lattice::unsolved(&equilibrium, held.shapes.len(), self.model.refinement, levels);
        let mut spans = self.spans(record, &self.matters(record, counts), &unsolved);
        spans.extend(&held.spans);
        spans.sort_unstable();
        spans.dedup();
        let wider = unsolved.around(&spans);
        let needed = wider.needed();
        if needed == held.lattice.needed() || needed >= HELD_FOR * alone {
            return;
        }
        let (lattice, starts) = wider.solved(&equilibrium, &slots.nodes[self.body]);
        slots.nodes[self.body] = starts;
        let (shapes, theta, parts) = (held.shapes.clone(), held.theta.clone(), held.parts.clone());
        slots.held[self.body] =
            Some(Arc::new(Held { shapes, theta, parts, spans, lattice: Arc::new(lattice) }));
    }

    pub(crate) fn remembers(&self) -> bool {
        self.model.effects.iter().any(|chosen| chosen.effect.memory() > 0)
    }

    /// Rows whose equilibrium matters: those that count, and where something is remembered those before them in their sweep.
    fn matters(&self, record: &Record, counts: &dyn Fn(usize) -> bool) -> Vec<bool> {
        let mut matters: Vec<bool> = (0..record.len()).map(counts).collect();
        if self.remembers() {
            for sweep in record.sweeps() {
                let rows = &mut matters[sweep.clone()];
                let last = rows.iter().rposition(|counts| *counts);
                rows[..last.unwrap_or(0)].fill(true);
            }
        }
        matters
    }

    /// All numbers of effects that change the shape.
    fn shaping(&self) -> impl Iterator<Item = (String, u64)> {
        let is_of_shape = |chosen: &&Chosen| chosen.effect.stage() == Stage::Shape;
        let numbers = |chosen: &Chosen| {
            let name = chosen.effect.card().name;
            let own = self.model.parameters().iter().zip(self.theta).filter(move |(p, _)| p.effect == name);
            own.map(move |(_, value)| (name.to_owned(), value.to_bits())).collect::<Vec<_>>()
        };
        self.model.effects.iter().filter(is_of_shape).flat_map(numbers)
    }

    /// Sweeps where something is remembered along them, else chunks of equal size.
    fn segments(&self, record: &Record) -> Vec<Range<usize>> {
        if self.remembers() {
            return record.sweeps().to_vec();
        }
        let searches =
            self.lattice.is_none() && self.equilibrium.as_ref().is_some_and(Equilibrium::is_costly);
        let chunk = CHUNK[usize::from(searches)];
        (0..record.len()).step_by(chunk).map(|start| start..(start + chunk).min(record.len())).collect()
    }

    /// What is remembered along a sweep: of each effect, and of the strands.
    pub(crate) fn memory(&self) -> Vec<Vec<Jet>> {
        let sizes = self.model.effects.iter().map(|chosen| chosen.effect.memory());
        sizes.chain([strands::MEMORY]).map(|size| vec![Jet::from(0.0); size]).collect()
    }

    /// What each effect does with a row, in their order.
    pub(crate) fn actions<'r>(
        &'r self,
        moment: &'r Moment,
        pass: &'r Pass,
        memory: &'r mut [Vec<Jet>],
    ) -> impl Iterator<Item = (Action<'r>, effects::Row<'r>)> {
        self.model.effects.iter().zip(memory).map(move |(chosen, memory)| {
            let theta = &pass.theta[self.model.range(chosen, moment.specimen)];
            (chosen.effect.action(), effects::Row { moment, setting: &self.setting, theta, memory })
        })
    }

    pub(crate) fn input(&self, moment: &Moment, pass: &Pass, memory: &mut [Vec<Jet>]) -> Input {
        let seeded = |value: f64, lane: Option<usize>| match lane {
            Some(lane) => Dual::variable(value, lane),
            None => Jet::from(value),
        };
        let mut input = Input::of(
            seeded(moment.pressure, pass.pressure_lane),
            seeded(moment.contraction, pass.contraction_lane),
        );
        for (action, row) in self.actions(moment, pass, memory) {
            match action {
                Action::Shape(effect) => effect.act(row, &mut input),
                Action::Input(effect) => effect.act(row, &mut input),
                Action::Load(_) | Action::Output(_) => {}
            }
        }
        input
    }

    /// Nodes of a lattice around the pressures and ranges of contraction at which equilibria will be asked for, by rows that matter; neighbours that ask for the same
    /// are one.
    fn spans(&self, record: &Record, matters: &[bool], lattice: &Lattice) -> Vec<Span> {
        let pass = Pass {
            theta: self.theta.iter().map(|v| Jet::from(*v)).collect(),
            pressure_lane: None,
            contraction_lane: None,
            shape_lanes: Vec::new(),
            columns: Vec::new(),
        };
        let span = |memory: &mut Vec<Vec<Jet>>, moment: &Moment| {
            if moment.begins {
                *memory = self.memory();
            }
            let input = self.input(moment, &pass, memory);
            let pressure = (input.pressure * input.area / input.wall).value();
            let e = input.contraction.value();
            // The force is not known yet: p pi (3 r0)^2 is more than any muscle has at usable contractions.
            let most = Jet::from(pressure * std::f64::consts::PI * (3.0 * self.setting.radius).powi(2));
            let give = (input.give_force.under(most) + input.give_tension.under(most)).value();
            let spread = NORMAL[1].0 * input.spread.value().abs();
            lattice.span(pressure, [e - spread + give.min(0.0), e + spread + give.max(0.0)])
        };
        let of_segment = |rows: &Range<usize>| {
            let mut memory = self.memory();
            let mut found: Vec<Span> = Vec::new();
            for (moment, matters) in record.moments()[rows.clone()].iter().zip(&matters[rows.clone()]) {
                let own = span(&mut memory, moment).filter(|own| *matters && found.last() != Some(own));
                found.extend(own);
            }
            found.sort_unstable();
            found.dedup();
            found
        };
        let segments = self.segments(record);
        segments.par_iter().flat_map_iter(of_segment).collect()
    }

    /// Whether rows start from the row before: within a fit where nothing is shot for.
    pub(crate) fn walks(&self) -> bool {
        self.within_fit && self.equilibrium.as_ref().is_some_and(|equilibrium| !equilibrium.is_costly())
    }
}

//! Evaluation of a model along a history: the force of every row, with exact derivatives.

use bulge_effects::{self as effects, Action, Give, Input, Jet, Moment, Setting, Stage};
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
use crate::pass::Pass;
use crate::prediction::{Partly, Prediction};
use crate::record::Record;
use crate::row::{NORMAL, Place};
use crate::segment::{Task, segment};
use crate::solved::Asked;
use crate::strands::{self, Strands};
use crate::warm::{Held, RowAnswers, Slots, Warm};
use crate::work;

/// The results that [`Model::evaluate`] returns besides the force.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Wanted {
    /// Parameters to differentiate by, as indices into [`Model::parameters`].
    pub parameters: Vec<usize>,
    /// Whether to differentiate by the readings of pressure and contraction.
    pub readings: bool,
}

/// Rows per task if nothing is remembered between rows: without and with a search for each row. The sizes are
/// fixed, so that results don't depend on the number of threads.
const CHUNK: [usize; 2] = [256, 8];
/// A held lattice is assumed to serve at least this many evaluations.
const HELD_FOR: usize = 4;
/// Most rows whose answers are held: 7 MB.
const MOST_ANSWERS: usize = 20_000;

/// Everything that is the same for all rows of one muscle in one evaluation.
pub(crate) struct Run<'a> {
    pub(crate) model: &'a Model,
    /// Index of the muscle among those of the model.
    pub(crate) body: usize,
    pub(crate) theta: &'a [f64],
    /// The action of each effect, in the order of the effects.
    actions: Vec<Action<'a>>,
    pub(crate) setting: Setting,
    pub(crate) strands: Strands,
    /// Parameters that change the shape, in the order of the answers' derivatives.
    shapes: Vec<usize>,
    pub(crate) equilibrium: Option<Equilibrium>,
    pub(crate) lattice: Option<Arc<Lattice>>,
    /// Answers of an earlier evaluation of this muscle.
    pub(crate) answers: Option<Arc<RowAnswers>>,
    /// Number of searches for rows outside the lattice.
    pub(crate) alone: AtomicUsize,
    /// Whether searches start from earlier equilibria and are as exact as a fit needs.
    pub(crate) within_fit: bool,
    /// Whether a segment stops at its first row without a state.
    pub(crate) all_or_none: bool,
}

impl Model {
    /// The force of every row at the parameters `theta`, with the derivatives that `wanted` asks for.
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

    /// Evaluates within a fit: searches start where those of the previous evaluation ended. If a row that
    /// counts (see [`Warm::of_rows`]) fails, the error lists only the first such row of each segment.
    ///
    /// Forces agree with [`Model::evaluate`] to about 1e-10 (solver accuracy), derivatives to 1e-6.
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

    /// As [`Model::evaluate_warm`], but rows without a state are only listed. No row keeps a start.
    ///
    /// # Errors
    /// If an effect doesn't fit the muscle. It is no error if no row has a state. To show [`Partly::error`],
    /// see [`Model::explained`].
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
            // The muscle itself has no equilibrium.
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
        work::count(record.len(), wanted.parameters.len());
        let counts = |row: usize| warm.is_none_or(|warm| warm.counts(row));
        let mut runs = self.runs(record, theta, &wanted.parameters, &counts, slots)?;
        for run in &mut runs {
            run.within_fit = warm.is_some();
            run.all_or_none = warm.is_some() && all_or_none;
        }
        let segments = runs.iter().map(|run| run.segments(record)).max_by_key(Vec::len).unwrap_or_default();
        let keeps = warm.is_some() && all_or_none;
        slots.fit(segments.iter().map(|rows| if keeps { rows.len() } else { 1 }));
        let passes = Pass::all(theta, wanted, &runs[0].shapes);
        let may_answer = record.len() <= MOST_ANSWERS && self.law().is_none();
        let holds = slots.holds && slots.answers.is_none() && may_answer;
        let task = Task {
            record,
            answers: may_answer && (holds || passes.len() > 1),
            passes,
            columns: wanted.parameters.len(),
            counts: &counts,
            keeps,
        };
        let mut all = Prediction::zero(record.len(), wanted);
        let (failed, answered): (Vec<_>, Vec<_>) = segments
            .par_iter()
            .zip(all.parts(&segments, task.columns))
            .zip(&mut slots.rows)
            .map(|((rows, part), slots)| segment(&runs, &task, rows.clone(), part, slots))
            .unzip();
        if holds {
            let parts =
                (0..self.bodies.len()).map(|body| self.parts_of(body, theta)).collect::<Result<_, _>>()?;
            let (shapes, rows) = (runs[0].shapes.clone(), answered.concat());
            slots.answers = Some(Arc::new(RowAnswers { parts, shapes, rows }));
        }
        slots.alone = runs.iter().map(|run| run.alone.load(Ordering::Relaxed)).collect();
        Ok((self.folded(all, asked, wanted), failed.into_iter().flatten().collect()))
    }

    /// One run for each distinct muscle among the specimens.
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
            actions: self.effects.iter().map(|chosen| chosen.effect.action()).collect(),
            setting: self.bodies[body].setting,
            strands: Strands::of(&self.bodies[body].parts),
            shapes: Vec::new(),
            equilibrium: None,
            lattice: None,
            answers: None,
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
        // The stated lengths are kept: a change by an effect would move them without a derivative.
        run.answers = slots.answers.clone().filter(|answers| answers.serve(body, &parts, &run.shapes));
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

    /// The force at a single moment at rest.
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
        let (start, answered, give) = (&mut None, &mut None, &mut 0.0);
        match run.row(moment, &pass, &mut memory, &mut Place { row: 0, start, answered, give }) {
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
    /// The lattice for the rows that count, if it pays off. It is held if `slots` asks for that.
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
        let unsolved = [false, true]
            .map(|levels| Lattice::unsolved(equilibrium, self.shapes.len(), self.model.refinement, levels));
        let [even, of_levels] = self.spans(record, &matters, &unsolved);
        let [for_even, for_levels] = unsolved;
        let (even, of_levels) = ((for_even.around(&even), even), (for_levels.around(&of_levels), of_levels));
        let (lattice, spans) = if of_levels.0.needed() < even.0.needed() { of_levels } else { even };
        // A node costs as much as a row. A held lattice serves several evaluations.
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

    /// Widens a held lattice to rows that have left it, if that takes fewer searches than the rows do. A zero
    /// error of the length, for example, moves all rows of an isometric test out of the lattice.
    fn widen(&self, record: &Record, counts: &dyn Fn(usize) -> bool, slots: &mut Slots) {
        let Some((held, alone)) = slots.missed(self.body) else { return };
        let there = || Equilibrium::new(self.model.shaped(self.body, &held.theta, &held.shapes).ok()?).ok();
        let Some(equilibrium) = (alone > FEWEST_NODES).then(there).flatten() else { return };
        let levels = held.lattice.is_of_levels();
        let unsolved = Lattice::unsolved(&equilibrium, held.shapes.len(), self.model.refinement, levels);
        let matters = self.matters(record, counts);
        let [mut spans] = self.spans(record, &matters, std::array::from_ref(&unsolved));
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

    /// Rows whose equilibrium matters: rows that count and, with memory, all rows before them in their sweep.
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

    /// All numbers of the effects that change the shape.
    fn shaping(&self) -> impl Iterator<Item = (String, u64)> {
        let is_of_shape = |chosen: &&Chosen| chosen.effect.stage() == Stage::Shape;
        let numbers = |chosen: &Chosen| {
            let name = chosen.effect.card().name;
            let own = self.model.parameters().iter().zip(self.theta).filter(move |(p, _)| p.effect == name);
            own.map(move |(_, value)| (name.to_owned(), value.to_bits())).collect::<Vec<_>>()
        };
        self.model.effects.iter().filter(is_of_shape).flat_map(numbers)
    }

    /// Sweeps if something is remembered along them, otherwise chunks of equal size.
    fn segments(&self, record: &Record) -> Vec<Range<usize>> {
        if self.remembers() {
            return record.sweeps().to_vec();
        }
        let searches =
            self.lattice.is_none() && self.equilibrium.as_ref().is_some_and(Equilibrium::is_costly);
        let chunk = CHUNK[usize::from(searches)];
        (0..record.len()).step_by(chunk).map(|start| start..(start + chunk).min(record.len())).collect()
    }

    /// The memory along a sweep, for each effect and for the strands.
    pub(crate) fn memory(&self) -> Vec<Vec<Jet>> {
        let sizes = self.model.effects.iter().map(|chosen| chosen.effect.memory());
        sizes.chain([strands::MEMORY]).map(|size| vec![Jet::from(0.0); size]).collect()
    }

    /// The actions of some stages on a row, in the order of the effects.
    pub(crate) fn actions<'r>(
        &'r self,
        stages: &'r [Stage],
        moment: &'r Moment,
        pass: &'r Pass,
        memory: &'r mut [Vec<Jet>],
    ) -> impl Iterator<Item = (Action<'r>, effects::Row<'r>)> {
        let all = self.actions.iter().zip(&self.model.effects).zip(memory);
        all.filter(|((action, _), _)| stages.contains(&action.stage())).map(
            move |((action, chosen), memory)| {
                let theta = &pass.theta[self.model.range(chosen, moment.specimen)];
                (*action, effects::Row { moment, setting: &self.setting, theta, memory })
            },
        )
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
        for (action, row) in self.actions(&[Stage::Shape, Stage::Input], moment, pass, memory) {
            match action {
                Action::Shape(effect) => effect.act(row, &mut input),
                Action::Input(effect) => effect.act(row, &mut input),
                Action::Load(_) | Action::Output(_) => {}
            }
        }
        input
    }

    /// Nodes that the rows that matter need of each lattice, nearly without duplicates.
    fn spans<const N: usize>(
        &self,
        record: &Record,
        matters: &[bool],
        lattices: &[Lattice; N],
    ) -> [Vec<Span>; N] {
        let pass = Pass {
            theta: self.theta.iter().map(|v| Jet::from(*v)).collect(),
            pressure_lane: None,
            contraction_lane: None,
            shape_lanes: Vec::new(),
            columns: Vec::new(),
        };
        // The pressure, and the contractions between which a row may be.
        let reach = |memory: &mut [Vec<Jet>], moment: &Moment| {
            let input = self.input(moment, &pass, memory);
            let pressure = (input.pressure * input.area / input.wall).value();
            let e = input.contraction.value();
            let spread = NORMAL[1].0 * input.spread.value().abs();
            let gives = [input.give_force, input.give_tension];
            if gives.iter().all(Give::is_none) {
                return (pressure, [e - spread, e + spread]);
            }
            // The force isn't known yet. No muscle exceeds p pi (3 r0)^2 at usable contractions.
            let most = Jet::from(pressure * std::f64::consts::PI * (3.0 * self.setting.radius).powi(2));
            let give: f64 = gives.iter().map(|give| give.under(most).value()).sum();
            (pressure, [e - spread + give.min(0.0), e + spread + give.max(0.0)])
        };
        let of_segment = |rows: &Range<usize>| {
            let mut memory = self.memory();
            let mut found = [const { Vec::new() }; N];
            for (moment, matters) in record.moments()[rows.clone()].iter().zip(&matters[rows.clone()]) {
                if moment.begins {
                    memory = self.memory();
                }
                let (pressure, contractions) = reach(&mut memory, moment);
                for (lattice, found) in lattices.iter().zip(&mut found).filter(|_| *matters) {
                    found
                        .extend(lattice.span(pressure, contractions).filter(|own| found.last() != Some(own)));
                }
            }
            for found in &mut found {
                found.sort_unstable();
                found.dedup();
            }
            found
        };
        let segments = self.segments(record);
        let of_each: Vec<[Vec<Span>; N]> = segments.par_iter().map(of_segment).collect();
        std::array::from_fn(|i| of_each.iter().flat_map(|of_one| &of_one[i]).copied().collect())
    }

    /// Whether a row starts from the row before it: within a fit, if nothing takes shooting.
    pub(crate) fn walks(&self) -> bool {
        self.within_fit && self.equilibrium.as_ref().is_some_and(|equilibrium| !equilibrium.is_costly())
    }
}

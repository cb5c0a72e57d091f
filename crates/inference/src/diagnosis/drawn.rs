//! Fitted forms of a model's effects, as expressions for a file of user-defined effects.
//!
//! ```text
//! s + B c = size (E(x, y) + direction O(x, y)),   x, y contraction and pressure over their ranges, held beyond them
//! ```
//! E and O are polynomials of the lowest degree that follows the form as closely as the data determine it.

use bulge_effects::{Effect, Form, Mechanism};
use bulge_measurements::Data;
use bulge_model::{ModelError, Record};
use bulge_muscles::Muscle;
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use std::sync::Arc;

use crate::comparison::analysis::Analysis;
use crate::comparison::options::Options;
use crate::diagnosis::averaged_data::{Stop, averaged_data};
use crate::diagnosis::claim::form_error;
use crate::diagnosis::diagnose::{DiagnoseOptions, where_it_has_a_state};
use crate::diagnosis::document::FormErrorResult;
use crate::diagnosis::form_error::Bent;
use crate::diagnosis::linearised_model::Context;
use crate::diagnosis::setpoints::setpoints;
use crate::error::InferenceError;
use crate::vector::{minus, range, rms};
use bulge_numerics::vector::add;

/// Highest total degree in contraction and pressure, and highest degree in the pressure. The form errors have
/// 4 and 2, on top of those of a formula.
const DEGREES: [usize; 2] = [7, 3];
/// Allowed error of an expression relative to the noise of a reading; a tenth would show in many rows.
const UNSEEN: f64 = 0.05;
/// Fraction of the allowed error that the smallest coefficients may add up to when they are dropped to
/// shorten the formula.
const TINY: f64 = 0.2;
/// An expression with an RMS error above this fraction of the effect counts as another effect.
const ANOTHER: f64 = 0.5;
/// Singular values below this fraction of the largest one are rounding errors.
const ROUNDING: f64 = 1e-10;
/// Half-width of the 95 % interval in standard deviations.
const SURE: f64 = 1.96;
/// Largest ratio of a written effect's size to the fitted one.
const LARGEST: f64 = 5.0;

/// Forms of a model's effects that some data want.
#[derive(Debug, Clone, Serialize)]
pub struct DrawnForms {
    /// RMS error with the formulas of the catalogue, on means of rows \[N\].
    pub rmse_n: f64,
    /// RMS error with the fitted forms, on means of rows \[N\].
    pub bent_rmse_n: f64,
    /// One form for each requested effect.
    pub forms: Vec<DrawnForm>,
}

/// The form of one effect.
#[derive(Debug, Clone, Serialize)]
pub struct DrawnForm {
    /// The effect.
    pub effect: String,
    /// The form error, its location and its standard deviation; none if the formula holds or is exact.
    pub form_error: Option<FormErrorResult>,
    /// Name of the effect that is written; none if none is.
    pub written: Option<String>,
    /// RMS difference between the expression and the form \[N\].
    pub missed_n: Option<f64>,
    /// In a sentence: what is written, or why nothing is.
    pub says: String,
    /// The effect as an entry of an effects file; empty if none is written.
    pub toml: String,
}

/// Fits effects with their form errors, and writes the fitted forms as user-defined effects.
///
/// # Errors
/// As [`crate::diagnose`]. Too few rows for estimating the noise are an error here.
pub fn drawn_forms(data: &Data, muscle: &Muscle, options: &Options) -> Result<DrawnForms, InferenceError> {
    rayon::scope(|_| {
        let options = DiagnoseOptions::new(options.clone());
        let mut analysis = Analysis::new(data, muscle, &options.base)?;
        let first = analysis.begin()?;
        let mut base = analysis.climb(options.base.effects.len(), Some(&first.climbed))?;
        let model = analysis.base_with_effects()?;
        let found = where_it_has_a_state(&analysis, &mut base, |base, used| {
            let averaged_data = averaged_data(&analysis, base, used, &options)?;
            let Some(law) = &averaged_data.law else {
                return Err(InferenceError::TooFewRows {
                    rows: averaged_data.record.len(),
                    numbers: base.theta.len(),
                }
                .into());
            };
            let nothing: [String; 0] = [];
            let context = Context {
                only: Some(&nothing),
                is_planned: true,
                to_draw: true,
                ..averaged_data.context(law, &options, None)
            };
            let near = (&base.prepared.model, &base.theta[..]);
            let drawn = context
                .confirm(&model, &[], Some(near), &[])
                .and_then(|confirmed| context.linearised(&confirmed.prepared, &confirmed.theta))
                .map(|linear| context.drawn(&linear.force, &linear.form.effects, &options.base.effects));
            drawn.map_err(|error: ModelError| Stop::at_means(error, &averaged_data.averaged, &analysis))
        });
        Ok(found?.0)
    })
}

impl DrawnForm {
    /// The result for an effect that isn't written.
    fn none(effect: &Arc<dyn Effect>, why: &str) -> Self {
        let effect = effect.card().name.to_owned();
        let says = format!("{effect} is not written: {why}");
        Self { effect, form_error: None, written: None, missed_n: None, says, toml: String::new() }
    }
}

/// Why an effect has no form errors.
fn without_columns(effect: &Arc<dyn Effect>) -> &'static str {
    if effect.card().form == Form::Exact {
        "its formula is exact, only its numbers can be wrong"
    } else {
        "at its best numbers it changes nothing"
    }
}

impl Context<'_> {
    fn drawn(&self, force: &[f64], bent: &[Bent], asked: &[Arc<dyn Effect>]) -> DrawnForms {
        let record = self.record;
        let residual = minus(record.force(), force);
        let mut left = residual.clone();
        for effect in bent.iter().filter(|bent| bent.may_bend()) {
            add(&mut left, -1.0, &effect.bending);
        }
        let state = State::of(&setpoints(record));
        let form = |effect: &Arc<dyn Effect>| {
            let own = bent.iter().find(|bent| bent.effect.card().name == effect.card().name);
            own.map_or_else(
                || DrawnForm::none(effect, without_columns(effect)),
                |bent| self.form(&state, bent),
            )
        };
        let forms = asked.iter().map(form).collect();
        DrawnForms { rmse_n: rms(&residual), bent_rmse_n: rms(&left), forms }
    }

    fn form(&self, state: &State, bent: &Bent) -> DrawnForm {
        let name = bent.effect.card().name;
        if !bent.may_bend() {
            return DrawnForm::none(&bent.effect, "its formula holds: the data want no other form");
        }
        let whole = &bent.drawn;
        let expression = Expression::of(state, whole, UNSEEN * self.row_n);
        let (size, missed) = (rms(whole), expression.missed_n);
        let form_error = form_error(self.record, bent);
        let bends = form_error.rms_n;
        if missed > ANOTHER * size {
            let says = format!(
                "{name} is not written: {missed:.3} N of its {size:.3} N (RMS) lie at turns or along the time, where an expression over contraction, pressure and direction can't follow"
            );
            let none = DrawnForm::none(&bent.effect, "");
            return DrawnForm { form_error: Some(form_error), missed_n: Some(missed), says, ..none };
        }
        let written = self.free_name(name);
        let beside = if missed > UNSEEN * self.row_n {
            format!("; {missed:.3} N of it lie at turns or along the time and are not in the expression")
        } else {
            String::new()
        };
        let says = format!(
            "{written}: {name} as the data want it, {size:.3} N (RMS), of which {bends:.3} N are not in its formula{beside}"
        );
        let toml = file(&bent.effect, &written, &form_error, &says, &expression.text(state, size), size);
        DrawnForm {
            effect: name.to_owned(),
            form_error: Some(form_error),
            written: Some(written),
            missed_n: Some(missed),
            says,
            toml,
        }
    }

    /// A name that isn't in the catalogue yet.
    fn free_name(&self, name: &str) -> String {
        let first = format!("{name}-bent");
        let mut free = first.clone();
        for number in 2.. {
            if self.catalogue.find(&free).is_err() {
                break;
            }
            free = format!("{first}-{number}");
        }
        free
    }
}

/// Scaled contraction and pressure and the direction of each row.
struct State {
    /// Ends of contraction and pressure, in SI.
    ends: [[f64; 2]; 2],
    scaled: [Vec<f64>; 2],
    direction: Vec<f64>,
}

impl State {
    fn of(set: &Record) -> Self {
        let moments = set.moments();
        let values = [
            moments.iter().map(|m| m.contraction).collect::<Vec<_>>(),
            moments.iter().map(|m| m.pressure).collect(),
        ];
        let ends = values.each_ref().map(|values| range(values.iter().copied()));
        let scaled = [0, 1].map(|axis: usize| {
            let [low, high] = ends[axis];
            let half = 0.5 * (high - low);
            let of = |v: &f64| if half > 0.0 { (v - low) / half - 1.0 } else { 0.0 };
            values[axis].iter().map(of).collect()
        });
        let direction = moments.iter().map(|m| m.direction).collect();
        Self { ends, scaled, direction }
    }

    fn is_moved(&self, axis: usize) -> bool {
        self.ends[axis][1] > self.ends[axis][0]
    }

    /// The variable x or y as an expression.
    fn text(&self, axis: usize) -> String {
        let (name, unit) = [("eps", ""), ("p", " [Pa]")][axis];
        let [low, high] = self.ends[axis];
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        format!(
            "((clamp({name}, {low:.9e}{unit}, {high:.9e}{unit}) - {middle:.9e}{unit}) / {half:.9e}{unit})"
        )
    }
}

/// A polynomial in contraction and pressure, and one that changes sign with the direction.
struct Expression {
    /// (whether the sign changes with the direction, degree in contraction, degree in pressure), coefficient.
    terms: Vec<((bool, usize, usize), f64)>,
    missed_n: f64,
}

impl Expression {
    /// The shortest expression with an RMS error below `unseen` of these forces; otherwise the closest one.
    fn of(state: &State, whole: &[f64], unseen: f64) -> Self {
        let parts: &[&[bool]] = if state.direction.iter().any(|d| *d != 0.0) {
            &[&[false], &[true], &[false, true]]
        } else {
            &[&[false]]
        };
        let powers = |total: usize| {
            let highest = move |axis: usize| if state.is_moved(axis) { DEGREES[axis].min(total) } else { 0 };
            (0..=highest(1)).flat_map(move |j| (0..=highest(0).min(total - j)).map(move |i| (i, j)))
        };
        let mut bases: Vec<Vec<(bool, usize, usize)>> = (0..=DEGREES[0])
            .flat_map(|total| {
                parts.iter().map(move |parts| {
                    parts.iter().flat_map(|turns| powers(total).map(|(i, j)| (*turns, i, j))).collect()
                })
            })
            .collect();
        bases.sort_by_key(Vec::len);
        let mut best: Option<Self> = None;
        for basis in bases.into_iter().filter(|basis| basis.len() < whole.len()) {
            let Some(found) = Self::fitted(state, whole, basis, TINY * unseen) else { continue };
            let is_enough = found.missed_n <= unseen;
            if best.as_ref().is_none_or(|best| found.missed_n < best.missed_n) {
                best = Some(found);
            }
            if is_enough {
                break;
            }
        }
        best.unwrap_or_else(|| Self { terms: Vec::new(), missed_n: rms(whole) })
    }

    /// The fit with these terms. The smallest coefficients, which together change less than `tiny` \[N\], are
    /// set to 0.
    fn fitted(state: &State, whole: &[f64], basis: Vec<(bool, usize, usize)>, tiny: f64) -> Option<Self> {
        let power =
            |axis: usize, row: usize, n: usize| (0..n).fold(1.0, |sum, _| sum * state.scaled[axis][row]);
        let design = DMatrix::from_fn(whole.len(), basis.len(), |row, column| {
            let (turns, i, j) = basis[column];
            let sign = if turns { state.direction[row] } else { 1.0 };
            sign * power(0, row, i) * power(1, row, j)
        });
        let wanted = DVector::from_column_slice(whole);
        let svd = design.clone().svd(true, true);
        let smallest = ROUNDING * svd.singular_values.max();
        let mut found = svd.solve(&wanted, smallest).ok()?;
        let mut order: Vec<usize> = (0..basis.len()).collect();
        order.sort_by(|a, b| found[*a].abs().total_cmp(&found[*b].abs()));
        let mut dropped = 0.0;
        for place in order {
            // No term is larger than its coefficient, because x and y lie within -1 and 1.
            dropped += found[place].abs();
            if dropped > tiny {
                break;
            }
            found[place] = 0.0;
        }
        let missed_n = rms((wanted - design * &found).as_slice());
        Some(Self { terms: basis.into_iter().zip(found.iter().copied()).collect(), missed_n })
    }

    /// The expression as a formula of the parameter `size`, whose fitted value is `size` \[N\].
    fn text(&self, state: &State, size: f64) -> String {
        let polynomial = |turns: bool| -> Option<String> {
            let of =
                |power: usize| self.terms.iter().filter(move |((t, _, j), _)| *t == turns && *j == power);
            let rows: Vec<String> = (0..=DEGREES[1])
                .map(|j| {
                    // Horner's scheme needs few operations and no exponents.
                    of(j).rev().fold(String::new(), |inner, (_, c)| {
                        let (c, x) = (c / size, state.text(0));
                        match (c == 0.0, inner.is_empty()) {
                            (true, true) => inner,
                            (true, false) => format!("({x} * {inner})"),
                            (false, true) => format!("({c:.9e})"),
                            (false, false) => format!("({c:.9e} + {x} * {inner})"),
                        }
                    })
                })
                .collect();
            rows.into_iter().rev().fold(None, |inner, own| match inner {
                None => Some(own).filter(|own| !own.is_empty()),
                Some(inner) if own.is_empty() => Some(format!("({} * {inner})", state.text(1))),
                Some(inner) => Some(format!("({own} + {} * {inner})", state.text(1))),
            })
        };
        let parts = [polynomial(false), polynomial(true).map(|odd| format!("direction * {odd}"))];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        format!("size * ({})", parts.join(" + "))
    }
}

/// An entry of an effects file, with the form that it follows and the interval in comments.
fn file(
    effect: &Arc<dyn Effect>,
    name: &str,
    drawn: &FormErrorResult,
    says: &str,
    formula: &str,
    size: f64,
) -> String {
    let card = effect.card();
    let mut lines = vec![
        format!("# {says}."),
        "# Beyond the contractions and pressures that were measured it stays as at the last of them.".to_owned(),
        "#".to_owned(),
        "# pressure [bar]  direction  contraction [%]  by its formula [N]  as the data want it [N]  95 % interval [N]".to_owned(),
    ];
    for curve in &drawn.curves {
        let points =
            curve.at.contraction.iter().zip(&curve.formula_n).zip(curve.bent_n.iter().zip(&curve.sd_n));
        lines.extend(points.map(|((contraction, formula), (bent, sd))| {
            format!(
                "# {:14.4}  {:9}  {:15.3}  {formula:18.3}  {bent:23.3}  {:.3} to {:.3}",
                1e-5 * curve.at.pressure_pa,
                curve.at.direction,
                100.0 * contraction,
                bent - SURE * sd,
                bent + SURE * sd,
            )
        }));
    }
    lines.push(String::new());
    lines.push(format!("[effects.{name}]"));
    lines.push(format!("title = \"{} as the data want it\"", card.name));
    lines.push(format!("family = \"{}\"", card.family));
    if card.mechanism != Mechanism::User {
        lines.push(format!("mechanism = \"{}\"", card.mechanism.name().replace(' ', "-")));
    }
    lines.push("form = \"near\"".to_owned());
    lines.push(format!("force = \"{formula}\""));
    lines.push(format!(
        "parameters.size = {{ unit = \"N\", typical = \"{size:.9e} N\", low = \"0 N\", high = \"{:.9e} N\", about = \"RMS of the effect over the rows that it was drawn from\" }}\n",
        LARGEST * size,
    ));
    lines.join("\n")
}

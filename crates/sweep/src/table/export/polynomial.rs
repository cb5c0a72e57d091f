//! Polynomials of force and volume in the form printed in S1 (eqs. 31 and 32, Tables 1 and 2), for muscles of
//! one slenderness.
//!
//! ```text
//! F = p l0^2 (f4 k^3 + f3 k^2 + f2 k + f1 + f0/k)                 S1 eq. 31
//! V = l0^3 (v5 k^5 + v4 k^4 + v3 k^3 + v2 k^2 + v1 k + v0)        S1 eq. 32
//! F in N, V in ml, p in bar, l0 in m, contraction k in %
//! ```
//! As in the paper, the force is multiplied by k, so that its rise towards k = 0 doesn't dominate. A
//! polynomial of fourth degree is fitted to the product.

mod fit;
mod s1;

pub use s1::{ForceRow, ForceTable, S1Tables, VolumeRow, VolumeSetting, VolumeTable, s1_tables};

use bulge_table::Table;
use serde::Serialize;
use std::f64::consts::{PI, TAU};

use super::{ExportError, axes, outputs};
use fit::{Fitted, fit, value};

/// Points of a fit.
const POINTS: usize = 400;
/// Points at which the errors of the fit are measured.
const CHECKS: usize = 2000;
/// Pascals per bar, and millilitres per cubic metre: they convert f and v to the units of the paper.
const BAR: f64 = 1e5;
const MILLILITRES: f64 = 1e6;
/// Length of the muscle in the paper \[m\], for which errors are stated.
pub const S1_LENGTH: f64 = 0.11;

/// Deviation of a polynomial from its curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FitError {
    /// Largest error.
    pub largest: f64,
    /// Root mean square over the range.
    pub rms: f64,
    /// Largest error divided by the largest value in the range.
    pub of_full_scale: f64,
}

/// Force and volume polynomials of one slenderness.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PapersPolynomial {
    /// f4, f3, f2, f1, f0 of eq. 31.
    pub force: [f64; 5],
    /// v5, v4, v3, v2, v1, v0 of eq. 32.
    pub volume: [f64; 6],
    /// Contractions of the fit \[%\].
    pub range_percent: [f64; 2],
    /// Slenderness l0/R for which the polynomials hold, if it is known.
    pub slenderness: Option<f64>,
    /// Number of fibres for which the polynomials hold; none for n -> infinity.
    pub fibres: Option<u32>,
    /// Errors of the force \[N/bar\] of a muscle of 110 mm.
    pub force_error: FitError,
    /// Errors of the volume \[ml\] of a muscle of 110 mm.
    pub volume_error: FitError,
    /// Bounds of the condition numbers of the two least-squares problems, in the Chebyshev basis in which
    /// they are solved.
    pub condition: [f64; 2],
    /// Largest sum of |terms| divided by the largest |sum| in the range, for k f and for v. The coefficients
    /// need more digits by this factor.
    pub cancellation: [f64; 2],
}

impl PapersPolynomial {
    /// Force \[N\] by eq. 31 at a pressure \[bar\], a length \[m\] and a contraction \[%\] > 0.
    #[must_use]
    pub fn force_n(&self, bar: f64, length: f64, percent: f64) -> f64 {
        bar * length * length * value(&self.force, percent) / percent
    }

    /// Volume \[ml\] by eq. 32 at a length \[m\] and a contraction \[%\].
    #[must_use]
    pub fn volume_ml(&self, length: f64, percent: f64) -> f64 {
        length.powi(3) * value(&self.volume, percent)
    }
}

/// The polynomials of a table of `force_f` and `volume_v` over the contraction. If the table also has the
/// slenderness l0/R as an axis, it must be given. `fibres` is the number n of the factor (n/2 pi) sin(2 pi/n)
/// that f leaves out; none for n -> infinity. The range is in %.
///
/// The fit is a least-squares fit at 400 Chebyshev points, by orthogonal polynomials.
///
/// # Errors
/// [`ExportError::Input`] if the table has no such polynomial, or no value in the range.
pub fn papers_polynomial(
    table: &Table<'_>,
    slenderness: Option<f64>,
    fibres: Option<u32>,
    range_percent: [f64; 2],
) -> Result<PapersPolynomial, ExportError> {
    let lacks = |what: &str| ExportError::Input(format!("no polynomial of this table: {what}"));
    if fibres.is_some_and(|n| n < 3) {
        return Err(lacks("a muscle has at least 3 fibres"));
    }
    if slenderness.is_some_and(|slenderness| !slenderness.is_finite()) {
        return Err(lacks("the slenderness must be a number"));
    }
    let names: Vec<&str> = axes(table).iter().map(|axis| axis.name).collect();
    let point = |k: f64| match (names.as_slice(), slenderness) {
        (["contraction"], None) => Ok(vec![k]),
        (["contraction", "slenderness"], Some(slenderness)) => Ok(vec![k, slenderness]),
        (["contraction"], Some(_)) => Err(lacks("it has no axis `slenderness`, so none can be chosen")),
        (["contraction", "slenderness"], None) => {
            Err(lacks("it needs a slenderness l0/R, such as `--slenderness 6.875`"))
        }
        _ => Err(lacks("its axes must be `contraction` and, perhaps, `slenderness`")),
    };
    let outputs = outputs(table);
    let place = |name: &str| {
        let found = outputs.iter().position(|output| output.name == name);
        found.ok_or_else(|| lacks(&format!("it has no output `{name}`")))
    };
    let (force, volume) = (place("force_f")?, place("volume_v")?);
    let (mut values, mut gradients) = (vec![0.0; outputs.len()], vec![0.0; outputs.len() * names.len()]);
    let curve = |percent: f64| {
        let point = point(percent / 100.0)?;
        let found = table.sample(&point, &mut values, &mut gradients);
        found.ok_or_else(|| {
            ExportError::Input(format!(
                "there is no value at the contraction {percent:.4} %: choose a range inside the domain"
            ))
        })?;
        Ok([values[force], values[volume]])
    };
    fitted(curve, slenderness, fibres, range_percent)
}

/// The polynomials of a curve f, v given over the contraction in %.
fn fitted(
    mut curve: impl FnMut(f64) -> Result<[f64; 2], ExportError>,
    slenderness: Option<f64>,
    fibres: Option<u32>,
    range @ [from, to]: [f64; 2],
) -> Result<PapersPolynomial, ExportError> {
    if !(from > 0.0 && to > from && to.is_finite()) {
        return Err(ExportError::Input(format!(
            "no polynomial from {from} % to {to} %: the contractions must rise, from more than 0"
        )));
    }
    let factor = fibres.map_or(1.0, |n| f64::from(n) / TAU * (TAU / f64::from(n)).sin());
    let mut printed = |percent: f64| {
        let [f, v] = curve(percent)?;
        Ok::<_, ExportError>([percent * f * factor * BAR, v * MILLILITRES])
    };
    let (mut force, mut volume) = (vec![], vec![]);
    for percent in chebyshev_points(range) {
        let [kf, v] = printed(percent)?;
        force.push([percent, kf]);
        volume.push([percent, v]);
    }
    let force: Fitted<5> = fit(&force, range);
    let volume: Fitted<6> = fit(&volume, range);
    let (mut of_force, mut of_volume) = (Errors::default(), Errors::default());
    for i in 0..=CHECKS {
        let percent = from + (to - from) * i as f64 / CHECKS as f64;
        let [kf, v] = printed(percent)?;
        let scale = S1_LENGTH.powi(2) / percent;
        of_force.add(kf * scale, value(&force.coefficients, percent) * scale);
        let scale = S1_LENGTH.powi(3);
        of_volume.add(v * scale, value(&volume.coefficients, percent) * scale);
    }
    Ok(PapersPolynomial {
        condition: [force.condition, volume.condition],
        cancellation: [force.cancellation(range), volume.cancellation(range)],
        force: force.coefficients,
        volume: volume.coefficients,
        range_percent: range,
        slenderness,
        fibres,
        force_error: of_force.summed(),
        volume_error: of_volume.summed(),
    })
}

/// Chebyshev points of the first kind. They all lie inside the range.
fn chebyshev_points([from, to]: [f64; 2]) -> impl Iterator<Item = f64> {
    (0..POINTS).map(move |i| {
        let t = -((i as f64 + 0.5) * PI / POINTS as f64).cos();
        0.5 * (from + to) + 0.5 * (to - from) * t
    })
}

/// Errors accumulated so far.
#[derive(Debug, Clone, Copy, Default)]
struct Errors {
    largest: f64,
    squares: f64,
    scale: f64,
    count: f64,
}

impl Errors {
    fn add(&mut self, exact: f64, found: f64) {
        let error = (found - exact).abs();
        self.largest = self.largest.max(error);
        self.squares += error * error;
        self.scale = self.scale.max(exact.abs());
        self.count += 1.0;
    }

    fn summed(&self) -> FitError {
        FitError {
            largest: self.largest,
            rms: (self.squares / self.count).sqrt(),
            of_full_scale: self.largest / self.scale,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::TableForm;
    use crate::{MuscleField, Plan, Requirements, build};

    fn table(slenderness: &str) -> Vec<u8> {
        let text = format!(
            "muscle = \"ppam-2-r16\"\n[axes.contraction]\nrange = \"4 %..36 %\"\n{slenderness}[table]\ntolerance = 1e-6\n"
        );
        let plan = Plan::from_toml(&text, "s.toml", None).unwrap();
        let wish = plan.table.clone().unwrap();
        let field = MuscleField::new(&plan, &wish).unwrap();
        let wish = Requirements {
            tolerance: 1e-6,
            gradient: 1e-4,
            max_bytes: 1 << 16,
            form: TableForm::Chebyshev,
            checks: 2000,
            text: String::new(),
        };
        build(&field, &wish, &|_| {}).unwrap().bytes
    }

    #[test]
    fn polynomials_of_a_table_are_those_of_the_model() {
        let model = s1_tables().unwrap().force.of_model;
        let bytes = table("");
        let one = Table::from_bytes(&bytes).unwrap();
        let found = papers_polynomial(&one, None, Some(40), [5.0, 35.0]).unwrap();
        for (found, wanted) in
            found.force.iter().zip(model.force).chain(found.volume.iter().zip(model.volume))
        {
            assert!((found / wanted - 1.0).abs() < 1e-3, "{found} {wanted}");
        }
        assert!((found.force_error.largest - model.force_error.largest).abs() < 0.01);
        // With more fibres the force is larger.
        let many = papers_polynomial(&one, None, None, [5.0, 35.0]).unwrap();
        assert!((found.force[4] / many.force[4] - 0.995_893).abs() < 1e-6);

        let bytes = table("[axes.slenderness]\nrange = \"6..8\"\n");
        let two = Table::from_bytes(&bytes).unwrap();
        let found = papers_polynomial(&two, Some(6.875), Some(40), [5.0, 35.0]).unwrap();
        assert!((found.force[4] / model.force[4] - 1.0).abs() < 1e-3);
    }

    #[test]
    fn what_has_no_polynomial() {
        let bytes = table("");
        let one = Table::from_bytes(&bytes).unwrap();
        let refused = |slenderness, range, part: &str| {
            let message = papers_polynomial(&one, slenderness, None, range).unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        };
        refused(Some(7.0), [5.0, 35.0], "no axis `slenderness`");
        refused(None, [0.0, 35.0], "must rise, from more than 0");
        refused(None, [35.0, 5.0], "must rise");
        refused(None, [f64::NAN, 5.0], "must rise");
        refused(None, [5.0, 39.0], "choose a range inside the domain");
    }
}

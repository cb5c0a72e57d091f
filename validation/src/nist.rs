//! Nonlinear regression problems of NIST's Statistical Reference Datasets: the least squares of the fits
//! against certified values.

use bulge_numerics::least_squares::{Bounds, Minimum, Options, Residuals, minimise};
use bulge_numerics::{Dual, Real};
use std::convert::Infallible;
use std::f64::consts::PI;
use std::ops::Range;

use crate::check::{Check, Claim, Trouble};

/// A problem's name and its file among the tests of the numerics crate.
macro_rules! problem {
    ($name:literal) => {
        ($name, include_str!(concat!("../reference/nist/", $name, ".dat")))
    };
}

const PROBLEMS: [(&str, &str); 27] = [
    problem!("Misra1a"),
    problem!("Chwirut2"),
    problem!("Chwirut1"),
    problem!("Lanczos3"),
    problem!("Gauss1"),
    problem!("Gauss2"),
    problem!("DanWood"),
    problem!("Misra1b"),
    problem!("Kirby2"),
    problem!("Hahn1"),
    problem!("Nelson"),
    problem!("MGH17"),
    problem!("Lanczos1"),
    problem!("Lanczos2"),
    problem!("Gauss3"),
    problem!("Misra1c"),
    problem!("Misra1d"),
    problem!("Roszman1"),
    problem!("ENSO"),
    problem!("MGH09"),
    problem!("Thurber"),
    problem!("BoxBOD"),
    problem!("Rat42"),
    problem!("MGH10"),
    problem!("Eckerle4"),
    problem!("Rat43"),
    problem!("Bennett5"),
];

/// Most parameters of a problem.
const MOST: usize = 9;
/// Lines before the data.
const HEADER: usize = 60;

/// A problem as stated in its file.
struct Regression {
    name: &'static str,
    starts: [Vec<f64>; 2],
    certified: Vec<f64>,
    deviations: Vec<f64>,
    /// Response, then one or two predictors.
    rows: Vec<Vec<f64>>,
}

impl Regression {
    fn read(name: &'static str, text: &str) -> Result<Self, Trouble> {
        let numbers = |line: &str| line.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>();
        let mut columns = [const { Vec::new() }; 4];
        for line in text.lines().take(HEADER) {
            // b1 = first start, second start, certified value, standard deviation
            let Some((index, values)) =
                line.trim_start().strip_prefix('b').and_then(|rest| rest.split_once('='))
            else {
                continue;
            };
            if index.trim().parse::<u32>().is_ok() {
                let values = numbers(values)?;
                for (column, value) in columns.iter_mut().zip(&values) {
                    column.push(*value);
                }
            }
        }
        let mut rows = Vec::new();
        for line in text.lines().skip(HEADER).filter(|line| !line.trim().is_empty()) {
            let mut row = numbers(line)?;
            if row.len() < 2 {
                return Err(format!("{name}: a row of data has {} numbers: {line}", row.len()).into());
            }
            if name == "Nelson" {
                row[0] = row[0].ln();
            }
            rows.push(row);
        }
        let [first, second, certified, deviations] = columns;
        Ok(Self { name, starts: [first, second], certified, deviations, rows })
    }

    /// Response for the predictors x of a row.
    fn response<D: Real>(&self, b: &[D], x: &[f64]) -> D {
        let (x, last) = (x[0], x[x.len() - 1]);
        let fall = |rate: D, x: f64| (rate * -x).exp();
        let bell = |height: D, centre: D, width: D| {
            let away = (centre - x) / width;
            height * (-(away * away)).exp()
        };
        // b0 + b1 x + b2 x^2 + ...
        let sum = |b: &[D]| {
            let mut power = 1.0;
            let mut sum = D::from(0.0);
            for coefficient in b {
                sum += *coefficient * power;
                power *= x;
            }
            sum
        };
        let cycle = |period: D, cosine: D, sine: D| {
            let (s, c) = (D::from(2.0 * PI * x) / period).sin_cos();
            cosine * c + sine * s
        };
        let one = D::from(1.0);
        match self.name {
            "Misra1a" | "BoxBOD" => b[0] - b[0] * fall(b[1], x),
            "Misra1b" => {
                let half = b[1] * x * 0.5 + 1.0;
                b[0] - b[0] / (half * half)
            }
            "Misra1c" => b[0] - b[0] / (b[1] * x * 2.0 + 1.0).sqrt(),
            "Misra1d" => b[0] - b[0] / (b[1] * x + 1.0),
            "Chwirut1" | "Chwirut2" => fall(b[0], x) / sum(&b[1..3]),
            "Lanczos1" | "Lanczos2" | "Lanczos3" => {
                b[0] * fall(b[1], x) + b[2] * fall(b[3], x) + b[4] * fall(b[5], x)
            }
            "Gauss1" | "Gauss2" | "Gauss3" => {
                b[0] * fall(b[1], x) + bell(b[2], b[3], b[4]) + bell(b[5], b[6], b[7])
            }
            "DanWood" => b[0] * (b[1] * x.ln()).exp(),
            "Kirby2" => sum(&b[..3]) / (sum(&[one, b[3], b[4]])),
            "Hahn1" | "Thurber" => sum(&b[..4]) / sum(&[one, b[4], b[5], b[6]]),
            "Nelson" => b[0] - b[1] * x * fall(b[2], last),
            "MGH17" => b[0] + b[1] * fall(b[3], x) + b[2] * fall(b[4], x),
            "Roszman1" => b[0] - b[1] * x - (b[2] / (-b[3] + x)).atan() / PI,
            "ENSO" => {
                b[0] + cycle(D::from(12.0), b[1], b[2]) + cycle(b[3], b[4], b[5]) + cycle(b[6], b[7], b[8])
            }
            "MGH09" => b[0] * x * (b[1] + x) / (sum(&[b[3], b[2], one])),
            "MGH10" => b[0] * (b[1] / (b[2] + x)).exp(),
            "Rat42" => b[0] / ((b[1] - b[2] * x).exp() + 1.0),
            "Rat43" => b[0] * (-(((b[1] - b[2] * x).exp() + 1.0).ln() / b[3])).exp(),
            "Eckerle4" => {
                let away = (b[2] - x) / b[1];
                b[0] / b[1] * (away * away * -0.5).exp()
            }
            "Bennett5" => b[0] * (-((b[1] + x).ln() / b[2])).exp(),
            // The model is unknown, so the check fails.
            _ => D::from(f64::NAN),
        }
    }

    /// Largest relative errors of the parameters and of their standard deviations.
    fn errors(&self, found: &Minimum) -> [f64; 2] {
        let variance = found.cost / (self.rows.len() - self.certified.len()) as f64;
        let deviations = found.standard_deviations(variance);
        let worst = |errors: &mut dyn Iterator<Item = f64>| {
            errors.fold(
                0.0,
                |worst: f64, error| if error.is_nan() { f64::INFINITY } else { worst.max(error.abs()) },
            )
        };
        [
            worst(&mut found.theta.iter().zip(&self.certified).map(|(got, exact)| got / exact - 1.0)),
            worst(
                &mut deviations
                    .iter()
                    .zip(&self.deviations)
                    .map(|(got, exact)| got.map_or(f64::INFINITY, |got| got / exact - 1.0)),
            ),
        ]
    }
}

impl Residuals for Regression {
    type Error = Infallible;

    fn rows(&self) -> usize {
        self.rows.len()
    }

    fn parameters(&self) -> usize {
        self.certified.len()
    }

    fn evaluate(
        &self,
        theta: &[f64],
        rows: Range<usize>,
        residuals: &mut [f64],
        mut jacobian: Option<&mut [f64]>,
    ) -> Result<(), Infallible> {
        let count = theta.len();
        let duals: Vec<_> = (0..count).map(|j| Dual::<MOST>::variable(theta[j], j)).collect();
        for (i, row) in self.rows[rows].iter().enumerate() {
            let found = self.response(&duals, &row[1..]);
            residuals[i] = found.value() - row[0];
            if let Some(jacobian) = jacobian.as_deref_mut() {
                jacobian[i * count..][..count].copy_from_slice(&found.gradient()[..count]);
            }
        }
        Ok(())
    }
}

/// All 27 problems, from both starts.
pub(crate) fn nonlinear_regression() -> Check {
    Claim {
        group: "least squares",
        name: "NIST StRD nonlinear regression: 27 problems from both starts, parameters and standard deviations",
        source: "certified values of the Statistical Reference Datasets, 11 digits",
        tolerance: 1e-6,
        why: "six digits; rounding blurs the sum of squares of MGH10 at 1e-7, and is all that the deviations of Lanczos1 hold: left out",
    }
    .run(|tally| {
        for (name, text) in PROBLEMS {
            let problem = Regression::read(name, text)?;
            for (i, start) in problem.starts.iter().enumerate() {
                let found = minimise(&problem, start, &Bounds::none(start.len()), &Options::default())?;
                if !found.certificate.converged {
                    return Err(format!("{name} from start {}: {:?}", i + 1, found.certificate.reason).into());
                }
                let [parameters, deviations] = problem.errors(&found);
                let case = |what: &str| format!("{what} of {name} from start {}", i + 1);
                tally.add(parameters, || case("parameters"));
                if name != "Lanczos1" {
                    tally.add(deviations, || case("deviations"));
                }
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_read() {
        for (name, text) in PROBLEMS {
            let problem = Regression::read(name, text).unwrap();
            let count = problem.certified.len();
            assert!((2..=MOST).contains(&count) && problem.rows.len() > count, "{name}");
            assert!(problem.starts.iter().all(|start| start.len() == count), "{name}");
            assert_eq!(problem.deviations.len(), count, "{name}");
            assert!(problem.response(&problem.certified, &problem.rows[0][1..]).is_finite(), "{name}");
        }
    }
}

//! The force functions that S2, S4 and S5 fitted to Festo muscles: coefficients, correlation, loops and
//! efficiency.

use bulge_effects::law::{Law, LawGeometry, LawPoint, efficiency};
use bulge_muscles::preset;
use bulge_numerics::least_squares::{Bounds, Options, Residuals, minimise};
use std::convert::Infallible;
use std::ops::Range;

use crate::check::{Check, Claim, Trouble};
use crate::reference::values;

const FUNCTIONS: &str = include_str!("../reference/festo_force_functions.csv");
/// Law and table of each function in the file, counted from 1.
const TABLES: [(&str, &str); 7] = [
    ("sarosi-6", "DMSP-20-200N"),
    ("sarosi-6", "DMSP-20-400N"),
    ("sarosi-5-branch", "DMSP-20-200N, lengthening"),
    ("sarosi-5-branch", "DMSP-20-400N, lengthening"),
    ("sarosi-5-branch", "DMSP-20-200N, shortening"),
    ("sarosi-5-branch", "DMSP-20-400N, shortening"),
    ("sarosi-6", "DMSP-20-400N, S4"),
];

/// A law with the coefficients of a table.
struct Fitted {
    law: &'static Law,
    coefficients: &'static [f64],
    muscle: LawGeometry,
}

impl Fitted {
    fn new(law: &str, table: &str) -> Result<Self, Trouble> {
        let law = Law::find(law).ok_or_else(|| format!("there is no law {law}"))?;
        let found = law.table(table).ok_or_else(|| format!("{} has no table {table}", law.name))?;
        let muscle = LawGeometry::from(&preset("dmsp-20-250")?);
        Ok(Self { law, coefficients: found.values, muscle })
    }

    /// Force at a pressure \[bar\], a contraction \[%\] and a direction.
    fn force(&self, bar: f64, percent: f64, direction: f64) -> f64 {
        let at = LawPoint { pressure: 1e5 * bar, contraction: 0.01 * percent, direction };
        self.law.force(at, &self.muscle, self.coefficients)
    }

    /// Half of the difference between the forces in lengthening and in shortening.
    fn half_width(&self, bar: f64, percent: f64) -> f64 {
        0.5 * (self.force(bar, percent, -1.0) - self.force(bar, percent, 1.0))
    }

    /// 1 to 5 bar and 0 to 25 % in steps of 1, where the muscle pulls.
    fn grid(&self) -> Vec<(f64, f64)> {
        let all = (1..=5).flat_map(|bar| (0..=25).map(move |percent| (f64::from(bar), f64::from(percent))));
        all.filter(|(bar, percent)| self.force(*bar, *percent, 0.0) > 0.0).collect()
    }
}

/// Every coefficient as printed.
pub(crate) fn printed_functions() -> Check {
    Claim {
        group: "force laws",
        name: "exponential functions of Festo muscles with the printed coefficients, seven tables",
        source: "S2 eqs. 16, 17 and Tables 1 to 6, S4 eq. 1 and Table 1, typed and evaluated separately",
        tolerance: 1e-10,
        why: "12 printed digits; against at least 10 N",
    }
    .run(|tally| {
        let rows = values::<4>(FUNCTIONS)?;
        for ((law, table), number) in TABLES.into_iter().zip(1_u8..) {
            let fitted = Fitted::new(law, table)?;
            for [_, bar, percent, expected] in
                rows.iter().filter(|row| (row[0] - f64::from(number)).abs() < 0.5)
            {
                let force = fitted.force(*bar, *percent, 0.0);
                tally.scaled(force, *expected, 10.0, || format!("{law} {table}, {bar} bar, {percent} %"));
            }
        }
        Ok(())
    })
}

/// The contraction at which the function lifts the loads of S4, against the value that S4 read from its
/// chart.
pub(crate) fn sizing_examples() -> Check {
    Claim {
        group: "force laws",
        name: "S4's examples of sizing: contraction in % at which 30, 50 and 70 kg are lifted with 3 to 5 bar",
        source: "S4 eq. 1, Table 1 and its worked examples, 9.81 m/s^2",
        tolerance: 0.25,
        why: "contractions are read from a chart to half a per cent",
    }
    .run(|tally| {
        let fitted = Fitted::new("sarosi-6", "DMSP-20-400N, S4")?;
        for (bar, printed, kilograms) in [
            (4.5, 14.5, 50.0),
            (4.0, 12.5, 50.0),
            (4.0, 17.5, 30.0),
            (4.0, 7.5, 70.0),
            (3.0, 6.5, 50.0),
            (5.0, 16.5, 50.0),
            (3.0, 12.5, 30.0),
            (5.0, 12.5, 70.0),
        ] {
            let (mut low, mut high) = (0.0, 25.0);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if fitted.force(bar, middle, 0.0) > 9.81 * kilograms { low = middle } else { high = middle }
            }
            tally.absolute(low, printed, || format!("{kilograms} kg with {bar} bar at {low:.2} %"));
        }
        Ok(())
    })
}

/// S2 fits eq. 16 and eq. 17 to the same measurements, which it does not print. Eq. 17 is eq. 16 with a = 1
/// N/bar, so the squares add up: for any measurements, R^2(16) - R^2(17) is the squared difference of the two
/// functions divided by the variance of the force.
pub(crate) fn correlation() -> Check {
    Claim {
        group: "force laws",
        name: "R^2(eq. 16) - R^2(eq. 17) of S2: 0.9995 - 0.9994 (200 mm), 0.9995 - 0.9993 (400 mm)",
        source: "S2 Figs. 9, 10, 13, 14; the measurements themselves are not printed, so that only the difference can be computed",
        tolerance: 1e-4,
        why: "two numbers rounded to 1e-4; where S2 measured moves the difference by 3e-5",
    }
    .run(|tally| {
        for (six, five, printed) in [
            ("DMSP-20-200N", "DMSP-20-200N, lengthening", 1e-4),
            ("DMSP-20-400N", "DMSP-20-400N, lengthening", 2e-4),
        ] {
            let (six, branch) = (Fitted::new("sarosi-6", six)?, Fitted::new("sarosi-5-branch", five)?);
            let grid = six.grid();
            let forces = || grid.iter().map(|(bar, percent)| six.force(*bar, *percent, 0.0));
            let mean = forces().sum::<f64>() / grid.len() as f64;
            let spread: f64 = forces().map(|force| (force - mean).powi(2)).sum();
            let apart: f64 = forces()
                .zip(&grid)
                .map(|(force, (bar, percent))| (branch.force(*bar, *percent, 0.0) - force).powi(2))
                .sum();
            tally.absolute(apart / spread, printed, || format!("{:.6} of {five}", apart / spread));
        }
        Ok(())
    })
}

/// Half the width of the loop as a linear function of 1, the pressure \[bar\] and exp(-kappa/3 %).
struct HalfWidth {
    loops: Fitted,
    grid: Vec<(f64, f64)>,
}

impl Residuals for HalfWidth {
    type Error = Infallible;

    fn rows(&self) -> usize {
        self.grid.len()
    }

    fn parameters(&self) -> usize {
        3
    }

    fn evaluate(
        &self,
        theta: &[f64],
        rows: Range<usize>,
        residuals: &mut [f64],
        mut jacobian: Option<&mut [f64]>,
    ) -> Result<(), Infallible> {
        for (i, &(bar, percent)) in self.grid[rows].iter().enumerate() {
            let terms = [1.0, bar, (-percent / 3.0).exp()];
            let sum: f64 = terms.iter().zip(theta).map(|(term, part)| term * part).sum();
            residuals[i] = sum - self.loops.half_width(bar, percent);
            if let Some(jacobian) = jacobian.as_deref_mut() {
                jacobian[3 * i..][..3].copy_from_slice(&terms);
            }
        }
        Ok(())
    }
}

/// Half the widths of the loops of S2, and their fit by a constant, the pressure and a decay.
pub(crate) fn half_widths() -> Check {
    Claim {
        group: "force laws",
        name: "half the loop: 18.7 and 20.5 N at 3 bar, 10 % (1.3 and 1.4 % of full scale), and its fit by h0 + h1 p + h2 exp(-kappa/3 %)",
        source: "S2 eq. 17, Tables 3 to 6, evaluated and fitted with NumPy over 1 to 5 bar, 0 to 25 % where the muscle pulls",
        tolerance: 1e-4,
        why: "five printed digits",
    }
    .run(|tally| {
        for (name, width, share, fit, rms) in [
            ("DMSP-20-200N", 18.7002, 0.012_789_7, [14.1173, 1.393_18, 18.5874], 1.997_05),
            ("DMSP-20-400N", 20.5259, 0.013_617_4, [17.2039, 0.861_658, 23.3125], 2.318_62),
        ] {
            let loops = Fitted::new("sarosi-5", name)?;
            let found = loops.half_width(3.0, 10.0);
            tally.relative(found, width, || format!("{found:.4} N, {name}"));
            let part = found / loops.force(5.0, 0.0, -1.0);
            tally.relative(part, share, || format!("{part:.6} of full scale, {name}"));
            let grid = Fitted::new("sarosi-6", name)?.grid();
            let problem = HalfWidth { loops, grid };
            let found = minimise(&problem, &[10.0, 1.0, 10.0], &Bounds::none(3), &Options::default())?;
            for (i, (got, expected)) in found.theta.iter().zip(fit).enumerate() {
                tally.relative(*got, expected, || format!("h{i} = {got:.5}, {name}"));
            }
            let missed = (found.cost / problem.rows() as f64).sqrt();
            tally.relative(missed, rms, || format!("{missed:.5} N rms, {name}"));
        }
        Ok(())
    })
}

/// S5 shows its efficiencies only in a figure; here the functions of S2 of the same type stand for the
/// measurement.
pub(crate) fn efficiencies() -> Check {
    Claim {
        group: "force laws",
        name: "efficiency F/F_t of a DMSP-20: 0.92 to 0.94 at rest while shortening, falling with contraction at every pressure",
        source: "S5 eqs. 11, 13 and Table 2 with the force of S2 eq. 17, Table 5; evaluated separately",
        tolerance: 1e-5,
        why: "six printed digits",
    }
    .run(|tally| {
        let (theory, measured) = (
            Fitted::new("chou-hannaford", "DMSP-20-250")?,
            Fitted::new("sarosi-5-branch", "DMSP-20-200N, shortening")?,
        );
        let eta = |bar: f64, percent: f64| {
            efficiency(measured.force(bar, percent, 0.0), theory.force(bar, percent, 0.0))
                .ok_or_else(|| format!("no efficiency at {bar} bar, {percent} %"))
        };
        for (bar, expected) in [
            (3.0, [0.920_742, 0.625_201, 0.485_584, 0.319_289]),
            (5.0, [0.938_738, 0.762_104, 0.675_974, 0.566_705]),
            (6.0, [0.943_237, 0.796_329, 0.723_571, 0.628_558]),
        ] {
            for (percent, expected) in [0.0, 5.0, 10.0, 15.0].into_iter().zip(expected) {
                tally.relative(eta(bar, percent)?, expected, || format!("{bar} bar, {percent} %"));
            }
            for percent in 0..20 {
                let [here, next] = [percent, percent + 1].map(|percent| eta(bar, f64::from(percent)));
                let rise = (next? - here?).max(0.0);
                tally.absolute(rise, 0.0, || format!("rise beyond {percent} % at {bar} bar"));
            }
        }
        Ok(())
    })
}

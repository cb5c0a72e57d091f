//! A simulated test of the pleated muscle with four effects and noise of a fixed seed. Loading and fitting
//! are timed on it.
//!
//! At five pressures (1 to 3 bar), the contraction follows triangles between 3 and 30 %, once slowly and once
//! at five times that speed; the second triangle has an inner loop. The true numbers are in [`TRUTH`].

use bulge_effects::{Catalogue, Effect};
use bulge_measurements::{Columns, Data, Labels, Trace};
use bulge_model::{Model, Record, Wanted};
use bulge_muscles::{Muscle, Quantity, preset};
use std::fmt::Write;
use std::sync::Arc;

use crate::Failure;

/// The effects with the numbers that generate the data: 12 N; 150 N s; 0.2 %/kN (EA of all fibres 500 kN);
/// 0.4 mm.
pub const TRUTH: [(&str, f64); 4] = [
    ("coulomb-friction", 12.0),
    ("viscous-damping", 150.0),
    ("fibre-stretch", 2e-6),
    ("length-zero-error", 4e-4),
];
/// Standard deviations of the noise of force \[N\], pressure \[Pa\] and contraction.
const NOISE: [f64; 3] = [1.0, 30.0, 1e-5];
/// Pressures \[Pa\], and rates of contraction \[1/s\].
const PRESSURES: [f64; 5] = [1e5, 1.5e5, 2e5, 2.5e5, 3e5];
const RATES: [f64; 2] = [0.02, 0.1];
/// Turning points of the contraction in a sweep.
const CORNERS: [f64; 7] = [0.03, 0.30, 0.03, 0.20, 0.10, 0.30, 0.03];

/// The pleated muscle of the benches.
///
/// # Errors
/// Never: it is shipped.
pub fn muscle() -> Result<Muscle, Failure> {
    Ok(preset("ppam-2-r16")?)
}

/// The effects of [`TRUTH`] in their order.
///
/// # Errors
/// Never: they are in the catalogue.
pub fn effects(catalogue: &Catalogue) -> Result<Vec<Arc<dyn Effect>>, Failure> {
    Ok(TRUTH.iter().map(|(name, _)| catalogue.find(name).cloned()).collect::<Result<_, _>>()?)
}

/// About `rows` rows of the test.
///
/// # Errors
/// Never: the effects are possible for the muscle.
pub fn columns(rows: usize) -> Result<Columns, Failure> {
    let each = (rows / (PRESSURES.len() * RATES.len())).max(2);
    let (mut pressure, mut contraction, mut time, mut sweep) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for level in PRESSURES {
        for rate in RATES {
            let start = time.last().map_or(0.0, |end| end + 60.0);
            let way: f64 = CORNERS.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
            for i in 0..each {
                let along = way * i as f64 / (each - 1) as f64;
                pressure.push(level);
                contraction.push(at(along));
                time.push(start + along / rate);
                sweep.push(format!("{} kPa, {} %/s", level / 1e3, 100.0 * rate));
            }
        }
    }
    let count = pressure.len();
    let mut columns = Columns::new(pressure, Trace::Contraction(contraction), vec![0.0; count]);
    columns.time_s = Some(time);
    columns.sweep = Some(Labels::from_iter(sweep));
    columns.force_n = forces(&columns)?;
    let mut noise = Noise(1);
    let Trace::Contraction(contraction) = &mut columns.motion else {
        return Err("contractions were given".into());
    };
    for ((force, pressure), contraction) in
        columns.force_n.iter_mut().zip(&mut columns.pressure_pa).zip(contraction)
    {
        *force += NOISE[0] * noise.normal();
        *pressure += NOISE[1] * noise.normal();
        *contraction += NOISE[2] * noise.normal();
    }
    Ok(columns)
}

/// The contraction at a distance along the path through the corners.
fn at(along: f64) -> f64 {
    let mut left = along;
    for pair in CORNERS.windows(2) {
        let leg = (pair[1] - pair[0]).abs();
        if left <= leg {
            return pair[0] + (pair[1] - pair[0]) * left / leg;
        }
        left -= leg;
    }
    CORNERS[CORNERS.len() - 1]
}

/// The forces of the muscle with the true effects, without noise.
fn forces(columns: &Columns) -> Result<Vec<f64>, Failure> {
    let muscle = muscle()?;
    let catalogue = Catalogue::builtin();
    let mut model = Model::new(&muscle);
    for (effect, (_, value)) in effects(&catalogue)?.iter().zip(TRUTH) {
        model = model.with(effect, Some(&[value]))?;
    }
    let record = Record::new(&Data::from_columns(columns.clone())?, muscle.length().si());
    Ok(model.evaluate(&record, &model.start(), &Wanted::default())?.force)
}

/// The columns as CSV.
#[must_use]
pub fn csv(columns: &Columns) -> String {
    let mut text = "time [s],pressure [bar],contraction [%],force [N],sweep\n".to_owned();
    let time = columns.time_s.as_deref().unwrap_or_default();
    let sweep = columns.sweep.as_ref().map(|labels| (labels.rows(), labels.names()));
    let motion = columns.motion.values();
    for row in 0..columns.force_n.len() {
        let (p, c) = (columns.pressure_pa[row] / 1e5, 100.0 * motion[row]);
        let label = sweep.map_or("", |(rows, names)| &names[rows[row] as usize]);
        // Writing to a string can't fail.
        let _ = writeln!(text, "{:.4},{p:.5},{c:.4},{:.3},\"{label}\"", time[row], columns.force_n[row]);
    }
    text
}

/// Reproducible normal random numbers from a 64-bit linear congruential sequence (Knuth's MMIX constants) by
/// the Box-Muller transform.
struct Noise(u64);

impl Noise {
    /// Uniform in (0, 1).
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let (radius, angle) = ((-2.0 * self.uniform().ln()).sqrt(), std::f64::consts::TAU * self.uniform());
        radius * angle.cos()
    }
}

//! Simulated readings for tests: a random sequence with a seed, and clean loops with every relevant column.

use crate::columns::{Columns, Labels, Trace};

/// Reproducible normal numbers: a 64-bit linear congruential sequence (Knuth's MMIX constants) and Box and Muller's transform.
pub(crate) struct Noise(u64);

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        let mut noise = Self(seed);
        noise.uniform();
        noise
    }

    /// Uniform in (0, 1).
    pub(crate) fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    /// Normal with mean 0 and variance 1.
    pub(crate) fn normal(&mut self) -> f64 {
        let (radius, angle) = ((-2.0 * self.uniform().ln()).sqrt(), std::f64::consts::TAU * self.uniform());
        radius * angle.cos()
    }
}

/// A muscle's force in the tests: falls with contraction, with a friction of 6 N \[Pa, -, +-1 -> N\].
pub(crate) fn force(pressure: f64, contraction: f64, direction: f64) -> f64 {
    2e-3 * pressure * (1.0 - 2.8 * contraction) - 6.0 * direction
}

/// Rows of one loop of [`clean_loop`].
pub(crate) const LOOP: usize = 400;

/// Sine loops between 2 % and 22 % contraction at 1, 2 and 3 bar, 10 ms per row, one sweep per pressure, `loops` loops each,
/// with noise of 30 Pa, 10^-5 and 0.5 N.
pub(crate) fn clean_loops(loops: usize, seed: u64) -> Columns {
    let mut noise = Noise::new(seed);
    let (mut pressure, mut contraction, mut force_n, mut time, mut sweep) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for level in 1..=3_u32 {
        for i in 0..=loops * LOOP {
            let phase = std::f64::consts::TAU * i as f64 / LOOP as f64;
            let p = 1e5 * f64::from(level);
            let c = 0.12 - 0.10 * phase.cos();
            // Friction changes sign within a few rows, as in a braid.
            let direction = (20.0 * phase.sin()).tanh();
            pressure.push(p + 30.0 * noise.normal());
            contraction.push(c + 1e-5 * noise.normal());
            force_n.push(force(p, c, direction) + 0.5 * noise.normal());
            time.push(100.0 * f64::from(level) + 0.01 * i as f64);
            sweep.push(level.to_string());
        }
    }
    let mut columns = Columns::new(pressure, Trace::Contraction(contraction), force_n);
    columns.time_s = Some(time);
    columns.sweep = Some(Labels::from_iter(sweep));
    columns
}

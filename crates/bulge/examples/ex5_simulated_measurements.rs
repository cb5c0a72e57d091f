//! Example 5. What would a test bench show of a muscle whose effects we know?
//!
//! A model is a base law with effects, evaluated along a history. Here a braid with clamped ends, a rubber bladder (c10 = 0.31 MPa) and Coulomb
//! friction (14 N) is moved three times through a loop at five pressures and read with the noise of a load cell. The output is the data file of the
//! tour, `crates/cli/data/braid-loops.csv`; the muscle file beside it knows nothing of the three effects.
//! Expect 750 rows, the first of them 2.000 bar, 1.010 %, 501 N within a few newtons.
//! Try next: another effect (`bulge effects`), another seed, and whether `bulge compare` finds its size.

use bulge::effects::{Catalogue, Moment};
use bulge::model::{Model, Record, Wanted};
use bulge::muscles::from_toml;

const MUSCLE: &str = include_str!("../../cli/data/braid.toml");
/// What the muscle file doesn't say: each effect with its numbers in SI.
const HIDDEN: [(&str, &[f64]); 3] =
    [("end-taper", &[]), ("bladder-elasticity", &[0.31e6]), ("coulomb-friction", &[14.0])];
const ROWS_OF_A_LOOP: usize = 50;

/// Reproducible normal numbers: a linear congruential sequence (Knuth's MMIX constants), Box and Muller's transform.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let (radius, angle) = ((-2.0 * self.uniform().ln()).sqrt(), std::f64::consts::TAU * self.uniform());
        radius * angle.cos()
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let catalogue = Catalogue::builtin();
    let mut model = Model::new(&from_toml(MUSCLE, "braid.toml")?);
    for (name, numbers) in HIDDEN {
        model = model.with(catalogue.find(name)?, Some(numbers))?;
    }
    // Three loops at each pressure, to where the muscle nearly stops pulling.
    let mut moments = Vec::new();
    let mut sweeps = Vec::new();
    for (bar, most) in [(2.0, 0.11), (3.0, 0.15), (4.0, 0.18), (5.0, 0.20), (6.0, 0.21)] {
        let start = moments.len();
        for i in 0..3 * ROWS_OF_A_LOOP {
            let phase = std::f64::consts::TAU * (i as f64 + 0.5) / ROWS_OF_A_LOOP as f64;
            let contraction = 0.01 + (most - 0.01) * 0.5 * (1.0 - phase.cos());
            moments.push(Moment {
                direction: phase.sin().signum(),
                begins: i == 0,
                ..Moment::at_rest(bar * 1e5, contraction)
            });
        }
        sweeps.push(start..moments.len());
    }
    let record = Record::from_moments(moments.clone(), vec![0.0; moments.len()], sweeps.clone())
        .ok_or("the sweeps don't fit the moments")?;
    let force = model.evaluate(&record, &model.start(), &Wanted::default())?.force;

    println!(
        "# Simulated, not measured: a 20 mm braid on a test bench, written by crates/bulge/examples/ex5_simulated_measurements.rs,"
    );
    println!(
        "# which says what is hidden in it. Three loops of 50 s at each of five pressures; noise 2 N and 100 Pa."
    );
    println!("time [s],sweep,pressure [bar],contraction [%],force [N]");
    let mut noise = Noise(20);
    for (number, sweep) in sweeps.iter().enumerate() {
        for row in sweep.clone() {
            let pressure = moments[row].pressure + 100.0 * noise.normal();
            let force = force[row] + 2.0 * noise.normal();
            let percent = 100.0 * moments[row].contraction;
            println!("{row},{},{:.4},{percent:.3},{force:.1}", number + 1, pressure / 1e5);
        }
    }
    Ok(())
}

//! Example 6. Where does the textbook fail, and which effects make the error fall?
//!
//! Measurements (here those of example 5) are compared with the muscle as its data sheet describes it, then with one effect more on each rung
//! of a ladder. Each rung is fitted anew; its error on held-out pressures says whether it learnt the muscle or the noise.
//! Expect 228 N, 175 N with clamped ends, 14.1 N with the bladder, 2.1 N with friction: the noise of the load cell. c10 = 0.31 MPa, 14 N.
//! Try next: another order, or a wrong cure (`radius-error`, `braid-angle-error`), which is flagged.

use bulge::effects::Catalogue;
use bulge::inference::{Options, compare};
use bulge::measurements::Data;
use bulge::muscles::from_toml;
use std::sync::Arc;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let muscle = from_toml(include_str!("../../cli/data/braid.toml"), "braid.toml")?;
    let data = Data::from_csv(include_str!("../../cli/data/braid-loops.csv"), "braid-loops.csv")?;
    let catalogue = Catalogue::builtin();
    let mut effects = Vec::new();
    for name in ["end-taper", "bladder-elasticity", "coulomb-friction"] {
        effects.push(Arc::clone(catalogue.find(name)?));
    }
    let comparison = compare(&data, &muscle, &Options::new(catalogue, effects))?;
    for rung in &comparison.ladder {
        println!(
            "{:<40} {:>6.1} N   held out {:>6.1} N",
            rung.title,
            rung.rmse_n,
            rung.held_out_rmse_n.unwrap_or(0.0)
        );
    }
    let fit = comparison.ladder[3].fit.as_ref().ok_or("the last rung has a fit")?;
    for number in &fit.parameters {
        println!(
            "{} = {:.3} ({:.3} to {:.3}) {}",
            number.effect, number.value, number.low, number.high, number.unit
        );
    }
    let [rubber, friction] = [&fit.parameters[0], &fit.parameters[1]];
    assert!((rubber.value - 0.31).abs() < 0.001 && (friction.value - 14.0).abs() < 0.3);
    assert!(comparison.ladder[3].rmse_n < 2.1 && comparison.warnings.is_empty());
    Ok(())
}

//! Windings: closed forms on cylinders and rings, polylines in space, order of convergence, inverse,
//! linearity and zones.

mod curves;
mod mistakes;
mod places;
mod readings;

use super::*;
use bulge_effects::{Catalogue, known};
use bulge_fibre::{Approach, Given, Problem};
use bulge_model::MuscleWithEffects;
use bulge_muscles::{Muscle, Pressure, Quantity as _, from_toml, preset};
use std::f64::consts::TAU;

fn bar(value: f64) -> Pressure {
    Pressure::bar(value)
}

fn muscle(text: &str) -> Muscle {
    from_toml(text, "m.toml").unwrap()
}

fn alone(muscle: &Muscle) -> MuscleWithEffects {
    MuscleWithEffects::new(muscle, &[]).unwrap()
}

fn ppam() -> MuscleWithEffects {
    alone(&preset("ppam-2-r16").unwrap())
}

fn braid() -> MuscleWithEffects {
    alone(&muscle(
        "name = \"b\"\nkind = \"braided\"\nlength = \"80 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\n",
    ))
}

fn cylinder() -> MuscleWithEffects {
    alone(&muscle(
        "name = \"c\"\nkind = \"braided\"\nlength = \"200 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"cylinder\"\n",
    ))
}

/// A thin channel centred on the fibres.
fn zone(start: f64, end: f64, turns: f64) -> Winding {
    Winding {
        start,
        end,
        turns,
        section_m2: 1e-14,
        offset_m: 0.0,
        layer: Layer::Kept,
        resistivity_ohm_m: EGAIN_RESISTIVITY_OHM_M,
    }
}

fn sensor_with(muscle: &MuscleWithEffects, winding: Winding, options: Options) -> Sensor {
    Sensor::new(muscle, bar(2.0), winding, Reference::Rest, options).unwrap()
}

fn sensor(muscle: &MuscleWithEffects, winding: Winding) -> Sensor {
    sensor_with(muscle, winding, Options::default())
}

#[track_caller]
fn close(found: f64, expected: f64, relative: f64) {
    let off = (found / expected - 1.0).abs();
    assert!(off <= relative, "{found} is not {expected}: off by {off:e}");
}

/// A layer of 0.5 mm with a channel of 0.05 mm^2.
fn layer(start: f64, end: f64, turns: f64) -> Winding {
    Winding { offset_m: 0.5e-3, layer: Layer::Thinning, section_m2: 0.05e-6, ..zone(start, end, turns) }
}

fn search(to: f64, widths: [f64; 2], goal: Goal) -> Search {
    let width_steps = if widths[0] < widths[1] { 4 } else { 1 };
    let range = Range { from: 0.05, to, points: 26 };
    Search { range, widths, width_steps, centres: 15, goal }
}

/// An impossible input is refused with a message that has this part.
fn assert_refused<T: std::fmt::Debug>(found: Result<T, SensingError>, part: &str) {
    let Err(SensingError::Input(message)) = found else { panic!("{found:?}") };
    assert!(message.contains(part), "{message}");
}

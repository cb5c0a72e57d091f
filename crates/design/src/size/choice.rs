//! A muscle of one length at one pressure that carries the load, and its margins.

use bulge_numerics::root::illinois;
use serde::Serialize;

use super::family::CutMuscle;
use super::load::LoadCase;
use super::{LoadPoint, SizeError};

/// State of a muscle at a point of the load.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AtPoint {
    /// Travel \[m\].
    pub travel_m: f64,
    /// Force that the load needs \[N\].
    pub force_n: f64,
    /// Contraction of the muscle at this point.
    pub contraction: f64,
    /// Pull of the muscle at this point at the operating pressure \[N\]; `None` if its fibres are straight,
    /// so that it can pull any force.
    pub available_n: Option<f64>,
    /// Gauge pressure at which the muscle just holds the load at this point \[Pa\]. Over the points it is the
    /// pressure history as the load moves.
    pub holding_pressure_pa: f64,
}

/// The given quantity and the sought one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "given")]
pub enum Given {
    /// The operating pressure is given; the shortest length is sought.
    Pressure {
        /// Given pressure \[Pa\].
        pressure_pa: f64,
    },
    /// The length is given; the lowest pressure is sought.
    Length {
        /// Given length \[m\].
        length_m: f64,
    },
    /// Nothing is given; the best compromise is sought.
    Compromise,
}

/// A muscle that carries the load.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Choice {
    /// Name of the muscle.
    pub family: String,
    /// Source of its forces.
    pub basis: String,
    /// Nominal diameter \[m\].
    pub diameter_m: f64,
    /// Length at zero pressure \[m\].
    pub length_m: f64,
    /// Operating gauge pressure \[Pa\].
    pub pressure_pa: f64,
    /// The given quantity.
    #[serde(flatten)]
    pub given: Given,
    /// Contractions at the beginning and at the end of the stroke.
    pub contraction: [f64; 2],
    /// The points of the load.
    pub points: Vec<AtPoint>,
    /// Smallest ratio of available to needed force, minus 1, anywhere on the way.
    pub force_margin: f64,
    /// Distance to the highest pressure, relative to that pressure.
    pub pressure_margin: f64,
    /// Distance to the largest contraction, relative to that contraction.
    pub contraction_margin: f64,
    /// Strain of the muscle's life, 0 to 1; see the module.
    pub strain: f64,
}

/// A muscle that doesn't carry the load.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Infeasible {
    /// Name of the muscle.
    pub family: String,
    /// The given quantity.
    #[serde(flatten)]
    pub given: Given,
    /// The reason in words, with numbers.
    pub why: String,
}

/// Tolerance of a pressure \[Pa\].
const PRESSURE_TOLERANCE: f64 = 1e-3;

/// Contraction of a muscle after a travel.
pub(super) fn contraction(muscle: &CutMuscle<'_>, travel_m: f64) -> f64 {
    muscle.family().limits().contraction[0] + travel_m / muscle.length_m()
}

/// Smallest ratio of pull to needed force (times 1 + margin), minus 1, on a way, and the point at which it
/// occurs.
pub(super) fn least(
    muscle: &CutMuscle<'_>,
    pressure_pa: f64,
    way: &[LoadPoint],
    margin: f64,
) -> Result<(f64, LoadPoint), SizeError> {
    let mut least = (f64::INFINITY, LoadPoint { travel_m: 0.0, force_n: 0.0 });
    for point in way.iter().filter(|point| point.force_n > 0.0) {
        let available = muscle.force_n(pressure_pa, contraction(muscle, point.travel_m))?;
        let ratio = available / ((1.0 + margin) * point.force_n) - 1.0;
        if ratio < least.0 {
            least = (ratio, *point);
        }
    }
    Ok(least)
}

/// The pressure at which a muscle just pulls a force at a contraction; the highest pressure if it can't pull
/// that force.
pub(super) fn holding_pressure(
    muscle: &CutMuscle<'_>,
    contraction: f64,
    force_n: f64,
) -> Result<f64, SizeError> {
    let highest = muscle.family().limits().pressure_pa;
    if force_n <= 0.0 {
        return Ok(0.0);
    }
    let mut failed = None;
    let missing = |p: f64| match muscle.force_n(p, contraction) {
        // The force is infinite if the fibres are straight; any pressure then suffices.
        Ok(force) => (force - force_n).clamp(-force_n, force_n),
        Err(error) => {
            failed.get_or_insert(error);
            f64::NAN
        }
    };
    let pressure = illinois(missing, 0.0, highest, PRESSURE_TOLERANCE);
    failed.map_or(Ok(pressure), Err)
}

impl Choice {
    /// The choice of a muscle at a pressure.
    pub(super) fn new(
        muscle: &CutMuscle<'_>,
        pressure_pa: f64,
        given: Given,
        load: &LoadCase,
    ) -> Result<Self, SizeError> {
        let (family, limits) = (muscle.family(), muscle.family().limits());
        let points = load
            .points()
            .iter()
            .map(|LoadPoint { travel_m, force_n }| {
                let contraction = contraction(muscle, *travel_m);
                let available = muscle.force_n(pressure_pa, contraction)?;
                Ok(AtPoint {
                    travel_m: *travel_m,
                    force_n: *force_n,
                    contraction,
                    available_n: available.is_finite().then_some(available),
                    holding_pressure_pa: holding_pressure(muscle, contraction, *force_n)?,
                })
            })
            .collect::<Result<Vec<_>, SizeError>>()?;
        let (force_margin, _) = least(muscle, pressure_pa, &load.path(), 0.0)?;
        let [low, high] = limits.contraction;
        let end = contraction(muscle, load.stroke_m());
        let [pressed, drawn] = [pressure_pa / limits.pressure_pa, end / high];
        Ok(Self {
            family: family.name().to_owned(),
            basis: family.basis().to_owned(),
            diameter_m: muscle.diameter_m(),
            length_m: muscle.length_m(),
            pressure_pa,
            given,
            contraction: [low, end],
            points,
            force_margin,
            pressure_margin: 1.0 - pressed,
            contraction_margin: 1.0 - drawn,
            strain: (0.5 * (pressed * pressed + drawn * drawn)).sqrt(),
        })
    }
}

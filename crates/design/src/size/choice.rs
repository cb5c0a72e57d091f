//! A muscle of one length at one pressure that carries the load, and how well.

use bulge_numerics::root::illinois;
use serde::Serialize;

use super::family::CutMuscle;
use super::load::LoadCase;
use super::{LoadPoint, SizeError};

/// How a muscle stands at a point of the load.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AtPoint {
    /// Travel \[m\].
    pub travel_m: f64,
    /// Force that the load needs \[N\].
    pub force_n: f64,
    /// The muscle's contraction there.
    pub contraction: f64,
    /// What it pulls there at the operating pressure \[N\]; `None`: its fibres are straight and it pulls anything.
    pub available_n: Option<f64>,
    /// Gauge pressure at which it just holds the load there \[Pa\]: the way of the pressure as the load moves.
    pub holding_pressure_pa: f64,
}

/// What was given, and what was sought.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "given")]
pub enum Given {
    /// The operating pressure, for the shortest length.
    Pressure {
        /// It \[Pa\].
        pressure_pa: f64,
    },
    /// The length, for the lowest pressure.
    Length {
        /// It \[m\].
        length_m: f64,
    },
    /// Neither: the best compromise.
    Compromise,
}

/// A muscle that carries the load.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Choice {
    /// Which muscle.
    pub family: String,
    /// Where its forces come from.
    pub basis: String,
    /// Nominal diameter \[m\].
    pub diameter_m: f64,
    /// Length without pressure \[m\].
    pub length_m: f64,
    /// Operating gauge pressure \[Pa\].
    pub pressure_pa: f64,
    /// What was given.
    #[serde(flatten)]
    pub given: Given,
    /// Contractions where the muscle begins and where the stroke ends.
    pub contraction: [f64; 2],
    /// The points of the load.
    pub points: Vec<AtPoint>,
    /// Least of available over needed force, less 1, anywhere on the way.
    pub force_margin: f64,
    /// What is left to the highest pressure, over it.
    pub pressure_margin: f64,
    /// What is left to the largest contraction, over it.
    pub contraction_margin: f64,
    /// Strain of the muscle's life, 0 to 1: see the module.
    pub strain: f64,
}

/// A muscle that doesn't carry the load.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Infeasible {
    /// Which muscle.
    pub family: String,
    /// What was given.
    #[serde(flatten)]
    pub given: Given,
    /// Why not, in words, with the numbers.
    pub why: String,
}

/// Pressures are found to this \[Pa\].
const PRESSURE_TOLERANCE: f64 = 1e-3;

/// Where a muscle begins, and the contraction after a travel.
pub(super) fn contraction(muscle: &CutMuscle<'_>, travel_m: f64) -> f64 {
    muscle.family().limits().contraction[0] + travel_m / muscle.length_m()
}

/// The least of what a muscle pulls over what is needed (times 1 + margin), less 1, on a way, and where.
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

/// The pressure at which a muscle just pulls a force at a contraction; the highest one where it can't.
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
        // Infinite where the fibres are straight: any pressure does.
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
    /// How a muscle stands at a pressure.
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

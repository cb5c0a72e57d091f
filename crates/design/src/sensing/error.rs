//! Why a winding has no resistance, no contraction or no best zone.

use bulge_fibre::FibreError;

/// What is wrong, where, and how to correct it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SensingError {
    /// A number outside its range.
    #[error("the {what} is {value}: it must be {needs}")]
    Number {
        /// The number.
        what: &'static str,
        /// Its value in SI units.
        value: f64,
        /// Its required range.
        needs: &'static str,
    },
    /// An invalid winding zone.
    #[error(
        "the winding zone from {start} to {end} of the fibre length is none: it must lie in 0..1, with its end at least 1e-6 beyond its start"
    )]
    Zone {
        /// Start, as a fraction of the fibre length.
        start: f64,
        /// End.
        end: f64,
    },
    /// Neighbouring turns would overlap.
    #[error(
        "the turns of the channel are {:.4} mm apart, but it is {:.4} mm wide: take fewer turns, a wider zone or a smaller section", 1e3 * pitch_m, 1e3 * diameter_m
    )]
    Crowded {
        /// Meridian per turn in the reference \[m\].
        pitch_m: f64,
        /// Diameter of a round channel of this section \[m\].
        diameter_m: f64,
    },
    /// The offset surface folds, or nothing of the layer is left.
    #[error(
        "a channel {:.4} mm outside the fibres has no place at {:.2} % of the fibre length: the muscle is too sharply waisted there; take a thinner layer", 1e3 * offset_m, 100.0 * at
    )]
    Folded {
        /// Offset in the reference \[m\].
        offset_m: f64,
        /// Position as a fraction of the fibre length.
        at: f64,
    },
    /// The muscle has no equilibrium in this state.
    #[error("the winding has no resistance at {pressure_pa} Pa and contraction {:.4} %: {error}", 100.0 * contraction)]
    Equilibrium {
        /// Gauge pressure \[Pa\].
        pressure_pa: f64,
        /// Contraction.
        contraction: f64,
        /// Error of the solver.
        error: Box<FibreError>,
    },
    /// The meridian isn't one of the winding's muscle, or has too few points.
    #[error(
        "this meridian doesn't fit the winding: {why}; give a shape of the same muscle with at least 7 points"
    )]
    Meridian {
        /// The reason.
        why: &'static str,
    },
    /// The elastomer would tear.
    #[error(
        "at contraction {:.3} % the channel is strained by {:.1} % at {:.2} % of the fibre length, more than the {:.1} % that the elastomer bears: \
         contract less, wind nearer to the fittings or with fewer turns, or take the reference at a larger radius",
        100.0 * contraction, 100.0 * strain, 100.0 * at, 100.0 * allowed
    )]
    Overstrained {
        /// Contraction.
        contraction: f64,
        /// Largest strain along the channel.
        strain: f64,
        /// Its position, as a fraction of the fibre length.
        at: f64,
        /// Largest strain allowed.
        allowed: f64,
    },
    /// The resistance doesn't change with the contraction.
    #[error(
        "the resistance changes by less than 1e-9 of itself over this range: this winding feels nothing; give it turns where the radius changes"
    )]
    NoChange,
    /// Two contractions with the same resistance.
    #[error(
        "the resistance does not rise or fall all the way: it turns between contraction {:.3} % and {:.3} %, so that it doesn't tell the contraction; choose another zone or a shorter range",
        100.0 * between[0], 100.0 * between[1]
    )]
    NotMonotone {
        /// Contractions between which it turns.
        between: [f64; 2],
    },
    /// The resistance is outside the range of the curve.
    #[error("the resistance {resistance_ohm} ohm lies outside those of the curve, {} ohm to {} ohm: measure within it, or compute a wider curve", range_ohm[0], range_ohm[1])]
    OutsideCurve {
        /// Given resistance \[ohm\].
        resistance_ohm: f64,
        /// Smallest and largest resistance of the curve \[ohm\].
        range_ohm: [f64; 2],
    },
    /// The curve belongs to another sensor.
    #[error("this curve is not one of this winding: compute it with the same sensor")]
    OtherCurve,
    /// The root search ended without a root.
    #[error("no contraction was found to the resistance {resistance_ohm} ohm near {:.4} %: compute the curve with more points", 100.0 * near)]
    NoContraction {
        /// Given resistance \[ohm\].
        resistance_ohm: f64,
        /// Last contraction tried.
        near: f64,
    },
    /// No zone meets the requirements.
    #[error(
        "none of the {scanned} zones is good enough: the largest mean sensitivity of a monotone one is {largest:.6} per contraction, {wanted:.6} is wanted, \
         and {overstrained} zones strain the elastomer too much; ask for less, or allow other widths or a shorter range"
    )]
    NoPlace {
        /// Zones tried.
        scanned: usize,
        /// Largest sensitivity |dR/de|/R0 among monotone zones within the strain limit; 0 if there is none.
        largest: f64,
        /// Smallest sensitivity required.
        wanted: f64,
        /// Number of zones that strain the elastomer too much.
        overstrained: usize,
    },
}

//! Errors of an equilibrium, with their numbers.

use bulge_muscles::units::significant;
use bulge_muscles::{Fault, Force, Length, Pressure, Ratio, Volume};

use crate::problem::{MOST_STRAIN, WIDEST_FITTING};

/// No equilibrium, or none was found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FibreError {
    /// Without gauge pressure nothing balances the fibres.
    #[error("the gauge pressure is {}: it must be greater than 0", Pressure::pa(*pressure_pa))]
    PressureNotPositive {
        /// Asked pressure \[Pa\].
        pressure_pa: f64,
    },
    /// A given number is not finite.
    #[error("the {what} is {value}: it must be a finite number")]
    NotFinite {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A number that must be positive isn't.
    #[error("the {what} is {value}: it must be greater than 0")]
    NotPositive {
        /// Which number.
        what: &'static str,
        /// Its value in SI.
        value: f64,
    },
    /// A dimension outside the range for which the solver is verified.
    #[error("the {what} of this muscle is {}: meridians are computed from {low} to {high}", significant(*value, 7))]
    OutOfRange {
        /// Which dimension.
        what: &'static str,
        /// Its value.
        value: f64,
        /// Smallest value.
        low: f64,
        /// Largest value.
        high: f64,
    },
    /// The cloth would be taut before the muscle bulges.
    #[error("the cloth is unfolded at a radius of {:.4}, less than the {:.4} of the fibres at the fittings: it must not be narrower than these", Length::m(*taut_m), Length::m(*end_m))]
    ClothTooNarrow {
        /// Radius at which the cloth is unfolded \[m\].
        taut_m: f64,
        /// Radius at the fittings \[m\].
        end_m: f64,
    },
    /// The fibres would lie along the parallels at these fittings.
    #[error("the fittings have a radius of {:.4}, and this muscle can't be wider than {:.4}, where its fibres lie along the circumference: at most {:.4}", Length::m(*end_m), Length::m(*widest_m), Length::m(WIDEST_FITTING * widest_m))]
    FittingTooWide {
        /// Radius of the fittings \[m\].
        end_m: f64,
        /// r0/sin(alpha0), or what a formula for the turn of the fibres leaves \[m\].
        widest_m: f64,
    },
    /// A user's own formula has no value.
    #[error(
        "the formula for `{what}` is {value} at rest (l1 = l2 = 1, r = r0): it needs a finite value there; look at its logarithms, roots and divisions"
    )]
    FormulaWithoutValue {
        /// Which formula.
        what: &'static str,
        /// The value that it gives.
        value: f64,
    },
    /// A user's own formula has no value or slope at a radius that the wall may take.
    #[error(
        "at contraction {:.4} the wall may be stretched to l1 = {along:.4}, l2 = {around:.4}, where the formula for `{what}` or its slope isn't finite; write one that is finite there", percent(*contraction)
    )]
    FormulaEnds {
        /// Asked contraction.
        contraction: f64,
        /// Which formula.
        what: &'static str,
        /// The stretch along the meridian.
        along: f64,
        /// The stretch around the axis.
        around: f64,
    },
    /// The slope of a user's own formula jumps.
    #[error(
        "no equilibrium is computed at contraction {:.4}: the slope of the formula for `{what}` jumps at l1 = {along:.4}, l2 = {around:.4}, so that the wall would keep that radius over a length; write a kink whose slope is continuous, such as max(l2 - 1.2, 0)^2", percent(*contraction)
    )]
    FormulaJumps {
        /// Asked contraction.
        contraction: f64,
        /// Which formula.
        what: &'static str,
        /// The stretch along the meridian.
        along: f64,
        /// The stretch around the axis.
        around: f64,
    },
    /// A formula gives the area, and so does the cloth.
    #[error("a formula for `area` says the area, and so does `{other}`: leave one of them out")]
    AreaTwice {
        /// The effect that gives an area, too.
        other: &'static str,
    },
    /// The contraction lies beyond the one at which the force vanishes.
    #[error(
        "no equilibrium with a pulling force at contraction {:.4}: the limit of this muscle is {:.4}, where the force vanishes",
        percent(*contraction), percent(*limit)
    )]
    BeyondLimit {
        /// Asked contraction.
        contraction: f64,
        /// Contraction at which the force is zero.
        limit: f64,
    },
    /// Nothing is left between the fittings.
    #[error("no equilibrium at contraction {:.4}: a muscle that contracts by 100 % has no length (a contraction without unit is a fraction: write \"20 %\" or 0.2)", percent(*contraction))]
    NoLength {
        /// Asked contraction.
        contraction: f64,
    },
    /// The muscle would have to be longer than its inextensible fibres allow.
    #[error(
        "no equilibrium at contraction {:.4}: it must be greater than {:.4}, where the inextensible fibres are drawn straight (give `fibre.stiffness` to let them stretch)",
        percent(*contraction), percent(*limit)
    )]
    TooLong {
        /// Asked contraction.
        contraction: f64,
        /// Smallest contraction (negative: the muscle is longer than at rest).
        limit: f64,
    },
    /// The fibres are so soft that the muscle balloons: no equilibrium with a fibre strain below 1 was found.
    #[error(
        "no equilibrium found: the fibres are too soft and the muscle balloons (p sin(2 pi/n) l0^2/(4 EA) of straight fibres, 2 pi p r0^2/(n EA sin^2(alpha0)) of a braid, is {group:.3}; slender muscles balloon from {limit} on, others may before); raise fibre.stiffness or lower the pressure"
    )]
    TooSoft {
        /// The elastic group of one fibre times the squared slenderness.
        group: f64,
        /// Its limit for a slender muscle.
        limit: f64,
    },
    /// The muscle would be drawn out farther than any fibre bears.
    #[error(
        "no equilibrium at contraction {:.4}: its fibres would be stretched by {:.1}, and none bears more than {:.0}; ask for less length or force", percent(*contraction), Ratio::one(*strain), Ratio::one(MOST_STRAIN)
    )]
    Overstretched {
        /// Asked contraction.
        contraction: f64,
        /// Strain of the fibres there.
        strain: f64,
    },
    /// The muscle would have to push, and the contraction at which its force vanishes was not found.
    #[error(
        "no equilibrium with a pulling force at contraction {:.4}: the muscle would push with {:.6}", percent(*contraction), Force::n(-force_n)
    )]
    WouldPush {
        /// Asked contraction.
        contraction: f64,
        /// Force there \[N\], negative.
        force_n: f64,
    },
    /// A muscle pulls; it can't push.
    #[error("no equilibrium with a force of {:.6}: a muscle only pulls, from 0 N at its contraction limit of {:.4}", Force::n(*force_n), percent(*limit))]
    Pushes {
        /// Asked force \[N\].
        force_n: f64,
        /// Contraction at which the force is zero.
        limit: f64,
    },
    /// The volume is larger than at any contraction at which the muscle pulls.
    #[error("no equilibrium with a volume of {:.4}: this muscle holds at most {:.4}, at contraction {:.4}, {why}", Volume::m3(*volume_m3), Volume::m3(*high_m3), percent(*contraction))]
    VolumeTooLarge {
        /// Asked volume \[m^3\].
        volume_m3: f64,
        /// The largest volume \[m^3\].
        high_m3: f64,
        /// Its contraction.
        contraction: f64,
        /// Why it holds no more.
        why: &'static str,
    },
    /// The volume is smaller than that of the muscle drawn out as far as it goes, or contracted to its limit.
    #[error("no equilibrium with a volume of {:.4}: it must be greater than {:.4}, the least that this muscle holds while it pulls", Volume::m3(*volume_m3), Volume::m3(*low_m3))]
    VolumeTooSmall {
        /// Asked volume \[m^3\].
        volume_m3: f64,
        /// The least volume \[m^3\].
        low_m3: f64,
    },
    /// The force is larger than any that was found at any length.
    #[error("no equilibrium with a force of {:.6}: the largest force found is {:.6}, at contraction {:.4}", Force::n(*force_n), Force::n(*high_n), percent(*contraction))]
    ForceTooLarge {
        /// Asked force \[N\].
        force_n: f64,
        /// Largest force \[N\].
        high_n: f64,
        /// Its contraction.
        contraction: f64,
    },
    /// No contraction with this volume was found at which the muscle pulls.
    #[error("no pulling equilibrium with a volume of {:.4} was found; `bulge curve` shows the volumes of this muscle", Volume::m3(*volume_m3))]
    VolumeNotFound {
        /// Asked volume \[m^3\].
        volume_m3: f64,
    },
    /// The closed form was asked for a muscle that has none.
    #[error("there is no closed form for this muscle: {why}; use the method `shooting` or `auto`")]
    NoClosedForm {
        /// The reason why there is none.
        why: &'static str,
    },
    /// Shooting was asked for a muscle without a meridian to integrate.
    #[error(
        "there is nothing to shoot at in a muscle with ends = \"cylinder\": its meridian is straight; use the method `auto`, or ends = \"clamped\""
    )]
    NothingToShoot,
    /// The rubber carries more than the pressure: there is no equilibrium with taut fibres, and one with
    /// slack ones isn't computed.
    #[error("at contraction {:.4} the fibres are slack{}: the bladder alone carries more than the pressure there; more pressure or less contraction makes them taut", percent(*contraction), slack_from(*limit))]
    Slack {
        /// Asked contraction.
        contraction: f64,
        /// The contraction at which the fibres become slack at this pressure, if it was asked for.
        limit: Option<f64>,
    },
    /// The fibres don't hold the long middle: it would bulge and narrow in turn.
    #[error("no equilibrium with one middle at contraction {:.4}: the gas acts so far inside the fibres that they don't hold a cylinder of this length, it would bulge and narrow in turn; a thinner wall or a shorter muscle has one", percent(*contraction))]
    Undulates {
        /// Asked contraction.
        contraction: f64,
    },
    /// Newton's method did not converge.
    #[error("the equilibrium at contraction {:.4} did not converge: residual {residual:.2e} after {iterations} iterations; try a contraction nearer to the middle of the muscle's range", percent(*contraction))]
    NotConverged {
        /// Asked contraction.
        contraction: f64,
        /// Last residual.
        residual: f64,
        /// Iterations spent.
        iterations: u32,
    },
}

/// In percent, with no sign where four digits show nothing else.
fn percent(contraction: f64) -> Ratio {
    Ratio::one(if contraction.abs() < 5e-7 { 0.0 } else { contraction })
}

fn slack_from(limit: Option<f64>) -> String {
    limit.map_or_else(String::new, |limit| format!(", as they are from {:.4} on", percent(limit)))
}

impl FibreError {
    /// Whose fault it is.
    #[must_use]
    pub fn fault(&self) -> Fault {
        match self {
            Self::NotConverged { .. } | Self::VolumeNotFound { .. } => Fault::NotConverged,
            Self::PressureNotPositive { .. }
            | Self::NotFinite { .. }
            | Self::NotPositive { .. }
            | Self::ClothTooNarrow { .. }
            | Self::FittingTooWide { .. }
            | Self::FormulaWithoutValue { .. }
            | Self::FormulaEnds { .. }
            | Self::FormulaJumps { .. }
            | Self::AreaTwice { .. }
            | Self::NoLength { .. }
            | Self::NoClosedForm { .. }
            | Self::NothingToShoot => Fault::Input,
            _ => Fault::NoSolution,
        }
    }
}

//! What can go wrong in an equilibrium, with the numbers.

/// No equilibrium, or none was found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FibreError {
    /// Without gauge pressure nothing balances the fibres.
    #[error("the gauge pressure is {pressure_pa} Pa: it must be greater than 0")]
    PressureNotPositive {
        /// Asked pressure \[Pa\].
        pressure_pa: f64,
    },
    /// A number that is asked for is not a number.
    #[error("the {what} is {value}: it must be a finite number")]
    NotFinite {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A dimension outside the range for which the solver is verified.
    #[error("the {what} of this muscle is {value:.6}: meridians are computed from {low} to {high}")]
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
    /// The contraction lies beyond the one at which the force vanishes.
    #[error(
        "no equilibrium with a pulling force at contraction {:.4} %: the limit of this muscle is {:.4} %, where the force vanishes",
        100.0 * contraction, 100.0 * limit
    )]
    BeyondLimit {
        /// Asked contraction.
        contraction: f64,
        /// Contraction at which the force is zero.
        limit: f64,
    },
    /// Nothing is left between the fittings.
    #[error("no equilibrium at contraction {:.4} %: a muscle that contracts by 100 % has no length", 100.0 * contraction)]
    NoLength {
        /// Asked contraction.
        contraction: f64,
    },
    /// The muscle would have to be longer than its inextensible fibres allow.
    #[error(
        "no equilibrium at contraction {:.4} %: it must be greater than {:.4} %, where the inextensible fibres are drawn straight (give `fibre.stiffness` to let them stretch)",
        100.0 * contraction, 100.0 * limit
    )]
    TooLong {
        /// Asked contraction.
        contraction: f64,
        /// Smallest contraction (negative: the muscle is longer than at rest).
        limit: f64,
    },
    /// The fibres are so soft that the muscle balloons: no equilibrium with a fibre strain below 1.
    #[error(
        "no equilibrium: the fibres are too soft and the muscle balloons (p sin(2 pi/n) l0^2/(4 EA) = {group:.3}, the limit is about {limit}); raise fibre.stiffness or lower the pressure"
    )]
    TooSoft {
        /// The elastic group of one fibre times the squared slenderness.
        group: f64,
        /// Its limit for a slender muscle.
        limit: f64,
    },
    /// The force can't be reached at this pressure.
    #[error("no equilibrium with a force of {force_n:.6} N: at this pressure the muscle pulls at most {largest_n:.6} N (at contraction {:.4} %)", 100.0 * contraction)]
    ForceTooLarge {
        /// Asked force \[N\].
        force_n: f64,
        /// Largest force found \[N\].
        largest_n: f64,
        /// The contraction there.
        contraction: f64,
    },
    /// A muscle pulls; it can't push.
    #[error("no equilibrium with a force of {force_n:.6} N: a muscle only pulls, from 0 N at its contraction limit of {:.4} %", 100.0 * limit)]
    Pushes {
        /// Asked force \[N\].
        force_n: f64,
        /// Contraction at which the force is zero.
        limit: f64,
    },
    /// The volume can't be reached at this pressure.
    #[error("no equilibrium with a volume of {:.4} ml: this muscle holds {:.4} ml to {:.4} ml", 1e6 * volume_m3, 1e6 * low_m3, 1e6 * high_m3)]
    VolumeOutOfReach {
        /// Asked volume \[m^3\].
        volume_m3: f64,
        /// Smallest volume \[m^3\].
        low_m3: f64,
        /// Volume at the contraction limit \[m^3\].
        high_m3: f64,
    },
    /// The closed form was asked for a muscle that has none.
    #[error("there is no closed form for this muscle: {why}; use the method `shooting` or `auto`")]
    NoClosedForm {
        /// What stands against it.
        why: &'static str,
    },
    /// Shooting was asked for a muscle without a meridian to integrate.
    #[error(
        "there is nothing to shoot at in a muscle with ends = \"cylinder\": its meridian is straight; use the method `auto`, or ends = \"clamped\""
    )]
    NothingToShoot,
    /// Newton's method did not converge.
    #[error("the equilibrium at contraction {:.4} % did not converge: residual {residual:.2e} after {iterations} iterations; try a contraction nearer to the middle of the range, or stiffer fibres", 100.0 * contraction)]
    NotConverged {
        /// Asked contraction.
        contraction: f64,
        /// Last residual.
        residual: f64,
        /// Iterations spent.
        iterations: u32,
    },
}

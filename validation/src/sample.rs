//! Random muscles for properties that must hold for all muscles. They are the same in every run.

use bulge_muscles::{
    Angle, Braided, Construction, Fibre, FibreCount, Force, Length, Muscle, MuscleError, Parameter, Pleated,
    Pressure,
};

/// A deterministic source of muscles (splitmix64: G. Steele, D. Lea, C. Flood, OOPSLA 2014).
#[derive(Debug, Clone)]
pub struct Sampler {
    state: u64,
    /// What the first numbers are made of, two bytes each, in reverse.
    bytes: Vec<u8>,
}

impl Sampler {
    /// The sequence of a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self { state: seed, bytes: Vec::new() }
    }

    /// A sequence whose first numbers follow two bytes each, so that a fuzzer that changes some bytes changes
    /// some numbers of a muscle.
    #[must_use]
    pub fn of_bytes(bytes: &[u8]) -> Self {
        Self { state: 0, bytes: bytes.iter().rev().copied().collect() }
    }

    fn bits(&mut self) -> u64 {
        let random = self.random();
        match (self.bytes.pop(), self.bytes.pop()) {
            (Some(high), Some(low)) => u64::from(high) << 56 | u64::from(low) << 48 | random >> 16,
            _ => random,
        }
    }

    fn random(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.state ^ (self.state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    /// Uniform in the logarithm.
    pub fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// One of several.
    pub fn one_of<T: Copy>(&mut self, choices: &[T; 4]) -> T {
        match self.bits() >> 62 {
            0 => choices[0],
            1 => choices[1],
            2 => choices[2],
            _ => choices[3],
        }
    }

    /// True with a probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.between(0.0, 1.0) < probability
    }

    /// An index below `count`, which is above 0.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and the count")]
    pub fn below(&mut self, count: usize) -> usize {
        (self.between(0.0, count as f64) as usize).min(count - 1)
    }

    /// A gauge pressure between 0.1 and 8 bar.
    pub fn pressure(&mut self) -> Pressure {
        Pressure::bar(self.log_between(0.1, 8.0))
    }

    /// A muscle of either kind within the ranges of the solver, with a random selection of features.
    ///
    /// # Errors
    /// Never, unless a range here is wrong.
    pub fn muscle(&mut self) -> Result<Muscle, MuscleError> {
        if self.chance(0.5) { self.pleated() } else { self.braided() }
    }

    fn pleated(&mut self) -> Result<Muscle, MuscleError> {
        let radius = self.log_between(0.002, 0.05);
        let length = radius * self.log_between(0.5, 1000.0);
        let count = self.one_of(&[Some(3), Some(12), Some(40), None]);
        let count = count.map_or(FibreCount::Continuous, FibreCount::Discrete);
        let pleated = Construction::Pleated(Pleated::new(Length::m(radius), count)?);
        let mut muscle = Muscle::new("pleated", Length::m(length), pleated)?;
        if self.chance(0.3) {
            // The strain is about 0.1 % to 10 %: for a slack muscle the group p l0^2/(n EA) is its cube.
            let total = 8e5 * length * length / self.log_between(1e-5, 1e-2);
            let each = total / muscle.fibres().map_or(1.0, f64::from);
            muscle = muscle.with_fibre(Fibre::new(Force::n(each))?)?;
        }
        if self.chance(0.25) {
            muscle = muscle.with(Parameter::PleatDepth, radius * self.between(0.01, 0.3))?;
        }
        if self.chance(0.25) && length < 90.0 * radius {
            // The fibre would lie along a parallel where r sin(gamma) = R; the bulge of a slender muscle
            // stays below 0.4 l0.
            let most = (0.8 * radius / (radius + 0.4 * length)).asin();
            muscle = muscle.with(Parameter::Misalignment, most * self.between(0.05, 1.0))?;
        }
        if self.chance(0.25) {
            muscle = muscle.with_all(&self.cloth(radius, 0.1 * length))?;
        }
        Ok(muscle)
    }

    fn braided(&mut self) -> Result<Muscle, MuscleError> {
        let radius = self.log_between(0.002, 0.03);
        let length = radius * self.log_between(1.0, 100.0);
        let angle = self.between(5.0, 50.0);
        let braided = Braided::new(Length::m(radius), Angle::deg(angle))?.with_fibres(60)?;
        let mut muscle = Muscle::new("braid", Length::m(length), Construction::Braided(braided))?;
        if self.chance(0.3) {
            muscle = muscle.with(Parameter::FittingRadius, radius * self.between(0.7, 1.2))?;
        }
        if self.chance(0.3) {
            let stiffness = 8e5 * radius * length / self.log_between(1e-5, 3e-2) / 60.0;
            muscle = muscle.with_fibre(Fibre::new(Force::n(stiffness))?)?;
        }
        if self.chance(0.4) {
            let modulus = Pressure::mpa(self.log_between(0.02, 0.5)).to_pa();
            let second = Pressure::mpa(self.between(0.0, 0.05)).to_pa();
            let wall = (Parameter::Wall, radius * self.between(0.01, 0.15));
            muscle = muscle.with_all(&[wall, (Parameter::C10, modulus), (Parameter::C01, second)])?;
        }
        if self.chance(0.2) {
            muscle = muscle.with_all(&self.cloth(1.2 * radius, 0.4 * radius))?;
        }
        Ok(muscle)
    }

    /// Cloth that is slack at the fitting. Cloth that is taut there may prevent any bulging.
    fn cloth(&mut self, radius: f64, bulge: f64) -> [(Parameter, f64); 2] {
        let unfolded = radius + bulge * self.between(0.02, 2.0);
        let stiffness = unfolded * 1e5 * self.log_between(0.1, 30.0);
        [(Parameter::HoopStiffness, stiffness), (Parameter::UnfoldedRadius, unfolded)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_muscles::Quantity;

    #[test]
    fn the_same_in_every_run_and_never_invalid() {
        let (mut one, mut two) = (Sampler::new(3), Sampler::new(3));
        let mut kinds = [0; 4];
        for _ in 0..300 {
            let muscle = one.muscle().unwrap();
            assert_eq!(muscle, two.muscle().unwrap());
            assert_eq!(one.pressure().si().to_bits(), two.pressure().si().to_bits());
            for (seen, has) in kinds.iter_mut().zip([
                muscle.is_pleated(),
                muscle.fibre().is_some(),
                muscle.bladder_wall().is_some(),
                muscle.get(Parameter::HoopStiffness).is_some(),
            ]) {
                *seen += i32::from(has);
            }
        }
        assert!(kinds.iter().all(|seen| *seen > 30), "{kinds:?}");
    }
}

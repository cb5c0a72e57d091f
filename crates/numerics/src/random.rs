//! Counter-based random numbers: Philox4x32-10 (Salmon, Moraes, Dror, Shaw: Parallel random numbers: as easy
//! as 1, 2, 3, SC'11).

use std::f64::consts::TAU;

/// Multipliers of the two halves of the counter.
const MULTIPLIERS: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
/// Increments of the key in each round.
const STEPS: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
const ROUNDS: usize = 10;

/// The random numbers of one stream of a seed.
///
/// Block i of the stream is the Philox permutation of (i, stream) under the key `seed`. Streams with
/// different numbers therefore never share a block, and the values of one stream don't depend on how many
/// were drawn from another: streams can be used in parallel.
///
/// [`uniform`](Self::uniform) is identical on all machines; the other methods use `ln`, `exp_m1` and `cos`,
/// and are identical where these are.
#[derive(Debug, Clone)]
pub struct Random {
    key: [u32; 2],
    stream: u64,
    next_block: u64,
    /// The second word of a block, after the first one was returned.
    word: Option<u64>,
    /// The second normal number of a pair.
    spare: Option<f64>,
}

impl Random {
    /// The stream with the number `stream` of `seed`, from its beginning.
    #[must_use]
    pub fn new(seed: u64, stream: u64) -> Self {
        Self { key: halves(seed), stream, next_block: 0, word: None, spare: None }
    }

    /// Uniform in (0, 1) without the ends: (k + 1/2) 2^-52 with the 52 random bits k.
    pub fn uniform(&mut self) -> f64 {
        ((self.bits() >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
    }

    /// Uniform between `low` and `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Normal with mean 0 and variance 1, from uniform u and v (Box and Muller 1958):
    ///
    /// ```text
    /// sqrt(-2 ln u) cos(2 pi v),    sqrt(-2 ln u) sin(2 pi v)
    /// ```
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        let angle = TAU * self.uniform();
        self.spare = Some(radius * angle.sin());
        radius * angle.cos()
    }

    /// Student's t with `dof` degrees of freedom (variance dof/(dof - 2), not 1), from uniform u and v (Bailey 1994, Math. Comp. 62, 779):
    ///
    /// ```text
    /// sqrt(dof (u^(-2/dof) - 1)) cos(2 pi v)
    /// ```
    /// `dof` is from 1 (Cauchy) to infinity (normal); smaller values are taken as 1.
    pub fn student(&mut self, dof: f64) -> f64 {
        let dof = dof.max(1.0);
        if dof.is_infinite() {
            return self.normal();
        }
        let radius = (dof * (-2.0 / dof * self.uniform().ln()).exp_m1()).sqrt();
        radius * (TAU * self.uniform()).cos()
    }

    fn bits(&mut self) -> u64 {
        if let Some(word) = self.word.take() {
            return word;
        }
        let ([a, b], [c, d]) = (halves(self.next_block), halves(self.stream));
        self.next_block = self.next_block.wrapping_add(1);
        let block = philox([a, b, c, d], self.key);
        self.word = Some(joined(block[2], block[3]));
        joined(block[0], block[1])
    }
}

/// Low and high half.
#[expect(clippy::cast_possible_truncation, reason = "the halves of a word")]
fn halves(word: u64) -> [u32; 2] {
    [word as u32, (word >> 32) as u32]
}

fn joined(low: u32, high: u32) -> u64 {
    u64::from(high) << 32 | u64::from(low)
}

fn philox(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    for _ in 0..ROUNDS {
        let [low_0, high_0] = halves(u64::from(MULTIPLIERS[0]) * u64::from(counter[0]));
        let [low_1, high_1] = halves(u64::from(MULTIPLIERS[1]) * u64::from(counter[2]));
        counter = [high_1 ^ counter[1] ^ key[0], low_1, high_0 ^ counter[3] ^ key[1], low_0];
        for (part, step) in key.iter_mut().zip(STEPS) {
            *part = part.wrapping_add(step);
        }
    }
    counter
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_those_the_authors_publish() {
        // Known answers of Random123, `kat_vectors`, philox4x32 10.
        assert_eq!(philox([0; 4], [0; 2]), [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);
        assert_eq!(
            philox([u32::MAX; 4], [u32::MAX; 2]),
            [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]
        );
        assert_eq!(
            philox([0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344], [0xa409_3822, 0x299f_31d0]),
            [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]
        );
    }

    #[test]
    fn moments_are_those_of_the_distributions() {
        let n = 200_000;
        let mut random = Random::new(1, 0);
        let mut mean = |draw: &mut dyn FnMut(&mut Random) -> f64| {
            (0..n).map(|_| draw(&mut random)).sum::<f64>() / f64::from(n)
        };
        // Four standard errors each.
        assert!((mean(&mut Random::uniform) - 0.5).abs() < 4.0 * 0.289 / 447.0);
        assert!(mean(&mut Random::normal).abs() < 4.0 / 447.0);
        assert!((mean(&mut |r| r.normal().powi(2)) - 1.0).abs() < 4.0 * 1.414 / 447.0);
        assert!((mean(&mut |r| r.normal().powi(4)) - 3.0).abs() < 4.0 * 9.8 / 447.0);
        // P(|t| < 0.741) = 1/2 for 4 degrees of freedom, and P(|t| < 2.776) = 0.95.
        assert!((mean(&mut |r| f64::from(r.student(4.0).abs() < 0.740_697)) - 0.5).abs() < 2.0 / 447.0);
        assert!(
            (mean(&mut |r| f64::from(r.student(4.0).abs() < 2.776_445)) - 0.95).abs() < 4.0 * 0.218 / 447.0
        );
        assert!(
            (mean(&mut |r| f64::from(r.student(f64::INFINITY).abs() < 1.959_964)) - 0.95).abs()
                < 4.0 * 0.218 / 447.0
        );
    }

    #[test]
    fn students_t_is_baileys_formula_of_two_uniforms() {
        let (mut draws, mut uniforms) = (Random::new(5, 0), Random::new(5, 0));
        for _ in 0..100 {
            let [u, v] = [uniforms.uniform(), uniforms.uniform()];
            let expected = (4.0 * (u.powf(-0.5) - 1.0)).sqrt() * (TAU * v).cos();
            assert!((draws.student(4.0) / expected - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn streams_and_seeds_differ_and_repeat() {
        let draw = |seed, stream| {
            let mut random = Random::new(seed, stream);
            (0..100).map(|_| random.normal()).collect::<Vec<f64>>()
        };
        assert_eq!(draw(7, 3), draw(7, 3));
        for (a, b) in [(draw(7, 3), draw(7, 4)), (draw(7, 3), draw(8, 3)), (draw(7, 3), draw(3, 7))] {
            let product: f64 = a.iter().zip(&b).map(|(x, y)| x * y).sum();
            assert!(product.abs() < 40.0, "{product}");
        }
    }

    #[test]
    fn between_reaches_both_ends_and_nothing_else() {
        let mut random = Random::new(5, 1);
        let drawn: Vec<f64> = (0..1000).map(|_| random.between(-3.0, 5.0)).collect();
        let [least, most] = [
            drawn.iter().copied().fold(f64::INFINITY, f64::min),
            drawn.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        ];
        assert!((-3.0..-2.98).contains(&least) && (4.98..5.0).contains(&most), "{least} {most}");
    }
}

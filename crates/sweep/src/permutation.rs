//! A keyed permutation of the numbers below n. It is evaluated one number at a time and needs no memory.

/// Rounds of the network. Four already hide the order, but the small networks of a few points need more.
const ROUNDS: usize = 8;
/// Increment of the counter of SplitMix64: 2^64 divided by the golden ratio.
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// A bijection of the numbers below `size`, chosen by a key.
///
/// A Feistel network of two equal halves permutes the numbers below the next power of 4. A number outside the
/// range is permuted again until it falls inside, which always happens (Black and Rogaway, Ciphers with
/// arbitrary finite domains, CT-RSA 2002). This takes fewer than 4 turns on average.
#[derive(Debug, Clone)]
pub(crate) struct Permutation {
    size: u64,
    half_bits: u32,
    keys: [u64; ROUNDS],
}

impl Permutation {
    /// The permutation number `index` of a seed; `size` is at most 2^62.
    pub(crate) fn new(size: u64, seed: u64, index: u64) -> Self {
        let bits = u64::BITS - size.saturating_sub(1).leading_zeros();
        let mut state = mixed(seed).wrapping_add(mixed(index ^ GOLDEN));
        let keys = std::array::from_fn(|_| {
            state = state.wrapping_add(GOLDEN);
            mixed(state)
        });
        Self { size, half_bits: bits.div_ceil(2).max(1), keys }
    }

    /// Image of `number`; a number beyond the size is taken modulo the size.
    pub(crate) fn of(&self, number: u64) -> u64 {
        if self.size <= 1 {
            return 0;
        }
        let mut at = number % self.size;
        loop {
            at = self.network(at);
            if at < self.size {
                return at;
            }
        }
    }

    fn network(&self, number: u64) -> u64 {
        let mask = (1 << self.half_bits) - 1;
        let (mut left, mut right) = (number >> self.half_bits, number & mask);
        for key in self.keys {
            // The upper bits are the best mixed ones.
            let scrambled = mixed(right ^ key) >> (u64::BITS - self.half_bits);
            (left, right) = (right, left ^ scrambled);
        }
        left << self.half_bits | right
    }
}

/// The finaliser of SplitMix64 (Steele, Lea and Flood, Fast splittable pseudorandom number generators, OOPSLA
/// 2014).
fn mixed(word: u64) -> u64 {
    let word = (word ^ word >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let word = (word ^ word >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    word ^ word >> 31
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_hit_once() {
        for size in (1..=70).chain([127, 128, 129, 1000, 4095, 4096, 4097, 65_537]) {
            for index in 0..3 {
                let permutation = Permutation::new(size, 7, index);
                let mut hit = vec![false; usize::try_from(size).unwrap()];
                for number in 0..size {
                    let at = usize::try_from(permutation.of(number)).unwrap();
                    assert!(!std::mem::replace(&mut hit[at], true), "{size}: {at} twice");
                }
            }
        }
    }

    #[test]
    fn large_sizes_stay_in_range_and_apart() {
        for size in [(1 << 48) - 59, 1 << 48, (1 << 48) + 1, 1 << 62] {
            let permutation = Permutation::new(size, 1, 0);
            let mut found: Vec<u64> = (0..1000).chain(size - 1000..size).map(|n| permutation.of(n)).collect();
            assert!(found.iter().all(|at| *at < size));
            // Both halves of the range are reached.
            assert!((850..1150).contains(&found.iter().filter(|at| **at < size / 2).count()));
            found.sort_unstable();
            found.dedup();
            assert_eq!(found.len(), 2000);
        }
    }

    /// Over many keys each number is mapped everywhere equally often, and two indices of one seed are
    /// independent.
    #[test]
    fn keys_are_independent() {
        let (size, keys) = (5_u64, 20_000);
        let mut counts = [[0_u32; 5]; 5];
        let mut pairs = [[0_u32; 5]; 5];
        for seed in 0..keys {
            let (first, second) = (Permutation::new(size, seed, 0), Permutation::new(size, seed, 1));
            let at = |p: &Permutation, n| usize::try_from(p.of(n)).unwrap();
            for (number, row) in (0..).zip(&mut counts) {
                row[at(&first, number)] += 1;
            }
            pairs[at(&first, 2)][at(&second, 2)] += 1;
        }
        // Five standard deviations of a binomial number of mean 4000, and of mean 800.
        assert!(counts.iter().flatten().all(|n| n.abs_diff(4000) < 283), "{counts:?}");
        assert!(pairs.iter().flatten().all(|n| n.abs_diff(800) < 139), "{pairs:?}");
    }

    /// The order of neighbours is lost: after the permutation it is as likely to rise as to fall.
    #[test]
    fn order_is_lost() {
        let size = 10_000;
        let permutation = Permutation::new(size, 3, 2);
        let rises = (1..size).filter(|n| permutation.of(*n) > permutation.of(n - 1)).count();
        // The number of ascents has the variance (n + 1)/12.
        assert!((4850..5150).contains(&rises), "{rises}");
        assert_eq!(permutation.of(size + 3), permutation.of(3));
    }
}

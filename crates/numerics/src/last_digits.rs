//! Whether processors compute the same last digits.

/// A number that tells processors apart whose elementary functions differ in their last digits, as those with
/// fused operations do from others.
///
/// Steps of a search depend on last digits. Tests that count steps hold where this number is the one they were
/// counted with.
#[must_use]
pub fn last_digits() -> u64 {
    let at = |i: u32| {
        let x = 1e-3 * f64::from(i);
        [x.sin(), x.cos(), x.tan(), x.atan(), x.exp(), x.ln(), x.sinh(), x.sqrt()]
    };
    (1..3000).flat_map(at).fold(0, |sum: u64, value| sum.rotate_left(5) ^ value.to_bits())
}

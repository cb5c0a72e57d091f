//! Readings whose comma of thousands was taken for a decimal one: 1,099.6 became 1.0996 among readings below a thousand.

use super::column::Column;

/// Fewest rows on either side of the gap between such readings and the others.
const FEWEST: usize = 3;
/// Least ratio of the smallest of the others to the largest of them.
const GAP: f64 = 10.0;
/// Largest ratio of the least thousand to the largest of the others.
const ABOVE: f64 = 1.5;
/// Where one follows another reading, its thousandfold is within this fraction of the largest from that, in most cases.
const NEAR: f64 = 0.4;
const MOSTLY: f64 = 0.5;

/// Why such rows don't count.
pub(super) const WHY: &str = "a thousandth of what the rows around lead to: was a comma of thousands read as a decimal one? Write the numbers without it";

/// The rows whose thousandfold goes on where the others end.
pub(super) fn rows(column: &Column<'_>) -> Vec<usize> {
    let values = column.values;
    let mut sizes: Vec<f64> = values.iter().map(|value| value.abs()).filter(|size| *size > 0.0).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let ratio = |place: usize| sizes[place] / sizes[place - 1];
    let places = FEWEST..sizes.len().saturating_sub(FEWEST - 1);
    let Some(gap) = places.max_by(|a, b| ratio(*a).total_cmp(&ratio(*b))) else { return Vec::new() };
    let (least, largest, limit) = (sizes[0], sizes[sizes.len() - 1], sizes[gap]);
    // Thousands begin where the others end.
    if ratio(gap) < GAP || !(largest..=ABOVE * largest).contains(&(1e3 * least)) {
        return Vec::new();
    }
    let is_small = |value: f64| value.abs() < limit && value != 0.0;
    let meant = |value: f64| if is_small(value) { 1e3 * value } else { value };
    let crossings = || values.windows(2).filter(|pair| is_small(pair[0]) != is_small(pair[1]));
    let near = crossings()
        .filter(|pair| (meant(pair[1]) - meant(pair[0])).abs() <= NEAR * 1e3 * sizes[gap - 1])
        .count();
    if near as f64 > MOSTLY * crossings().count() as f64 {
        (0..values.len()).filter(|row| is_small(values[*row])).collect()
    } else {
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::resolution::Resolution;

    fn found(values: &[f64]) -> Vec<usize> {
        let whole = 0..values.len();
        let sweeps = std::slice::from_ref(&whole);
        rows(&Column::new("force", values, Resolution::of(values, sweeps), sweeps))
    }

    #[test]
    fn thousands_among_hundreds() {
        let curve: Vec<f64> = (0..200).map(|row| 900.0 + 600.0 * (0.1 * f64::from(row)).sin()).collect();
        assert!(found(&curve).is_empty());
        let read: Vec<f64> =
            curve.iter().map(|value| if *value >= 1e3 { value / 1e3 } else { *value }).collect();
        let thousands: Vec<usize> = (0..200).filter(|row| curve[*row] >= 1e3).collect();
        assert_eq!(found(&read), thousands);
        // A muscle that goes slack now and then reads less than a thousandth of the rest, or not where the rest ends.
        let slack: Vec<f64> = curve.iter().map(|value| if *value < 400.0 { 0.3 } else { *value }).collect();
        assert!(found(&slack).is_empty());
        // A sweep with a lost comma is a hundred times too large.
        let sweep: Vec<f64> = curve
            .iter()
            .enumerate()
            .map(|(row, value)| if row < 80 { 1e2 * value } else { *value })
            .collect();
        assert!(found(&sweep).is_empty());
        let other: Vec<f64> = curve.iter().map(|value| if *value < 500.0 { 1.6 } else { *value }).collect();
        assert!(found(&other).is_empty());
    }
}

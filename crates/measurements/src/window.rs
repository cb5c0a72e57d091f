//! Runs of rows whose values stay within a band.

use std::collections::VecDeque;

/// The longest run of rows from a given one whose values stay within a band, for rows requested in ascending
/// order, in O(n) overall.
pub(crate) struct Window<'a> {
    s: &'a [f64],
    /// Rows that may become the lowest and the highest of the window, in order.
    low: VecDeque<usize>,
    high: VecDeque<usize>,
    /// The first row that is not in the window.
    end: usize,
}

impl<'a> Window<'a> {
    pub(crate) fn new(s: &'a [f64]) -> Self {
        Self { s, low: VecDeque::new(), high: VecDeque::new(), end: 0 }
    }

    /// The last row of the run that starts at `first`.
    pub(crate) fn last_within(&mut self, first: usize, band: f64) -> usize {
        let s = self.s;
        for rows in [&mut self.low, &mut self.high] {
            while rows.front().is_some_and(|row| *row < first) {
                rows.pop_front();
            }
        }
        self.end = self.end.max(first);
        while self.end < s.len() {
            let value = s[self.end];
            let low = self.low.front().map_or(value, |row| s[*row].min(value));
            let high = self.high.front().map_or(value, |row| s[*row].max(value));
            if high - low > band {
                break;
            }
            while self.low.back().is_some_and(|row| s[*row] >= value) {
                self.low.pop_back();
            }
            while self.high.back().is_some_and(|row| s[*row] <= value) {
                self.high.pop_back();
            }
            self.low.push_back(self.end);
            self.high.push_back(self.end);
            self.end += 1;
        }
        self.end.saturating_sub(1).max(first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulated::Noise;

    #[test]
    fn windows_are_the_longest() {
        let mut noise = Noise::new(3);
        let s: Vec<f64> = (0..300).map(|_| noise.normal()).collect();
        let mut window = Window::new(&s);
        for first in 0..s.len() {
            let within = |last: usize| {
                let (low, high) = crate::resolution::bounds(&s[first..=last]);
                high - low <= 1.5
            };
            let last = (first..s.len()).take_while(|last| within(*last)).last().unwrap();
            assert_eq!(window.last_within(first, 1.5), last);
        }
    }
}

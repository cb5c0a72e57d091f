//! Colours and dashes that distinguish curves on screen, in grey print and with any kind of colour vision.

use crate::comparison::svg::Stroke;

/// Red, green and blue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Rgb(pub(crate) u8, pub(crate) u8, pub(crate) u8);

/// Stops of a scale from cold to hot with evenly increasing lightness (as in "plasma"), without the light
/// end, which fades on paper.
const STOPS: [[f64; 3]; 4] =
    [[13.0, 8.0, 135.0], [126.0, 3.0, 168.0], [204.0, 71.0, 120.0], [240.0, 140.0, 50.0]];

/// Dashes of neighbouring curves; the first is solid.
const DASHES: [Option<&str>; 4] = [None, Some("9 4.5"), Some("3 3"), Some("12 3 3 3")];

/// With more curves than this only the order of their colours distinguishes them.
const MOST_DASHED: usize = 12;

/// Colour of curve `i` of `n`.
pub(crate) fn colour(i: usize, n: usize) -> Rgb {
    let place = i as f64 / n.saturating_sub(1).max(1) as f64 * (STOPS.len() - 1) as f64;
    let below = (0..STOPS.len() - 1).rev().find(|k| *k as f64 <= place).unwrap_or(0);
    let share = place - below as f64;
    let [r, g, b] =
        [0, 1, 2].map(|c| to_byte(STOPS[below][c] + share * (STOPS[below + 1][c] - STOPS[below][c])));
    Rgb(r, g, b)
}

/// The line of curve `i` of `n`.
pub(crate) fn line(i: usize, n: usize) -> Stroke {
    let dashes = if n > MOST_DASHED { None } else { DASHES[i % DASHES.len()] };
    Stroke { colour: colour(i, n), width: 1.6, dashes }
}

/// Paper.
pub(crate) const WHITE: Rgb = Rgb(255, 255, 255);
/// Text and axes.
pub(crate) const INK: Rgb = Rgb(34, 34, 34);
/// Names of axes and lines of zero.
pub(crate) const SOFT_INK: Rgb = Rgb(96, 96, 96);
/// Lines of a grid.
pub(crate) const GRID: Rgb = Rgb(228, 228, 228);
/// The model without effects.
pub(crate) const FIRST: Rgb = Rgb(158, 164, 170);
/// The model with all effects.
pub(crate) const LAST: Rgb = Rgb(11, 92, 173);
/// The noise floor, and what should be noticed.
pub(crate) const ALERT: Rgb = Rgb(190, 78, 10);

/// Colours of categories (Okabe and Ito, 2008, without black), told apart with any kind of colour vision.
pub(crate) const CATEGORIES: [Rgb; 7] = [
    Rgb(0, 114, 178),
    Rgb(230, 159, 0),
    Rgb(0, 158, 115),
    Rgb(204, 121, 167),
    Rgb(86, 180, 233),
    Rgb(213, 94, 0),
    Rgb(240, 228, 66),
];

/// Ends and middle of the scale for signed values: blue, white, orange.
const SIGNED: [[f64; 3]; 3] = [[22.0, 82.0, 150.0], [250.0, 250.0, 250.0], [184.0, 78.0, 8.0]];

/// Colour of a signed value between -1 and 1; white at 0.
pub(crate) fn signed(value: f64) -> Rgb {
    let end = SIGNED[if value < 0.0 { 0 } else { 2 }];
    let share = value.abs().min(1.0);
    let [r, g, b] = [0, 1, 2].map(|c| to_byte(SIGNED[1][c] + share * (end[c] - SIGNED[1][c])));
    Rgb(r, g, b)
}

/// As SVG writes it.
pub(crate) fn hex(Rgb(r, g, b): Rgb) -> String {
    format!("#{r:02X}{g:02X}{b:02X}")
}

/// Nearest byte of 0 ..= 255.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "rounded and clamped to the range of a byte"
)]
fn to_byte(value: f64) -> u8 {
    value.round().clamp(0.0, 255.0) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_that_are_dashed_have_colours_of_their_own() {
        for n in 1..=MOST_DASHED {
            let colours: Vec<_> = (0..n).map(|i| colour(i, n)).collect();
            assert!((0..n).all(|i| (0..i).all(|j| colours[i] != colours[j])), "{n} curves");
        }
    }

    #[test]
    fn scale_runs_from_first_to_last_stop() {
        assert_eq!(colour(0, 1), Rgb(13, 8, 135));
        assert_eq!(colour(4, 5), Rgb(240, 140, 50));
        assert_eq!(colour(1, 4), Rgb(126, 3, 168));
    }

    #[test]
    fn signed_scale_is_light_at_zero_and_darkens_to_both_ends() {
        assert_eq!(hex(signed(0.0)), "#FAFAFA");
        assert_eq!([signed(-1.0), signed(2.0)].map(hex), ["#165296", "#B84E08"]);
        let red = |v: f64| signed(v).0;
        assert!(red(-0.5) < red(-0.1) && red(0.5) > red(-0.5));
    }

    /// Grey values (Rec. 709) increase along the scale, so the order survives a photocopy.
    #[test]
    fn lightness_rises() {
        let grey = |i| {
            let Rgb(r, g, b) = colour(i, 20);
            0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
        };
        assert!((1..20).all(|i| grey(i) > grey(i - 1)));
    }
}

//! Colours and dashes that distinguish curves on screen, in grey print and with any kind of colour vision.

use plotters::style::RGBColor;

/// Stops of a scale from cold to hot with evenly increasing lightness (as in "plasma"), without the light
/// end, which fades on paper.
const STOPS: [[f64; 3]; 4] =
    [[13.0, 8.0, 135.0], [126.0, 3.0, 168.0], [204.0, 71.0, 120.0], [240.0, 140.0, 50.0]];

/// Dash patterns of neighbouring curves, in line widths; the first is solid.
const DASHES: [&[u32]; 4] = [&[], &[6, 3], &[2, 2], &[8, 2, 2, 2]];

/// With more curves than this only the order of their colours distinguishes them.
const MOST_DASHED: usize = 12;

/// Colour of curve `i` of `n`.
pub(crate) fn colour(i: usize, n: usize) -> RGBColor {
    let place = i as f64 / n.saturating_sub(1).max(1) as f64 * (STOPS.len() - 1) as f64;
    let below = (0..STOPS.len() - 1).rev().find(|k| *k as f64 <= place).unwrap_or(0);
    let share = place - below as f64;
    let [r, g, b] =
        [0, 1, 2].map(|c| to_byte(STOPS[below][c] + share * (STOPS[below + 1][c] - STOPS[below][c])));
    RGBColor(r, g, b)
}

/// Text and axes.
pub(crate) const INK: RGBColor = RGBColor(34, 34, 34);
/// Names of axes and zero lines.
pub(crate) const SOFT_INK: RGBColor = RGBColor(96, 96, 96);
/// Lines of a grid.
pub(crate) const GRID: RGBColor = RGBColor(228, 228, 228);
/// The model without effects.
pub(crate) const FIRST: RGBColor = RGBColor(158, 164, 170);
/// The model with all effects.
pub(crate) const LAST: RGBColor = RGBColor(11, 92, 173);
/// The noise floor, and anything that needs attention.
pub(crate) const ALERT: RGBColor = RGBColor(190, 78, 10);

/// Colours of categories (Okabe and Ito, 2008, without black), distinguishable with any kind of colour
/// vision.
pub(crate) const CATEGORIES: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(230, 159, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(213, 94, 0),
    RGBColor(240, 228, 66),
];

/// Ends and middle of the scale for signed values: blue, white, orange.
const SIGNED: [[f64; 3]; 3] = [[22.0, 82.0, 150.0], [250.0, 250.0, 250.0], [184.0, 78.0, 8.0]];

/// Colour of a signed value between -1 and 1; white at 0.
pub(crate) fn signed(value: f64) -> RGBColor {
    let end = SIGNED[if value < 0.0 { 0 } else { 2 }];
    let share = value.abs().min(1.0);
    let [r, g, b] = [0, 1, 2].map(|c| to_byte(SIGNED[1][c] + share * (end[c] - SIGNED[1][c])));
    RGBColor(r, g, b)
}

/// The colour in SVG notation.
pub(crate) fn hex(RGBColor(r, g, b): RGBColor) -> String {
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

/// Value of the SVG attribute `stroke-dasharray` for curve `i` of `n`; `None` for a solid line.
pub(crate) fn dashes(i: usize, n: usize, line_width: u32) -> Option<String> {
    let pattern = DASHES[i % DASHES.len()];
    if n > MOST_DASHED || pattern.is_empty() {
        return None;
    }
    let lengths: Vec<String> = pattern.iter().map(|widths| (widths * line_width).to_string()).collect();
    Some(lengths.join(" "))
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
        assert_eq!(colour(0, 1), RGBColor(13, 8, 135));
        assert_eq!(colour(4, 5), RGBColor(240, 140, 50));
        assert_eq!(colour(1, 4), RGBColor(126, 3, 168));
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
            let RGBColor(r, g, b) = colour(i, 20);
            0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
        };
        assert!((1..20).all(|i| grey(i) > grey(i - 1)));
    }
}

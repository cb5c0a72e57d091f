//! Cross-section of the cloth between two neighbouring fibres of a pleated muscle.

use std::f64::consts::{FRAC_PI_2, PI};

/// Cloth of constant width s over the chord 2w between two fibres; it bulges away from the axis.
///
/// ```text
/// s <= 2w         flat: the cloth is the chord
/// s <= pi w       lobe: an arc of radius rho = s/(2v), sin(v)/v = 2w/s, v its half-opening
/// s >  pi w       pleat: two flanks of height h = (s - pi w)/2 and a semicircle of radius w on top
/// ```
///
/// The lobe is the shape of an inextensible cloth without bending stiffness under pressure. The pleat is only
/// a way to draw surplus cloth: a lobe that opens further would penetrate its neighbours (their flanks lean
/// apart by no more than 2 pi/n).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Panel {
    /// The cloth is taut along the chord of half-length `w`.
    Flat { w: f64 },
    /// Circular arc of radius `rho` and half-opening `v`.
    Lobe { rho: f64, v: f64 },
    /// Straight flanks of height `h` below a semicircle of radius `w`.
    Pleat { w: f64, h: f64 },
}

impl Panel {
    /// Panel over the half chord `w` with cloth of width `s`, both positive and in the same unit.
    pub(crate) fn new(w: f64, s: f64) -> Self {
        if s <= 2.0 * w {
            Self::Flat { w }
        } else if s <= PI * w {
            let v = half_opening(2.0 * w / s);
            Self::Lobe { rho: s / (2.0 * v), v }
        } else {
            Self::Pleat { w, h: (s - PI * w) / 2.0 }
        }
    }

    /// Point at the fraction `t` (0 ..= 1) of the cloth: position along the chord from its middle, and height
    /// above the chord.
    pub(crate) fn point(&self, t: f64) -> [f64; 2] {
        match *self {
            Self::Flat { w } => [w * (2.0 * t - 1.0), 0.0],
            Self::Lobe { rho, v } => {
                let phi = v * (2.0 * t - 1.0);
                // rho (cos phi - cos v), rewritten to avoid cancellation for shallow lobes.
                let height = 2.0 * rho * f64::midpoint(v, phi).sin() * (0.5 * (v - phi)).sin();
                [rho * phi.sin(), height]
            }
            Self::Pleat { w, h } => {
                let from_middle = (2.0 * t - 1.0) * (h + FRAC_PI_2 * w);
                let side = from_middle.signum();
                let beyond_crown = from_middle.abs() - FRAC_PI_2 * w;
                if beyond_crown > 0.0 {
                    [side * w, h - beyond_crown]
                } else {
                    let phi = from_middle / w;
                    [w * phi.sin(), h + w * phi.cos()]
                }
            }
        }
    }
}

/// Root v of sin(v)/v = q for 2/pi <= q < 1.
///
/// sin(v)/v is concave and decreasing up to pi/2, so Newton's method approaches the root from above after at
/// most one step.
fn half_opening(q: f64) -> f64 {
    let mut v = (6.0 * (1.0 - q)).sqrt();
    // Newton's method converges quadratically from an error below 7 %: five steps are exact, the others guard
    // against rounding in shallow lobes.
    for _ in 0..8 {
        let (sin, cos) = v.sin_cos();
        let step = (sin - q * v) / (cos - sin / v);
        if !step.is_finite() || step.abs() <= f64::EPSILON * v {
            break;
        }
        v -= step;
    }
    v.min(FRAC_PI_2)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Length of the inscribed polygon with `n` chords.
    fn length(panel: &Panel, n: u32) -> f64 {
        let points: Vec<_> = (0..=n).map(|i| panel.point(f64::from(i) / f64::from(n))).collect();
        points.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])).sum()
    }

    #[test]
    fn lobe_keeps_cloth_width_and_spans_the_chord() {
        for s in [2.000_001, 2.001, 2.1, 2.5, 3.0, 3.13, PI] {
            let Panel::Lobe { rho, v } = Panel::new(1.0, s) else { panic!("no lobe at s = {s}") };
            assert!((2.0 * v * rho / s - 1.0).abs() < 1e-12, "arc length at s = {s}");
            assert!((rho * v.sin() - 1.0).abs() < 1e-12, "half chord {} at s = {s}", rho * v.sin());
        }
    }

    #[test]
    fn pleat_keeps_cloth_width() {
        let Panel::Pleat { w, h } = Panel::new(0.3, 2.0) else { panic!("no pleat") };
        assert!((2.0 * h + PI * w - 2.0).abs() < 1e-12);
    }

    /// The inscribed polygon of points equally spaced along the cloth is shorter by O(1/n^2), the crown by
    /// the chord factor 1 - d^2/24.
    #[test]
    fn points_are_equally_spaced_along_the_cloth() {
        for s in [1.5, 2.1, 2.9, 3.3, 6.0, 40.0] {
            let panel = Panel::new(1.0, s);
            let cloth = s.max(2.0);
            let error = |n| cloth - length(&panel, n);
            assert!(error(4000).abs() < 1e-4 * cloth, "s = {s}: {}", error(4000));
            let longest = cloth / 240.0;
            for i in 0..240_u32 {
                let [a, b] = [i, i + 1].map(|i| panel.point(f64::from(i) / 240.0));
                let chord = (b[0] - a[0]).hypot(b[1] - a[1]);
                assert!(
                    chord <= longest * (1.0 + 1e-9) && chord > 0.99 * longest,
                    "s = {s}: {chord} of {longest}"
                );
            }
        }
    }

    #[test]
    fn ends_lie_on_the_fibres_and_the_middle_is_highest() {
        for s in [1.0, 2.2, PI, 3.2, 9.0] {
            let panel = Panel::new(1.0, s);
            for (t, u) in [(0.0, -1.0), (1.0, 1.0)] {
                let [x, y] = panel.point(t);
                assert!((x - u).abs() < 1e-12 && y.abs() < 1e-12, "s = {s}, t = {t}: {x}, {y}");
            }
            let top = panel.point(0.5);
            assert!(
                top[0].abs() < 1e-12
                    && (0..=20).all(|i| panel.point(f64::from(i) / 20.0)[1] <= top[1] + 1e-15)
            );
        }
    }

    #[test]
    fn shapes_join_without_a_step() {
        let heights = |s: f64| Panel::new(1.0, s).point(0.5)[1];
        assert!(heights(2.0 + 1e-12) < 1e-5, "flat to lobe");
        assert!((heights(PI * (1.0 + 1e-9)) - heights(PI * (1.0 - 1e-9))).abs() < 1e-8, "lobe to pleat");
    }
}

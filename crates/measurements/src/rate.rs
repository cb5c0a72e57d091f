//! Rate of a motion within a monotone stretch: local least squares with a window as wide as the sensor needs.

use crate::resolution::Resolution;

/// Most rows in a fit; wider windows are thinned.
const MOST_POINTS: usize = 33;
/// The window is so wide that the motion covers this many times the sensor's resolution: the rate's standard
/// error is then below 3 %.
const RESOLVED: f64 = 10.0;

/// A faster rate (per second) comes from two nearly equal times.
const FASTEST: f64 = 1e30;

/// ds/dt at each row of a stretch. `s` and `time` are those of its rows, including the turning point before
/// it. Exact for uniform acceleration.
///
/// A parabola is fitted to the rows around each one, with as few rows as let the motion exceed step and
/// noise. A rate against the `direction` of the stretch is noise near a turning point and set to 0.
pub(crate) fn along(s: &[f64], time: &[f64], direction: i8, resolution: &Resolution) -> Vec<f64> {
    let needed = RESOLVED * resolution.step.max(3.0 * resolution.noise);
    let last = s.len().saturating_sub(1);
    let sign = f64::from(direction);
    let mut half = 2;
    (0..s.len())
        .map(|row| {
            half = (half / 2).max(2);
            let mut window = || {
                let bounds = (row.saturating_sub(half), (row + half).min(last));
                half *= 2;
                bounds
            };
            let (mut first, mut end) = window();
            while (first, end) != (0, last) && (end - first < 4 || (s[end] - s[first]).abs() < needed) {
                (first, end) = window();
            }
            half /= 2;
            let rate = slope(s, time, row, first, end);
            // Nearly equal times don't give a rate either.
            if rate * sign > 0.0 && rate.abs() < FASTEST { rate } else { 0.0 }
        })
        .collect()
}

/// Slope at `row` of the parabola through rows `first..=last`, or of the straight line if a parabola isn't
/// determined.
fn slope(s: &[f64], time: &[f64], row: usize, first: usize, last: usize) -> f64 {
    let stride = (last - first).div_ceil(MOST_POINTS - 1).max(1);
    let width = (time[last] - time[row]).abs().max((time[row] - time[first]).abs());
    if width == 0.0 {
        return 0.0;
    }
    // Moments about the row: m[k] = sum x^k, n[k] = sum x^k y, with x in units of the window.
    let (mut m, mut n) = ([0.0; 5], [0.0; 3]);
    for i in (first..=last).step_by(stride) {
        let (x, y) = ((time[i] - time[row]) / width, s[i] - s[row]);
        let powers = [1.0, x, x * x, x * x * x, x * x * x * x];
        for (sum, power) in m.iter_mut().zip(powers) {
            *sum += power;
        }
        for (sum, power) in n.iter_mut().zip(powers) {
            *sum += power * y;
        }
    }
    // Normal equations after eliminating the constant.
    let (xx, xq, qq) = (m[2] - m[1] * m[1] / m[0], m[3] - m[1] * m[2] / m[0], m[4] - m[2] * m[2] / m[0]);
    let (xy, qy) = (n[1] - m[1] * n[0] / m[0], n[2] - m[2] * n[0] / m[0]);
    let determinant = xx * qq - xq * xq;
    if m[0] >= 5.0 && determinant > 1e-6 * xx * qq {
        (xy * qq - qy * xq) / determinant / width
    } else if xx > 0.0 {
        xy / xx / width
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulated::Noise;

    const SHARP: Resolution = Resolution { step: 0.0, noise: 0.0, range: 1.0 };

    #[test]
    fn exact_for_uniform_motion_and_acceleration() {
        for rows in [2, 3, 4, 5, 6, 50, 5000] {
            // Uneven time steps.
            let time: Vec<f64> =
                (0..rows).map(|i| 1000.0 + 0.01 * f64::from(i) + 0.003 * f64::from(i % 2)).collect();
            let s: Vec<f64> = time.iter().map(|t| 0.1 + 0.02 * (t - 1000.0)).collect();
            for rate in along(&s, &time, 1, &SHARP) {
                assert!((rate / 0.02 - 1.0).abs() < 1e-8, "{rows}: {rate}");
            }
            let s: Vec<f64> = time.iter().map(|t| -0.3 * (t - 999.0).powi(2)).collect();
            for (rate, t) in along(&s, &time, -1, &SHARP).iter().zip(&time).filter(|_| rows > 4) {
                assert!((rate / (-0.6 * (t - 999.0)) - 1.0).abs() < 1e-6, "{rows}: {rate}");
            }
        }
    }

    #[test]
    fn near_the_rate_of_a_sine() {
        let omega = 2.0;
        let time: Vec<f64> = (0..=200).map(|i| std::f64::consts::PI / omega * f64::from(i) / 200.0).collect();
        let s: Vec<f64> = time.iter().map(|t| -(omega * t).cos()).collect();
        for (rate, t) in along(&s, &time, 1, &SHARP).iter().zip(&time) {
            assert!((rate - omega * (omega * t).sin()).abs() < 2e-3 * omega, "{t}: {rate}");
        }
    }

    #[test]
    fn steps_and_noise_leave_the_rate() {
        let time: Vec<f64> = (0..20_000).map(|i| 1e-3 * f64::from(i)).collect();
        let steps: Vec<f64> = time.iter().map(|t| (0.01 * t / 1e-3).round() * 1e-3).collect();
        let resolution = Resolution { step: 1e-3, noise: 0.0, range: 0.2 };
        let rates = along(&steps, &time, 1, &resolution);
        let worst = rates.iter().map(|rate| (rate / 0.01 - 1.0).abs()).fold(0.0, f64::max);
        assert!(worst < 0.25, "{worst}");
        let middle = &rates[2000..18_000];
        let worst = middle.iter().map(|rate| (rate / 0.01 - 1.0).abs()).fold(0.0, f64::max);
        assert!(worst < 0.06, "{worst}");
        let mut noise = Noise::new(5);
        let noisy: Vec<f64> = time.iter().map(|t| 0.01 * t + 1e-4 * noise.normal()).collect();
        let resolution = Resolution { step: 0.0, noise: 1e-4, range: 0.2 };
        let rates = along(&noisy, &time, 1, &resolution);
        let squares: f64 = rates.iter().map(|rate| (rate / 0.01 - 1.0).powi(2)).sum();
        let spread = (squares / rates.len() as f64).sqrt();
        assert!(spread < 0.06, "{spread}");
    }

    #[test]
    fn equal_times_give_no_rate() {
        assert_eq!(along(&[0.0, 1.0, 2.0], &[5.0; 3], 1, &SHARP), [0.0; 3]);
        assert_eq!(along(&[0.0], &[5.0], 1, &SHARP), [0.0]);
        assert_eq!(along(&[], &[], 1, &SHARP), [] as [f64; 0]);
    }
}

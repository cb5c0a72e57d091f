//! The load: required forces over a travel.

use bulge_muscles::Length;
use serde::Serialize;

use super::SizeError;
use crate::question::is;

/// Required force after a travel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LoadPoint {
    /// Travel from the initial position of the muscle \[m\], 0 or more.
    pub travel_m: f64,
    /// Required force \[N\], 0 or more.
    pub force_n: f64,
}

/// Forces over a stroke, linear between the points.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(transparent)]
pub struct LoadCase {
    points: Vec<LoadPoint>,
}

/// Number of places checked between one point and the next.
const BETWEEN: usize = 8;

impl LoadCase {
    /// A load through points in the order of their travel.
    ///
    /// # Errors
    /// If no point lies beyond the beginning, points are out of order, a number is negative or not finite, or
    /// all forces are 0.
    pub fn new(points: Vec<LoadPoint>) -> Result<Self, SizeError> {
        let mut before = f64::NEG_INFINITY;
        for (i, LoadPoint { travel_m, force_n }) in points.iter().enumerate() {
            for (what, value) in [("travel [m]", *travel_m), ("force [N]", *force_n)] {
                if !(value >= 0.0 && value.is_finite()) {
                    let point = i + 1;
                    return Err(SizeError::Input(format!(
                        "point {point} of the load: the {}: it must be finite, 0 or more",
                        is(what, value)
                    )));
                }
            }
            if *travel_m <= before {
                let point = i + 1;
                return Err(SizeError::Input(format!(
                    "point {point} of the load lies at the travel {}, not beyond the one before: give the points in order, each travel once",
                    Length::m(*travel_m)
                )));
            }
            before = *travel_m;
        }
        if before <= 0.0 {
            return Err(SizeError::no_stroke());
        }
        if points.iter().all(|point| point.force_n == 0.0) {
            let what = "the load is 0 N everywhere: any muscle carries it";
            return Err(SizeError::Input(what.to_owned()));
        }
        Ok(Self { points })
    }

    /// A load with a force at rest and another one after the stroke.
    ///
    /// # Errors
    /// As [`LoadCase::new`].
    pub fn lift(stroke_m: f64, at_rest_n: f64, contracted_n: f64) -> Result<Self, SizeError> {
        let point = |travel_m, force_n| LoadPoint { travel_m, force_n };
        if stroke_m == 0.0 {
            return Err(SizeError::no_stroke());
        }
        Self::new(vec![point(0.0, at_rest_n), point(stroke_m, contracted_n)])
    }

    /// The points.
    #[must_use]
    pub fn points(&self) -> &[LoadPoint] {
        &self.points
    }

    /// The whole travel \[m\].
    #[must_use]
    pub fn stroke_m(&self) -> f64 {
        self.points.last().map_or(0.0, |point| point.travel_m)
    }

    /// The largest force \[N\].
    #[must_use]
    pub fn largest_n(&self) -> f64 {
        self.points.iter().fold(0.0, |most, point| most.max(point.force_n))
    }

    /// The points of the load, and places between them.
    #[must_use]
    pub fn path(&self) -> Vec<LoadPoint> {
        let mut path = Vec::with_capacity(BETWEEN * self.points.len());
        for pair in self.points.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            path.extend((0..BETWEEN).map(|k| {
                let part = k as f64 / BETWEEN as f64;
                let mix = |a: f64, b: f64| a + part * (b - a);
                LoadPoint { travel_m: mix(a.travel_m, b.travel_m), force_n: mix(a.force_n, b.force_n) }
            }));
        }
        path.extend(self.points.last());
        path
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(travel_m: f64, force_n: f64) -> LoadPoint {
        LoadPoint { travel_m, force_n }
    }

    #[test]
    fn a_load_goes_through_its_points() {
        let load = LoadCase::new(vec![point(0.0, 100.0), point(0.02, 500.0), point(0.05, 200.0)]).unwrap();
        assert_eq!((load.stroke_m(), load.largest_n(), load.points().len()), (0.05, 500.0, 3));
        let path = load.path();
        assert_eq!(
            (path.len(), path[0], path[8], path[16]),
            (17, point(0.0, 100.0), point(0.02, 500.0), point(0.05, 200.0))
        );
        assert!((path[4].travel_m - 0.01).abs() < 1e-15 && (path[4].force_n - 300.0).abs() < 1e-12);
    }

    #[test]
    fn nonsense_is_refused() {
        let load = |points: &[(f64, f64)]| {
            LoadCase::new(points.iter().map(|(x, f)| point(*x, *f)).collect()).unwrap_err()
        };
        assert_eq!(LoadCase::lift(0.0, 1.0, 2.0), Err(SizeError::no_stroke()));
        for (points, says) in [
            (&[][..], "the load has no stroke"),
            (&[(0.0, 5.0)], "the load has no stroke"),
            (&[(0.0, 0.0), (0.1, 0.0)], "the load is 0 N everywhere"),
            (&[(0.1, 1.0), (0.1, 2.0)], "point 2 of the load lies at the travel 100 mm"),
            (&[(0.0, 1.0), (f64::NAN, 2.0)], "point 2 of the load: the travel is NaN mm"),
            (&[(0.0, -1.0)], "point 1 of the load: the force is -1 N"),
            (&[(0.1, f64::INFINITY)], "point 1 of the load: the force is inf N"),
        ] {
            let message = load(points).to_string();
            assert!(message.starts_with(says), "{message}");
        }
    }
}

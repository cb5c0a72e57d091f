//! Where to wind: the zone with the most linear characteristic, or with the most sensitive one.
//!
//! Zones of given widths w are scanned over their centres c from w/2 to 1/2 (muscles are symmetric: a zone at
//! 1 - c is equivalent), each over the whole range of contractions. For each width the best centre is refined
//! by golden section between its neighbours in the scan. Then the best width is refined, each time with its
//! best centre. A golden section finds the optimum of a unimodal function; the scan brackets it. The shapes
//! of the muscle are computed once, for all zones.

use bulge_numerics::minimum::golden;
use rayon::prelude::*;
use serde::Serialize;

use super::sensor::{Pose, Sensor};
use super::winding::number;
use super::{Curve, Range, Reading, SensingError, Winding};

/// Width of the bracket, as a fraction of the fibre length, at which a golden section ends.
const ENOUGH: f64 = 1e-5;
/// Centres tried for each width between those of the scan.
const CENTRES: usize = 7;
/// Most centres and widths of a scan.
const MOST: usize = 1001;

/// What the search optimises.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Goal {
    /// The smallest deviation from the least-squares line, in % of full scale.
    MostLinear {
        /// Smallest |slope of the line|/R0 that suffices, 0 or more.
        least_sensitivity: f64,
    },
    /// The largest |slope of the least-squares line|/R0.
    MostSensitive,
}

/// Space of the search.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Search {
    /// Contractions to measure.
    pub range: Range,
    /// Smallest and largest width of the zone, as fractions of the fibre length; equal for a given width. The
    /// number of turns is constant.
    pub widths: [f64; 2],
    /// Widths in the scan, 1 to 1001; 1 if both ends are equal.
    pub width_steps: usize,
    /// Centres in the scan for each width, 3 to 1001.
    pub centres: usize,
    /// What the search optimises.
    pub goal: Goal,
}

/// Assessment of a zone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// It is acceptable.
    Good,
    /// Its mean sensitivity is below the requirement.
    Insensitive,
    /// The resistance isn't monotone, or doesn't change.
    NotMonotone,
    /// The channel is strained more than the elastomer bears.
    Overstrained,
    /// The winding itself is impossible: its turns overlap, or its layer has no room.
    Impossible,
}

/// One zone and its characteristics.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Place {
    /// Centre, as a fraction of the fibre length.
    pub centre: f64,
    /// Width, as a fraction of the fibre length.
    pub width: f64,
    /// |slope of the least-squares line|/R0 \[-\]; `None` if the resistance doesn't change, or for an impossible winding.
    pub sensitivity: Option<f64>,
    /// Largest departure from that line \[% of full scale\].
    pub best_fit_percent: Option<f64>,
    /// Largest departure from the line through both ends \[% of full scale\].
    pub terminal_percent: Option<f64>,
    /// Largest strain along the channel over the range \[-\].
    pub largest_strain: Option<f64>,
    /// Assessment of the zone.
    pub verdict: Verdict,
}

/// The best zone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Placement {
    /// The best zone, refined.
    pub best: Place,
    /// The winding in that zone.
    pub winding: Winding,
    /// Its characteristic.
    pub curve: Curve,
    /// All zones of the scan, by width, then by centre.
    pub scanned: Vec<Place>,
}

impl Search {
    fn check(&self) -> Result<(), SensingError> {
        let [low, high] = self.widths;
        number("smallest width of the zone [%]", low, "from 0.0001 % to 100 %", |w| {
            (1e-6..=1.0).contains(&w)
        })?;
        number("largest width of the zone [%]", high, "from the smallest one to 100 %", |w| {
            w >= low && w <= 1.0
        })?;
        let widths = if high > low { 2..=MOST } else { 1..=1 };
        let needs = "from 2 to 1001 for a range of widths, 1 for a single one";
        number("number of widths", self.width_steps as f64, needs, |_| widths.contains(&self.width_steps))?;
        number("number of centres", self.centres as f64, "from 3 to 1001", |_| {
            (3..=MOST).contains(&self.centres)
        })?;
        if let Goal::MostLinear { least_sensitivity } = self.goal {
            number("least sensitivity", least_sensitivity, "a finite number, 0 or more", |s| {
                s.is_finite() && s >= 0.0
            })?;
        }
        Ok(())
    }

    /// Centres and widths of the scan.
    fn zones(&self) -> Vec<[f64; 2]> {
        let between = |low: f64, high: f64, i: usize, count: usize| {
            if i + 1 == count { high } else { low + (high - low) * i as f64 / (count - 1) as f64 }
        };
        let widths =
            (0..self.width_steps).map(|i| between(self.widths[0], self.widths[1], i, self.width_steps));
        widths
            .flat_map(|width| {
                // A zone over the whole length has only one position.
                let centres = if width < 1.0 { self.centres } else { 1 };
                (0..centres).map(move |i| [between(0.5 * width, 0.5, i, centres), width])
            })
            .collect()
    }

    /// The objective to be minimised; infinite for an unacceptable zone.
    fn cost(&self, place: &Place) -> f64 {
        let wanted = match self.goal {
            Goal::MostLinear { .. } => place.best_fit_percent,
            Goal::MostSensitive => place.sensitivity.map(|s| -s),
        };
        wanted.filter(|_| place.verdict == Verdict::Good).unwrap_or(f64::INFINITY)
    }

    fn least_sensitivity(&self) -> f64 {
        if let Goal::MostLinear { least_sensitivity } = self.goal { least_sensitivity } else { 0.0 }
    }
}

impl Sensor {
    /// The best zone for this winding. Its own zone is ignored; its turns, section and layer are kept.
    ///
    /// # Errors
    /// [`SensingError::Input`] for an invalid search, [`SensingError::Equilibrium`] over the range,
    /// [`SensingError::NoPlace`] if no zone is acceptable.
    pub fn best_place(&self, search: &Search) -> Result<Placement, SensingError> {
        search.check()?;
        let poses = self.poses(search.range)?;
        let try_zone = |[centre, width]: [f64; 2]| self.try_zone(search, &poses, centre, width);
        let scanned: Vec<Place> = search.zones().into_par_iter().map(try_zone).collect();
        if !scanned.iter().any(|place| place.verdict == Verdict::Good) {
            return Err(no_place(search, &scanned));
        }
        let cost = |place: &Place| search.cost(place);
        // Each width is refined at its own best centre: the best width on the coarse centres of the scan need
        // not be the best one.
        let refined: Vec<Place> = scanned
            .chunk_by(|a, b| a.width.to_bits() == b.width.to_bits())
            .collect::<Vec<_>>()
            .into_par_iter()
            .map(|zones| refined_centre(zones, |centre| try_zone([centre, zones[0].width]), cost))
            .collect();
        let Some(mut best) = cheapest(&refined, cost).map(|i| refined[i]) else {
            return Err(no_place(search, &scanned));
        };
        if search.width_steps > 1 {
            best = self.refined_width(search, &poses, best);
        }
        let sensor = self.rewound(self.winding().placed(best.centre, best.width))?;
        let curve = sensor.curve(search.range)?;
        Ok(Placement { best, winding: *sensor.winding(), curve, scanned })
    }

    /// The best width near that of `best`, each with its best centre near that of `best`.
    fn refined_width(&self, search: &Search, poses: &[Pose], best: Place) -> Place {
        let step = (search.widths[1] - search.widths[0]) / (search.width_steps - 1) as f64;
        let reach = 0.5 / (search.centres - 1) as f64 + 0.5 * step;
        let around = [(best.width - step).max(search.widths[0]), (best.width + step).min(search.widths[1])];
        let at = |width: f64| {
            let low = (best.centre - reach).clamp(0.5 * width, 0.5);
            let high = (best.centre + reach).clamp(0.5 * width, 0.5);
            let try_centre = |centre: f64| self.try_zone(search, poses, centre, width);
            let last = (CENTRES - 1) as f64;
            let zones: Vec<Place> =
                (0..CENTRES).map(|i| try_centre(low + (high - low) * i as f64 / last)).collect();
            refined_centre(&zones, try_centre, |place| search.cost(place))
        };
        golden(best, around, ENOUGH, |place| (place.width, search.cost(place)), at)
    }

    fn try_zone(&self, search: &Search, poses: &[Pose], centre: f64, width: f64) -> Place {
        let winding = self.winding().placed(centre, width);
        let mut place = Place {
            centre,
            width,
            sensitivity: None,
            best_fit_percent: None,
            terminal_percent: None,
            largest_strain: None,
            verdict: Verdict::Impossible,
        };
        let Ok(totals) = self.reference_totals(&winding) else { return place };
        let read = |pose| self.read(&winding, totals.length, pose);
        let Ok(readings) = poses.iter().map(read).collect::<Result<Vec<Reading>, _>>() else { return place };
        let strain = readings.iter().map(|reading| reading.largest_strain).fold(f64::NEG_INFINITY, f64::max);
        let reference_ohm = winding.resistivity_ohm_m * totals.length / winding.section_m2;
        let curve = Curve::of_readings(readings, reference_ohm, self.muscle_length_m());
        place.largest_strain = Some(strain);
        place.sensitivity = curve.linearity.map(|line| line.mean_sensitivity.abs());
        place.best_fit_percent = curve.linearity.map(|line| line.best_fit_percent);
        place.terminal_percent = curve.linearity.map(|line| line.terminal_percent);
        place.verdict = if strain > self.options().max_strain {
            Verdict::Overstrained
        } else if curve.check_monotone().is_err() {
            Verdict::NotMonotone
        } else if place.sensitivity.is_none_or(|s| s < search.least_sensitivity()) {
            Verdict::Insensitive
        } else {
            Verdict::Good
        };
        place
    }
}

/// Index of the place with the lowest cost; the first of equals.
fn cheapest(places: &[Place], cost: impl Fn(&Place) -> f64) -> Option<usize> {
    (0..places.len()).min_by(|a, b| cost(&places[*a]).total_cmp(&cost(&places[*b])))
}

/// Refines the best of a row of places (at least one) that have the same width and ascending centres, between
/// its neighbours.
fn refined_centre(row: &[Place], at: impl Fn(f64) -> Place, cost: impl Fn(&Place) -> f64) -> Place {
    let i = cheapest(row, &cost).unwrap_or(0);
    if cost(&row[i]).is_infinite() {
        return row[i];
    }
    let around = [row[i.saturating_sub(1)].centre, row[(i + 1).min(row.len() - 1)].centre];
    golden(row[i], around, ENOUGH, |place| (place.centre, cost(place)), at)
}

fn no_place(search: &Search, scanned: &[Place]) -> SensingError {
    let usable = scanned.iter().filter(|place| matches!(place.verdict, Verdict::Good | Verdict::Insensitive));
    SensingError::NoPlace {
        scanned: scanned.len(),
        largest: usable.filter_map(|place| place.sensitivity).fold(0.0, f64::max),
        wanted: search.least_sensitivity(),
        overstrained: scanned.iter().filter(|place| place.verdict == Verdict::Overstrained).count(),
    }
}

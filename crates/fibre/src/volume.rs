//! The equilibrium with a given volume: on the way up to the largest volume, beyond it where the volume
//! falls, or drawn out.
//!
//! `F = -p dV/dl` holds where nothing stores energy, so the volume rises with the contraction as long as the
//! muscle pulls. Rubber and fibres that stretch give energy back, and the volume may fall before the range
//! ends. A short muscle of elastic fibres that is drawn out far holds more again.

use crate::FibreError;
use crate::outcome::Scheme;
use crate::problem::Problem;
use crate::search::{Goal, Seen};
use crate::solve::Found;

/// Part of the largest volume. Within it the distance from the contraction of the largest volume can't be
/// told.
const FLAT: f64 = 1e-13;
/// Part of the volume at the end of the range that rounding of the contraction there causes.
const END: f64 = 1e-9;
/// Steps of the contraction back from the point at which fibres become slack.
const SHORT_OF: [f64; 3] = [0.0, 1e-9, 1e-6];

/// The equilibrium with the largest volume among several, and the reason why there is no larger one.
#[derive(Clone, Copy)]
struct Most {
    found: Found,
    why: &'static str,
}

impl Most {
    fn volume(&self) -> f64 {
        self.found.response.volume_m3
    }

    fn contraction(&self) -> f64 {
        self.found.response.contraction
    }
}

impl Problem {
    pub(crate) fn with_volume(&self, scheme: Scheme, volume: f64) -> Result<Found, FibreError> {
        if volume <= 0.0 {
            return Err(FibreError::NotPositive { what: "volume", value: volume });
        }
        if !volume.is_finite() {
            return Err(FibreError::NotFinite { what: "volume", value: volume });
        }
        let (end, radius) = (self.net.acting_at(1.0), self.parts.radius);
        let least = end.volume_section(1.0, &end.section(1.0)) * radius.powi(2) * self.parts.length;
        if self.is_singular() && volume <= least {
            return Err(FibreError::VolumeTooSmall { volume_m3: volume, low_m3: least });
        }
        let end = self.range_end_with(scheme)?;
        let most = if volume > end.volume() { self.fullest(scheme, &end) } else { end };
        let mut seen = Seen::NOTHING;
        if volume > most.volume() * (1.0 + FLAT) {
            let found = self.drawn_out(scheme, volume, most.contraction(), &mut seen);
            return found.ok_or_else(|| {
                let why = if self.net.compliance > 0.0 {
                    "drawn out as far as its fibres bear"
                } else {
                    "drawn out as far as an equilibrium was found"
                };
                let drawn = seen.fullest.map(|found| Most { found, why });
                let most = drawn.filter(|drawn| drawn.volume() > most.volume()).unwrap_or(most);
                FibreError::VolumeTooLarge {
                    volume_m3: volume,
                    high_m3: most.volume(),
                    contraction: most.contraction(),
                    why: most.why,
                }
            });
        }
        // The volume is flat at its maximum. A volume within rounding of the largest one counts as that.
        if volume > most.volume() * (1.0 - FLAT) {
            return Ok(most.found);
        }
        let found = self.rising(scheme, volume, self.way_to(most.contraction()), &mut seen);
        let found = found.or_else(|| {
            let beyond = [most.contraction(), end.contraction()];
            (volume > end.volume() * (1.0 - END))
                .then(|| self.falling(scheme, volume, beyond, &mut seen))
                .flatten()
        });
        let found = found.or_else(|| ((volume / end.volume() - 1.0).abs() <= FLAT).then_some(end.found));
        found.or_else(|| self.on_a_path(scheme, Goal::Volume(volume), true, &seen)).ok_or({
            let least = seen.volume.min(end.volume());
            if seen.volume.is_finite() && least > volume {
                FibreError::VolumeTooSmall { volume_m3: volume, low_m3: least }
            } else {
                FibreError::VolumeNotFound { volume_m3: volume }
            }
        })
    }

    /// The way from a start in the range to a contraction.
    fn way_to(&self, contraction: f64) -> [f64; 2] {
        [self.contraction_start().min(contraction - 0.05 * contraction.abs()), contraction]
    }

    /// The equilibrium with a volume, on a way on which the volume rises.
    fn rising(&self, scheme: Scheme, volume: f64, way: [f64; 2], seen: &mut Seen) -> Option<Found> {
        let found = self.root(scheme, way, seen, |found| volume - found.response.volume_m3);
        found.ok().filter(|found| self.pulls(&found.response))
    }

    /// The same where the volume falls.
    fn falling(&self, scheme: Scheme, volume: f64, way: [f64; 2], seen: &mut Seen) -> Option<Found> {
        let found = self.root(scheme, way, seen, |found| found.response.volume_m3 - volume);
        found.ok().filter(|found| self.pulls(&found.response))
    }

    /// The equilibrium with more than the largest volume that was found on the way to the end of the range, at
    /// the contraction `peak`: a muscle that stores energy may hold more drawn out, or on another branch.
    fn drawn_out(&self, scheme: Scheme, volume: f64, peak: f64, seen: &mut Seen) -> Option<Found> {
        if self.is_scale_free() {
            return None;
        }
        let found = self.falling(scheme, volume, self.way_to(peak), seen);
        found.or_else(|| self.on_a_path(scheme, Goal::Volume(volume), true, seen))
    }

    /// The last equilibrium that pulls with taut fibres.
    fn range_end_with(&self, scheme: Scheme) -> Result<Most, FibreError> {
        let mut seen = Seen::NOTHING;
        match self.at_limit(scheme, &mut seen) {
            Ok(found) => Ok(Most { found, why: "where its force vanishes" }),
            Err(FibreError::Slack { contraction, limit: Some(limit) }) => {
                // Just short of the limit, because rounding may make the fibres slack at it.
                let places = SHORT_OF.map(|step| limit - step);
                let near = places.iter().find_map(|place| self.at(scheme, *place, seen.last).ok());
                let found =
                    near.or_else(|| places.iter().find_map(|place| self.walked(scheme, *place, false)));
                let slack = FibreError::Slack { contraction, limit: Some(limit) };
                found.map(|found| Most { found, why: "where its fibres slacken" }).ok_or(slack)
            }
            Err(error) => Err(error),
        }
    }

    /// The equilibrium with the largest volume up to the end of the range. It may lie before the end even
    /// where the volume rises at the end: on wide fittings it falls first.
    fn fullest(&self, scheme: Scheme, end: &Most) -> Most {
        let rising = |found: &Found| -found.response.volume_slope_m2;
        if self.is_scale_free() {
            return *end;
        }
        let mut seen = Seen::NOTHING;
        let peak = self.root(scheme, self.way_to(end.contraction()), &mut seen, rising);
        // The volume falls from the point where the fibres can't be drawn out farther.
        match peak.ok().or(seen.fullest) {
            Some(found) if found.response.volume_m3 > end.volume() => {
                Most { found, why: "and less if it contracts more" }
            }
            _ => *end,
        }
    }
}

//! Noise law of a record by restricted maximum likelihood under a saturated model (Patterson and Thompson
//! 1971), with a test against white noise.

use bulge_model::Record;
use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::noise::error::NoiseError;
use crate::noise::law::{CorrelationTime, NoiseLaw, NoiseSource};
use crate::noise::offset_belief::{offset_beliefs, rms};
use crate::noise::orthonormal::Basis;
use crate::noise::restricted_likelihood::RestrictedLikelihood;
use crate::noise::simplex::{Search, minimise};
use crate::noise::whitening::{Components, Layout};

/// Most rows used for the estimate; they give its variances to some per cent.
const MOST_ROWS: usize = 5_000;
/// Rows on which the search begins.
const FIRST_ROWS: usize = 1_200;
/// Fewest rows that are kept of a sweep.
const LEAST_PART: usize = 50;
/// Degrees of freedom from which correlation can be told from chance.
const ENOUGH: f64 = 30.0;
/// Number of sweeps from which a variance of their offsets is estimated.
const ENOUGH_SWEEPS: usize = 3;
/// Degrees of freedom of the sweeps' offsets, after the saturated model, from which their variance is
/// estimated.
const ENOUGH_OFFSETS: f64 = 2.0;
/// Residuals below this fraction of the values are rounding errors.
const EXACT: f64 = 1e-10;
/// Level of the tests.
const LEVEL: f64 = 0.05;
/// Least and largest variance in units of the white one, or of the total scatter if input variances fix the
/// scale.
const RATIOS: (f64, f64) = (1e-6, 1e6);

impl NoiseLaw {
    /// Estimates white, correlated and offset noise by restricted maximum likelihood from the residuals of a
    /// saturated model.
    ///
    /// - `design`: the saturated model, n x m values row by row for the n used rows \[any units\]; dependent
    ///   columns count once,
    /// - `values`: measured force, or measured less predicted force, of the used rows \[N\],
    /// - `input_variances`: as in [`Whitening::new`](crate::Whitening::new) \[N^2\]; they are added to the
    ///   white part.
    ///
    /// Parts that the data can't determine are left out, and `says` names the reason: correlation along a
    /// static map, offsets of fewer than three sweeps, everything but white noise below 30 degrees of
    /// freedom. The remaining parts are kept if they beat white noise in a likelihood-ratio test (p < 0.05,
    /// chi-squared with one degree of freedom per parameter; this is conservative, because variances on the
    /// bound 0 make the ratio smaller). The law is reduced to one part if the other isn't needed at the same
    /// level. Without time, the correlation is over rows. Of more than 5000 rows, the beginnings of the
    /// sweeps are used.
    ///
    /// # Errors
    /// Numbers of values that don't match, values that aren't finite, and as many independent columns as
    /// rows.
    pub fn estimate(
        record: &Record,
        used: &[bool],
        input_variances: &[f64],
        design: &[f64],
        values: &[f64],
    ) -> Result<Self, NoiseError> {
        let unit = if record.has_time() { CorrelationTime::Seconds(1.0) } else { CorrelationTime::Rows(1.0) };
        let layout = Layout::new(record, used, input_variances, Some(unit))?;
        check(&layout, design, values)?;
        let n = values.len();
        let columns = design.len().checked_div(n).unwrap_or(0);
        let keep = leading(&layout, MOST_ROWS);
        let rows = || (0..n).filter(|i| keep[*i]);
        let kept: Vec<f64> = rows().map(|i| values[i]).collect();
        let design: Vec<f64> =
            rows().flat_map(|i| &design[i * columns..(i + 1) * columns]).copied().collect();
        let basis = Basis::of(&design, kept.len());
        let too_few = NoiseError::TooFewRows { rows: kept.len(), columns: basis.rank() };
        let likelihood = RestrictedLikelihood::new(layout.kept(&keep), &basis, &kept).ok_or(too_few)?;
        let size = kept.iter().map(|y| y * y).sum::<f64>() / kept.len() as f64;
        let from = format!(
            "what a saturated model of {} numbers leaves of {} rows in {} sweeps",
            basis.rank(),
            kept.len(),
            likelihood.layout.blocks.len()
        );
        if likelihood.variance.sqrt() <= EXACT * size.sqrt() {
            let says = format!("{from}: nothing but rounding");
            let sd = likelihood.variance.sqrt();
            return Ok(Self::white(sd, NoiseSource::Saturated, likelihood.freedom(), says));
        }
        Ok(Estimate::new(&likelihood, record.is_path()).law(unit, &from))
    }
}

fn check(layout: &Layout, design: &[f64], values: &[f64]) -> Result<(), NoiseError> {
    let n = layout.rows.len();
    let mismatch = |what, given, expected| {
        let instead = "give one value for each used row";
        NoiseError::Lengths { what, given, expected, instead }
    };
    if values.len() != n {
        return Err(mismatch("measured values", values.len(), n));
    }
    let columns = design.len().checked_div(n).unwrap_or(0);
    if design.len() != n * columns {
        return Err(mismatch("columns of the saturated model", design.len(), n * (columns + 1)));
    }
    for (what, list) in [("measured value", values), ("saturated model", design)] {
        if let Some(place) = list.iter().position(|x| !x.is_finite()) {
            return Err(NoiseError::Value { what, place, value: list[place], bound: "" });
        }
    }
    Ok(())
}

/// About `most` rows: the beginnings of the blocks. Blocks are skipped at a regular stride if the beginnings
/// would become too short.
fn leading(layout: &Layout, most: usize) -> Vec<bool> {
    let n = layout.rows.len();
    if n <= most {
        return vec![true; n];
    }
    let stride = layout.blocks.len().div_ceil((most / LEAST_PART).max(1));
    let blocks: Vec<_> = layout.blocks.iter().step_by(stride).collect();
    let total = |length: usize| blocks.iter().map(|b| b.len().min(length)).sum::<usize>();
    let (mut low, mut high) = (1, n);
    while low < high {
        let middle = (low + high).div_ceil(2);
        if total(middle) <= most { low = middle } else { high = middle - 1 }
    }
    let mut keep = vec![false; n];
    for block in blocks {
        keep[block.start..block.start + block.len().min(low)].fill(true);
    }
    keep
}

/// The parts of a law besides the white one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Parts {
    correlated: bool,
    offset: bool,
}

impl Parts {
    fn degrees(self) -> f64 {
        2.0 * f64::from(u8::from(self.correlated)) + f64::from(u8::from(self.offset))
    }
}

/// The best law with some parts.
#[derive(Debug, Clone, Copy)]
struct Found {
    parts: Parts,
    components: Components,
    deviance: f64,
    /// Common factor of the variances.
    factor: f64,
}

struct Estimate<'a> {
    likelihood: &'a RestrictedLikelihood,
    /// The likelihood of fewer rows, on which searches begin.
    first: Option<RestrictedLikelihood>,
    /// Least and largest correlation time; none without neighbouring rows.
    times: Option<(f64, f64)>,
    /// Parts that the data can determine.
    parts: Parts,
    /// Whether there may be offsets, whether or not the data determine them.
    asks_for_offsets: bool,
    /// Reasons why parts are left out.
    limits: Vec<&'static str>,
}

impl<'a> Estimate<'a> {
    fn new(likelihood: &'a RestrictedLikelihood, is_path: bool) -> Self {
        let layout = &likelihood.layout;
        let mut gaps: Vec<f64> = layout.gaps.iter().copied().filter(|gap| *gap > 0.0).collect();
        gaps.sort_unstable_by(f64::total_cmp);
        let longest = layout.blocks.iter().map(|b| layout.gaps[b.clone()].iter().sum::<f64>());
        let longest = longest.fold(0.0, f64::max);
        // A shorter time is white noise; for longer ones only the ratio of variance to time is determined.
        let times = gaps.get(gaps.len() / 2).map(|step| (0.5 * step, longest.max(*step)));
        let mut limits = Vec::new();
        let sweeps = layout.blocks.iter().filter(|b| b.len() > 1).count();
        let mut parts = Parts { correlated: times.is_some(), offset: sweeps >= ENOUGH_SWEEPS };
        if !is_path {
            parts = Parts { correlated: false, offset: false };
            limits.push("the rows are a static map, whose order means nothing");
        } else if likelihood.freedom() < ENOUGH {
            parts = Parts { correlated: false, offset: false };
            limits.push("below 30 degrees of freedom correlation can't be told from chance");
        } else if !parts.offset {
            limits.push("fewer than three sweeps say nothing about offsets between sweeps");
        } else if likelihood.offset_freedom() < ENOUGH_OFFSETS {
            parts.offset = false;
            limits.push("the saturated model can follow the sweeps one by one: nothing is said about offsets between them");
        }
        let first = (layout.rows.len() > FIRST_ROWS)
            .then(|| likelihood.on(&leading(layout, FIRST_ROWS)))
            .flatten()
            .filter(|first| first.freedom() > 0.5 * first.layout.rows.len() as f64);
        let asks_for_offsets = is_path && sweeps >= 2 && likelihood.freedom() >= ENOUGH;
        Self { likelihood, first, times, parts, asks_for_offsets, limits }
    }

    /// Bounds of the coordinates: logarithms of the white variance (if the scale is fixed), of the correlated
    /// variance and its time, and of the offsets' variance.
    fn bounds(&self, parts: Parts) -> Vec<(f64, f64)> {
        let logs = |(low, high): (f64, f64)| (low.ln(), high.ln());
        let mut bounds = Vec::with_capacity(4);
        if self.likelihood.absolute {
            bounds.push(logs(RATIOS));
        }
        if parts.correlated {
            bounds.extend([logs(RATIOS), logs(self.times.unwrap_or((1.0, 1.0)))]);
        }
        if parts.offset {
            bounds.push(logs(RATIOS));
        }
        bounds
    }

    fn components(&self, parts: Parts, coordinates: &[f64]) -> Components {
        let unit = if self.likelihood.absolute { self.likelihood.variance } else { 1.0 };
        let mut next = coordinates.iter().map(|x| x.exp());
        let mut take = |is: bool, without: f64| if is { next.next().unwrap_or(without) } else { without };
        let white = unit * take(self.likelihood.absolute, 1.0);
        let correlated = unit * take(parts.correlated, 0.0);
        let time = take(parts.correlated, 1.0);
        let offset = unit * take(parts.offset, 0.0);
        Components { white, correlated, time, offset }
    }

    /// Coordinates for variances in units of the white one, scaled to the total scatter.
    fn coordinates(&self, parts: Parts, correlated: f64, time: f64, offset: f64) -> Vec<f64> {
        let absolute = self.likelihood.absolute;
        let white = if absolute { 1.0 / (1.0 + correlated + offset) } else { 1.0 };
        let mut coordinates = Vec::with_capacity(4);
        if absolute {
            coordinates.push(white.ln());
        }
        if parts.correlated {
            coordinates.extend([(correlated * white).ln(), time.ln()]);
        }
        if parts.offset {
            coordinates.push((offset * white).ln());
        }
        coordinates
    }

    /// The best law with these parts, from the best of the starts.
    fn fit(&self, parts: Parts, starts: &[Vec<f64>]) -> Option<Found> {
        let bounds = self.bounds(parts);
        let value = |likelihood: &RestrictedLikelihood, coordinates: &[f64]| {
            let deviance = likelihood.deviance(&self.components(parts, coordinates));
            deviance.map_or(f64::INFINITY, |d| d.value)
        };
        let first = self.first.as_ref().unwrap_or(self.likelihood);
        let tried: Vec<(f64, &Vec<f64>)> =
            starts.par_iter().map(|start| (value(first, start), start)).collect();
        let mut start =
            tried.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, start)| start.clone())?;
        if let Some(first) = &self.first {
            let search = Search { bounds: &bounds, step: 0.7, evaluations: 60, tolerance: 1e-2 };
            start = minimise(|x| value(first, x), &start, search).0;
        }
        let step = if self.first.is_some() { 0.3 } else { 0.7 };
        let search = Search { bounds: &bounds, step, evaluations: 30 * (1 + bounds.len()), tolerance: 1e-3 };
        let (best, _) = minimise(|x| value(self.likelihood, x), &start, search);
        let components = self.components(parts, &best);
        let deviance = self.likelihood.deviance(&components)?;
        Some(Found { parts, components, deviance: deviance.value, factor: deviance.factor })
    }

    /// Correlation times on a logarithmic grid.
    fn grid(&self, points: u32) -> Vec<f64> {
        let (low, high) = self.times.unwrap_or((1.0, 1.0));
        let at = |i: u32| low * (high / low).powf((f64::from(i) + 0.5) / f64::from(points));
        (0..points).map(at).collect()
    }

    fn correlated(&self) -> Option<Found> {
        let parts = Parts { correlated: true, offset: false };
        let mut starts = Vec::new();
        for time in self.grid(6) {
            starts.extend([0.3, 3.0, 30.0].map(|ratio| self.coordinates(parts, ratio, time, 0.0)));
        }
        self.fit(parts, &starts)
    }

    fn offset(&self) -> Option<Found> {
        let parts = Parts { correlated: false, offset: true };
        self.fit(parts, &[0.03, 0.3, 3.0, 30.0].map(|ratio| self.coordinates(parts, 0.0, 1.0, ratio)))
    }

    /// The law with both parts, started from the best laws with one.
    fn both(&self, correlated: Option<&Found>, offset: Option<&Found>) -> Option<Found> {
        let parts = Parts { correlated: true, offset: true };
        let mut starts = Vec::new();
        if let Some(Found { components: Components { white, correlated, time, .. }, .. }) = correlated {
            let ratio = correlated / white;
            let of = |part: f64| self.coordinates(parts, ratio, *time, part * (1.0 + ratio));
            starts.extend([0.01, 0.1, 1.0].map(of));
        }
        if let Some(Found { components: Components { white, offset, .. }, .. }) = offset {
            for time in self.grid(6) {
                starts.extend([0.3, 3.0].map(|r| self.coordinates(parts, r, time, offset / white)));
            }
        }
        self.fit(parts, &starts)
    }

    /// The chosen law, with what decided.
    fn law(&self, unit: CorrelationTime, from: &str) -> NoiseLaw {
        let none = Parts { correlated: false, offset: false };
        let white = self.fit(none, &[self.coordinates(none, 0.0, 1.0, 0.0)]);
        let (correlated, offset) = rayon::join(
            || self.parts.correlated.then(|| self.correlated()).flatten(),
            || self.parts.offset.then(|| self.offset()).flatten(),
        );
        let both = (self.parts.correlated && self.parts.offset)
            .then(|| self.both(correlated.as_ref(), offset.as_ref()))
            .flatten();
        let mut says = from.to_owned();
        for limit in &self.limits {
            says = format!("{says}; {limit}");
        }
        let candidates: Vec<Found> = [white, offset, correlated, both].into_iter().flatten().collect();
        let full = candidates.iter().map(|found| found.deviance).fold(f64::INFINITY, f64::min);
        let most = self.parts.degrees();
        // Take the simplest law that isn't significantly worse than the full one.
        let chosen = candidates.iter().find(|found| {
            found.deviance <= full || tail(found.deviance - full, most - found.parts.degrees()) >= LEVEL
        });
        if let Some(white) = white.filter(|_| most > 0.0) {
            let ratio = (white.deviance - full).max(0.0);
            let p = in_words(tail(ratio, most));
            says = format!("{says}; likelihood ratio {ratio:.2} against white noise, {p}");
        }
        let (components, factor) = chosen.map_or_else(
            || (Components { white: self.likelihood.variance, correlated: 0.0, time: 1.0, offset: 0.0 }, 1.0),
            |found| (found.components, found.factor),
        );
        let sd = |variance: f64| (variance * factor).sqrt();
        let beliefs = if self.asks_for_offsets {
            let [white, correlated] =
                [components.white, components.correlated].map(|variance| variance * factor);
            offset_beliefs(self.likelihood, &Components { white, correlated, ..components })
        } else {
            Vec::new()
        };
        let time = match unit {
            CorrelationTime::Seconds(_) => CorrelationTime::Seconds(components.time),
            CorrelationTime::Rows(_) => CorrelationTime::Rows(components.time),
        };
        NoiseLaw {
            white_n: sd(components.white),
            correlated_n: sd(components.correlated),
            time: (components.correlated > 0.0).then_some(time),
            offset_n: if beliefs.is_empty() { sd(components.offset) } else { rms(&beliefs) },
            offset_beliefs: beliefs,
            source: NoiseSource::Saturated,
            degrees_of_freedom: self.likelihood.freedom(),
            offset_freedom: self.likelihood.offset_freedom(),
            says,
        }
    }
}

/// Upper tail probability of chi-squared with `degrees` degrees of freedom.
fn tail(ratio: f64, degrees: f64) -> f64 {
    if degrees <= 0.0 || ratio <= 0.0 {
        return 1.0;
    }
    ChiSquared::new(degrees).map_or(1.0, |law| law.sf(ratio))
}

fn in_words(p: f64) -> String {
    if p < 1e-16 {
        "p < 1e-16".to_owned()
    } else if p < 1e-3 {
        format!("p = {p:.1e}")
    } else {
        format!("p = {p:.3}")
    }
}

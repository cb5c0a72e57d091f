//! A measured history prepared for a model: one moment per row, sweep by sweep.

use bulge_effects::Moment;
use bulge_measurements::{Columns, Data, History};
use std::ops::Range;
use std::sync::Arc;

/// Measured forces: those of the file, which are in memory anyway, or given ones.
#[derive(Debug, Clone)]
enum Forces {
    Read(Arc<Columns>),
    Given(Arc<Vec<f64>>),
}

/// The rows of a data set as moments, with the measured forces.
#[derive(Debug, Clone)]
pub struct Record {
    /// Shared by copies that differ only in the forces or their standard deviations. For long records this is
    /// the largest block of memory.
    moments: Arc<Vec<Moment>>,
    sweeps: Vec<Range<usize>>,
    specimens: Vec<String>,
    /// The muscle's length over the length of each specimen; empty if all are of one length.
    shortness: Vec<f64>,
    force: Forces,
    force_sd: Option<Arc<Vec<f64>>>,
    is_path: bool,
    has_time: bool,
}

impl Record {
    /// The rows of a data set, for a muscle of unpressurised length `l0` \[m\].
    #[must_use]
    pub fn new(data: &Data, l0: f64) -> Self {
        let path = Moved::of(data, l0);
        let sweeps: Vec<Range<usize>> = data.sweeps().iter().map(|sweep| sweep.rows.clone()).collect();
        let contraction = data.contraction(l0);
        let shortness = (0_u32..).zip(data.specimens()).map(|(i, _)| l0 / data.length_of(i, l0)).collect();
        let mut moments = Vec::with_capacity(data.len());
        for sweep in &sweeps {
            append(&mut moments, data, &path, &contraction, sweep.clone());
        }
        Self {
            moments: Arc::new(moments),
            sweeps,
            specimens: data.specimens().to_vec(),
            shortness,
            force: Forces::Read(Arc::clone(data.columns())),
            force_sd: data.force_sd().map(|sd| Arc::new(sd.to_vec())),
            is_path: path.is_path,
            has_time: data.time().is_some(),
        }
    }

    /// A record of computed moments. The sweeps are consecutive ranges of rows and must cover all rows in
    /// order.
    ///
    /// Returns none if they don't, or if the numbers of moments and forces differ.
    #[must_use]
    pub fn from_moments(moments: Vec<Moment>, force: Vec<f64>, sweeps: Vec<Range<usize>>) -> Option<Self> {
        let mut end = 0;
        for sweep in &sweeps {
            if sweep.start != end || sweep.end < sweep.start {
                return None;
            }
            end = sweep.end;
        }
        let specimens = moments.iter().map(|m| m.specimen).max().map_or(0, |last| last + 1);
        (end == moments.len() && force.len() == end).then(|| Self {
            is_path: moments.iter().any(|m| m.branch() != 0.0),
            has_time: moments.iter().any(|m| m.clock != 0.0),
            moments: Arc::new(moments),
            sweeps,
            specimens: (1..=specimens).map(|i| i.to_string()).collect(),
            shortness: Vec::new(),
            force: Forces::Given(Arc::new(force)),
            force_sd: None,
        })
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.moments.len()
    }

    /// Whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.moments.is_empty()
    }

    /// The moments.
    #[must_use]
    pub fn moments(&self) -> &[Moment] {
        &self.moments
    }

    /// Measured force \[N\].
    #[must_use]
    pub fn force(&self) -> &[f64] {
        match &self.force {
            Forces::Read(columns) => &columns.force_n,
            Forces::Given(force) => force,
        }
    }

    /// Standard deviation of each force \[N\], if the file states it.
    #[must_use]
    pub fn force_sd(&self) -> Option<&[f64]> {
        self.force_sd.as_deref().map(Vec::as_slice)
    }

    /// Rows of each sweep.
    #[must_use]
    pub fn sweeps(&self) -> &[Range<usize>] {
        &self.sweeps
    }

    /// Names of the specimens.
    #[must_use]
    pub fn specimens(&self) -> &[String] {
        &self.specimens
    }

    /// The unpressurised length of the muscle over that of the row's specimen. The contraction due to an
    /// error of length scales with this factor.
    #[must_use]
    pub fn shortness(&self, row: usize) -> f64 {
        let specimen = self.moments.get(row).map_or(0, |moment| moment.specimen as usize);
        self.shortness.get(specimen).copied().unwrap_or(1.0)
    }

    /// Whether the rows form a path rather than a static map.
    #[must_use]
    pub fn is_path(&self) -> bool {
        self.is_path
    }

    /// Whether the rows have times.
    #[must_use]
    pub fn has_time(&self) -> bool {
        self.has_time
    }
}

/// The largest completed part of a loop, so that a long loop isn't counted as the next one.
const MOST_OF_LOOP: f64 = 0.999;

/// The parts of the motion's history that moments need. The rest is freed before the moments are made.
struct Moved {
    direction: Vec<f64>,
    pressure_direction: Vec<f64>,
    rate: Vec<f64>,
    cycle: Vec<f64>,
    is_path: bool,
}

impl Moved {
    fn of(data: &Data, l0: f64) -> Self {
        let History { direction, pressure_direction, rate, cycle, is_path, .. } = data.history(l0);
        Self { direction, pressure_direction, rate, cycle, is_path }
    }
}

fn append(moments: &mut Vec<Moment>, data: &Data, path: &Moved, contraction: &[f64], rows: Range<usize>) {
    let time = data.time();
    let start = time.map_or(0.0, |t| t[rows.start]);
    let origin = time.and_then(|t| t.first().copied()).unwrap_or(0.0);
    let temperature = data.temperature();
    let reference = temperature.and_then(|t| t.first().copied()).unwrap_or(0.0);
    let pressure = data.pressure();
    let mut largest = f64::NEG_INFINITY;
    for row in rows.clone() {
        largest = largest.max(contraction[row]);
        let begins = row == rows.start;
        // The pressure rate is a central difference within the sweep, one-sided at its ends.
        let before = if begins { row } else { row - 1 };
        let after = if row + 1 == rows.end { row } else { row + 1 };
        let span = time.map_or(0.0, |t| t[after] - t[before]);
        moments.push(Moment {
            pressure: pressure[row],
            contraction: contraction[row],
            direction: path.direction[row],
            pressure_direction: path.pressure_direction[row],
            rate: path.rate[row],
            pressure_rate: if span > 0.0 { (pressure[after] - pressure[before]) / span } else { 0.0 },
            time: time.map_or(0.0, |t| t[row] - start),
            clock: time.map_or(0.0, |t| t[row] - origin),
            since: 0.0,
            step: 0.0,
            pressure_step: 0.0,
            temperature: temperature.map_or(0.0, |t| t[row] - reference),
            cycle: path.cycle[row],
            largest,
            begins,
            specimen: data.specimen_of(row),
        });
    }
    if let Some(sweep) = moments.get_mut(rows) {
        step(sweep, path.is_path);
        if path.is_path {
            under_way(sweep);
        }
    }
}

/// Adds the completed part to the loop number of each moment of a sweep. The part is the distance since the
/// loop began over that of a whole loop, twice the range of the driven quantity.
fn under_way(sweep: &mut [Moment]) {
    let is_held = sweep.iter().all(|m| m.direction == 0.0);
    let driven = |m: &Moment| if is_held { m.pressure } else { m.contraction };
    let branch = |m: &Moment| if is_held { m.pressure_direction } else { m.direction };
    let [low, high] = sweep
        .iter()
        .map(driven)
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
    let whole = 2.0 * (high - low);
    if whole <= 0.0 {
        return;
    }
    let (mut number, mut done, mut direction) = (f64::NAN, 0.0, 0.0);
    let (mut turned, mut last) = (0.0, 0.0);
    for moment in sweep {
        let (x, now) = (driven(moment), branch(moment));
        if moment.cycle.total_cmp(&number).is_ne() {
            (number, done, turned) = (moment.cycle, 0.0, if moment.begins { x } else { last });
        } else if now * direction < 0.0 {
            // The distance is measured between reversals, so that noise doesn't add to it.
            (done, turned) = (done + f64::abs(last - turned), last);
        }
        if now != 0.0 {
            direction = now;
        }
        moment.cycle += ((done + f64::abs(x - turned)) / whole).min(MOST_OF_LOOP);
        last = x;
    }
}

/// Sets the changes since the previous row in all moments of one sweep. In a static map the order of the rows
/// means nothing, so the steps are 0. A held pressure only scatters, so its step is 0 too.
fn step(sweep: &mut [Moment], is_path: bool) {
    let is_driven = sweep.iter().any(|m| m.pressure_direction != 0.0);
    let mut before: Option<Moment> = None;
    for moment in sweep {
        let last = before.unwrap_or(*moment);
        moment.begins = before.is_none();
        moment.since = moment.clock - last.clock;
        moment.step = if is_path { moment.contraction - last.contraction } else { 0.0 };
        moment.pressure_step = if is_path && is_driven { moment.pressure - last.pressure } else { 0.0 };
        before = Some(*moment);
    }
}

impl Record {
    /// The record thinned to about `most` rows, and the indices of the rows kept. Every n-th row of each
    /// sweep is kept, including its first and last row.
    #[must_use]
    pub fn thinned(&self, most: usize) -> (Self, Vec<usize>) {
        let stride = self.len().div_ceil(most.max(1)).max(1);
        if stride == 1 {
            return (self.clone(), (0..self.len()).collect());
        }
        let mut kept = Vec::with_capacity(most + self.sweeps.len());
        let mut sweeps = Vec::with_capacity(self.sweeps.len());
        for sweep in &self.sweeps {
            let start = kept.len();
            kept.extend(sweep.clone().step_by(stride));
            if let Some(last) = sweep.clone().next_back().filter(|last| kept.last() != Some(last)) {
                kept.push(last);
            }
            sweeps.push(start..kept.len());
        }
        let mut moments: Vec<Moment> = kept.iter().map(|row| self.moments[*row]).collect();
        for sweep in &sweeps {
            step(&mut moments[sweep.clone()], self.is_path);
        }
        let thin = Self {
            moments: Arc::new(moments),
            sweeps,
            specimens: self.specimens.clone(),
            shortness: self.shortness.clone(),
            force: Forces::Given(Arc::new(kept.iter().map(|row| self.force()[*row]).collect())),
            force_sd: self.force_sd().map(|sd| Arc::new(kept.iter().map(|row| sd[*row]).collect())),
            is_path: self.is_path,
            has_time: self.has_time,
        };
        (thin, kept)
    }
}

impl Record {
    /// Replaces the forces \[N\], one for each moment. Moments without a new force keep their own.
    #[must_use]
    pub fn with_force(mut self, force: Vec<f64>) -> Self {
        let mut forces = force;
        forces.truncate(self.len());
        forces.extend_from_slice(&self.force()[forces.len()..]);
        self.force = Forces::Given(Arc::new(forces));
        self
    }

    /// Replaces the standard deviations of the forces \[N\], one for each moment. Nothing changes if the
    /// number differs.
    #[must_use]
    pub fn with_force_sd(mut self, sd: Vec<f64>) -> Self {
        if sd.len() == self.len() {
            self.force_sd = Some(Arc::new(sd));
        }
        self
    }

    /// Replaces the pressures \[Pa\] and contractions, one for each moment. Moments without new values keep
    /// their own.
    #[must_use]
    pub fn at(mut self, pressure: &[f64], contraction: &[f64]) -> Self {
        for (moment, (pressure, contraction)) in
            Arc::make_mut(&mut self.moments).iter_mut().zip(pressure.iter().zip(contraction))
        {
            (moment.pressure, moment.contraction) = (*pressure, *contraction);
        }
        self
    }

    /// All rows as those of one specimen, by its index; the contractions stay.
    #[must_use]
    pub fn of_specimen(mut self, specimen: u32) -> Self {
        for moment in Arc::make_mut(&mut self.moments) {
            moment.specimen = specimen;
        }
        self
    }

    /// Replaces groups of neighbouring rows by their means, with the forces that belong to them. `sweeps` are
    /// ranges of groups.
    ///
    /// Each group lies within one sweep and one specimen, and moves in one direction. The muscle then passes
    /// through the mean moment. Steps and times since the previous moment are those between means. A mean
    /// takes the largest contraction from its last row.
    ///
    /// Returns none if a group is empty or names a row that doesn't exist, or if the numbers of groups and
    /// forces differ.
    #[must_use]
    pub fn averaged(
        &self,
        groups: &[Vec<usize>],
        force: Vec<f64>,
        sweeps: Vec<Range<usize>>,
    ) -> Option<Self> {
        let mut moments: Vec<Moment> = Vec::with_capacity(groups.len());
        for group in groups {
            let members = group.iter().map(|row| self.moments.get(*row)).collect::<Option<Vec<_>>>()?;
            let (first, last) = (members.first()?, members.last()?);
            let mean = |of: &dyn Fn(&Moment) -> f64| {
                members.iter().map(|m| of(m)).sum::<f64>() / members.len() as f64
            };
            // A group of one row stays unchanged, bit for bit.
            let moment = if members.len() == 1 {
                **first
            } else {
                Moment {
                    pressure: mean(&|m| m.pressure),
                    contraction: mean(&|m| m.contraction),
                    rate: mean(&|m| m.rate),
                    pressure_rate: mean(&|m| m.pressure_rate),
                    time: mean(&|m| m.time),
                    clock: mean(&|m| m.clock),
                    temperature: mean(&|m| m.temperature),
                    cycle: mean(&|m| m.cycle),
                    largest: last.largest,
                    ..**first
                }
            };
            moments.push(moment);
        }
        for sweep in &sweeps {
            step(moments.get_mut(sweep.clone())?, self.is_path);
        }
        let sd = |all: &[f64]| {
            let means = groups.iter().map(|g| g.iter().map(|row| all[*row]).sum::<f64>() / g.len() as f64);
            Arc::new(means.collect())
        };
        (force.len() == moments.len()).then(|| Self {
            moments: Arc::new(moments),
            sweeps,
            specimens: self.specimens.clone(),
            shortness: self.shortness.clone(),
            force: Forces::Given(Arc::new(force)),
            force_sd: self.force_sd().map(sd),
            is_path: self.is_path,
            has_time: self.has_time,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loops_are_counted_with_the_part_that_is_done() {
        // Two loops of eight rows and half of a third, at a stroke of 4 %.
        let at = |i: usize| {
            let place = [0.0, 1.0, 2.0, 3.0, 4.0, 3.0, 2.0, 1.0][i % 8];
            let direction = if i == 0 || (1..5).contains(&(i % 8)) { 1.0 } else { -1.0 };
            let cycle = (i.max(1) - 1) / 8;
            Moment { direction, cycle: cycle as f64, begins: i == 0, ..Moment::at_rest(1e5, 0.01 * place) }
        };
        let mut sweep: Vec<Moment> = (0..21).map(at).collect();
        under_way(&mut sweep);
        for (i, moment) in sweep.iter().enumerate() {
            let expected = i as f64 / 8.0;
            assert!((moment.cycle - expected).abs() < 1.1e-3, "{i}: {} {expected}", moment.cycle);
        }
    }

    #[test]
    fn specimens_are_those_of_the_data() {
        let csv =
            "specimen,pressure [bar],contraction [%],force [N]\nlong,2,5,300\nlong,2,9,200\nshort,2,5,310\n";
        let record = Record::new(&Data::from_csv(csv, "two.csv").unwrap(), 0.25);
        assert_eq!(record.specimens(), ["long", "short"]);
        let of_rows: Vec<u32> = record.moments().iter().map(|moment| moment.specimen).collect();
        assert_eq!(of_rows, [0, 0, 1]);
    }

    #[test]
    fn groups_are_their_means() {
        let at = |i: u32| {
            let x = f64::from(i * i);
            Moment {
                direction: 1.0,
                pressure_direction: 1.0,
                rate: 2.0 * x,
                pressure_rate: 3.0 * x,
                time: 4.0 * x,
                clock: 5.0 * x,
                temperature: 6.0 * x,
                cycle: 7.0 * x,
                largest: 8.0 * x,
                begins: i == 0,
                ..Moment::at_rest(1e5 + x, 0.01 * x)
            }
        };
        let force = vec![0.0, 1.0, 4.0, 9.0];
        let record =
            Record::from_moments((0..4).map(at).collect(), force, std::iter::once(0..4).collect()).unwrap();
        let record = record.with_force_sd(vec![1.0, 2.0, 3.0, 4.0]);
        let sweeps: Vec<Range<usize>> = std::iter::once(0..2).collect();
        let groups = [vec![0], vec![1, 2, 3]];
        let found = record.averaged(&groups, vec![10.0, 20.0], sweeps.clone()).unwrap();
        // The mean of 1, 4 and 9, and the last row for the largest so far.
        let (x, moment) = (14.0 / 3.0, found.moments()[1]);
        let close =
            |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12 * expected, "{found}");
        close(moment.pressure, 1e5 + x);
        close(moment.contraction, 0.01 * x);
        for (number, times) in
            [moment.rate, moment.pressure_rate, moment.time, moment.clock, moment.temperature, moment.cycle]
                .into_iter()
                .zip([2.0, 3.0, 4.0, 5.0, 6.0, 7.0])
        {
            close(number, times * x);
        }
        close(moment.largest, 72.0);
        assert!(found.moments()[0].begins && !moment.begins);
        assert_eq!((found.force(), found.force_sd()), (&[10.0, 20.0][..], Some(&[1.0, 3.0][..])));
        let lost = [vec![0], vec![]];
        assert!(record.averaged(&lost, vec![10.0, 20.0], sweeps.clone()).is_none());
        assert!(record.averaged(&groups, vec![10.0], sweeps).is_none());
    }

    /// Two sweeps at a held length, with uneven times: rates are differences of the neighbours, steps those of the row before.
    #[test]
    fn moments_know_what_was_before() {
        let head = "time [s],pressure [bar],contraction [%],force [N],temperature [C],sweep\n";
        let rows =
            "10,1,5,1,20,a\n11,2,5,2,21,a\n13,4,5,3,23,a\n17,3,5,2,26,a\n20,1,5,1,26,b\n22,3,5,2,25,b\n";
        let record = Record::new(&Data::from_csv(&format!("{head}{rows}"), "held.csv").unwrap(), 0.25);
        let of = |number: &dyn Fn(&Moment) -> f64| record.moments().iter().map(number).collect::<Vec<_>>();
        let close = |found: Vec<f64>, expected: [f64; 6]| {
            let worst = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-9, "{found:?} {expected:?}");
        };
        close(of(&|m| 1e-5 * m.pressure_rate), [1.0, 1.0, 1.0 / 6.0, -0.25, 1.0, 1.0]);
        close(of(&|m| 1e-5 * m.pressure_step), [0.0, 1.0, 2.0, -1.0, 0.0, 2.0]);
        close(of(&|m| m.since), [0.0, 1.0, 2.0, 4.0, 0.0, 2.0]);
        close(of(&|m| m.time), [0.0, 1.0, 3.0, 7.0, 0.0, 2.0]);
        close(of(&|m| m.clock), [0.0, 1.0, 3.0, 7.0, 10.0, 12.0]);
        close(of(&|m| m.temperature), [0.0, 1.0, 3.0, 6.0, 6.0, 5.0]);
        close(of(&|m| f64::from(m.begins)), [1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        // Without times there are no rates.
        let untimed = "pressure [bar],contraction [%],force [N]\n1,5,1\n2,5,2\n";
        let untimed = Record::new(&Data::from_csv(untimed, "map.csv").unwrap(), 0.25);
        assert!(untimed.moments().iter().all(|m| m.pressure_rate == 0.0 && m.since == 0.0));
        assert!(!record.is_empty() && record.has_time() && !untimed.has_time());
    }

    /// A noisy reading at rest adds nothing to the part of the loop that is done.
    #[test]
    fn rest_is_no_part_of_a_loop() {
        let place = [0.0, 1.0, 2.0, 2.2, 1.8, 2.2, 1.8, 2.0, 3.0, 4.0];
        let moves = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0];
        let at = |i: usize| Moment {
            direction: moves[i],
            begins: i == 0,
            ..Moment::at_rest(1e5, 0.01 * place[i])
        };
        let mut sweep: Vec<Moment> = (0..place.len()).map(at).collect();
        under_way(&mut sweep);
        for (moment, place) in sweep.iter().zip(place) {
            assert!((moment.cycle - place / 8.0).abs() < 1e-12, "{place}: {}", moment.cycle);
        }
    }

    #[test]
    fn a_map_is_no_path() {
        let still = || vec![Moment::at_rest(1e5, 0.01), Moment::at_rest(2e5, 0.02)];
        let of =
            |moments| Record::from_moments(moments, vec![1.0; 2], std::iter::once(0..2).collect()).unwrap();
        let [mut moved, map] = [still(), still()];
        moved[1].direction = 1.0;
        let (moved, map) = (of(moved), of(map));
        assert!(moved.is_path() && !map.is_path());
    }

    /// The last row of a sweep is kept, once; steps are those between the rows kept.
    #[test]
    fn thinned_sweeps_end_where_they_ended() {
        let at = |i: u32| Moment {
            direction: 1.0,
            clock: f64::from(i),
            ..Moment::at_rest(1e5, 0.01 * f64::from(i))
        };
        let record =
            Record::from_moments((0..19).map(at).collect(), vec![0.0; 19], vec![0..9, 9..19]).unwrap();
        let (thin, kept) = record.thinned(10);
        assert_eq!(kept, [0, 2, 4, 6, 8, 9, 11, 13, 15, 17, 18]);
        assert_eq!(thin.sweeps(), [0..5, 5..11]);
        let steps: Vec<f64> = thin.moments().iter().map(|moment| (100.0 * moment.step).round()).collect();
        assert_eq!(steps, [0.0, 2.0, 2.0, 2.0, 2.0, 0.0, 2.0, 2.0, 2.0, 2.0, 1.0]);
        assert_eq!(thin.moments()[10].since.to_bits(), 1.0_f64.to_bits());
    }

    #[test]
    fn copies_with_other_forces_share_what_was_moved() {
        let moments: Vec<Moment> = (0..5).map(|i| Moment::at_rest(1e5, 0.01 * f64::from(i))).collect();
        let record = Record::from_moments(moments, vec![1.0; 5], std::iter::once(0..5).collect());
        assert!(record.is_some());
        let Some(record) = record else { return };
        let other = record.clone().with_force(vec![2.0; 5]).with_force_sd(vec![0.1; 5]);
        assert_eq!(record.moments().as_ptr(), other.moments().as_ptr());
        assert_eq!((record.force()[0].to_bits(), record.force_sd()), (1.0_f64.to_bits(), None));
        assert_eq!(record.force().as_ptr(), record.clone().with_force_sd(vec![0.1; 5]).force().as_ptr());
        // A million rows take 150 bytes each, including their forces.
        assert!(size_of::<Moment>() <= 120, "{}", size_of::<Moment>());
    }
}

//! The columns of a data set in SI units: the result of reading a file, and the input from a program.

use crate::error::MeasurementError;
use std::collections::HashMap;

/// The measured motion of the muscle.
#[derive(Debug, Clone, PartialEq)]
pub enum Trace {
    /// Contraction 1 - l/l0.
    Contraction(Vec<f64>),
    /// Length l between the fittings \[m\].
    Length(Vec<f64>),
}

impl Trace {
    /// The values, whichever they are.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        match self {
            Self::Contraction(values) | Self::Length(values) => values,
        }
    }

    fn values_mut(&mut self) -> &mut Vec<f64> {
        match self {
            Self::Contraction(values) | Self::Length(values) => values,
        }
    }
}

/// A column that is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// The pressure.
    Pressure,
    /// The contraction or length.
    Motion,
    /// The force.
    Force,
}

impl Channel {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Pressure, Self::Motion, Self::Force];

    /// Its name in messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Pressure => "pressure",
            Self::Motion => "motion",
            Self::Force => "force",
        }
    }
}

/// A text per row; each distinct text is stored once.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Labels {
    names: Vec<String>,
    rows: Vec<u32>,
    places: HashMap<String, u32>,
}

impl Labels {
    /// Adds the label of the next row.
    pub fn push(&mut self, name: &str) {
        let last = self.rows.last().copied();
        if let Some(last) = last
            && self.names.get(last as usize).is_some_and(|known| known == name)
        {
            self.rows.push(last);
            return;
        }
        let next = u32::try_from(self.names.len()).unwrap_or(u32::MAX);
        let place = *self.places.entry(name.to_owned()).or_insert_with(|| {
            self.names.push(name.to_owned());
            next
        });
        self.rows.push(place);
    }

    /// The distinct labels in the order of their first appearance.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// For each row, the index of its label in [`Labels::names`].
    #[must_use]
    pub fn rows(&self) -> &[u32] {
        &self.rows
    }

    fn append(&mut self, other: &Self) {
        for row in &other.rows {
            self.push(&other.names[*row as usize]);
        }
    }

    fn filter(&mut self, keep: &[usize]) {
        self.rows = picked(&self.rows, keep);
    }
}

impl<S: AsRef<str>> FromIterator<S> for Labels {
    fn from_iter<I: IntoIterator<Item = S>>(labels: I) -> Self {
        let mut found = Self::default();
        labels.into_iter().for_each(|label| found.push(label.as_ref()));
        found
    }
}

/// The columns of a data set, in SI, one value per row. Create it with [`Columns::new`], then set the
/// optional columns.
///
/// ```
/// use bulge_measurements::{Columns, Data, Trace};
/// let mut columns = Columns::new(vec![2e5; 3], Trace::Length(vec![0.30, 0.29, 0.28]), vec![900.0, 700.0, 520.0]);
/// columns.time_s = Some(vec![0.0, 0.1, 0.2]);
/// let data = Data::from_columns(columns)?;
/// assert_eq!((data.len(), data.history(0.3).direction), (3, vec![1.0, 1.0, 1.0]));
/// # Ok::<(), bulge_measurements::MeasurementError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    /// Gauge pressure \[Pa\].
    pub pressure_pa: Vec<f64>,
    /// Contraction, or length \[m\].
    pub motion: Trace,
    /// Pulling force \[N\].
    pub force_n: Vec<f64>,
    /// Time \[s\].
    pub time_s: Option<Vec<f64>>,
    /// Temperature \[K\].
    pub temperature_k: Option<Vec<f64>>,
    /// Largest diameter \[m\].
    pub diameter_m: Option<Vec<f64>>,
    /// Enclosed volume \[m^3\].
    pub volume_m3: Option<Vec<f64>>,
    /// Standard deviation of the force \[N\].
    pub force_sd_n: Option<Vec<f64>>,
    /// Number of the load cycle.
    pub cycle: Option<Vec<i64>>,
    /// Stated direction: +1 shortening, -1 lengthening, 0 at rest. The observed one is in [`crate::Data::history`].
    pub direction: Option<Vec<i8>>,
    /// Label of the uninterrupted run that the row belongs to.
    pub sweep: Option<Labels>,
    /// Name of the specimen; if absent, there is one specimen, "1".
    pub specimen: Option<Labels>,
}

impl Columns {
    /// The readings of one channel.
    pub(crate) fn values_mut(&mut self, channel: Channel) -> &mut Vec<f64> {
        match channel {
            Channel::Pressure => &mut self.pressure_pa,
            Channel::Motion => self.motion.values_mut(),
            Channel::Force => &mut self.force_n,
        }
    }

    /// The mandatory columns of a data set.
    #[must_use]
    pub fn new(pressure_pa: Vec<f64>, motion: Trace, force_n: Vec<f64>) -> Self {
        Self {
            pressure_pa,
            motion,
            force_n,
            time_s: None,
            temperature_k: None,
            diameter_m: None,
            volume_m3: None,
            force_sd_n: None,
            cycle: None,
            direction: None,
            sweep: None,
            specimen: None,
        }
    }

    /// Number of rows.
    pub(crate) fn len(&self) -> usize {
        self.pressure_pa.len()
    }

    /// Every numeric column with its name.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = (&'static str, &[f64])> {
        let motion = match &self.motion {
            Trace::Contraction(values) => ("contraction", values.as_slice()),
            Trace::Length(values) => ("length", values.as_slice()),
        };
        let required = [("pressure", self.pressure_pa.as_slice()), motion, ("force", &self.force_n)];
        let optional = [
            ("time", &self.time_s),
            ("temperature", &self.temperature_k),
            ("diameter", &self.diameter_m),
            ("volume", &self.volume_m3),
            ("force_sd", &self.force_sd_n),
        ];
        let given = optional.into_iter().filter_map(|(name, values)| Some((name, values.as_deref()?)));
        required.into_iter().chain(given)
    }

    /// Name and length of every other column.
    pub(crate) fn marks(&self) -> impl Iterator<Item = (&'static str, usize)> {
        let counts = [
            ("cycle", self.cycle.as_ref().map(Vec::len)),
            ("direction", self.direction.as_ref().map(Vec::len)),
            ("sweep", self.sweep.as_ref().map(|labels| labels.rows.len())),
            ("specimen", self.specimen.as_ref().map(|labels| labels.rows.len())),
        ];
        counts.into_iter().filter_map(|(name, count)| Some((name, count?)))
    }

    /// Appends the rows of another file. `names` are the names of the two files, for the message.
    pub(crate) fn append(&mut self, other: &Self, names: [&str; 2]) -> Result<(), MeasurementError> {
        fn both<T: Clone>(
            name: &'static str,
            own: &mut Option<Vec<T>>,
            other: Option<&Vec<T>>,
            [first, second]: [&str; 2],
        ) -> Result<(), MeasurementError> {
            match (own, other) {
                (Some(own), Some(other)) => own.extend_from_slice(other),
                (None, None) => {}
                (Some(_), None) => return Err(differ(name, first, second)),
                (None, Some(_)) => return Err(differ(name, second, first)),
            }
            Ok(())
        }
        match (&self.motion, &other.motion) {
            (Trace::Length(_), Trace::Contraction(_)) => return Err(differ("length", names[0], names[1])),
            (Trace::Contraction(_), Trace::Length(_)) => {
                return Err(differ("contraction", names[0], names[1]));
            }
            _ => {}
        }
        both("time", &mut self.time_s, other.time_s.as_ref(), names)?;
        both("temperature", &mut self.temperature_k, other.temperature_k.as_ref(), names)?;
        both("diameter", &mut self.diameter_m, other.diameter_m.as_ref(), names)?;
        both("volume", &mut self.volume_m3, other.volume_m3.as_ref(), names)?;
        both("force_sd", &mut self.force_sd_n, other.force_sd_n.as_ref(), names)?;
        both("cycle", &mut self.cycle, other.cycle.as_ref(), names)?;
        both("direction", &mut self.direction, other.direction.as_ref(), names)?;
        match (&mut self.sweep, &other.sweep) {
            (Some(own), Some(other)) => own.append(other),
            (None, None) => {}
            (own, _) => {
                let [with, without] = if own.is_some() { names } else { [names[1], names[0]] };
                return Err(differ("sweep", with, without));
            }
        }
        // A file without specimens belongs to specimen "1".
        if self.specimen.is_some() || other.specimen.is_some() {
            let ones = |rows| std::iter::repeat_n("1", rows).collect::<Labels>();
            let rows = self.len();
            let own = self.specimen.get_or_insert_with(|| ones(rows));
            own.append(other.specimen.as_ref().unwrap_or(&ones(other.len())));
        }
        self.pressure_pa.extend_from_slice(&other.pressure_pa);
        self.motion.values_mut().extend_from_slice(other.motion.values());
        self.force_n.extend_from_slice(&other.force_n);
        Ok(())
    }

    /// Keeps these rows, in this order.
    pub(crate) fn filter(&mut self, keep: &[usize]) {
        fn given<T: Copy>(values: &mut Option<Vec<T>>, keep: &[usize]) {
            if let Some(values) = values {
                *values = picked(values, keep);
            }
        }
        self.pressure_pa = picked(&self.pressure_pa, keep);
        self.force_n = picked(&self.force_n, keep);
        let motion = self.motion.values_mut();
        *motion = picked(motion, keep);
        given(&mut self.time_s, keep);
        given(&mut self.temperature_k, keep);
        given(&mut self.diameter_m, keep);
        given(&mut self.volume_m3, keep);
        given(&mut self.force_sd_n, keep);
        given(&mut self.cycle, keep);
        given(&mut self.direction, keep);
        for labels in [&mut self.sweep, &mut self.specimen].into_iter().flatten() {
            labels.filter(keep);
        }
    }
}

fn differ(name: &'static str, with: &str, without: &str) -> MeasurementError {
    MeasurementError::Request(format!(
        "{without} has no column `{name}`, {with} has: files of one analysis need the same columns; add it there, leave it out here, or analyse them separately"
    ))
}

/// The values of some rows.
pub(crate) fn picked<T: Copy>(values: &[T], rows: &[usize]) -> Vec<T> {
    rows.iter().filter_map(|row| values.get(*row).copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(rows: usize) -> Columns {
        Columns::new(vec![1e5; rows], Trace::Contraction(vec![0.1; rows]), vec![100.0; rows])
    }

    #[test]
    fn labels_are_stored_once() {
        let labels: Labels = ["a", "a", "b", "a"].into_iter().collect();
        assert_eq!(labels.names(), ["a", "b"]);
        assert_eq!(labels.rows(), [0, 0, 1, 0]);
    }

    #[test]
    fn files_need_the_same_columns() {
        let mut first = columns(2);
        let mut second = columns(1);
        second.time_s = Some(vec![0.0]);
        let error = first.append(&second, ["a.csv", "b.csv"]).unwrap_err().to_string();
        assert!(error.contains("a.csv has no column `time`, b.csv has"), "{error}");
        let lengths = Columns::new(vec![1e5], Trace::Length(vec![0.1]), vec![1.0]);
        let error = first.append(&lengths, ["a.csv", "b.csv"]).unwrap_err().to_string();
        assert!(error.contains("b.csv has no column `contraction`"), "{error}");
        second.time_s = None;
        second.sweep = Some(Labels::from_iter(["x"]));
        let error = first.append(&second, ["a.csv", "b.csv"]).unwrap_err().to_string();
        assert!(error.contains("a.csv has no column `sweep`, b.csv has"), "{error}");
    }

    #[test]
    fn a_file_without_specimens_is_about_the_first() {
        let mut first = columns(2);
        let mut second = columns(1);
        second.specimen = Some(Labels::from_iter(["left"]));
        assert_eq!(first.append(&second, ["a.csv", "b.csv"]), Ok(()));
        let specimen = first.specimen.unwrap();
        assert_eq!(
            (specimen.names(), specimen.rows()),
            (&["1".to_owned(), "left".to_owned()][..], &[0, 0, 1][..])
        );
        assert_eq!(first.force_n.len(), 3);
    }

    #[test]
    fn rows_are_picked() {
        let mut found = columns(3);
        found.force_n = vec![1.0, 2.0, 3.0];
        found.cycle = Some(vec![1, 2, 3]);
        found.sweep = Some(Labels::from_iter(["a", "b", "c"]));
        found.filter(&[0, 2]);
        assert_eq!((found.force_n, found.cycle), (vec![1.0, 3.0], Some(vec![1, 3])));
        assert_eq!(found.sweep.unwrap().rows(), [0, 2]);
    }
}

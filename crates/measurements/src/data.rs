//! The data set: checked columns, files, specimens and sweeps.

use crate::columns::{Channel, Columns, Trace, picked};
use crate::error::MeasurementError;
use crate::reading::{ReadOptions, Reading, SetApart};
use crate::recorded::Order;
use crate::resolution::{Resolution, bounds};
use crate::source::{Source, SourceFile};
use crate::stretch::{self, DeadBand, Stretch};
use crate::structure::Structure;
use crate::sweep::{self, Contradiction, Sweep, SweepKind};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

/// A set of measurements: at least pressure, motion and force of each row, all finite, in SI.
///
/// Rows with a time or a sweep label form a path: they follow each other, and [`Data::history`] describes the
/// motion. So do those of a file that go to and fro in small steps without either; others are a static map. Sweeps are the runs with one label. Without labels a new sweep
/// begins with another file or specimen, where the time goes back or pauses for more than 20 times the median
/// time between rows, and where the pressure steps from one isobaric run to another. Isobaric runs are
/// stretches of constant pressure (within 8 % of the largest) over which the muscle is driven and its force
/// changes; pressure steps at held length or under a weight begin none. A label whose rows contradict it in
/// one of these ways, pauses excepted, is split, and [`Data::quality`] reports it.
///
/// ```
/// use bulge_measurements::{Data, SweepKind};
/// let text = "\
/// pressure [bar], length [mm], force [N], time [s]
/// 2, 300, 900, 0.0
/// 2, 290, 700, 0.1
/// 2, 280, 520, 0.2
/// ";
/// let data = Data::from_csv(text, "pull.csv")?;
/// assert_eq!((data.pressure()[0], data.sweeps()[0].kind), (2e5, SweepKind::Shortening));
/// assert_eq!(data.contraction(0.3)[0], 0.0);
/// let rate = data.history(0.3).rate[1];
/// assert!((rate - 1.0 / 3.0).abs() < 1e-9);
/// # Ok::<(), bulge_measurements::MeasurementError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Data {
    columns: Arc<Columns>,
    files: Vec<SourceFile>,
    /// Unpressurised length \[m\] from which the displacements of each file count, if it has displacements.
    pub(crate) displaced_from_m: Vec<Option<f64>>,
    lines: Vec<u32>,
    specimens: Vec<String>,
    /// Unpressurised length of each specimen \[m\] if it differs from the muscle's; empty if none differs.
    lengths: Vec<Option<f64>>,
    sweeps: Vec<Sweep>,
    /// Rows of pressure steps between isobaric runs, in ascending order.
    between: Vec<usize>,
    /// Rows at which a stated sweep contradicts itself.
    pub(crate) contradictions: Vec<(usize, Contradiction)>,
    reading: Reading,
    order: Order,
    pub(crate) structure: Structure,
}

impl Data {
    /// Reads text, Excel, MATLAB or Parquet files, recognised by their first bytes; `-` is standard input.
    /// Several files form one analysis; they need the same columns, and their sweeps are distinct. Without a
    /// column `specimen` there is one specimen, "1".
    ///
    /// # Errors
    /// If a file can't be read or isn't a table of measurements. The message gives file, line, column and
    /// remedy of every defect.
    pub fn read(paths: &[impl AsRef<Path>]) -> Result<Self, MeasurementError> {
        Self::read_with(paths, &ReadOptions::default())
    }

    /// Reads files with options, such as the assignment of columns or the muscle's length.
    ///
    /// # Errors
    /// As [`Data::read`].
    pub fn read_with(paths: &[impl AsRef<Path>], options: &ReadOptions) -> Result<Self, MeasurementError> {
        let named = |path: &dyn AsRef<Path>| (Source::name_of(path.as_ref()), path.as_ref().to_path_buf());
        let files: Vec<_> = paths.iter().map(|path| named(path)).collect();
        Self::read_named(&files, options)
    }

    /// Reads files whose displayed names differ from their paths.
    ///
    /// # Errors
    /// As [`Data::read`]; messages use the displayed names.
    pub fn read_named(files: &[(String, PathBuf)], options: &ReadOptions) -> Result<Self, MeasurementError> {
        let mut all: Option<Self> = None;
        let mut complaints = Vec::new();
        for (name, path) in files {
            match (Source::read(name, path, options), &mut all) {
                (Ok(source), None) => all = Some(Self::start(source)),
                (Ok(source), Some(all)) => complaints.extend(all.add(source).err()),
                (Err(complaint), _) => complaints.push(complaint),
            }
        }
        if !complaints.is_empty() {
            return Err(MeasurementError::of(complaints));
        }
        all.map(|all| all.in_order().structured()).ok_or_else(|| {
            let what = "no data file is given: name at least one file of CSV, Excel, MATLAB or Parquet, or `-` for standard input";
            MeasurementError::Request(what.to_owned())
        })
    }

    /// Reads CSV; `origin` is its name in messages.
    ///
    /// # Errors
    /// If it isn't a table of measurements.
    pub fn from_csv(text: &str, origin: &str) -> Result<Self, MeasurementError> {
        Self::from_bytes(text.as_bytes(), origin, &ReadOptions::default())
    }

    /// Reads the bytes of a file of any kind but Parquet; `origin` is its name in messages.
    ///
    /// # Errors
    /// If they are not a table of measurements.
    pub fn from_bytes(bytes: &[u8], origin: &str, options: &ReadOptions) -> Result<Self, MeasurementError> {
        Ok(Self::start(Source::bytes(origin, bytes, options)?).in_order().structured())
    }

    /// Takes the columns of a program.
    ///
    /// # Errors
    /// If there are no rows, the columns differ in length, or a value isn't finite.
    pub fn from_columns(columns: Columns) -> Result<Self, MeasurementError> {
        Ok(Self::start(Source::columns(columns)?).structured())
    }

    /// Starts with one file; specimens and sweeps are found in `structured`.
    fn start(source: Source) -> Self {
        Self {
            columns: Arc::new(source.table.columns),
            files: vec![source.file],
            displaced_from_m: vec![source.table.displaced_from_m],
            lines: source.table.lines,
            reading: source.table.reading,
            specimens: Vec::new(),
            lengths: Vec::new(),
            sweeps: Vec::new(),
            between: Vec::new(),
            contradictions: Vec::new(),
            order: Order::Stated,
            structure: Structure::default(),
        }
    }

    fn add(&mut self, source: Source) -> Result<(), MeasurementError> {
        let name = &source.file.name;
        if let Some(same) = self.files.iter().find(|file| file.sha256 == source.file.sha256) {
            let what = format!("{} and {name} have the same content: name each file once", same.name);
            return Err(MeasurementError::Request(what));
        }
        let first = self.files[0].name.clone();
        Arc::make_mut(&mut self.columns).append(&source.table.columns, [&first, name])?;
        self.lines.extend(source.table.lines);
        self.reading.append(source.table.reading);
        self.files.push(source.file);
        self.displaced_from_m.push(source.table.displaced_from_m);
        Ok(())
    }

    /// Finds out whether the rows of files follow each other.
    fn in_order(mut self) -> Self {
        let rows: Vec<usize> = self.files.iter().map(|file| file.rows).collect();
        let order = Order::of(&self.columns, &rows);
        self.reading.notes.extend(order.says().map(str::to_owned));
        self.order = order;
        if order == Order::Lost {
            let columns = Arc::make_mut(&mut self.columns);
            (columns.time_s, columns.sweep) = (None, None);
        }
        self
    }

    fn structured(mut self) -> Self {
        self.specimens = match &self.columns.specimen {
            Some(labels) => labels.names().to_vec(),
            None => vec!["1".to_owned()],
        };
        let mut start = 0;
        let files: Vec<_> = self
            .files
            .iter()
            .map(|file| {
                let rows = start..start + file.rows;
                start = rows.end;
                let stem = Path::new(&file.name).file_stem().unwrap_or_default().to_string_lossy();
                (rows, if self.files.len() == 1 { String::new() } else { format!("{stem}/") })
            })
            .collect();
        let found = sweep::find(&self.columns, &files, self.is_path());
        (self.sweeps, self.between, self.contradictions) =
            (found.sweeps, found.between, found.contradictions);
        self.finished()
    }

    /// Finds the stretches and the kinds of the sweeps.
    fn finished(mut self) -> Self {
        let rows: Vec<Range<usize>> = self.sweeps.iter().map(|sweep| sweep.rows.clone()).collect();
        let resolution = Resolution::of(self.columns.motion.values(), &rows);
        let scale = match &self.columns.motion {
            Trace::Contraction(_) => 1.0,
            Trace::Length(lengths) => bounds(lengths).1,
        };
        let longest = rows.iter().map(Range::len).max().unwrap_or(0);
        let band = DeadBand::new(&resolution, longest, scale);
        let pressure = &self.columns.pressure_pa;
        let largest = pressure.iter().fold(0.0_f64, |m, p| m.max(p.abs()));
        let pressure_band = DeadBand::new(&Resolution::of(pressure, &rows), longest, largest);
        let (mut stretches, mut pressure_stretches) = (Vec::new(), Vec::new());
        if self.is_path() {
            let shortening = self.shortening();
            let time = self.columns.time_s.as_deref();
            for sweep in &mut self.sweeps {
                let found = stretch::find(&shortening, time, &sweep.rows, band);
                let filling = if sweep::is_held(&self.columns.pressure_pa[sweep.rows.clone()], largest) {
                    Vec::new()
                } else {
                    stretch::find(&self.columns.pressure_pa, time, &sweep.rows, pressure_band)
                };
                let path = sweep::Path {
                    motion: &shortening[sweep.rows.clone()],
                    force: &self.columns.force_n[sweep.rows.clone()],
                    stretches: &found,
                    pressure_stretches: &filling,
                };
                sweep.kind = sweep::kind(&path, scale);
                pressure_stretches.push(filling);
                // At held length, the compliance of the rig and the scatter of the readings are no motion.
                let rest = || vec![Stretch { rows: sweep.rows.clone(), direction: 0 }];
                stretches.push(if sweep.kind == SweepKind::Isometric { rest() } else { found });
            }
        }
        let disturbed = OnceLock::new();
        self.structure =
            Structure { stretches, pressure_stretches, pressure_band, resolution, band, scale, disturbed };
        self
    }

    /// Whether rows follow each other: they have a time or a sweep label, or are those of a file that go to and fro in small
    /// steps.
    #[must_use]
    pub fn is_path(&self) -> bool {
        self.columns.time_s.is_some() || self.columns.sweep.is_some() || self.order == Order::Recorded
    }

    /// Whether the rows of a file were sorted, so that nothing says in which order they were measured.
    #[must_use]
    pub fn is_out_of_order(&self) -> bool {
        self.order == Order::Lost
    }

    /// A quantity that grows when the muscle shortens: the contraction, or the negative length \[m\].
    pub(crate) fn shortening(&self) -> Vec<f64> {
        match &self.columns.motion {
            Trace::Contraction(values) => values.clone(),
            Trace::Length(values) => values.iter().map(|length| -length).collect(),
        }
    }

    /// The data with unpressurised lengths for some specimens \[m\]. A length `l0` in other methods is then
    /// that of the remaining specimens. Displacements count from the length of their own specimen.
    ///
    /// ```
    /// use bulge_measurements::Data;
    /// let text = "pressure [bar], length [mm], force [N], specimen\n2, 60, 900, short\n2, 250, 900, long\n";
    /// let data = Data::from_csv(text, "pull.csv")?.with_lengths(|name| (name == "short").then_some(0.06));
    /// assert_eq!(data.contraction(0.25), [0.0, 0.0]);
    /// # Ok::<(), bulge_measurements::MeasurementError>(())
    /// ```
    #[must_use]
    pub fn with_lengths(mut self, of: impl Fn(&str) -> Option<f64>) -> Self {
        let lengths: Vec<Option<f64>> = self.specimens.iter().map(|name| of(name)).collect();
        let shift = |row: usize| {
            let zero = (*self.displaced_from_m.get(self.line(row).0)?)?;
            let own = lengths.get(self.specimen_of(row) as usize).copied().flatten().unwrap_or(zero);
            Some(own - self.length_of(self.specimen_of(row), zero)).filter(|shift| *shift != 0.0)
        };
        let shifts: Vec<(usize, f64)> = (0..self.len()).filter_map(|row| Some((row, shift(row)?))).collect();
        if !shifts.is_empty()
            && let Trace::Length(values) = &mut Arc::make_mut(&mut self.columns).motion
        {
            for (row, shift) in shifts {
                values[row] += shift;
            }
        }
        (self.lengths, self.structure.disturbed) = (lengths, OnceLock::new());
        self
    }

    /// Unpressurised length of a specimen \[m\], by its index in [`Data::specimens`]; `l0` if it has none of
    /// its own.
    #[must_use]
    pub fn length_of(&self, specimen: u32, l0: f64) -> f64 {
        self.lengths.get(specimen as usize).copied().flatten().unwrap_or(l0)
    }

    /// The contraction of a row if its muscle was another specimen; what was read stays.
    #[must_use]
    pub fn contraction_as(&self, specimen: u32, row: usize, contraction: f64, l0: f64) -> f64 {
        let ratio = self.length_of(self.specimen_of(row), l0) / self.length_of(specimen, l0);
        match &self.columns.motion {
            Trace::Contraction(_) => contraction,
            Trace::Length(_) if self.is_displaced(row) => contraction * ratio,
            Trace::Length(_) => 1.0 - (1.0 - contraction) * ratio,
        }
    }

    /// Contraction per unit of shortening, for a specimen of a muscle of length `l0`.
    pub(crate) fn contraction_per_shortening(&self, specimen: u32, l0: f64) -> f64 {
        match &self.columns.motion {
            Trace::Contraction(_) => 1.0,
            Trace::Length(_) => 1.0 / self.length_of(specimen, l0),
        }
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Whether no row is left, which is only possible after [`Data::subset`].
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Gauge pressure of each row \[Pa\].
    #[must_use]
    pub fn pressure(&self) -> &[f64] {
        &self.columns.pressure_pa
    }

    /// Contraction or length of each row, whichever was measured.
    #[must_use]
    pub fn motion(&self) -> &Trace {
        &self.columns.motion
    }

    /// Contraction of each row, 1 - l/l0 if the length was measured. `l0` is the unpressurised length \[m\],
    /// > 0.
    #[must_use]
    pub fn contraction(&self, l0: f64) -> Vec<f64> {
        match &self.columns.motion {
            Trace::Contraction(values) => values.clone(),
            Trace::Length(values) => {
                let contraction =
                    |(row, length): (usize, &f64)| 1.0 - length / self.length_of(self.specimen_of(row), l0);
                values.iter().enumerate().map(contraction).collect()
            }
        }
    }

    /// Force of each row \[N\].
    #[must_use]
    pub fn force(&self) -> &[f64] {
        &self.columns.force_n
    }

    /// Whether every file has a force column. Without it forces are 0, see [`ReadOptions::force_may_lack`].
    #[must_use]
    pub fn has_force(&self) -> bool {
        let uses = &self.reading.columns;
        let has = |file: &SourceFile| {
            let mut own = uses.iter().filter(|used| used.file == file.name).peekable();
            // The columns of a program have no headings.
            own.peek().is_none() || own.any(|used| used.quantity.as_deref() == Some("force"))
        };
        self.files.iter().all(has)
    }

    /// Time of each row \[s\].
    #[must_use]
    pub fn time(&self) -> Option<&[f64]> {
        self.columns.time_s.as_deref()
    }

    /// Temperature of each row \[K\].
    #[must_use]
    pub fn temperature(&self) -> Option<&[f64]> {
        self.columns.temperature_k.as_deref()
    }

    /// Standard deviation of the force of each row \[N\].
    #[must_use]
    pub fn force_sd(&self) -> Option<&[f64]> {
        self.columns.force_sd_n.as_deref()
    }

    /// Index of a row's specimen in [`Data::specimens`].
    #[must_use]
    pub fn specimen_of(&self, row: usize) -> u32 {
        self.columns.specimen.as_ref().and_then(|labels| labels.rows().get(row)).map_or(0, |place| *place)
    }

    /// Names of the specimens in the order of their first appearance.
    #[must_use]
    pub fn specimens(&self) -> &[String] {
        &self.specimens
    }

    /// The sweeps in order; they cover all rows without gaps.
    #[must_use]
    pub fn sweeps(&self) -> &[Sweep] {
        &self.sweeps
    }

    /// Rows of pressure steps between isobaric runs of a recording, in ascending order. They belong to the
    /// next run or form a run of their own, and lie on no isobar.
    #[must_use]
    pub fn between_isobars(&self) -> &[usize] {
        &self.between
    }

    /// Index of the file of a row, and its line there (CSV) or its number (Parquet), counted from 1; line 0
    /// if there is no such row.
    #[must_use]
    pub fn line(&self, row: usize) -> (usize, usize) {
        let mut end = 0;
        let file = self.files.iter().position(|file| {
            end += file.rows;
            row < end
        });
        (file.unwrap_or(0), self.lines.get(row).map_or(0, |line| *line as usize))
    }

    /// The files.
    #[must_use]
    pub fn files(&self) -> &[SourceFile] {
        &self.files
    }

    /// How the files were read: what their columns were taken for, and which rows were set apart.
    #[must_use]
    pub fn reading(&self) -> &Reading {
        &self.reading
    }

    /// Unusable rows, which aren't part of the data, with their reasons: the first [`Reading::MOST_LISTED`].
    #[must_use]
    pub fn set_apart(&self) -> &[SetApart] {
        &self.reading.set_apart
    }

    /// The rows with `keep` as a data set of its own; rows beyond the end of `keep` are dropped.
    ///
    /// A sweep that loses some of its rows stays one sweep. Files and specimens keep their indices. The
    /// motion is determined again from the remaining rows; [`crate::History::subset`] keeps that of all rows.
    #[must_use]
    pub fn subset(&self, keep: &[bool]) -> Self {
        let is_kept = |row: &usize| keep.get(*row).copied().unwrap_or(false);
        let kept: Vec<usize> = (0..self.len()).filter(is_kept).collect();
        let count = |rows: &Range<usize>| {
            kept.partition_point(|row| *row < rows.start)..kept.partition_point(|row| *row < rows.end)
        };
        let mut found = self.clone();
        Arc::make_mut(&mut found.columns).filter(&kept);
        found.lines = picked(&self.lines, &kept);
        let mut start = 0;
        for file in &mut found.files {
            let rows = start..start + file.rows;
            start = rows.end;
            file.rows = count(&rows).len();
        }
        found.sweeps.iter_mut().for_each(|sweep| sweep.rows = count(&sweep.rows));
        let place = |row: &usize| kept.binary_search(row).ok();
        found.between = self.between.iter().filter_map(place).collect();
        let placed = self.contradictions.iter().filter_map(|(row, what)| Some((place(row)?, *what)));
        found.contradictions = placed.collect();
        found.sweeps.retain(|sweep| !sweep.rows.is_empty());
        found.finished()
    }

    /// The data with the readings of one column moved to rows before theirs, within each sweep; to rows after
    /// theirs if `rows` is negative. Rows at the end of a sweep for which there are none keep their own.
    #[must_use]
    pub fn moved(mut self, channel: Channel, rows: isize) -> Self {
        let values = Arc::make_mut(&mut self.columns).values_mut(channel);
        for sweep in &self.sweeps {
            let own = &mut values[sweep.rows.clone()];
            let by = rows.unsigned_abs().min(own.len());
            let (from, to) = if rows > 0 { (by..own.len(), 0) } else { (0..own.len() - by, by) };
            own.copy_within(from, to);
        }
        self.finished()
    }

    /// All columns, shared, because copies are large.
    #[must_use]
    pub fn columns(&self) -> &Arc<Columns> {
        &self.columns
    }

    /// The sweep of a row.
    pub(crate) fn sweep_of(&self, row: usize) -> usize {
        self.sweeps.partition_point(|sweep| sweep.rows.end <= row)
    }
}

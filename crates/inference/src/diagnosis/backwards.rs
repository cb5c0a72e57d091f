//! A channel whose readings of a sweep stand in the reverse order: a column that was turned over when files were put together.

use bulge_measurements::{Channel, Data};

use crate::comparison::rows::lines;
use crate::diagnosis::channel::{PutRight, name, readings};
use crate::diagnosis::trimmed::Linearised;
use crate::diagnosis::write::Findings;
use crate::diagnosis::wrong_channel::WrongChannel;
use crate::vector::{count, rms};

/// Fewest rows of a sweep.
const FEWEST: usize = 5;
/// RMS misfit over that as read, and over what was named leaves. No number is fitted.
const FALLS: f64 = 0.7;
const BETTER: f64 = 0.8;
/// The same over the least of all channels, up to which they are alike: at a held pressure force and length are.
const ALIKE: f64 = 1.05;

/// The channel that leaves least if some of its sweeps are turned over.
pub(crate) fn backwards(
    found: &Findings<'_>,
    linear: &Linearised,
    data: &Data,
    groups: &[Vec<usize>],
) -> Option<WrongChannel> {
    let record = found.context.record;
    let sweeps: Vec<_> = record.sweeps().iter().filter(|sweep| sweep.len() >= FEWEST).cloned().collect();
    let tried = Channel::ALL.into_iter().filter_map(|channel| {
        let mut others = readings(record, channel);
        for sweep in &sweeps {
            others[sweep.clone()].reverse();
        }
        let found = PutRight::of(found, linear, (channel, &others), &sweeps)?;
        // Turned over in all sweeps as well as in none, a column says nothing of the others.
        let some = 1..=record.len() / 2;
        some.contains(&count(&found.wrong)).then(|| (channel, rms(&found.left), found.wrong))
    });
    let mut tried: Vec<(Channel, f64, Vec<bool>)> = tried.collect();
    tried.sort_by(|a, b| a.1.total_cmp(&b.1));
    let (_, left_n, wrong) = tried.first()?;
    let alike = tried.iter().filter(|(_, left, rows)| *left < ALIKE * left_n && rows == wrong);
    let own = groups.iter().zip(wrong).filter(|(_, wrong)| **wrong);
    let rows: Vec<usize> = own.flat_map(|(group, _)| group.iter().copied()).collect();
    let says = format!(
        "nothing is left if the readings of the {} stand in the reverse order in line {}: was that column turned over or sorted there, or the sweep driven the \
         other way? See the file of the rig, and ask again",
        alike.map(|(channel, ..)| name(*channel)).collect::<Vec<_>>().join(" or of the "),
        lines(data, &rows),
    );
    Some(WrongChannel { left_n: *left_n, of_misfit: FALLS, of_named: BETTER, is_curve: false, says })
}

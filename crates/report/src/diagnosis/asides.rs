//! First lines beside a verdict: effects that could be the answer but could not be tested, and the geometry
//! on which the verdict depends.

use bulge_inference::Diagnosis;

/// Most effects named for one reason.
const MOST_NAMES: usize = 6;

/// Lines that begin with `not looked for: ` or `geometry: `.
///
/// ```text
/// not looked for: temperature (needs a column `temperature` that changes)
/// geometry: radius 16.00 mm +- 0.48 by default (state `+- ...`, `+- 0` if exact): the data want radius 17.11 mm, 2.3 widths off
/// ```
pub(super) fn asides(diagnosis: &Diagnosis) -> Vec<String> {
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for effect in &diagnosis.not_looked_for {
        match reasons.iter_mut().find(|(why, _)| *why == effect.why) {
            Some((_, names)) => names.push(&effect.effect),
            None => reasons.push((&effect.why, vec![&effect.effect])),
        }
    }
    let listed = |(why, names): (&str, Vec<&str>)| {
        let more = names.len().checked_sub(MOST_NAMES).filter(|more| *more > 0);
        let more = more.map_or_else(String::new, |more| format!(" and {more} more"));
        format!("{}{more} ({why})", names[..names.len().min(MOST_NAMES)].join(", "))
    };
    let reasons: Vec<String> = reasons.into_iter().map(listed).collect();
    let untested = (!reasons.is_empty()).then(|| format!("not looked for: {}", reasons.join("; ")));
    let says = &diagnosis.geometry.says;
    let geometry = (!says.is_empty()).then(|| format!("geometry: {says}"));
    untested.into_iter().chain(geometry).collect()
}

//! The verdict in plain words.

use bulge_inference::{Diagnosis, Missing, Verdict};

use crate::diagnosis::words::chance;

/// The verdict, one line for each thing that it says; each begins with `missing: `, `adequate: `, `unknown: `, `cannot tell: ` or `nearest: `.
///
/// ```text
/// missing: bladder-elasticity (on data like these such a claim is right 97 % of the time)
/// ```
/// Effects that were tried on the way to another verdict are `nearest: `: nothing is claimed of them.
#[must_use]
pub fn headlines(diagnosis: &Diagnosis) -> Vec<String> {
    let claim = |missing: &Missing| {
        let right = chance(missing.confidence);
        format!("missing: {} (on data like these such a claim is right {right} of the time)", missing.effect)
    };
    let nearest = |why: &str| -> Vec<String> {
        diagnosis.missing.iter().map(|missing| format!("nearest: {} ({why})", missing.effect)).collect()
    };
    let (first, rest) = match diagnosis.verdict {
        Verdict::Missing => {
            let mut lines: Vec<String> = diagnosis.missing.iter().map(claim).collect();
            if diagnosis.remaining.structured {
                let left = "unknown: what is left then has a structure that no other effect of the catalogue explains";
                lines.push(left.to_owned());
            }
            return lines;
        }
        Verdict::Adequate => {
            ("adequate: the model explains these data within noise and tolerance", nearest("not needed"))
        }
        Verdict::Unknown => (
            "unknown: these data hold a structure that no effect of the catalogue explains",
            nearest("it lowers the error and leaves the structure"),
        ),
        Verdict::CannotTell => (
            "cannot tell: these data are too few or too noisy for a verdict",
            nearest("a ranking, not a claim"),
        ),
    };
    std::iter::once(first.to_owned()).chain(rest).collect()
}

/// Effects that the data can't tell from a missing one, without itself.
pub fn others_in_class(missing: &Missing) -> impl Iterator<Item = &str> {
    missing.class.iter().map(String::as_str).filter(|name| *name != missing.effect)
}

//! The verdict in plain words.

use bulge_inference::{Diagnosis, Level, MOST_EFFECTS, Missing, Remaining, Verdict};

use crate::comparison::number::{newton, three};
use crate::diagnosis::asides::asides;
use crate::diagnosis::words::chance;

/// Two sentences that share this number of first words are considered the same.
const ALIKE: usize = 4;
/// Smallest difference in confidence between mechanism and effect for both to be given.
const SURER: f64 = 0.05;
/// Beginning of a verdict that names effects.
const MISSING: &str = "missing: ";
/// Added to a claim that another geometry would change.
const IF_STATED: &str = ", if the geometry is as stated, which these data doubt";
/// Possible beginning of a diagnosis without a verdict.
const CANNOT_TELL: &str = "these data can't tell: ";
/// Wording of verdicts for which the diagnosis has no sentence of its own.
const ADEQUATE: &str = "the model explains these data within noise and tolerance";
const UNKNOWN: &str = "these data hold a structure that no effect of the catalogue explains";
const NO_VERDICT: &str = "these data allow no verdict";
const ASKED: &str = "these readings are asked about before anything is looked for in them";
const EVENT: &str = "something happened during the test, and no effect is named across it";

/// The verdict, one line per statement. Each line begins with `missing: `, `remains: `, `adequate: `,
/// `unknown: `, `cannot tell: `, `nearest: `, `not looked for: ` or `geometry: `.
///
/// ```text
/// missing: bladder-elasticity (rubber; on data like these such a claim is right 97 % of the time)
/// ```
/// If the data decide only the mechanism or the class, the claim says so: `missing: dry friction, likeliest
/// force-friction`, `missing: one of fibre-stretch, end-slip`. Missing effects come first, then the statement
/// that something remains. Effects tried on the way to another verdict are `nearest: `: nothing is claimed of
/// them. If the diagnosis has its own sentence with numbers for the verdict, that sentence is the line. Last
/// come effects that could be the answer but were not tested, and the geometry on which all this depends.
#[must_use]
pub fn headlines(diagnosis: &Diagnosis) -> Vec<String> {
    let mut lines = verdict(diagnosis);
    lines.extend(asides(diagnosis));
    lines
}

fn verdict(diagnosis: &Diagnosis) -> Vec<String> {
    let doubtful = diagnosis.geometry.if_doubtful.as_ref();
    let if_stated = if doubtful.is_some_and(|other| other.differs) { IF_STATED } else { "" };
    let claim = |missing: &Missing| {
        let (right, mechanism) = (chance(missing.confidence), missing.mechanism.name());
        let right = if missing.simulated.claims == 0 {
            format!("by the weight of the evidence right {right} of the time, not simulated")
        } else {
            format!("on data like these such a claim is right {right} of the time")
        };
        let surer = missing.confidence_mechanism - missing.confidence;
        let of_mechanism = if surer > SURER {
            format!(", that it is {mechanism} {}", chance(missing.confidence_mechanism))
        } else {
            String::new()
        };
        let of = if missing.level == Level::Class { format!("{}: ", missing.effect) } else { String::new() };
        format!("{MISSING}{} ({of}{mechanism}; {right}{of_mechanism}{if_stated})", missing.claim())
    };
    let nearest = |why: &str| -> Vec<String> {
        diagnosis.nearest.iter().map(|missing| format!("nearest: {} ({why})", missing.effect)).collect()
    };
    let (verdict, says, rest) = match diagnosis.verdict {
        Verdict::Missing => {
            let mut lines: Vec<String> = diagnosis.missing.iter().map(claim).collect();
            lines.extend(diagnosis.nearest.iter().map(|missing| {
                let why = if missing.may_be_form_error {
                    "larger errors of the other formulas would explain as much"
                } else if missing.is_doubtful() {
                    "something is there, and these data don't tell what"
                } else if missing.plausible {
                    "not needed: what is left without it is within the tolerance"
                } else {
                    "its numbers are implausible: it stands in for something else"
                };
                format!("nearest: {} ({why})", missing.effect)
            }));
            if let Some(jump) = &diagnosis.remaining.jump {
                lines.push(format!("remains: {jump}: see what happened there before you accept a name"));
            } else if diagnosis.remaining.structured {
                let may_bend = diagnosis.added().any(|added| added.form_error.is_some());
                let what = if diagnosis.added().count() >= MOST_EFFECTS {
                    format!(
                        "after {MOST_EFFECTS} effects, where the search stops: accept them with `--with` and ask again"
                    )
                } else if may_bend {
                    "beside which no further effect is named while these formulas may be a little wrong: accept them with `--with` and ask again"
                        .to_owned()
                } else {
                    "that no other effect of the catalogue explains".to_owned()
                };
                lines.push(format!("remains: a structure of {} {what}", structure(&diagnosis.remaining)));
            }
            return lines;
        }
        Verdict::Adequate => ("adequate", ADEQUATE, nearest("not needed")),
        Verdict::Unknown => {
            let why = if diagnosis.remaining.structured {
                "it lowers the error and leaves the structure"
            } else {
                "too much is left to errors of the formulas"
            };
            ("unknown", UNKNOWN, nearest(why))
        }
        Verdict::CannotTell => {
            let is_asked = diagnosis.data.findings.iter().any(|finding| finding.decided);
            let why = match &diagnosis.remaining.event {
                Some(_) => EVENT,
                None if is_asked => ASKED,
                None => NO_VERDICT,
            };
            ("cannot tell", why, nearest("a ranking, not a claim"))
        }
    };
    let own = diagnosis.says.trim();
    let says = if opens_alike(own, says) { own } else { says };
    std::iter::once(format!("{verdict}: {says}")).chain(rest).collect()
}

/// Size of a structure; if it can't be distinguished from zero, its upper limit.
fn structure(remaining: &Remaining) -> String {
    if remaining.misfit_n > 0.0 {
        newton(remaining.misfit_n)
    } else {
        format!("at most {}", newton(remaining.misfit_interval_n[1]))
    }
}

/// The sentence of the diagnosis, if it says more than [`headlines`].
#[must_use]
pub fn further(diagnosis: &Diagnosis) -> Option<&str> {
    let says = diagnosis.says.trim();
    let is_said = match diagnosis.verdict {
        Verdict::Missing => says.starts_with(MISSING),
        Verdict::Adequate => opens_alike(says, ADEQUATE),
        Verdict::Unknown => opens_alike(says, UNKNOWN),
        Verdict::CannotTell => false,
    };
    let says = says.strip_prefix(CANNOT_TELL).unwrap_or(says);
    (!is_said && !says.is_empty()).then_some(says)
}

/// Whether two sentences begin with the same words.
fn opens_alike(a: &str, b: &str) -> bool {
    let [a, b] = [a, b].map(|text| text.split_whitespace().take(ALIKE));
    a.eq(b)
}

/// The form in which a missing effect was fitted, and the other forms of the same mechanism that would do;
/// `None` if it is the only one and was fitted under its own name.
#[must_use]
pub fn forms_says(missing: &Missing) -> Option<String> {
    let fitted = (missing.fitted != missing.effect)
        .then(|| format!("fitted as {}, with a transition much shorter than the strokes", missing.fitted));
    let others = (!missing.forms.is_empty())
        .then(|| format!("other forms of it, not told apart here: {}", missing.forms.join(", ")));
    let parts: Vec<String> = fitted.into_iter().chain(others).collect();
    (!parts.is_empty()).then(|| parts.join("; "))
}

/// The size of the form error of a missing effect; `None` if its formula is exact.
#[must_use]
pub fn bending_says(missing: &Missing) -> Option<String> {
    let error = missing.form_error.as_ref()?;
    let Some(at) = error.r#where else {
        return Some("its formula holds as it is".to_owned());
    };
    Some(format!(
        "these data bend its formula by {}: {} RMS, most at {} bar and a contraction of {}, where the formula says {} and its bent form {}",
        chance(error.share),
        newton(error.rms_n),
        three(at.pressure_pa / 1e5),
        three(at.contraction),
        newton(at.formula_n),
        newton(at.formula_n + at.bending_n),
    ))
}

/// The other effects that the data can't distinguish from a missing one.
pub fn others_in_class(missing: &Missing) -> impl Iterator<Item = &str> {
    missing.class.iter().map(String::as_str).filter(|name| *name != missing.effect)
}

//! A diagnosis as text: the verdict first, then its evidence, in about forty lines.

use bulge_inference::{CandidateResult, Diagnosis, LadderStep, Level, Missing, SEPARATION, Verdict};
use bulge_report::diagnosis::{
    bending_says, chance, forms_says, further, headlines, is_significant, noise_says, once_in,
    others_in_class, remains_says, step_name,
};
use std::fmt::Write;

use crate::compare::spans;
use crate::diagnose::paragraph::paragraph;
use crate::diagnose::untested::reasons;
use crate::text::{counted, three, with_interval};
use bulge_report::Call;

/// Most lines of a kind; JSON has all.
const MOST_NUMBERS: usize = 6;
const MOST_PLACES: usize = 4;
const MOST_HINTS: usize = 3;
const MOST_RIVALS: usize = 3;
const MOST_LIMITS: usize = 5;
const MOST_WARNINGS: usize = 6;
const MOST_FINDINGS: usize = 6;
/// Words before the effects that could not be tested.
const UNTESTED: &str = "  could not be looked for ";

/// The diagnosis as text.
pub(super) fn text(diagnosis: &Diagnosis, call: &Call) -> String {
    let mut out = String::new();
    measured(&mut out, diagnosis);
    verdict(&mut out, diagnosis);
    if diagnosis.ladder.is_empty() {
        // Nothing was fitted: the first lines say why, warnings and all.
        return out;
    }
    ladder(&mut out, diagnosis);
    places(&mut out, diagnosis);
    let _ = writeln!(out, "\n  what remains: {}", remains_says(diagnosis));
    for hint in diagnosis.remaining.hints.iter().take(MOST_HINTS) {
        paragraph(&mut out, "    ", hint);
    }
    paragraph(&mut out, "  ", &format!("noise: {}", noise_says(diagnosis)));
    rivals(&mut out, diagnosis);
    limits(&mut out, diagnosis);
    next(&mut out, diagnosis);
    for warning in diagnosis.warnings.iter().take(MOST_WARNINGS) {
        let _ = writeln!(out, "  ! {warning}");
    }
    if let Some(more) = diagnosis.warnings.len().checked_sub(MOST_WARNINGS).filter(|more| *more > 0) {
        let _ = writeln!(out, "  ! {more} more: see --json");
    }
    accept(&mut out, diagnosis, call);
    out
}

fn measured(out: &mut String, diagnosis: &Diagnosis) {
    let data = &diagnosis.comparison.data;
    let _ = writeln!(out, "{} diagnosed on {}\n", diagnosis.muscle, data.files.join(", "));
    let sweeps = if data.is_path {
        format!(" in {}", counted(data.sweeps, "sweep"))
    } else {
        " in a static map".to_owned()
    };
    let _ = writeln!(out, "  {}{sweeps}: {}", counted(data.rows, "row"), spans(data));
    for left in &data.left_out {
        let _ = writeln!(out, "  left out {} (line {}): {}", counted(left.rows, "row"), left.lines, left.why);
    }
    let found = &diagnosis.data.quality;
    for finding in found.iter().take(MOST_FINDINGS) {
        paragraph(out, "  ", &finding.says);
    }
    if let Some(more) = found.len().checked_sub(MOST_FINDINGS).filter(|more| *more > 0) {
        let _ = writeln!(out, "  {more} more findings of the data check: see --json");
    }
}

/// The verdict in plain words, and each effect with its class and numbers.
pub(crate) fn verdict(out: &mut String, diagnosis: &Diagnosis) {
    out.push('\n');
    let mut missing = diagnosis.added();
    for line in headlines(diagnosis) {
        paragraph(out, "  ", &line);
        let is_claim = line.starts_with("missing: ") || line.starts_with("nearest: ");
        if let Some(missing) = is_claim.then(|| missing.next()).flatten() {
            found(out, missing, line.starts_with("missing: "));
        }
    }
    if let Some(says) = further(diagnosis) {
        paragraph(out, "  ", says);
    }
}

fn found(out: &mut String, missing: &Missing, is_claimed: bool) {
    let others: Vec<&str> = others_in_class(missing).collect();
    if !others.is_empty() {
        let right = match missing.simulated.claims {
            claims if claims == 0 || !is_claimed => String::new(),
            _ => format!(" (the class holds the right one {} of the time)", chance(missing.simulated.class)),
        };
        // If only the class is claimed, its names are in the line above.
        let told = if is_claimed && missing.level == Level::Class {
            format!("these data cannot tell which{right}; the numbers below are those of {}", missing.effect)
        } else {
            format!("these data cannot tell it from: {}{right}", others.join(", "))
        };
        paragraph(out, "    ", &told);
    }
    for says in [forms_says(missing), bending_says(missing)].into_iter().flatten() {
        paragraph(out, "    ", &says);
    }
    let width = missing.parameters.keys().map(String::len).max().unwrap_or(0);
    for (name, p) in missing.parameters.iter().take(MOST_NUMBERS) {
        let [value, low, high] = with_interval(p.value, p.low, p.high);
        let unit = if p.unit == "1" { "" } else { &p.unit };
        let _ = writeln!(
            out,
            "    {name:<width$}  {} (95 %: {low} to {high})",
            format!("{value} {unit}").trim_end()
        );
    }
    if let Some(more) = missing.parameters.len().checked_sub(MOST_NUMBERS).filter(|more| *more > 0) {
        let _ = writeln!(out, "    and {more} more numbers: see --json");
    }
    if !missing.plausible {
        let _ = writeln!(out, "    ! IMPLAUSIBLE numbers: a wrong cure, even if the error falls");
    }
}

/// Errors from the base to the last effect, as `bulge compare` prints them, and the errors of effects with
/// form errors.
pub(crate) fn ladder(out: &mut String, diagnosis: &Diagnosis) {
    let name = |step: &LadderStep| step_name(diagnosis, step);
    let width = diagnosis.ladder.iter().map(|step| name(step).len()).max().unwrap_or(0).max(14);
    let percent =
        |error_n: f64| 100.0 * error_n / diagnosis.comparison.data.full_scale_n.max(f64::MIN_POSITIVE);
    let _ = writeln!(
        out,
        "\n    {:<width$}  {:>9}  {:>10}  {:>9}  adequate",
        "model", "error", "full scale", "held out"
    );
    for step in &diagnosis.ladder {
        let sign = if step.added.is_some() { "+" } else { " " };
        let held = step.held_out_rmse_n.map_or_else(|| "-".to_owned(), |v| format!("{} N", three(v)));
        let _ = writeln!(
            out,
            "  {sign} {:<width$}  {:>7} N  {:>8.2} %  {held:>9}  {}",
            name(step),
            three(step.rmse_n),
            percent(step.rmse_n),
            match step.adequate {
                _ if diagnosis.verdict == Verdict::CannotTell => "-",
                true => "yes",
                false => "no",
            }
        );
    }
    let _ = writeln!(
        out,
        "    {:<width$}  {:>7} N  {:>8.2} %  ({})",
        "noise floor",
        three(diagnosis.noise_floor_n),
        percent(diagnosis.noise_floor_n),
        diagnosis.noise.source.name()
    );
    if let Some(directed) = diagnosis.comparison.ladder.last().and_then(|rung| rung.directed_rmse_n) {
        let says = "without the readings whose direction is in doubt, which count less, the last error";
        let is_bent = diagnosis.ladder.iter().any(|step| step.bent);
        let of = if is_bent { " by the formulas" } else { "" };
        paragraph(out, "    ", &format!("{says}{of} is {} N", three(directed)));
    }
}

/// The variables on which the misfit of the base depends significantly.
fn places(out: &mut String, diagnosis: &Diagnosis) {
    let found: Vec<_> = diagnosis.r#where.iter().filter(|located| is_significant(located.p)).collect();
    if found.is_empty() {
        out.push_str("\n  the misfit of the base depends on nothing that stands out of the noise\n");
        return;
    }
    let of = match diagnosis.verdict {
        // In an adequate model the whole misfit is the tolerated one.
        Verdict::Adequate => {
            format!("the {} N (RMS) that are judged small enough", three(diagnosis.remaining.misfit_n))
        }
        _ => "the whole".to_owned(),
    };
    let _ = writeln!(out, "\n  on what the misfit of the base depends, in parts of {of}");
    let width = found.iter().map(|located| located.variable.len()).max().unwrap_or(0);
    for located in found.iter().take(MOST_PLACES) {
        let _ = writeln!(
            out,
            "    {:<width$}  {:>3.0} %  {:<11}  {}",
            located.variable,
            100.0 * located.share,
            once_in(located.p),
            located.says
        );
    }
}

/// The nearest rivals of each effect that was found.
fn rivals(out: &mut String, diagnosis: &Diagnosis) {
    let mut lines = Vec::new();
    for missing in diagnosis.added() {
        let mut nearest: Vec<_> = missing.rivals.iter().collect();
        nearest.sort_by(|a, b| a.separation.total_cmp(&b.separation));
        let class: Vec<&str> = others_in_class(missing).collect();
        let named = nearest.iter().take(MOST_RIVALS).map(|r| {
            // Members of the class can be far off as their formulas stand, and near once these may err.
            let is_near = r.separation <= SEPARATION || !class.contains(&r.effect.as_str());
            let errs = if is_near { "" } else { " (not told apart if its formula may be a little wrong)" };
            format!("{} {}{errs}", r.effect, three(r.separation))
        });
        let named: Vec<String> = named.collect();
        if !named.is_empty() {
            lines.push(format!("    {}: {}", missing.effect, named.join(", ")));
        }
    }
    if !lines.is_empty() {
        let _ = writeln!(
            out,
            "  nearest rivals, by sigmas between them (told apart from {SEPARATION} on)\n{}",
            lines.join("\n")
        );
    }
}

/// Detection limits of some effects for these data.
fn limits(out: &mut String, diagnosis: &Diagnosis) {
    let is_absent = |c: &&CandidateResult| c.status == "rejected" && c.detection_limit.is_some();
    let absent: Vec<&CandidateResult> = diagnosis.candidates.iter().filter(is_absent).collect();
    let named = absent.iter().take(MOST_LIMITS).filter_map(|c| {
        let unit = if c.unit == "1" { "" } else { &c.unit };
        let force = c.detection_limit_n.map_or_else(String::new, |n| format!(" ({} N)", three(n)));
        Some(format!("{} {}{force}", c.effect, format!("{} {unit}", three(c.detection_limit?)).trim_end()))
    });
    let named: Vec<String> = named.collect();
    if !named.is_empty() {
        let all = absent.len();
        let of_all = if all > named.len() { format!("; all {all}: --json") } else { String::new() };
        // These are limits of what is more than the effects named.
        let beside = if diagnosis.missing.is_empty() { "" } else { " beside what is missing" };
        paragraph(
            out,
            "  ",
            &format!("not found{beside}, and would show from: {}{of_all}", named.join(", ")),
        );
    }
    if let Some(unseen) = diagnosis.remaining.unseen_below_n {
        let says = format!(
            "a further effect that changes less than about {} N (RMS) would not be told from an error of the formulas named",
            three(unseen)
        );
        paragraph(out, "  ", &says);
    }
    let failed: Vec<&str> = diagnosis
        .candidates
        .iter()
        .filter(|c| c.status == "not-converged")
        .map(|c| c.effect.as_str())
        .collect();
    if !failed.is_empty() {
        paragraph(
            out,
            "  ",
            &format!("did not converge, so neither found nor rejected: {}", failed.join(", ")),
        );
    }
    // Effects that could be the answer are listed beside the verdict.
    let mut others = untested(diagnosis);
    others.retain(|(name, _)| diagnosis.not_looked_for.iter().all(|effect| effect.effect != *name));
    for line in reasons(&others, UNTESTED.len()) {
        let _ = writeln!(out, "{UNTESTED}{line}");
    }
}

/// Effects that could not be tested, with the reason.
pub(crate) fn untested(diagnosis: &Diagnosis) -> Vec<(&str, Option<&str>)> {
    let untested = diagnosis.candidates.iter().filter(|c| c.status == "not-testable");
    untested.map(|c| (c.effect.as_str(), c.why.as_deref())).collect()
}

fn next(out: &mut String, diagnosis: &Diagnosis) {
    let Some(next) = &diagnosis.next_experiment else { return };
    paragraph(out, "  ", &format!("next experiment: {}", next.says.trim()));
    // Without repeats there is no such experiment, and the sentence says so.
    if !next.separates.is_empty() && next.repeats > 0 {
        let times = if next.repeats == 1 { "once" } else { "times" };
        let repeats = if next.repeats == 1 { times.to_owned() } else { format!("{} {times}", next.repeats) };
        let _ = writeln!(
            out,
            "    it separates {} by {} sigma, done {repeats}",
            next.separates.join(" and "),
            three(next.sigma)
        );
    }
}

/// How to continue with the effects that were found.
fn accept(out: &mut String, diagnosis: &Diagnosis, call: &Call) {
    if diagnosis.missing.is_empty() || diagnosis.verdict != Verdict::Missing {
        return;
    }
    let mut next = call.clone();
    next.with.extend(diagnosis.missing.iter().map(|missing| missing.fitted.clone()));
    let rest = next.arguments();
    let _ = writeln!(
        out,
        "\n  to accept this step:\n    bulge diagnose {rest}\n    bulge fit {rest} --out learnt.toml"
    );
}

#[cfg(test)]
#[path = "../../../report/tests/all/diagnosed/mod.rs"]
mod diagnosed;

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_effects::Catalogue;
    use bulge_inference::{Comparison, NotLookedFor, Options, compare};
    use bulge_measurements::Data;
    use bulge_muscles::from_toml;

    const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/data");

    /// The shipped loops against the textbook cylinder with friction.
    fn comparison() -> Comparison {
        let muscle =
            from_toml(&std::fs::read_to_string(format!("{FOLDER}/braid.toml")).unwrap(), "braid").unwrap();
        let data = Data::read(&[format!("{FOLDER}/braid-loops.csv")]).unwrap();
        let catalogue = Catalogue::builtin();
        let effects = ["bladder-elasticity", "coulomb-friction"]
            .map(|name| std::sync::Arc::clone(catalogue.find(name).unwrap()));
        compare(&data, &muscle, &Options::new(catalogue, effects.to_vec())).unwrap()
    }

    fn call() -> Call {
        Call {
            data: vec!["my loops.csv".to_owned(), "b.csv".to_owned()],
            columns: None,
            exclude: None,
            muscle: "braid.toml".to_owned(),
            with: vec!["end-taper".to_owned()],
            restrictions: Vec::new(),
            effects: Some("own.toml".to_owned()),
        }
    }

    fn lines(diagnosis: &Diagnosis) -> Vec<String> {
        let text = text(diagnosis, &call());
        assert!(text.lines().count() <= 50 && !text.contains("NaN"), "{text}");
        text.lines().map(str::to_owned).collect()
    }

    fn place(lines: &[String], part: &str) -> usize {
        lines
            .iter()
            .position(|line| line.contains(part))
            .unwrap_or_else(|| panic!("no {part:?} in {lines:#?}"))
    }

    #[test]
    fn what_is_missing_comes_first_with_class_and_numbers() {
        let diagnosis = diagnosed::missing(comparison());
        let lines = lines(&diagnosis);
        let order = [
            "20 mm braid, textbook diagnosed on ",
            "  missing: bladder-elasticity (rubber; on data like these such a claim is right 97 % of the time)",
            "    these data cannot tell it from: wall-thickness (the class holds the right one 99 % of the time)",
            "    other forms of it, not told apart here: bladder-c01",
            "    modulus  0.310 MPa (95 %: 0.280 to 0.330)",
            "  missing: coulomb-friction (dry friction; by the weight of the evidence right more than 99 % of the",
            "    fitted as bouc-wen, with a transition much shorter than the strokes",
            "    friction  14 N (95 %: 8 to 20)",
            "    ! IMPLAUSIBLE numbers",
            "  Two things are missing.",
            "    equilibrium",
            "  + bladder-elasticity, by its formula",
            "  + coulomb-friction ",
            "  + bladder-elasticity, as the data want it",
            "    noise floor",
            "    direction   71 %  p < 0.001    flips sign with direction",
            "  what remains: 0.4 N of systematic misfit (RMS; 95 % interval 0.0 to 1.2 N): no structure",
            "    grows with the pressure",
            "  noise: a single reading scatters by 4.10 N, 1.00 N of it correlated over 5.00 s",
            "    bladder-elasticity: wall-thickness 1.20, hoop-elasticity 7.50",
            "  not found beside what is missing, and would show from: creep 0.220 N/decade (0.500 N)",
            "  a further effect that changes less than about 0.320 N (RMS) would not be told",
            "  did not converge, so neither found nor rejected: bouc-wen",
            "  could not be looked for (needs a column `temperature` that changes): temperature",
            "  next experiment: Hold at 3 bar for an hour.",
            "    it separates bladder-elasticity and wall-thickness by 4.90 sigma, done 2 times",
            "  ! one warning",
            "  to accept this step:",
            "    bulge diagnose \"my loops.csv\" b.csv --muscle braid.toml --effects own.toml --with end-taper,bladder-elasticity,bouc-wen",
            "    bulge fit \"my loops.csv\" b.csv --muscle braid.toml --effects own.toml --with end-taper,bladder-elasticity,bouc-wen --out learnt.toml",
        ];
        let places = order.map(|part| place(&lines, part));
        assert!(places.windows(2).all(|pair| pair[0] < pair[1]), "{places:?} in {lines:#?}");
        assert!(places[1] <= 4, "the verdict is in the first lines");
    }

    #[test]
    fn the_ladder_says_which_step_is_adequate() {
        let diagnosis = diagnosed::missing(comparison());
        let lines = lines(&diagnosis);
        let words = |part: &str| -> Vec<String> {
            lines[place(&lines, part)].split_whitespace().map(str::to_owned).collect()
        };
        let base = words("    equilibrium");
        assert_eq!([&base[1], &base[2], &base[5], &base[6], &base[7]], ["31.0", "N", "33.0", "N", "no"]);
        let percent = 100.0 * 31.0 / diagnosis.comparison.data.full_scale_n;
        assert_eq!(base[3], format!("{percent:.2}"));
        assert_eq!(words("  + coulomb-friction").last().unwrap(), "no");
        let bent = words("  + bladder-elasticity, as the data want it");
        assert_eq!([&bent[7], &bent[8], &bent[11], &bent[12]], ["4.20", "N", "-", "yes"]);
        assert_eq!(words("noise floor")[2..4], ["4.10", "N"]);
    }

    #[test]
    fn every_verdict_has_its_words() {
        let comparison = comparison();
        let adequate = lines(&diagnosed::adequate(comparison.clone()));
        place(&adequate, "  adequate: the model explains these data within noise and tolerance");
        place(&adequate, "  the misfit of the base depends on nothing that stands out of the noise");
        // The fractions given are those of a tolerated misfit.
        let mut passed = diagnosed::adequate(comparison.clone());
        passed.r#where = diagnosed::missing(comparison.clone()).r#where;
        passed.remaining.misfit_n = 0.25;
        let says = "depends, in parts of the 0.250 N (RMS) that are judged small enough";
        assert!(place(&lines(&passed), says) > 0);
        let unknown = lines(&diagnosed::unknown(comparison.clone()));
        place(&unknown, "  unknown: these data hold a structure that no effect of the catalogue explains");
        place(&unknown, "  nearest: bladder-elasticity (it lowers the error and leaves the structure)");
        place(&unknown, "it has a structure beyond chance");
        let cannot_tell = lines(&diagnosed::cannot_tell(comparison.clone()));
        place(&cannot_tell, "  cannot tell: these data allow no verdict");
        for lines in [&adequate, &unknown, &cannot_tell] {
            let claims = |part: &str| lines.iter().any(|line| line.contains(part));
            assert!(
                !claims("such a claim") && !claims("to accept") && !claims("holds the right one"),
                "{lines:#?}"
            );
        }
        let mut more = diagnosed::missing(comparison);
        more.remaining.structured = true;
        let lines = lines(&more);
        let remains =
            place(&lines, "  remains: a structure of 0.400 N beside which no further effect is named");
        assert!(
            place(&lines, "  missing: coulomb-friction") < remains && remains < place(&lines, "noise floor")
        );
    }

    #[test]
    fn what_the_answer_depends_on_stands_in_the_first_lines() {
        let mut diagnosis = diagnosed::missing(comparison());
        let why = "needs a column `temperature` that changes".to_owned();
        diagnosis.not_looked_for = vec![NotLookedFor { effect: "temperature".to_owned(), why }];
        "radius 16 mm +- 0.48 by default".clone_into(&mut diagnosis.geometry.says);
        let lines = lines(&diagnosis);
        let order = [
            "  missing: coulomb-friction",
            "  not looked for: temperature (needs a column `temperature` that changes)",
            "  geometry: radius 16 mm +- 0.48 by default",
            "    equilibrium",
        ];
        let places = order.map(|part| place(&lines, part));
        assert!(places.windows(2).all(|pair| pair[0] < pair[1]), "{places:?} in {lines:#?}");
        assert!(lines.iter().all(|line| !line.contains("could not be looked for")), "{lines:#?}");
    }

    #[test]
    fn nothing_is_said_twice() {
        let comparison = comparison();
        let mut missing = diagnosed::missing(comparison.clone());
        missing.says =
            "missing: bladder-elasticity and coulomb-friction; with it the model explains the data"
                .to_owned();
        assert!(lines(&missing).iter().all(|line| !line.contains("with it the model")));
        let mut unknown = diagnosed::unknown(comparison.clone());
        unknown.says =
            "these data hold a structure of 3.1 N (2.0 to 4.2) that no effect of the catalogue explains"
                .to_owned();
        let text = lines(&unknown);
        let verdict = "  unknown: these data hold a structure of 3.1 N (2.0 to 4.2) that no effect of the catalogue explains";
        place(&text, verdict);
        assert_eq!(text.iter().filter(|line| line.contains("these data hold")).count(), 1, "{text:#?}");
        let mut cannot_tell = diagnosed::cannot_tell(comparison);
        cannot_tell.says = "these data can't tell: 7 rows are too few to know their noise".to_owned();
        let text = lines(&cannot_tell);
        assert!(text.contains(&"  7 rows are too few to know their noise".to_owned()), "{text:#?}");
    }

    #[test]
    fn where_no_experiment_separates_none_is_counted() {
        let mut diagnosis = diagnosed::missing(comparison());
        let next = diagnosis.next_experiment.as_mut().unwrap();
        (next.says, next.repeats) = ("no test of force tells them apart".to_owned(), 0);
        let text = lines(&diagnosis);
        place(&text, "  next experiment: no test of force");
        assert!(text.iter().all(|line| !line.contains("it separates")), "{text:#?}");
    }
}

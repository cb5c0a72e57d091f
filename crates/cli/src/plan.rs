//! `bulge plan`: before measuring, what a test would show and which effects it could not distinguish.

use bulge_effects::known;
use bulge_inference::{ConfusedPair, CorrelationTime, Plan, PlannedEffect, Protocol, SEPARATION, plan};
use bulge_measurements::{ColumnMap, Data};
use bulge_model::read_options;
use bulge_muscles::{Muscle, Quantity};
use clap::{ArgGroup, Args};
use std::fmt::Write;
use std::path::{Path, PathBuf};

use crate::arguments::{self, Json};
use crate::data::told;
use crate::diagnose::paragraph::paragraph;
use crate::diagnose::untested::reasons;
use crate::failure::Failure;
use crate::files;
use crate::text::{counted, table, three};
use bulge_report::shell_word;

/// Sigmas at which an effect is detected.
const SEEN: f64 = 3.3;
/// Compensations above this are mentioned.
const MUCH: f64 = 0.5;
/// Most lines of a kind; JSON has all.
const EASIEST: usize = 8;
const HARDEST: usize = 7;
const MOST_NAMES: usize = 12;
const MOST_PAIRS: usize = 5;
const MOST_WARNINGS: usize = 2;
/// Effects with a larger cosine are the same: no practical number of tests distinguishes them.
const SAME: f64 = 1.0 - 1e-9;
/// Words before the effects that a test can't show.
const UNTESTED: &str = "  cannot be seen ";

/// Before measuring: detection limits, and which effects this test could not tell apart.
#[derive(Debug, Args)]
#[command(group(ArgGroup::new("test").required(true).args(["protocol", "like"])))]
pub(crate) struct PlanCommand {
    /// A muscle file or the name of a shipped muscle
    #[arg(long)]
    muscle: String,
    /// What the test bench does: a TOML file as for `bulge simulate` (its help has an example)
    #[arg(long, value_name = "PROTOCOL.toml")]
    protocol: Option<PathBuf>,
    /// Instead of a protocol: measurements; it is about the test that they come from, as far as blocks describe it
    #[arg(long, value_name = "DATA")]
    like: Option<PathBuf>,
    /// Which column of these data is which, where the headings don't say it: "force=Force_N [N], pressure=P1 [psi], length=-Weg"
    #[arg(long, value_name = "QUANTITY=COLUMN,...", requires = "like")]
    columns: Option<String>,
    /// Writes the test as a protocol file, to begin from
    #[arg(long, value_name = "PROTOCOL.toml")]
    out: Option<PathBuf>,
    /// Your own effects, as expressions in a TOML file
    #[arg(long, value_name = "FILE")]
    effects: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

impl PlanCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let catalogue = arguments::catalogue(self.effects.as_deref())?;
        let muscle = arguments::muscle(&self.muscle)?;
        let (protocol, reading) = self.test(&muscle)?;
        let known = known(&muscle, &catalogue)?;
        let found = plan(&muscle, &known, &catalogue, &protocol)?;
        if let Some(path) = &self.out {
            files::write(path, protocol.to_toml().as_bytes())?;
        }
        self.json.or(&found, || reading + &self.text(&found))
    }

    /// The protocol; or the protocol derived from measurements, with the text on how they were read.
    fn test(&self, muscle: &Muscle) -> Result<(Protocol, String), Failure> {
        if let Some(out) = &self.out {
            let read = [
                ("the protocol", self.protocol.as_deref()),
                ("the data file", self.like.as_deref()),
                ("the muscle file", Some(Path::new(&self.muscle))),
                ("the file of --effects", self.effects.as_deref()),
            ];
            let read: Vec<files::Named<'_>> =
                read.into_iter().filter_map(|(what, path)| Some((what, path?))).collect();
            files::are_apart(&[("--out", out)], &read)?;
            files::can_be_written(out)?;
        }
        if let Some(path) = &self.like {
            let columns = self.columns.as_deref().map(str::parse::<ColumnMap>).transpose()?;
            let data = Data::read_with(&[path], &read_options(muscle, columns.as_ref())?)?;
            let like = Protocol::like(&data, muscle.length().si());
            // Written and read again, so that it is the protocol in the file.
            return Ok((
                Protocol::from_toml(&like.to_toml(), "the test of these data")?,
                told(data.reading()),
            ));
        }
        // The parser of the command line ensures that one of the two is given.
        Ok((Protocol::read(self.protocol.as_deref().unwrap_or(Path::new("")))?, String::new()))
    }

    /// The plan as text.
    fn text(&self, plan: &Plan) -> String {
        let mut out = String::new();
        test(&mut out, plan);
        limits(&mut out, plan);
        pairs(&mut out, plan);
        for warning in plan.warnings.iter().take(MOST_WARNINGS) {
            paragraph(&mut out, "  ! ", warning);
        }
        let own = self.effects.as_ref().map_or_else(String::new, |path| {
            format!(" --effects {}", shell_word(&path.display().to_string()))
        });
        let hidden = plan.effects.first().map_or("coulomb-friction", |effect| effect.effect.as_str());
        match self.out.as_ref().or(self.protocol.as_ref()) {
            Some(protocol) => {
                let _ = writeln!(
                    out,
                    "\n  to try it, hide an effect and look for it:\n    bulge simulate {} --protocol {}{own} --with {hidden} --out trial",
                    shell_word(&self.muscle),
                    shell_word(&protocol.display().to_string())
                );
            }
            None => out.push_str("\n  --out protocol.toml writes this test as a file, to begin from\n"),
        }
        out
    }
}

/// What the test is.
fn test(out: &mut String, plan: &Plan) {
    let [low, high] = plan.pressure_pa.map(|p| three(p / 1e5));
    let [short, long] = plan.contraction.map(|e| three(100.0 * e));
    let _ = writeln!(
        out,
        "{}, before measuring\n\n  {} in {}: {low} to {high} bar, contraction {short} to {long} %",
        plan.muscle,
        counted(plan.rows, "row"),
        counted(plan.sweeps, "sweep")
    );
    let noise = &plan.noise;
    let correlated = match noise.time.filter(|_| noise.correlated_n > 0.0) {
        Some(CorrelationTime::Seconds(time)) => {
            format!(", {} N correlated over {} s", three(noise.correlated_n), three(time))
        }
        Some(CorrelationTime::Rows(rows)) => {
            format!(", {} N correlated over {} rows", three(noise.correlated_n), three(rows))
        }
        None => String::new(),
    };
    let offset = if noise.offset_n > 0.0 {
        format!(", {} N from sweep to sweep", three(noise.offset_n))
    } else {
        String::new()
    };
    paragraph(
        out,
        "  ",
        &format!("noise of the force: {} N white{correlated}{offset} ({})", three(noise.white_n), noise.says),
    );
}

/// Detection limits, and the effects without one.
fn limits(out: &mut String, plan: &Plan) {
    let seen: Vec<&PlannedEffect> = plan.effects.iter().filter(|e| e.detection_limit_n.is_some()).collect();
    // The easiest and the hardest ones are shown; those between them are only named.
    let (easiest, hardest) = if seen.len() <= EASIEST + HARDEST {
        (seen.len(), seen.len())
    } else {
        (EASIEST, seen.len() - HARDEST)
    };
    let part = if easiest == hardest { "" } else { "; the easiest and the hardest" };
    let _ = writeln!(out, "\n  seen from ({SEEN} sigma), and sigmas at the usual size{part}");
    let mut rows = vec![["effect", "limit", "force", "usual", "compensated"].map(str::to_owned).to_vec()];
    rows.extend(seen[..easiest].iter().chain(&seen[hardest..]).map(|effect| row(effect)));
    if rows.iter().skip(1).all(|row| row[4].is_empty()) {
        for row in &mut rows {
            row.truncate(4);
        }
    }
    out.push_str(&table(&rows));
    let between: Vec<&str> = seen[easiest..hardest].iter().map(|e| e.effect.as_str()).collect();
    if !between.is_empty() {
        let shown = &between[..between.len().min(MOST_NAMES)];
        let more = match between.len() - shown.len() {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        paragraph(out, "  ", &format!("between them: {}{more} (--json)", shown.join(", ")));
    }
    let unseen: Vec<(&str, Option<&str>)> = plan
        .effects
        .iter()
        .filter(|e| e.detection_limit_n.is_none())
        .map(|e| (e.effect.as_str(), e.why.as_deref()))
        .collect();
    for line in reasons(&unseen, UNTESTED.len()) {
        let _ = writeln!(out, "{UNTESTED}{line}");
    }
}

fn row(effect: &PlannedEffect) -> Vec<String> {
    let unit = if effect.unit == "1" { "" } else { &effect.unit };
    let limit = effect.detection_limit.map_or_else(
        || "as it is".to_owned(),
        |limit| format!("{} {} {unit}", effect.parameter, three(limit)),
    );
    let compensated = if effect.compensation > MUCH {
        format!("{:.0} %", 100.0 * effect.compensation)
    } else {
        String::new()
    };
    vec![
        effect.effect.clone(),
        limit.trim_end().to_owned(),
        effect.detection_limit_n.map_or_else(String::new, |n| format!("{} N", three(n))),
        three(effect.usual_sigma),
        compensated,
    ]
}

/// Effects that the test can't distinguish.
fn pairs(out: &mut String, plan: &Plan) {
    // Confusion only matters for effects that are detected.
    let is_seen = |name: &str| plan.effects.iter().any(|e| e.effect == name && e.usual_sigma >= SEEN);
    let (never, others): (Vec<&ConfusedPair>, Vec<&ConfusedPair>) =
        plan.confused.iter().filter(|pair| pair.sigma < SEPARATION).partition(|pair| pair.cosine >= SAME);
    let some: Vec<&ConfusedPair> =
        others.into_iter().filter(|pair| pair.effects.iter().all(|name| is_seen(name))).collect();
    if never.is_empty() && some.is_empty() {
        out.push_str("\n  all effects that are seen at their usual size can be told apart\n");
        return;
    }
    let _ = writeln!(out, "\n  could not be told apart (less than {SEPARATION} sigma at the usual size)");
    if !some.is_empty() {
        let mut rows = vec![["pair", "cosine", "sigma", "tests that would"].map(str::to_owned).to_vec()];
        rows.extend(some.iter().take(MOST_PAIRS).map(|pair| {
            let [a, b] = &pair.effects;
            let tests = pair.repeats.map_or_else(|| "-".to_owned(), |repeats| format!("{repeats:.0}"));
            let cosine = format!("{:.5}", pair.cosine);
            vec![format!("{a} and {b}"), cosine, three(pair.sigma), tests]
        }));
        out.push_str(&table(&rows));
    }
    if some.len() > MOST_PAIRS {
        let _ = writeln!(out, "  and {} pairs more: --json", some.len() - MOST_PAIRS);
    }
    if !never.is_empty() {
        let twins: Vec<String> = twins(&never).iter().map(|names| names.join(" = ")).collect();
        paragraph(out, "  ", &format!("by no number of tests (cosine 1, 0 sigma): {}", twins.join("; ")));
    }
}

/// Merges pairs that share an effect into one list.
fn twins<'a>(pairs: &[&'a ConfusedPair]) -> Vec<Vec<&'a str>> {
    let mut lists: Vec<Vec<&str>> = Vec::new();
    for pair in pairs {
        let both = pair.effects.each_ref().map(String::as_str);
        let (mut joined, others): (Vec<_>, Vec<_>) =
            lists.into_iter().partition(|list| both.iter().any(|name| list.contains(name)));
        joined.push(both.to_vec());
        let mut list: Vec<&str> = Vec::new();
        for name in joined.into_iter().flatten() {
            if !list.contains(&name) {
                list.push(name);
            }
        }
        lists = others;
        lists.push(list);
    }
    lists
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_that_share_an_effect_are_one_list() {
        let pair = |a: &str, b: &str| ConfusedPair {
            effects: [a, b].map(str::to_owned),
            cosine: 1.0,
            sigma: 0.0,
            repeats: None,
            separate: String::new(),
        };
        let all = [pair("a", "b"), pair("c", "d"), pair("e", "f"), pair("d", "b")];
        let lists = twins(&all.iter().collect::<Vec<_>>());
        assert_eq!(lists, [vec!["e", "f"], vec!["a", "b", "c", "d"]]);
    }
}

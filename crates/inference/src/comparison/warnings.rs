//! Warnings about the results of a comparison.

use bulge_muscles::Parameter;

use crate::comparison::analysis::Analysis;
use crate::comparison::clock::TIME_UNIT;
use crate::comparison::document::{LeftOut, Rung};
use crate::comparison::specimens::note;
use crate::fit::nuisance::is_geometry;

impl Analysis<'_> {
    /// The warnings, most important first.
    pub(crate) fn warnings(&self, ladder: &[Rung]) -> Vec<String> {
        let mut warnings: Vec<String> =
            self.findings.iter().map(ToString::to_string).chain(note(&self.data, self.muscle)).collect();
        let is_asked = self.findings.iter().any(|finding| finding.kind != TIME_UNIT);
        let negative = ladder.first().filter(|rung| rung.r_squared < 0.0 && !is_asked);
        if let Some(rung) = negative {
            warnings.push(format!(
                "the muscle as stated is farther from these forces ({:.1} N) than their mean is (R^2 below 0): check its length and radius, the zero of the contraction, \
                 and the units of the data",
                rung.rmse_n
            ));
        }
        if self.folds.is_none() && self.options.held_out {
            warnings.push(
                "nothing could be held out: no three pressures, lengths, loads or sweeps were set apart, and no two specimens".to_owned(),
            );
        }
        for rung in ladder {
            let without = rung.without_state.as_ref();
            warnings.extend(without.map(|w| without_state(rung.added.as_deref().unwrap_or("base"), w)));
        }
        let used = |p: Parameter| is_geometry(p) || p == Parameter::GasWall;
        for (parameter, _) in self.muscle.widths().iter().filter(|(p, width)| !used(*p) && *width > 0.0) {
            warnings.push(format!(
                "the width stated for `{}` is not used: only those of length, radius, braid angle and wall are",
                parameter.key()
            ));
        }
        warnings.extend(self.extensor());
        let lowest = ladder.iter().filter_map(|rung| rung.held_out_rmse_n).fold(f64::INFINITY, f64::min);
        if let Some((last, held_out)) = ladder.last().and_then(|rung| Some((rung, rung.held_out_rmse_n?)))
            && held_out > 1.2 * lowest
        {
            let larger =
                format!("the error on unseen data larger ({held_out:.1} N instead of {lowest:.1} N)");
            let held = held_amiss(ladder);
            let all: Vec<String> =
                last.held.iter().map(|held| format!("`{}.{}`", held.effect, held.name)).collect();
            let or_held = match all.len() {
                0 => String::new(),
                _ => format!(", or what is held ({}) is far from what the data want", all.join(", ")),
            };
            warnings.push(if held.is_empty() {
                format!(
                    "the last effect, `{}`, makes {larger}: it follows these rows, not the muscle{or_held}",
                    last.added.as_deref().unwrap_or("")
                )
            } else {
                format!("what is held makes {larger}: {}; fitted, it would be another", held.join(", "))
            });
        }
        if let Some(fit) = ladder.last().and_then(|rung| rung.fit.as_ref()) {
            warnings.extend(fit.warnings.iter().cloned());
        }
        warnings
    }

    /// Warns about a braid whose fibres run around the axis rather than along it.
    fn extensor(&self) -> Option<String> {
        let neutral = std::f64::consts::SQRT_2.atan();
        let angle = self.muscle.get(Parameter::BraidAngle).filter(|angle| *angle > neutral)?;
        Some(format!(
            "the braid angle at rest is {:.1} deg, above the neutral {:.1} deg: under pressure such a muscle gets longer and pushes; check that the angle counts from the axis",
            angle.to_degrees(),
            neutral.to_degrees()
        ))
    }
}

/// Held parameters of effects with which the error rose, or which left nothing to fit. With a free parameter
/// the error would fall.
fn held_amiss(ladder: &[Rung]) -> Vec<String> {
    let mut found = Vec::new();
    for (i, pair) in ladder.windows(2).enumerate() {
        let [before, rung] = pair else { continue };
        let is_last = i + 2 == ladder.len();
        if rung.rmse_n > before.rmse_n || is_last && rung.fitted <= before.fitted {
            let own = rung.held.iter().filter(|held| Some(&held.effect) == rung.added.as_ref());
            found.extend(own.map(|held| format!("`{held}`")));
        }
    }
    found
}

/// The sentence about rows that have no state in a model.
pub(crate) fn without_state(model: &str, left: &LeftOut) -> String {
    let LeftOut { why, lines, rows } = left;
    format!(
        "`{model}`: {rows} rows have no state with its numbers (line {lines}) and are not in its error; of the first: {why}"
    )
}

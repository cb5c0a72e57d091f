//! The rungs of a diagnosis: the effects by their formulas, then with their fitted form errors. Each rung
//! that is shown lowers the error.

use crate::comparison::analysis::Analysis;
use crate::comparison::document::Rung;
use crate::diagnosis::form_error::Bent;
use crate::diagnosis::stage::Stage;
use crate::error::InferenceError;
use bulge_numerics::vector::add;

/// Separator between the names of effects that were added together.
pub(crate) const TOGETHER: &str = " + ";
/// Smaller relative decreases of an error count as none.
const NOTHING: f64 = 1e-3;

/// Joins each rung that doesn't lower the error with the next one, and the last such rung with the one
/// before. The base and the first `known` rungs stay, as does a single effect.
pub(crate) fn join_useless(ladder: &mut Vec<Rung>, known: usize) {
    let first = known + 1;
    let mut i = first;
    while i < ladder.len() && ladder.len() > first + 1 {
        if ladder[i].rmse_n <= (1.0 - NOTHING) * ladder[i - 1].rmse_n {
            i += 1;
            continue;
        }
        // The later of the two has both effects.
        let earlier = if i + 1 < ladder.len() { i } else { i - 1 };
        if earlier < first {
            break;
        }
        let joined = ladder.remove(earlier);
        let later = &mut ladder[earlier];
        later.added = joined.added.zip(later.added.take()).map(|(a, b)| format!("{a}{TOGETHER}{b}"));
        later.title = format!("{}{TOGETHER}{}", joined.title, later.title);
        i = earlier;
    }
}

/// A rung of effects that get their form errors, on top of the rungs before.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BentRung {
    /// Names of the effects.
    pub(crate) effects: Vec<String>,
    /// RMS error of the rows, measured - (formulas + form errors) \[N\].
    pub(crate) rmse_n: f64,
}

/// The rungs of a stage's effects with their form errors, below an error of `above_n`. `groups` are the rows
/// of each mean on which the stage was found.
pub(crate) fn bent_rungs(
    analysis: &Analysis<'_>,
    stage: &Stage,
    groups: &[Vec<usize>],
    above_n: f64,
) -> Result<Vec<BentRung>, InferenceError> {
    let bent: Vec<&Bent> = stage.linear.form.effects.iter().filter(|bent| bent.may_bend()).collect();
    if bent.is_empty() {
        return Ok(Vec::new());
    }
    let model = &stage.confirmed;
    let force = analysis.predicted(&model.prepared, &model.theta)?.prediction.force;
    let mut residual = vec![f64::NAN; analysis.record.len()];
    for row in analysis.with_state(&[&force]) {
        residual[row] = analysis.record.force()[row] - force[row];
    }
    let bending: Vec<(&str, &[f64])> =
        bent.iter().map(|bent| (bent.effect.card().name, &bent.bending[..])).collect();
    Ok(lowered(&bending, groups, &residual, above_n))
}

/// Rungs of effects that get their form errors one after the other, from the name and the form error of each
/// mean \[N\]. An effect that doesn't lower the error is joined with the next one, and dropped if none
/// follows.
///
/// Residuals of rows that don't count are NaN. Rows that are in no mean, the later cycles of a long record,
/// are assumed to improve as much as the others.
fn lowered(
    bending: &[(&str, &[f64])],
    groups: &[Vec<usize>],
    residual: &[f64],
    above_n: f64,
) -> Vec<BentRung> {
    let mean_square = |values: &mut dyn Iterator<Item = f64>| {
        let counted = values.filter(|value| value.is_finite());
        let (sum, count) = counted.fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
        sum / f64::max(count, 1.0)
    };
    let less = |sum: &[f64]| {
        let rows = groups.iter().zip(sum);
        mean_square(&mut rows.flat_map(|(rows, bent)| rows.iter().map(move |row| residual[*row] - bent)))
    };
    let mut sum = vec![0.0; groups.len()];
    let beyond = mean_square(&mut residual.iter().copied()) - less(&sum);
    let mut found: Vec<BentRung> = Vec::new();
    let mut waiting = Vec::new();
    for (name, bending) in bending {
        add(&mut sum, 1.0, bending);
        waiting.push((*name).to_owned());
        let rmse_n = (less(&sum) + beyond).max(0.0).sqrt();
        let above_n = found.last().map_or(above_n, |rung| rung.rmse_n);
        if rmse_n <= (1.0 - NOTHING) * above_n {
            found.push(BentRung { effects: std::mem::take(&mut waiting), rmse_n });
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bent_rung_is_what_the_bending_leaves_of_the_rows() {
        let groups = [vec![0, 1], vec![2], vec![3, 4, 5]];
        // Row 3 doesn't count.
        let residual = [5.0, 3.0, -2.0, f64::NAN, 1.0, 2.0];
        let (first, second) = (vec![3.0, -1.0, 0.5], vec![0.5, -1.0, 1.0]);
        let bending = [("a", &first[..]), ("b", &second[..])];
        let by_hand = |left: [f64; 5]| (left.iter().map(|r| r * r).sum::<f64>() / 5.0).sqrt();
        let one = by_hand([2.0, 0.0, -1.0, 0.5, 1.5]);
        let both = by_hand([1.5, -0.5, 0.0, -0.5, 0.5]);
        let found = lowered(&bending, &groups, &residual, 3.0);
        assert_eq!(found.iter().map(|rung| rung.effects.concat()).collect::<Vec<_>>(), ["a", "b"]);
        assert!((found[0].rmse_n - one).abs() < 1e-12 && (found[1].rmse_n - both).abs() < 1e-12, "{found:?}");
        // An effect that lowers nothing forms a rung with the next one, and none if nothing follows.
        let found = lowered(&bending, &groups, &residual, one);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].effects, ["a", "b"]);
        assert!((found[0].rmse_n - both).abs() < 1e-12);
        assert_eq!(lowered(&bending[..1], &groups, &residual, one), []);
        assert_eq!(lowered(&bending, &groups, &residual, both), []);
    }

    #[test]
    fn rows_that_are_in_no_mean_gain_as_much_as_the_others() {
        let found = lowered(&[("a", &[3.0])], &[vec![0, 1]], &[4.0, 2.0, 6.0, 0.0], 4.0);
        // The mean square is 14; rows 0 and 1 go from 10 to 1.
        assert!((found[0].rmse_n - 5.0_f64.sqrt()).abs() < 1e-12, "{found:?}");
    }

    fn rung(name: &str, rmse_n: f64) -> Rung {
        Rung {
            added: (!name.is_empty()).then(|| name.to_owned()),
            title: name.to_owned(),
            rmse_n,
            ..Rung::default()
        }
    }

    fn joined(errors: &[(&str, f64)], known: usize) -> Vec<String> {
        let mut ladder: Vec<Rung> = errors.iter().map(|(name, error)| rung(name, *error)).collect();
        join_useless(&mut ladder, known);
        ladder
            .iter()
            .map(|rung| format!("{} {}", rung.added.as_deref().unwrap_or("base"), rung.rmse_n))
            .collect()
    }

    #[test]
    fn each_rung_lowers_something() {
        assert_eq!(joined(&[("", 9.0), ("a", 5.0), ("b", 3.0)], 0), ["base 9", "a 5", "b 3"]);
        assert_eq!(joined(&[("", 9.0), ("a", 9.1), ("b", 3.0)], 0), ["base 9", "a + b 3"]);
        assert_eq!(joined(&[("", 9.0), ("a", 5.0), ("b", 5.0)], 0), ["base 9", "a + b 5"]);
        assert_eq!(joined(&[("", 9.0), ("a", 9.0), ("b", 9.0), ("c", 2.0)], 0), ["base 9", "a + b + c 2"]);
        // Rungs of the base are never joined, and a single effect stays.
        assert_eq!(joined(&[("", 9.0), ("a", 9.0), ("b", 8.0)], 1), ["base 9", "a 9", "b 8"]);
        assert_eq!(joined(&[("", 9.0), ("a", 9.0)], 0), ["base 9", "a 9"]);
    }
}

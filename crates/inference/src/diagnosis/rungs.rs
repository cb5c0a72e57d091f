//! Rungs of a ladder that lower nothing: they are joined with the next one, so that each rung that is shown does something.

use crate::comparison::document::Rung;

/// What stands between the names of effects that were added together.
pub(crate) const TOGETHER: &str = " + ";
/// Part of an error below which a fall is none.
const NOTHING: f64 = 1e-3;

/// Joins each rung above the first `known` and the base that lowers the error by nothing with the one after it, and the last with the one before. An effect that stands
/// alone stays.
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

#[cfg(test)]
mod tests {
    use super::*;

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
        // What the base has is no rung to join, and an effect alone stays.
        assert_eq!(joined(&[("", 9.0), ("a", 9.0), ("b", 8.0)], 1), ["base 9", "a 9", "b 8"]);
        assert_eq!(joined(&[("", 9.0), ("a", 9.0)], 0), ["base 9", "a 9"]);
    }
}

//! Effects that can't be tested, in one line for each reason.

use crate::diagnose::paragraph::WIDTH;

/// Most lines.
const MOST: usize = 3;
/// Most characters of a reason.
const LONGEST: usize = 64;
/// Reason if no other is known.
const NOTHING: &str = "would change nothing here";

/// At most three lines, the reason with most effects first: `(needs a path with a column `time`): creep,
/// viscous-damping and 2 more`. Each line follows words of `lead` characters.
pub(crate) fn reasons(untested: &[(&str, Option<&str>)], lead: usize) -> Vec<String> {
    let mut groups: Vec<(&str, Vec<&str>)> = Vec::new();
    for (name, why) in untested {
        let why = why.unwrap_or(NOTHING);
        match groups.iter_mut().find(|(other, _)| *other == why) {
            Some((_, names)) => names.push(name),
            None => groups.push((why, vec![name])),
        }
    }
    // The sort is stable: of reasons with equally many effects the first one comes first.
    groups.sort_by_key(|(_, names)| std::cmp::Reverse(names.len()));
    if groups.len() > MOST {
        let others = groups.split_off(MOST - 1).into_iter().flat_map(|(_, names)| names).collect();
        groups.push(("for other reasons: see --json", others));
    }
    groups.iter().map(|(why, names)| line(why, names, WIDTH.saturating_sub(lead))).collect()
}

/// As many names as fit, at least one.
fn line(why: &str, names: &[&str], width: usize) -> String {
    let why = if why.chars().count() > LONGEST {
        why.chars().take(LONGEST - 3).chain("...".chars()).collect()
    } else {
        why.to_owned()
    };
    let with = |shown: usize| {
        let more = match names.len() - shown {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        format!("({why}): {}{more}", names[..shown].join(", "))
    };
    (1..=names.len())
        .rev()
        .map(with)
        .find(|line| line.chars().count() <= width)
        .unwrap_or_else(|| with(names.len().min(1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effects_stand_together_by_their_reason() {
        let time = Some("needs a path with a column `time`");
        let lines =
            reasons(&[("temperature", Some("needs warmth")), ("creep", time), ("force-lag", time)], 0);
        assert_eq!(
            lines,
            ["(needs a path with a column `time`): creep, force-lag", "(needs warmth): temperature"]
        );
        assert_eq!(reasons(&[("lobes", None)], 0), ["(would change nothing here): lobes"]);
        assert_eq!(reasons(&[], 0), Vec::<String>::new());
    }

    #[test]
    fn there_are_three_lines_at_most_and_none_is_too_long() {
        let long = "why ".repeat(40);
        let names: Vec<String> = (0..40).map(|i| format!("effect-{i}")).collect();
        let mut untested: Vec<(&str, Option<&str>)> =
            names.iter().map(|n| (n.as_str(), Some(long.as_str()))).collect();
        untested.extend([("a", Some("x")), ("b", Some("y")), ("c", Some("y")), ("d", Some("z"))]);
        let lines = reasons(&untested, 16);
        assert_eq!(lines.len(), 3);
        assert!(lines.iter().all(|line| line.chars().count() <= WIDTH - 16), "{lines:#?}");
        assert!(lines[0].contains("...): effect-0 and ") && lines[0].ends_with(" more"), "{lines:#?}");
        assert_eq!(lines[1..], ["(y): b, c", "(for other reasons: see --json): a, d"]);
    }
}

//! Differences between the plan stored in a folder and the plan of a sweep that is to be resumed there.

/// Largest number of differing lines that are shown from each text.
const MOST_SHOWN: usize = 12;

/// The lines in which two texts differ; each is shown with its key.
pub(crate) fn difference(before: &str, now: &str) -> String {
    let (old, new): (Vec<&str>, Vec<&str>) = (before.lines().collect(), now.lines().collect());
    let same = old.iter().zip(&new).take_while(|(a, b)| a == b).count();
    let rest = old.len().min(new.len()) - same;
    let tail = old.iter().rev().zip(new.iter().rev()).take(rest).take_while(|(a, b)| a == b).count();
    let part = |lines: &[&str], sign: char| {
        let lines = &lines[same..lines.len() - tail];
        let mut shown: Vec<String> =
            lines.iter().take(MOST_SHOWN).map(|line| format!("  {sign} {}", line.trim())).collect();
        if lines.len() > MOST_SHOWN {
            shown.push(format!("  {sign} ... and {} lines more", lines.len() - MOST_SHOWN));
        }
        shown
    };
    [part(&old, '-'), part(&new, '+')].concat().join("\n")
}

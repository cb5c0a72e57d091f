//! Descriptions of force laws for a reader: equation, coefficients with values and units, range, source,
//! errata.

use super::coefficient::{Coefficient, CoefficientTable, Role};
use super::definition::Law;
use super::list::{LAWS, PAPERS};
use super::pleated_polynomial::{S1_VOLUME, VolumeLaw};
use crate::Evidence;
use bulge_muscles::Kind;
use std::fmt::{self, Write};

/// The largest width of running text.
const WIDTH: usize = 100;

/// The contents that force laws and volume formulas have in common.
struct Sheet<'a> {
    name: &'a str,
    aliases: &'a [&'a str],
    title: &'a str,
    kind: Option<Kind>,
    directional: bool,
    equation: &'a str,
    coefficients: &'a [Coefficient],
    tables: &'a [CoefficientTable],
    range: &'a str,
    source: &'a str,
    evidence: Evidence,
    notes: &'a [&'a str],
}

impl fmt::Display for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, aliases, title, kind, directional, equation, coefficients, .. } = *self;
        let Self { tables, range, source, evidence, notes, .. } = *self;
        Sheet {
            name,
            aliases,
            title,
            kind,
            directional,
            equation,
            coefficients,
            tables,
            range,
            source,
            evidence,
            notes,
        }
        .fmt(f)
    }
}

impl fmt::Display for VolumeLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, title, kind, equation, coefficients, tables, range, source, evidence, notes } =
            *self;
        Sheet {
            name,
            aliases: &[],
            title,
            kind,
            directional: false,
            equation,
            coefficients,
            tables,
            range,
            source,
            evidence,
            notes,
        }
        .fmt(f)
    }
}

impl fmt::Display for Sheet<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {}", self.name, self.title)?;
        let muscles = self.kind.map_or("braided and pleated", Kind::name);
        let direction = if self.directional { "; tells shortening from lengthening" } else { "" };
        let aliases = if self.aliases.is_empty() {
            String::new()
        } else {
            format!("; also called {}", self.aliases.join(", "))
        };
        writeln!(f, "{muscles} muscles{direction}{aliases}\n")?;
        for line in self.equation.lines() {
            writeln!(f, "    {line}")?;
        }
        writeln!(f)?;
        self.write_coefficients(f)?;
        self.write_tables(f)?;
        write_item(f, "valid", self.range)?;
        write_item(f, "source", &cited(self.source, self.evidence))?;
        self.notes.iter().try_for_each(|note| write_item(f, "note", note))
    }
}

impl Sheet<'_> {
    /// One line for each coefficient: symbol, unit, start, meaning.
    fn write_coefficients(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let symbol = widest(self.coefficients.iter().map(|c| c.name));
        let unit = widest(self.coefficients.iter().map(|c| c.unit)) + 2;
        for coefficient in self.coefficients {
            let unit_text = format!("[{}]", coefficient.unit);
            let note = match coefficient.role {
                Role::Measured(_) => {
                    format!(" (measured on the muscle, such as {})", digits(coefficient.typical))
                }
                Role::Redundant => format!(" (kept at {})", digits(coefficient.typical)),
                Role::Fitted if self.tables.is_empty() => {
                    format!(" (such as {})", digits(coefficient.typical))
                }
                Role::Fitted if !coefficient.linear => " (not linear)".to_owned(),
                Role::Fitted => String::new(),
            };
            writeln!(f, "  {:symbol$}  {unit_text:unit$}  {}{note}", coefficient.name, coefficient.meaning)?;
        }
        writeln!(f)
    }

    /// The sets of coefficients side by side, with their sources below.
    fn write_tables(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.tables.is_empty() {
            return Ok(());
        }
        let symbol = widest(self.coefficients.iter().map(|c| c.name));
        let columns: Vec<Vec<String>> = self
            .tables
            .iter()
            .map(|table| table.values.iter().map(|value| digits(*value)).collect())
            .collect();
        let widths: Vec<usize> = columns
            .iter()
            .zip(self.tables)
            .map(|(column, table)| widest(column.iter().map(String::as_str)).max(table.name.chars().count()))
            .collect();
        write!(f, "  {:symbol$}", "")?;
        for (table, width) in self.tables.iter().zip(&widths) {
            write!(f, "  {:>width$}", table.name)?;
        }
        writeln!(f)?;
        let rows = columns.iter().map(Vec::len).max().unwrap_or(0);
        for (row, coefficient) in self.coefficients.iter().enumerate().take(rows) {
            write!(f, "  {:symbol$}", coefficient.name)?;
            for (column, width) in columns.iter().zip(&widths) {
                write!(f, "  {:>width$}", column.get(row).map_or("", String::as_str))?;
            }
            writeln!(f)?;
        }
        writeln!(f)?;
        for table in self.tables {
            write_item(f, "table", &format!("{}: {}", table.name, cited(table.source, table.evidence)))?;
        }
        Ok(())
    }
}

/// A source, with its reliability unless it is simply printed.
fn cited(source: &str, evidence: Evidence) -> String {
    if evidence == Evidence::Paper { source.to_owned() } else { format!("{source} ({})", evidence.says()) }
}

fn widest<'a>(texts: impl Iterator<Item = &'a str>) -> usize {
    texts.map(|text| text.chars().count()).max().unwrap_or(0)
}

/// A number with at most ten significant digits, as printed in the papers.
fn digits(value: f64) -> String {
    format!("{value:.9e}").parse::<f64>().unwrap_or(value).to_string()
}

/// Writes a paragraph with a heading in the margin.
fn write_item(out: &mut dyn Write, heading: &str, text: &str) -> fmt::Result {
    const MARGIN: usize = 10;
    let mut column = MARGIN;
    write!(out, "  {heading:<width$}", width = MARGIN - 2)?;
    for (i, word) in text.split_whitespace().enumerate() {
        let length = word.chars().count();
        if i > 0 && column + 1 + length > WIDTH {
            write!(out, "\n{:MARGIN$}", "")?;
            column = MARGIN;
        } else if i > 0 {
            write!(out, " ")?;
            column += 1;
        }
        write!(out, "{word}")?;
        column += length;
    }
    writeln!(out)
}

/// All laws and the papers, as a text for a reader.
///
/// ```
/// let text = bulge_effects::law::reference();
/// assert!(text.contains("sarosi-6") && text.contains("-280.498151"));
/// ```
#[must_use]
pub fn reference() -> String {
    let mut text = String::from(
        "Force laws of the papers: rivals of the equilibrium model\n\n\
         p is the gauge pressure, kappa = (l0 - l)/l0 the contraction, F the force (tension positive), l0 the length at rest.\n\n",
    );
    for paper in &PAPERS {
        // Writing into a String can't fail.
        let _ = writeln!(text, "  {}  \"{}\"", paper.key, paper.title);
    }
    let sheets = LAWS.iter().map(ToString::to_string).chain([S1_VOLUME.to_string()]);
    for sheet in sheets {
        text.push_str("\n\n");
        text.push_str(&sheet);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheet_says_everything() {
        for law in LAWS {
            let text = law.to_string();
            for part in [law.name, law.title, law.equation.lines().next().unwrap(), "  valid", "  source"] {
                assert!(text.contains(part), "{part} in\n{text}");
            }
            for coefficient in law.coefficients {
                let unit = format!("[{}]", coefficient.unit);
                let line = text
                    .lines()
                    .find(|line| line.contains(&format!("{unit} ")) && line.contains(coefficient.meaning))
                    .unwrap_or_else(|| panic!("{}: {text}", coefficient.name));
                let is_kept = matches!(coefficient.role, Role::Redundant);
                let is_asked = matches!(coefficient.role, Role::Fitted) && !law.tables.is_empty();
                let such_as = line.contains(&format!("such as {})", digits(coefficient.typical)));
                assert_eq!(such_as, !is_asked && !is_kept, "{}: {text}", coefficient.name);
                let note = line.contains(" (not linear)");
                assert_eq!(note, is_asked && !coefficient.linear, "{}: {text}", coefficient.name);
            }
            // Meanings stand below each other, two spaces after the widest unit.
            let mut meanings = law
                .coefficients
                .iter()
                .filter_map(|c| text.lines().find_map(|line| line.find(&format!("  {}", c.meaning))));
            let first = meanings.next();
            assert!(meanings.all(|at| Some(at) == first), "{text}");
            for table in law.tables {
                assert!(text.contains(table.name));
                assert!(table.values.iter().all(|value| text.contains(&digits(*value))), "{}", table.name);
            }
            assert_eq!(text.matches("\n  note").count(), law.notes.len());
            assert!(!text.contains("  \n") && text.lines().all(|line| line.chars().count() <= 112), "{text}");
        }
    }

    #[test]
    fn numbers_as_printed() {
        let text = Law::find("sarosi-6").unwrap().to_string();
        for number in ["-4.00180705", "292.4620246", "-9.38346682", "-274.484755"] {
            assert!(text.contains(number), "{number}");
        }
        assert_eq!((digits(0.1 + 0.2), digits(-573_892.1)), ("0.3".to_owned(), "-573892.1".to_owned()));
    }

    #[test]
    fn the_reference_has_every_paper_and_law() {
        let text = reference();
        assert!(PAPERS.iter().all(|paper| text.contains(paper.title)));
        assert!(LAWS.iter().all(|law| text.contains(&format!("\n{}: ", law.name))));
        assert!(text.contains("\ns1-volume: ") && text.contains("Not a force law"));
    }
}
